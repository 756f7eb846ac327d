"""Trumić, Grioli, Jovanović, Fagiolini 2022: link-side unknown-input observer."""

from rotatum.evaluation.papers.trumic2022 import experiments, simulation, uncertainty

__all__ = ["CASES", "TITLE"]

TITLE = "Force/Torque-Sensorless Joint Stiffness Estimation in Articulated Soft Robots"
CASES = (simulation.CASE, uncertainty.CASE, experiments.CASE)
