"""One file per method: wires kernels into a stage, states its assumptions, cites its paper."""

from rotatum.estimators.estimator import Estimator
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.estimators.full_state.states import FullState
from rotatum.estimators.readings import Readings

__all__ = ["Estimator", "FullState", "Readings", "StateObserver"]
