"""A log's own accelerometer calibrated on it: found within its deviation, and the state profits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rotatum as rt
from rotatum.errors import RotatumError
from rotatum.evaluation.calibrate import Calibrated, calibrate

pytest.importorskip("pinocchio", reason="the arm needs the extra urdf")

BIAS = [0.2, -0.3, 0.25]  # m/s^2
TURNED = [0.02, -0.01, 0.015]  # rad
LATE = 0.0025  # s
NOISY = {
    "seconds": 1.2,
    "joint.axis1.drives.motors.path.times": [0.1, 0.4, 0.6, 0.9],
    "inertial.link4.noise": 0.1,
}
FAULTS = NOISY | {
    "inertial.link4.bias": BIAS,
    "inertial.link4.misalignment": TURNED,
    "inertial.link4.delay": LATE,
}


@pytest.fixture(scope="module")
def scenario() -> rt.Scenario:
    return rt.load_scenario("deluca2007/short").with_values(FAULTS)


@pytest.fixture(scope="module")
def log(scenario: rt.Scenario) -> rt.Log:
    return scenario.run()


@pytest.fixture(scope="module")
def least() -> float:
    """Error with a sensor that is but noisy."""
    ideal = rt.load_scenario("deluca2007/short").with_values(NOISY)
    return errors(Calibrated(ideal.device, ideal.run(), {}))


def without_encoders(log: rt.Log) -> rt.Log:
    joints = {n: {k: v for k, v in own.items() if k != "q"} for n, own in log.joints.items()}
    return replace(log, joints=joints)


@pytest.mark.parametrize("encoders", [True, False])
def test_what_is_wrong_is_found_and_taken_off(
    scenario: rt.Scenario, log: rt.Log, least: float, encoders: bool
) -> None:
    used = log if encoders else without_encoders(log)
    better = calibrate(used, scenario.device)
    own = better.found["link4"]
    truth = np.array([*BIAS, *TURNED, 0.0, 0.0, 0.0, LATE])
    fitted = [*range(6), 9]
    # Seven numbers: one in 10^4 of such logs has one beyond 4 deviations. Against observed angles
    # what the observer lacks looks like the sensor's: up to twice as far.
    beyond = 4.0 if encoders else 8.0
    assert (np.abs(own.values - truth)[fitted] < beyond * own.std[fitted]).all()
    # As good as a sensor that is but noisy; before it was not.
    assert errors(better) < 1.1 * least
    assert errors(Calibrated(scenario.device, used, {})) > 1.2 * least


def errors(given: Calibrated) -> float:
    """Rms of the link positions' errors, all joints, the start left out."""
    found = rt.observe(given.log, given.device, gyro=0.0, start=0.1)
    return float(np.sqrt(np.mean([j.score.q_rms**2 for j in found.joints.values() if j.score])))


def test_nothing_to_calibrate_or_to_calibrate_with_is_refused(
    scenario: rt.Scenario, log: rt.Log
) -> None:
    with pytest.raises(RotatumError, match="nothing to calibrate"):
        calibrate(log, rt.load_device("series-demo"))
    axes = {k: v for k, v in log.inertial["link4"].items() if k != "ay"}
    with pytest.raises(RotatumError, match=r"lacks the readings link4\.ay"):
        calibrate(replace(log, inertial={"link4": axes}), scenario.device)
