"""Ready-made stages with parameters and good samples: what the contract suite and checks run on."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rotatum.estimators.series import Shape
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import prepare
from rotatum.kernels import lowpass
from rotatum.models import device_from_tables
from rotatum.record import Records
from rotatum.runtime.stage import Stage

PERIOD = 1e-3
STIFFNESS, HARDENING = 120.0, 2000.0
INERTIA, DAMPING, COULOMB, GEAR = 4e-5, 5e-5, 0.01, 80.0


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


def example_stages(samples: int = 2000) -> tuple[Example, ...]:
    """Return every kind of stage there is, with two joints' parameters and samples."""
    found = [_lowpass(samples)]
    for method, torque, solver, fit in (
        ("weak", "estimated", "ud", ("coulomb", "offset")),
        ("weak", "sensor", "ud", ("offset",)),
        ("residual", "estimated", "covariance", ("offset",)),
        ("residual", "sensor", "ud", ("offset",)),
    ):
        found.append(_series(samples, Request(method, torque=torque, solver=solver, fit=fit)))
    return tuple(found)


def example_shapes() -> tuple[Shape, ...]:
    """Return the shapes of ``example_stages``: enough to reach every kernel."""
    return (
        Shape("weak", "estimated", 2, 4, 3),
        Shape("weak", "sensor", 2, 3, 3),
        Shape("residual", "estimated", 2, 3, 3, "covariance"),
        Shape("residual", "sensor", 2, 3, 3),
    )


def _lowpass(samples: int) -> Example:
    stage = lowpass_stage()
    params = stage.params.zeros(2)
    params["pole"] = math.exp(-0.3), math.exp(-0.01)
    params["order"] = 1, 2
    inputs = stage.input.zeros(samples, 2)
    time = PERIOD * np.arange(samples)
    inputs["x"] = np.stack([np.sin(20.0 * time), 3.0 + np.cos(7.0 * time)], axis=1)
    return Example(stage, params, inputs)


def _series(samples: int, request: Request) -> Example:
    joint = {
        "motor": {
            "inertia": INERTIA,
            "damping": DAMPING,
            "coulomb": COULOMB,
            "gear_ratio": GEAR,
            "torque_limit": 10.0,
        },
        "encoders": {"link": 65536.0, "motor": 65536.0, "wrap_link": 2.0 * math.pi},
        "basis": {"deflection_range": 0.1, "orders": 2},
    }
    device = device_from_tables({"name": "example", **joint}, "example")
    chosen = settle(device.joints[0], device, PERIOD, request)
    prepared = prepare(device.joints[0], chosen, period=PERIOD, holds={}, zero=0.0)
    params = np.concatenate([prepared.params, prepared.params])
    return Example(prepared.stage, params, series_signals(prepared.stage, samples))


def series_signals(stage: Stage, samples: int) -> Records:
    """Samples of two joints whose motor obeys its equation exactly, encoders quantised.

    ``theta`` and ``phi`` are sums of sines, ``q = theta + phi`` and
    ``tau = B theta'' + D theta' + C sgn(theta') - (K phi + K3 phi^3)``.
    """
    time = PERIOD * np.arange(samples)
    inputs = stage.input.zeros(samples, 2)
    inputs["time"] = time[:, None]
    inputs["enable"] = 1
    n2 = GEAR**2
    for j, rate in enumerate((5.0, 8.0)):
        theta = 0.3 * np.sin(rate * time) + 0.1 * np.sin(2.7 * rate * time)
        speed = 0.3 * rate * np.cos(rate * time) + 0.27 * rate * np.cos(2.7 * rate * time)
        acceleration = -0.3 * rate**2 * np.sin(rate * time)
        acceleration -= 0.1 * (2.7 * rate) ** 2 * np.sin(2.7 * rate * time)
        phi = 0.06 * np.sin(1.3 * rate * time + 0.4) + 0.03 * np.cos(3.1 * rate * time)
        elastic = STIFFNESS * phi + HARDENING * phi**3
        step = 2.0 * np.pi / 65536.0
        inputs["theta"][:, j] = np.round(theta / step) * step
        inputs["q"][:, j] = np.round((theta + phi) / step) * step
        if "tau" in stage.input.fields:
            friction = DAMPING * n2 * speed + COULOMB * GEAR * np.sign(speed)
            inputs["tau"][:, j] = INERTIA * n2 * acceleration + friction - elastic
        else:
            inputs["torque"][:, j] = elastic
    return inputs
