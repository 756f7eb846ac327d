"""Robots with known truth: plants, torques that move them, sensors with faults, logs of them."""

from rotatum.simulation.demo import demo_log
from rotatum.simulation.excitation import After, Chirp, Sines, Torque, multisine, sine
from rotatum.simulation.plant import SeriesPlant, plant_of
from rotatum.simulation.sensors import Sensors
from rotatum.simulation.series import simulate_series

__all__ = [
    "After",
    "Chirp",
    "Sensors",
    "SeriesPlant",
    "Sines",
    "Torque",
    "demo_log",
    "multisine",
    "plant_of",
    "simulate_series",
    "sine",
]
