"""Robots with known truth: plants, drivers that move them, sensors with faults, logs of them."""

from rotatum.simulation.demo import demo_log
from rotatum.simulation.device import simulate
from rotatum.simulation.drivers.arm_control import ArmControl
from rotatum.simulation.drivers.binary import Prbs
from rotatum.simulation.drivers.combined import Scaled, Together
from rotatum.simulation.drivers.commands import co_contraction, position_drives
from rotatum.simulation.drivers.compensation import gravity_of
from rotatum.simulation.drivers.feedback import Feedback, Seen
from rotatum.simulation.drivers.paths import FadeIn, Path, Ramps, Superposed, hold
from rotatum.simulation.drivers.recorded import recorded
from rotatum.simulation.drivers.waves import (
    After,
    Chirp,
    Drive,
    Sawtooth,
    Sines,
    Square,
    multisine,
    sine,
)
from rotatum.simulation.joint import simulate_joint
from rotatum.simulation.payload import Payload
from rotatum.simulation.plant.bodies import Body, Plant, plant_of
from rotatum.simulation.plant.effects import Effects, StiffnessDrift
from rotatum.simulation.scenario import Scenario, load_scenario, scenario_names
from rotatum.simulation.sensing.inertial import InertialFaults
from rotatum.simulation.sensing.live import LiveSensors, Readings
from rotatum.simulation.sensing.sensors import Sensors

__all__ = [
    "After",
    "ArmControl",
    "Body",
    "Chirp",
    "Drive",
    "Effects",
    "FadeIn",
    "Feedback",
    "InertialFaults",
    "LiveSensors",
    "Path",
    "Payload",
    "Plant",
    "Prbs",
    "Ramps",
    "Readings",
    "Sawtooth",
    "Scaled",
    "Scenario",
    "Seen",
    "Sensors",
    "Sines",
    "Square",
    "StiffnessDrift",
    "Superposed",
    "Together",
    "co_contraction",
    "demo_log",
    "gravity_of",
    "hold",
    "load_scenario",
    "multisine",
    "plant_of",
    "position_drives",
    "recorded",
    "scenario_names",
    "simulate",
    "simulate_joint",
    "sine",
]
