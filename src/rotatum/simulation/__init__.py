"""Robots with known truth: plants, drives that move them, sensors with faults, logs of them."""

from rotatum.simulation.demo import demo_log
from rotatum.simulation.drivers.waves import (
    After,
    Chirp,
    Drive,
    Ramps,
    Sawtooth,
    Sines,
    Square,
    hold,
    multisine,
    sine,
)
from rotatum.simulation.joint import simulate_joint
from rotatum.simulation.plant.bodies import Body, Plant, plant_of
from rotatum.simulation.sensing.sensors import Sensors

__all__ = [
    "After",
    "Body",
    "Chirp",
    "Drive",
    "Plant",
    "Ramps",
    "Sawtooth",
    "Sensors",
    "Sines",
    "Square",
    "demo_log",
    "hold",
    "multisine",
    "plant_of",
    "simulate_joint",
    "sine",
]
