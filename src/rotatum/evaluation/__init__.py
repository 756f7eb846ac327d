"""The main job, and how good its answer is."""

from rotatum.evaluation.estimate import Estimate, JointEstimate
from rotatum.evaluation.metrics import TruthScore, coverage_percent, mse, msrep_percent
from rotatum.evaluation.run import estimate

__all__ = [
    "Estimate",
    "JointEstimate",
    "TruthScore",
    "coverage_percent",
    "estimate",
    "mse",
    "msrep_percent",
]
