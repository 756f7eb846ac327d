"""Poles and constants matched to known states: what was wrong is found, and nothing gets worse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rotatum.errors import LogError, RotatumError
from rotatum.evaluation.matching import match_observer
from rotatum.logs import Log
from rotatum.models import Device, device_from_tables
from rotatum.simulation import simulate
from rotatum.simulation.drivers.waves import multisine

T = 1e-3
NOISE = 0.05  # rad/s^2


def device(stiffness: float) -> Device:
    return device_from_tables(
        {
            "name": "linear", "actuation": "series",
            "motor": {"inertia": 0.3, "damping": 0.2},
            "transmission": {"law": "linear", "stiffness": stiffness, "zero": 0.0},
            "link": {"inertia": 0.25, "gravity_torque": 6.0},
            "encoders": {"link": 262144, "motor": 1638400},
        },
        "test",
    )  # fmt: skip


@pytest.fixture(scope="module")
def log() -> Log:
    """Two seconds of a joint of 300 N m/rad, its motor shaken, its link's acceleration measured."""
    plant = device(300.0)
    shake = multisine(rms=3.0, low=0.5, high=8.0, count=12, seed=5)
    found = simulate(plant, seconds=2.0, period=T, drives={"linear": {"tau": shake}}, seed=5)
    own = dict(found.joints["linear"])
    acc = -(own["torque_true"] + 6.0 * np.sin(own["q_true"])) / 0.25
    own["acc"] = acc + NOISE * np.random.default_rng(501).standard_normal(acc.size)
    return replace(found, joints={"linear": own})


def test_a_wrong_stiffness_is_found_and_the_states_are_the_better_for_it(log: Log) -> None:
    found = match_observer(log, device(330.0))["linear"]
    # A hundredth: the encoder's counts and 0.05 rad/s^2 over two seconds leave less.
    assert found.varied["stiffness"] == pytest.approx(300.0, rel=0.01)
    assert found.design.drivetrain.stiffness == found.varied["stiffness"]
    assert found.design.pairs[0].frequency == found.varied["frequency"]
    assert found.after["phi"] < 0.2 * found.before["phi"]
    assert found.after["dq"] < found.before["dq"]


def test_what_the_bounds_keep_back_is_said(log: Log) -> None:
    found = match_observer(log, device(450.0), vary=("stiffness",), within=0.2)["linear"]
    assert found.varied["stiffness"] == pytest.approx(450.0 / 1.2, rel=1e-3)
    assert found.at_bound == ("stiffness",)
    assert found.after["phi"] < found.before["phi"]


def test_what_cannot_be_varied_or_is_not_known_is_refused(log: Log) -> None:
    with pytest.raises(RotatumError, match=r"[Dd]id you mean 'stiffness'"):
        match_observer(log, device(300.0), vary=("stifness",))
    with pytest.raises(RotatumError, match="cannot be varied by a factor"):
        match_observer(log, device(300.0), vary=("spring_damping",))
    own = {k: v for k, v in log.joints["linear"].items() if k != "dq_true"}
    with pytest.raises(LogError, match="lacks dq_true"):
        match_observer(replace(log, joints={"linear": own}), device(300.0))
