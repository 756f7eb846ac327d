"""Flacco, De Luca, Sardellitti, Tsagarakis 2012: motor-side residual and least squares."""

from rotatum.evaluation.papers.flacco2012 import (
    antagonistic_figures,
    arm,
    encoders,
    experiment,
    serial_figures,
    stability,
    table1,
    table2,
    validation,
)

__all__ = ["CASES", "TITLE"]

TITLE = "On-line estimation of variable stiffness in flexible robot joints"
CASES = (
    table1.CASE,
    *antagonistic_figures.CASES,
    table2.CASE,
    serial_figures.CASE,
    arm.CASE,
    stability.CASE,
    *encoders.CASES,
    experiment.CASE,
    validation.CASE,
)
