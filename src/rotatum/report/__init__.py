"""Reports for people: one self-contained HTML page, and its figures."""

from rotatum.report.figure import plot
from rotatum.report.page import write_report

__all__ = ["plot", "write_report"]
