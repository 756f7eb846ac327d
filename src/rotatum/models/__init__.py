"""What a device is: joints, motors, transmissions, elastic laws, units; read from TOML."""

from rotatum.models.channel import ROLES, Channel, Reading
from rotatum.models.device import Device, device_from_tables, device_names, load_device
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.models.joint import FIT_QUANTITIES, EstimatorSettings, Joint
from rotatum.models.laws import LAWS, Law
from rotatum.models.parts import Basis, Encoders, Link, Motor, Setpoint
from rotatum.models.quantity import Uncertain
from rotatum.models.robot.cartesian import CartesianStiffness, cartesian_stiffness
from rotatum.models.robot.description import RobotTable
from rotatum.models.transmission import Transmission
from rotatum.models.units import Unit, find_unit, unit_names

__all__ = [
    "FIT_QUANTITIES",
    "LAWS",
    "ROLES",
    "Accelerometer",
    "Basis",
    "CartesianStiffness",
    "Channel",
    "Device",
    "Encoders",
    "EstimatorSettings",
    "Gyroscope",
    "Joint",
    "Law",
    "Link",
    "Motor",
    "Reading",
    "RobotTable",
    "Setpoint",
    "Transmission",
    "Uncertain",
    "Unit",
    "cartesian_stiffness",
    "device_from_tables",
    "device_names",
    "find_unit",
    "load_device",
    "unit_names",
]
