"""Reports for people: self-contained HTML pages, and their figures."""

from rotatum.report.comparison_page import write_comparison
from rotatum.report.comparison_panel import plot_comparison
from rotatum.report.figure import plot
from rotatum.report.observation_page import write_observation
from rotatum.report.page import write_report
from rotatum.report.statics_page import write_characterisation

__all__ = [
    "plot",
    "plot_comparison",
    "write_characterisation",
    "write_comparison",
    "write_observation",
    "write_report",
]
