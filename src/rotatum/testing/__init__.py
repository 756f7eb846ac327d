"""Checks for stages, public as numpy's are: ``check_stage`` runs the contract on any stage."""

from __future__ import annotations

from rotatum.testing.check import check_stage
from rotatum.testing.report import Report, Verdict
from rotatum.testing.signals import random_inputs, random_params

__all__ = ["Report", "Verdict", "check_stage", "random_inputs", "random_params"]
