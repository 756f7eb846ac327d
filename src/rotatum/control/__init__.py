"""Control on the estimate: inverse dynamics, full-state feedback, decoupled stiffness."""

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState
from rotatum.control.decoupling import DecouplingGains, DecouplingLaw, Target
from rotatum.control.elastic_arm import ElasticArm
from rotatum.control.inverse_dynamics import Desired, desired_motion, inverse_dynamics
from rotatum.control.pole_placement import ElasticJoint, PolePair, motor_gains, state_gains
from rotatum.control.state_feedback import (
    StateFeedback,
    full_state_feedback,
    joints_at,
    motor_feedback,
)
from rotatum.control.stiffness_control import StiffnessControl
from rotatum.control.switching import Switching
from rotatum.control.trajectory import LinkTrajectory, RestToRest, blend, shortest_duration

__all__ = [
    "AntagonisticJoint",
    "DecouplingGains",
    "DecouplingLaw",
    "Desired",
    "ElasticArm",
    "ElasticJoint",
    "JointState",
    "LinkTrajectory",
    "PolePair",
    "RestToRest",
    "StateFeedback",
    "StiffnessControl",
    "Switching",
    "Target",
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
