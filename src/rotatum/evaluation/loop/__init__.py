"""Robots in closed loop in the simulator: laws of `rotatum.control` on what estimators observe."""

from rotatum.evaluation.loop.closed import (
    ClosedLoop,
    StateEstimate,
    at_rest,
    closed_loop,
    vibration,
)
from rotatum.evaluation.loop.observed import ObservedState, true_state
from rotatum.evaluation.loop.told import less_known, without_friction

__all__ = [
    "ClosedLoop",
    "ObservedState",
    "StateEstimate",
    "at_rest",
    "closed_loop",
    "less_known",
    "true_state",
    "vibration",
    "without_friction",
]
