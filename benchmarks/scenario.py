"""The case all benchmarks share: a series joint with a hardening spring under a multisine."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rotatum.estimators.series import Shape, series_stage

from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import prepare
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.models.device import device_from_tables
from rotatum.record import Records
from rotatum.runtime import Stage
from rotatum.simulation import Sensors, multisine, simulate_joint

SECONDS = 20.0
PERIOD = 4e-4
SHAPE = Shape("weak", "estimated", 3, 4, 5)

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
orders = 3
{open}estimator]
method = "weak"
fit = ["offset"]
{open}channels]
tau = {{ hold = "{hold}" }}
"""


class Case(NamedTuple):
    """Everything a runner of one joint needs.

    Args:
        stage: the estimator.
        params: ``(1,)`` records.
        inputs: ``(N, 1)`` records.
    """

    stage: Stage
    params: Records
    inputs: Records


def device_text(joints: int = 1, *, hold: str = "held") -> str:
    """Return a device file with that many equal joints: named ``arm``, or ``j0``, ``j1`` ..."""
    if joints == 1:
        return 'name = "arm"\n' + JOINT.format(open="[", hold=hold)
    body = JOINT.format(open="[joint.", hold=hold)
    return 'name = "arm"\n' + "".join(f'[[joint]]\nname = "j{i}"\n{body}' for i in range(joints))


@lru_cache(maxsize=4)
def device(joints: int = 1) -> Device:
    """Return the device of ``device_text``."""
    return device_from_tables(tomllib.loads(device_text(joints)), "benchmark")


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
    """Return the log's time and the three channels the estimator reads, each ``(N,)``."""
    data = log()
    roles = data.joints["arm"]
    return {"time": data.time} | {role: roles[role] for role in ("q", "theta", "tau")}


@lru_cache(maxsize=1)
def case() -> Case:
    """Tune the stage of ``SHAPE`` to the device and fill its input with the log."""
    robot = device()
    joint = robot.joints[0]
    settings = settle(joint, robot, PERIOD, Request())
    prepared = prepare(joint, settings, period=PERIOD, holds={"tau": "held"})
    if prepared.shape != SHAPE or prepared.stage != series_stage(SHAPE):
        raise AssertionError(f"the benchmark's device asks for {prepared.shape}, not {SHAPE}")
    columns = channels()
    inputs = prepared.stage.input.zeros(len(columns["time"]), 1)
    for name, values in columns.items():
        inputs[name][:, 0] = values
    inputs["enable"] = 1
    return Case(prepared.stage, prepared.params, inputs)
