"""De Luca, Schröder, Thümmel 2007: the full state from motor encoders and accelerometers."""

from rotatum.evaluation.papers.deluca2007 import control, observer, singular

__all__ = ["CASES", "TITLE"]

TITLE = "An Acceleration-based State Observer for Robot Manipulators with Elastic Joints"
CASES = (observer.CASE, singular.CASE, control.CASE)
