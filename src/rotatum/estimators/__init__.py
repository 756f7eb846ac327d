"""One file per method: wires kernels into a stage, states its assumptions, cites its paper."""

from rotatum.estimators.estimator import Estimator, Readings

__all__ = ["Estimator", "Readings"]
