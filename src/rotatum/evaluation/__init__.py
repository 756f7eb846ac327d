"""The main job, how good its answer is, and which method suits a log."""

from rotatum.evaluation.characterise import characterise
from rotatum.evaluation.compare import compare
from rotatum.evaluation.comparison import ComparedMethod, Comparison
from rotatum.evaluation.estimate import Estimate, JointEstimate
from rotatum.evaluation.metrics import TruthScore, coverage_percent, mse, msrep_percent
from rotatum.evaluation.recommend import Advice, Recommendation, recommend
from rotatum.evaluation.run import estimate
from rotatum.evaluation.statics.result import Characterisation

__all__ = [
    "Advice",
    "Characterisation",
    "ComparedMethod",
    "Comparison",
    "Estimate",
    "JointEstimate",
    "Recommendation",
    "TruthScore",
    "characterise",
    "compare",
    "coverage_percent",
    "estimate",
    "mse",
    "msrep_percent",
    "recommend",
]
