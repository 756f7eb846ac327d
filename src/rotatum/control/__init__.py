"""Control on the estimate: inverse dynamics of elastic joints, full-state feedback."""

from rotatum.control.elastic_arm import ElasticArm
from rotatum.control.inverse_dynamics import Desired, desired_motion, inverse_dynamics
from rotatum.control.pole_placement import ElasticJoint, PolePair, motor_gains, state_gains
from rotatum.control.state_feedback import (
    StateFeedback,
    full_state_feedback,
    joints_at,
    motor_feedback,
)
from rotatum.control.trajectory import LinkTrajectory, RestToRest, blend, shortest_duration

__all__ = [
    "Desired",
    "ElasticArm",
    "ElasticJoint",
    "LinkTrajectory",
    "PolePair",
    "RestToRest",
    "StateFeedback",
    "blend",
    "desired_motion",
    "full_state_feedback",
    "inverse_dynamics",
    "joints_at",
    "motor_feedback",
    "motor_gains",
    "shortest_duration",
    "state_gains",
]
