"""Scenarios: TOML files that say which device moves how, with which faults, and for how long."""

from rotatum.simulation.scenario.scenario import Scenario, load_scenario, scenario_from_tables
from rotatum.simulation.scenario.sources import ready_abouts, scenario_names, scenario_text

__all__ = [
    "Scenario",
    "load_scenario",
    "ready_abouts",
    "scenario_from_tables",
    "scenario_names",
    "scenario_text",
]
