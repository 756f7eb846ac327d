"""What a device is: joints, motors, transmissions, encoders, units; read from TOML."""

from rotatum.models.channel import ROLES, Channel
from rotatum.models.device import Device, device_from_tables, device_names, load_device
from rotatum.models.joint import FIT_QUANTITIES, EstimatorSettings, Joint
from rotatum.models.parts import Basis, Encoders, Link, Motor, Setpoint, Transmission
from rotatum.models.quantity import Uncertain
from rotatum.models.units import Unit, find_unit, unit_names

__all__ = [
    "FIT_QUANTITIES",
    "ROLES",
    "Basis",
    "Channel",
    "Device",
    "Encoders",
    "EstimatorSettings",
    "Joint",
    "Link",
    "Motor",
    "Setpoint",
    "Transmission",
    "Uncertain",
    "Unit",
    "device_from_tables",
    "device_names",
    "find_unit",
    "load_device",
    "unit_names",
]
