"""The main job, how good its answer is, and which method suits a log."""

from rotatum.evaluation.calibrate import Calibrated, calibrate
from rotatum.evaluation.characterise import characterise
from rotatum.evaluation.compare import compare
from rotatum.evaluation.comparison import ComparedMethod, Comparison
from rotatum.evaluation.estimate import Estimate, JointEstimate
from rotatum.evaluation.matching import Matched, match_observer
from rotatum.evaluation.metrics import TruthScore, coverage_percent, mse, msrep_percent
from rotatum.evaluation.observation import JointObservation, Observation
from rotatum.evaluation.observe import observe
from rotatum.evaluation.recommend import Advice, Recommendation, recommend
from rotatum.evaluation.run import estimate
from rotatum.evaluation.statics.result import Characterisation

__all__ = [
    "Advice",
    "Calibrated",
    "Characterisation",
    "ComparedMethod",
    "Comparison",
    "Estimate",
    "JointEstimate",
    "JointObservation",
    "Matched",
    "Observation",
    "Recommendation",
    "TruthScore",
    "calibrate",
    "characterise",
    "compare",
    "coverage_percent",
    "estimate",
    "match_observer",
    "mse",
    "msrep_percent",
    "observe",
    "recommend",
]
