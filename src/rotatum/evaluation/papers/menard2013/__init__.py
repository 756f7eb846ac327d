"""Ménard, Grioli, Bicchi 2013: operational calculus on the motor side."""

from rotatum.evaluation.papers.menard2013 import section4, section5

__all__ = ["CASES", "TITLE"]

TITLE = "A real time robust observer for an agonist-antagonist variable stiffness actuator"
CASES = (section4.CASE, section5.CASE)
