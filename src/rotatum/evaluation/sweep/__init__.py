"""Sweeps: a scenario simulated, estimated and scored for every combination of values."""

from rotatum.evaluation.sweep.case import Case
from rotatum.evaluation.sweep.choices import Choices
from rotatum.evaluation.sweep.plan import Plan, plan_of
from rotatum.evaluation.sweep.run import sweep
from rotatum.evaluation.sweep.summary import Group, summary
from rotatum.evaluation.sweep.table import TIMINGS
from rotatum.evaluation.sweep.vary import Vary, parse_vary

__all__ = [
    "TIMINGS",
    "Case",
    "Choices",
    "Group",
    "Plan",
    "Vary",
    "parse_vary",
    "plan_of",
    "summary",
    "sweep",
]
