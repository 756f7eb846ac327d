"""The cases of the benchmarks: a series joint with a hardening spring, and an antagonistic one.

The series joint also with seven odd powers, eight columns in all: through poles and a window.
"""

from __future__ import annotations

import tomllib
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.assemble import joint_stage
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.shapes import Shape, roles
from rotatum.estimators.tuning import prepare
from rotatum.logs import Log
from rotatum.models import Device, load_device
from rotatum.models.device import device_from_tables
from rotatum.record import Records
from rotatum.runtime import Stage
from rotatum.simulation import Sensors, multisine, simulate_joint, sine

SECONDS = 20.0
PERIOD = 4e-4
PAIR_PERIOD = 1e-3
WINDOW = 200 * PERIOD
ORDERS = 7  # of the series joint with eight columns
SHAPE = Shape("weak", "estimated", 3, 4, 5, shrunk=True)
SHAPE8 = Shape("weak", "estimated", ORDERS, 8, 13, shrunk=True)
WINDOW_SHAPE8 = SHAPE8._replace(operator="window", size=256)
PAIR_SHAPE = Shape("weak", "estimated", 4, 5, 7, actuation="antagonistic", shrunk=True)

JOINT = """\
actuation = "series"
{open}motor]
inertia = 0.25
damping = 0.3
{open}transmission]
law = "cubic"
stiffness = 200.0
cubic = 1500.0
{open}link]
inertia = 0.8
damping = 1.0
{open}encoders]
link = 32768.0
motor = 65536.0
{open}basis]
deflection_range = 0.15
orders = {orders}
{open}estimator]
method = "weak"
fit = ["offset"]
{open}channels]
tau = {{ hold = "{hold}" }}
"""


class Case(NamedTuple):
    """Everything a runner of one joint needs.

    Args:
        name: of the C written by hand.
        stage: the estimator.
        params: ``(1,)`` records.
        inputs: ``(N, 1)`` records.
    """

    name: str
    stage: Stage
    params: Records
    inputs: Records


def device_text(joints: int = 1, *, hold: str = "held", orders: int = 3) -> str:
    """Return a device file with that many equal joints: named ``arm``, or ``j0``, ``j1`` ..."""
    if joints == 1:
        return 'name = "arm"\n' + JOINT.format(open="[", hold=hold, orders=orders)
    body = JOINT.format(open="[joint.", hold=hold, orders=orders)
    return 'name = "arm"\n' + "".join(f'[[joint]]\nname = "j{i}"\n{body}' for i in range(joints))


@lru_cache(maxsize=4)
def device(orders: int = 3) -> Device:
    """Return the device of ``device_text`` with one joint."""
    return device_from_tables(tomllib.loads(device_text(orders=orders)), "benchmark")


@lru_cache(maxsize=1)
def log() -> Log:
    """Simulate 20 s at 2.5 kHz: 50,000 samples, quantised encoders, noisy torque."""
    torque = multisine(rms=12.0, low=0.5, high=20.0, count=30, seed=1)
    return simulate_joint(
        device().joints[0],
        seconds=SECONDS,
        period=PERIOD,
        drives={"tau": torque},
        sensors=Sensors(noise={"tau": 0.2}),
        seed=1,
    )


def channels() -> dict[str, NDArray[np.float64]]:
    """Return the series log's time and the three channels the estimator reads, each ``(N,)``."""
    data = log()
    return {"time": data.time} | {role: data.joints["arm"][role] for role in ("q", "theta", "tau")}


@lru_cache(maxsize=1)
def series() -> Case:
    """Return the series joint, under a multisine."""
    return _case("weak_series", device(), log(), SHAPE)


@lru_cache(maxsize=1)
def series8() -> Case:
    """Return the series joint with eight columns."""
    return _case("weak_series8", device(ORDERS), log(), SHAPE8)


@lru_cache(maxsize=1)
def window8() -> Case:
    """Return the same through a window of 200 samples, a row every twenty."""
    request = Request(window=WINDOW)
    return _case("window_series8", device(ORDERS), log(), WINDOW_SHAPE8, request)


@lru_cache(maxsize=1)
def pair() -> Case:
    """Return the antagonistic joint of flacco2012 section 6: 20 s at 1 kHz."""
    robot = load_device("vsa-ii")
    data = simulate_joint(
        robot.joints[0],
        seconds=SECONDS,
        period=PAIR_PERIOD,
        drives={"tau1": sine(0.05, 0.05), "tau2": sine(0.05, 1.0)},
        sensors=Sensors(noise={"tau1": 2e-3, "tau2": 2e-3}),
        seed=1,
    )
    return _case("weak_pair", robot, data, PAIR_SHAPE)


def _case(
    name: str, robot: Device, data: Log, shape: Shape, request: Request | None = None
) -> Case:
    """Tune the stage of ``shape`` to the device and fill its input with the log."""
    joint = robot.joints[0]
    wanted = roles(joint.actuation, "estimated")
    period = float(data.time[1] - data.time[0])
    settings = settle(joint, robot, period, request or Request())
    holds = {role: "held" for role in wanted if role.startswith("tau")}
    prepared = prepare(joint, settings, period=period, holds=holds)
    if prepared.shape != shape or prepared.stage != joint_stage(shape):
        raise AssertionError(f"the benchmark's device asks for {prepared.shape}, not {shape}")
    inputs = prepared.stage.input.zeros(len(data.time), 1)
    inputs["time"][:, 0] = data.time
    for role in wanted:
        inputs[role][:, 0] = data.joints[joint.name][role]
    inputs["enable"] = 1
    return Case(name, prepared.stage, prepared.params, inputs)
