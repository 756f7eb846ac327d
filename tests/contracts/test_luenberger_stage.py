"""The observer of deluca2007 behind its guard passes the contract, friction and all."""

from __future__ import annotations

import numpy as np

from rotatum.estimators.full_state.stage import design_of, luenberger_params, luenberger_stage
from rotatum.models import load_device
from rotatum.report.references import REFERENCES
from rotatum.testing import check_stage

PERIOD = 1e-3


def test_the_observer_passes() -> None:
    (joint, *_) = load_device("manutec-r3").joints
    stage = luenberger_stage()
    designs = [design_of(joint, PERIOD, gyro=g, held=h) for g, h in ((0.0, True), (100.0, False))]
    params = luenberger_params(stage, [joint, joint], designs, change=0.05)
    inputs = stage.input.zeros(2500, 2)
    t = PERIOD * np.arange(len(inputs))[:, None] + [0.0, 0.3]
    inputs["time"] = PERIOD * np.arange(len(inputs))[:, None]
    inputs["theta"] = np.sin(3.0 * t)
    inputs["acceleration"] = -9.0 * np.sin(3.0 * t) + 4.0 * np.cos(40.0 * t)
    inputs["rate"] = 3.0 * np.cos(3.0 * t)
    inputs["torque"] = 500.0 * np.sin(2.0 * t)
    inputs["coupling"] = 10.0 * np.cos(7.0 * t)
    inputs["stiffness"] = 4e5 * (1.0 + 0.3 * np.sin(20.0 * t))
    inputs["stiffness"][::100] = 0.0  # the params' own
    inputs["bias"] = 20.0 * np.sin(t)
    inputs["rest"] = 1e-3
    inputs["seen"] = 1
    inputs["seen"][1000:1100] = 0
    torques = ("damping", "motor_damping", "coulomb", "stiffness", "softest", "stiffest")
    report = check_stage(
        stage,
        params=params,
        inputs=inputs,
        settle=400,
        endurance=300_000,
        scale={
            **{f"params.inner.{name}": 1.0 for name in torques},
            "params.inner.inverse_inertia": -1.0,
            **{f"u.{name}": 1.0 for name in ("torque", "coupling", "stiffness", "bias")},
            **{f"out.{name}": 1.0 for name in ("torque", "transmission_torque", "stiffness")},
        },
        references=frozenset(REFERENCES),
    )
    assert {v.clause for v in report.skipped} <= {"compiled = C"}
