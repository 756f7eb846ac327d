"""Ready-made stages with parameters and good samples: what the contract suite and checks run on."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.settings import Request, settle
from rotatum.estimators.shapes import Shape
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.kernels import lowpass
from rotatum.models import device_from_tables
from rotatum.record import Records
from rotatum.runtime.stage import Stage

PERIOD = 1e-3
Array = NDArray[np.float64]
STIFFNESS, HARDENING, SPRING = 120.0, 2000.0, 14220.0
INERTIA, DAMPING, COULOMB, GEAR = 4e-5, 5e-5, 0.01, 80.0
LINK_INERTIA, LINK_DAMPING, GRAVITY = 0.1, 0.05, 1.0


class Example(NamedTuple):
    """A stage that can be run at once.

    Args:
        stage: the stage.
        params: (2,) records.
        inputs: (N, 2) records of good samples.
    """

    stage: Stage
    params: Records
    inputs: Records


def lowpass_stage() -> Stage:
    """The second-order matched low-pass as a stage of its own."""
    sample = lowpass.Sample.layout()
    return Stage(
        "lowpass",
        lowpass.LowpassParams.layout(),
        lowpass.LowpassState.layout(),
        sample,
        sample,
        lowpass.init,
        lowpass.step,
    )


KINDS: tuple[tuple[str, Request], ...] = (
    ("series", Request("weak", fit=("coulomb", "offset"))),
    ("series", Request("weak", torque="sensor", fit=("offset",), shrinkage=False)),
    ("series", Request("residual", solver="covariance", fit=("offset",))),
    ("serial", Request("weak", fit=("offset",))),
    ("serial", Request("residual", torque="model", fit=())),
    ("antagonistic", Request("weak", fit=("offset",))),
    ("series", Request("algebraic", window=0.1, fit=())),
    ("series", Request("weak", side="link", cutoff=100.0, order=3, fit=("link_damping",))),
    ("antagonistic", Request("weak", side="link", window=0.1, fit=("link_coulomb",))),
    ("serial", Request("rotatum", side="link", cutoff=200.0, order=50, selective=0.1)),
)
"""Actuation and settings of the examples: enough to reach every kernel."""


def example_stages(samples: int = 2000) -> tuple[Example, ...]:
    """Return every kind of stage there is, with two joints' parameters and samples."""
    found = [_lowpass(samples)]
    for actuation, request in KINDS:
        prepared = _prepared(actuation, request)
        params = np.concatenate([prepared.params, prepared.params])
        inputs = example_signals(prepared.stage, actuation, samples, request.side or "motor")
        found.append(Example(prepared.stage, params, inputs))
    return tuple(found)


def example_shapes() -> tuple[Shape, ...]:
    """Return the shapes of ``example_stages``."""
    return tuple(_prepared(actuation, request).shape for actuation, request in KINDS)


def _lowpass(samples: int) -> Example:
    stage = lowpass_stage()
    params = stage.params.zeros(2)
    params["pole"] = math.exp(-0.3), math.exp(-0.01)
    params["order"] = 1, 2
    inputs = stage.input.zeros(samples, 2)
    time = PERIOD * np.arange(samples)
    inputs["x"] = np.stack([np.sin(20.0 * time), 3.0 + np.cos(7.0 * time)], axis=1)
    return Example(stage, params, inputs)


def _prepared(actuation: str, request: Request) -> Prepared:
    motor = {
        "inertia": INERTIA,
        "damping": DAMPING,
        "coulomb": COULOMB,
        "gear_ratio": GEAR,
        "torque_limit": 10.0,
    }
    tables: dict[str, object] = {
        "name": "example",
        "actuation": actuation,
        "motor": [motor, motor] if actuation == "antagonistic" else motor,
        "link": {
            "inertia": LINK_INERTIA,
            "damping": LINK_DAMPING,
            "gravity_torque": GRAVITY,
        },
        "transmission": {"law": "cubic", "stiffness": STIFFNESS, "cubic": HARDENING},
        "encoders": {"link": 65536.0, "motor": 65536.0, "wrap_link": 2.0 * math.pi},
        "basis": {"deflection_range": 0.1, "orders": 2},
    }
    if actuation == "serial":
        tables["transmission"] = {"law": "lever", "spring": SPRING}
        tables["setpoint"] = {"law": "lever", "r0": 0.1, "b": 4e-4}
        tables["basis"] = {
            "deflection_range": 0.1,
            "orders": 2,
            "setpoint_range": [0.06, 0.12],
            "setpoint_orders": 2,
        }
    device = device_from_tables(tables, "example")
    chosen = settle(device.joints[0], device, PERIOD, request)
    zeros = [0.0] * len(device.joints[0].transmissions)
    return prepare(device.joints[0], chosen, period=PERIOD, holds={}, zeros=zeros)


def example_signals(stage: Stage, actuation: str, samples: int, side: str = "motor") -> Records:
    """Samples of two joints that obey their equations exactly, encoders quantised.

    ``q`` and ``phi`` are sums of sines, ``theta = q - phi`` and
    ``tau = B theta'' + D theta' + C sgn(theta') - tau_e(phi)``. The antagonist of a pair stands
    where another deflection of the same link puts it. From the link's ``side`` the last spring's
    deflection is what ``M q'' + D q' + G sin q + tau_e = 0`` asks for.
    """
    time: Array = PERIOD * np.arange(samples, dtype=np.float64)
    inputs = stage.input.zeros(samples, 2)
    inputs["time"] = time[:, None]
    inputs["enable"] = 1
    for j, rate in enumerate((5.0, 8.0)):
        q = _wave(time, rate, (0.35, 1.0, 0.0), (0.1, 2.7, 0.0))
        inputs["q"][:, j] = _quantised(q[0])
        ends = ("1", "2") if actuation == "antagonistic" else ("",)
        load = -(LINK_INERTIA * q[2] + LINK_DAMPING * q[1] + GRAVITY * np.sin(q[0]))
        for k, end in enumerate(ends):
            phi = _wave(time, rate, (0.06, 1.3 + 0.2 * k, 0.4), (0.03, 3.1, 1.6 + k))
            if side == "link" and end == ends[-1]:
                phi = (_deflection(load), *phi[1:])
            elastic = STIFFNESS * phi[0] + HARDENING * phi[0] ** 3
            if actuation == "serial":
                angle = 40.0 * np.sin(0.7 * rate * time)
                inputs["setpoint"][:, j] = angle
                lever = SPRING * (0.1 - 4e-4 * angle) ** 2
                if side == "link":
                    phi = (0.5 * np.arcsin(load / lever), *phi[1:])
                elastic = lever * np.sin(2.0 * phi[0])
            load = load - elastic
            theta = [a - b for a, b in zip(q, phi, strict=True)]
            inputs[f"theta{end}"][:, j] = _quantised(theta[0])
            if f"tau{end}" in stage.input.fields:
                friction = DAMPING * GEAR**2 * theta[1] + COULOMB * GEAR * np.sign(theta[1])
                inputs[f"tau{end}"][:, j] = INERTIA * GEAR**2 * theta[2] + friction - elastic
            if f"torque_measured{end}" in stage.input.fields:
                inputs[f"torque_measured{end}"][:, j] = elastic
    return inputs


def _wave(time: Array, rate: float, *sines: tuple[float, float, float]) -> tuple[Array, ...]:
    """A sum of sines (amplitude, factor on the rate, phase) and its first two derivatives."""
    return tuple(
        sum(
            (
                size * (factor * rate) ** n * np.sin(factor * rate * time + at + n * math.pi / 2.0)
                for size, factor, at in sines
            ),
            np.zeros_like(time),
        )
        for n in range(3)
    )


def _deflection(torque: Array) -> Array:
    """Deflection of the hardening spring under a torque, by Newton's method."""
    phi = torque / STIFFNESS
    for _ in range(30):
        slope = STIFFNESS + 3.0 * HARDENING * phi**2
        phi = phi - (STIFFNESS * phi + HARDENING * phi**3 - torque) / slope
    return phi


def _quantised(angle: Array) -> Array:
    step = 2.0 * np.pi / 65536.0
    return np.round(angle / step) * step
