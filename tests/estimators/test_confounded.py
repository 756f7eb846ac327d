"""What data cannot tell apart is refused by name, and what they can is told."""

from __future__ import annotations

from functools import lru_cache
from statistics import median

import numpy as np
import pytest

import rotatum as rt
from rotatum.evaluation.confounded import null_directions

NOISE = 0.1  # N m at the joint: 2 mN m at the motor, behind its gear of 50


# A joint without dry friction, its spring straight and its link free: a sine in, sines everywhere.
SERIES = {
    "seconds": 40.0,
    "drives.tau": {"kind": "sine", "amplitude": 15.0, "frequency": 0.1},
    "truth.transmission.cubic": 0.0,
    "truth.motor.coulomb": 0.0,
    "told.motor.coulomb": 0.0,
    "truth.link.gravity_torque": 0.0,
    "told.link.gravity_torque": 0.0,
}
BOTH = ("series", pytest.param("awas", marks=pytest.mark.slow))  # a stage more to compile


@lru_cache(maxsize=4)
def driven(name: str, seed: int) -> tuple[rt.Device, rt.Log]:
    """A free link under one slow sine of torque, the lever arm of the AwAS moving slowly."""
    values = SERIES if name == "series" else {}
    scenario = rt.load_scenario("trouble/clean" if name == "series" else "flacco2012/table2")
    scenario = scenario.with_values({**values, "sensors.noise.tau": NOISE})
    return scenario.device, scenario.run(seed=seed)


def one(name: str, seed: int, fit: tuple[str, ...], **options: float) -> rt.JointEstimate:
    device, log = driven(name, seed)
    (joint,) = rt.estimate(log, device, fit=fit, **options).joints.values()
    return joint


@pytest.mark.parametrize("name", BOTH)
def test_inertia_and_damping_under_one_slow_sine_are_refused_by_name(name: str) -> None:
    """Acceleration, velocity and torque of one sine lie in a plane: three columns, two directions.

    The stiffness that least squares finds there is off by half, with a narrow formal interval.
    """
    joint = one(name, 0, ("inertia", "damping"))
    assert joint.verdict == "starved"
    assert joint.confounded == (("inertia", "damping", "stiffness"),)
    assert "does not tell inertia, damping and stiffness apart" in joint.reason
    for name in ("inertia", "damping"):
        value, std = joint.fitted[name]
        assert np.isnan(value)
        assert np.isinf(std)
    assert joint.to_json()["confounded"] == [["inertia", "damping", "stiffness"]]


@pytest.mark.parametrize("name", BOTH)
def test_a_cutoff_that_lets_the_noise_in_does_not_make_them_known(name: str) -> None:
    """At 300 rad/s the acceleration is noise: the inertia is named, and nothing is claimed."""
    joint = one(name, 0, ("inertia", "damping"), cutoff=300.0)
    truth = joint.truth_records["stiffness"][-1]
    covered = abs(joint.stiffness["final"] - truth) <= 1.96 * joint.stiffness_std
    assert joint.verdict != "informative" or covered
    assert any("inertia" in group for group in joint.confounded)


def test_inertia_alone_is_told() -> None:
    found = [one("awas", seed, ("inertia",)) for seed in range(3)]
    for joint in found:
        truth = float(joint.truth_records["stiffness"][-1])
        assert abs(joint.stiffness["final"] / truth - 1.0) <= 0.02
        assert abs(joint.fitted["inertia"][0] / 2.3e-5 - 1.0) <= 0.03
        assert joint.confounded == ()
    assert median(joint.truth["msrep_percent"] for joint in found if joint.truth) <= 5e-3


def test_null_directions_are_those_that_noise_or_prior_alone_fill() -> None:
    """Columns a, b and a + b + noise: the difference is noise; a column of zeros is prior."""
    rng = np.random.default_rng(0)
    n, v = 2000, 1e-4
    a, b = rng.standard_normal((2, n))
    R = np.stack([a, b, a + b + np.sqrt(v) * rng.standard_normal(n), np.zeros(n)], axis=1)
    spread = np.full(4, 1e8)
    P = np.linalg.inv(R.T @ R + np.diag(1.0 / spread))
    found = null_directions(P, np.array([0.0, 0.0, v, 0.0]), spread, float(n))
    assert len(found) == 2
    shapes = sorted((np.abs(w) / np.abs(w).max() >= 0.2).tolist() for w in found)
    assert shapes == [[False, False, False, True], [True, True, True, False]]


def test_rich_motion_has_no_null_direction() -> None:
    from rotatum.simulation.demo import demo_log

    device, log = demo_log()
    (joint,) = rt.estimate(log, device, fit=("inertia", "damping")).joints.values()
    assert joint.confounded == ()
    assert joint.verdict == "informative"
