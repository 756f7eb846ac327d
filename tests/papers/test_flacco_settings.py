"""The paper's own settings in our records: the recursion as printed, in the paper's units."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from rotatum.evaluation.papers.flacco2012 import awas, stability, vsa2
from rotatum.evaluation.papers.flacco2012.modality import channels, printed, score
from rotatum.evaluation.papers.flacco2012.settings import AWAS, VSA2, as_printed
from rotatum.logs import Log
from rotatum.models import Device
from tests import naive

N = 4000


def test_vsa2_is_the_printed_recursion_in_newton_millimetres() -> None:
    device = vsa2.device()
    log = vsa2.motion(device, 0)
    out = printed(device, log, "RESIDUAL", VSA2).out[:N]
    for i in (0, 1):
        phi = np.asarray(out["part_deflection"][:, i])
        rows = np.stack([phi, phi**3, phi**5, phi**7], axis=1)
        y = 1e3 * out["part_row_torque"][:, i]
        alpha = naive.rls_as_printed(rows, y, 1e6 * np.eye(4), np.zeros(4), 1e-5)
        ours = 1e3 * out["coefficients"].reshape(N, 2, 4)[:, i]
        # P(0) = 1e6 leaves 1e6 ulps in coefficients of hundreds.
        np.testing.assert_allclose(ours[10:], alpha[10:], rtol=1e-7, atol=1e-6)


def test_vsa2_residual_is_the_printed_one() -> None:
    device = vsa2.device()
    log = vsa2.motion(device, 0)
    out = printed(device, log, "RESIDUAL", VSA2).out
    logged = channels(device, log)
    (joint,) = device.joints
    stage = as_printed(device, VSA2, period=log.period)
    record = stage.parts[0]["rows"]["residual"]
    assert record["gain"] == 300.0
    assert record["held"] == 0
    assert record["inertia"] == joint.motors[0].inertia.value
    # At 300 rad/s the residual follows what the motor does below 1 Hz with a lag of 3 ms.
    error = out["part_row_torque"][2000:, 0] - logged["torque1_true"][2000:]
    # White noise of 2 N mm through a first-order low-pass at 300 rad/s, 0.39 of it, and the lag.
    assert 0.5e-3 < np.sqrt(np.mean(error**2)) < 2e-3


@pytest.mark.slow
def test_awas_is_the_printed_recursion_in_millimetres() -> None:
    device = awas.device(awas.PAPER_ORDERS)
    log = awas.motion(device, 0)
    run = printed(device, log, "RESIDUAL", AWAS)
    rows = stability.rows_of(device, log)
    F, D, y = (np.asarray(rows[name]) for name in ("F", "D", "y"))
    lever = 1e3 * channels(device, log)["lever"]
    phi = np.asarray(rows["phi"])
    # The filter on the angle of the second motor smooths steps of 0.0024 mm.
    np.testing.assert_allclose(F[:, 0], phi, rtol=1e-12)
    np.testing.assert_allclose(F[100:, 1], (phi * lever)[100:], rtol=1e-4, atol=1e-9)
    again = stability.recursion(F, D, y, AWAS.spread, c=AWAS.c).stiffness
    sigma = run.out["stiffness"]
    # 18 monomials whose P spans 30 decades: the two orders of the same sums agree to this.
    np.testing.assert_allclose(again[2000:], sigma[2000:], rtol=1e-6)


def by_recursion(device: Device, log: Log, spread: float) -> np.ndarray:
    """Total stiffness by MODEL and the recursion as printed: the law's torque in N mm."""
    logged = channels(device, log)
    total = np.zeros(log.samples)
    for spring, end in zip(device.joints[0].transmissions, ("1", "2"), strict=True):
        phi = logged["q"] - logged[f"theta{end}"]
        rows = np.stack([phi, phi**3, phi**5, phi**7], axis=1)
        y = 1e3 * np.asarray(spring.torque(phi))
        alpha = naive.rls_as_printed(rows, y, spread * np.eye(4), np.zeros(4), VSA2.c)
        slopes = np.stack([phi**0, 3.0 * phi**2, 5.0 * phi**4, 7.0 * phi**6], axis=1)
        total += 1e-3 * (alpha * slopes).sum(axis=1)
    return total


def by_stage(device: Device, log: Log, spread: float) -> np.ndarray:
    """The same by the stage that `rotatum reproduce` runs."""
    settings = VSA2._replace(spread=spread)
    return np.asarray(printed(device, log, "MODEL", settings).out["stiffness"])


@pytest.mark.parametrize("by", [by_recursion, pytest.param(by_stage, marks=pytest.mark.slow)])
def test_the_prior_is_what_keeps_model_off(by: Callable[[Device, Log, float], np.ndarray]) -> None:
    # MODEL has no noise in its torque; with a prior a million times as wide it has no error left.
    device = vsa2.device()
    log = vsa2.motion(device, 0)
    truth = channels(device, log)["stiffness_true"]
    own, wide = (score(log, by(device, log, spread), truth)[1] for spread in (VSA2.spread, 1e12))
    assert own > 0.02
    assert wide < 0.1 * own


@pytest.mark.slow
def test_the_stability_factor_of_eq_41_is_within_its_bounds() -> None:
    rng = np.random.default_rng(3)
    F = rng.standard_normal((200, 3))
    found = stability.recursion(F, F, F @ [1.0, 2.0, 3.0], 1e3, c=1e-2)
    assert (found.factor >= 1e-2).all()  # c where there is no information
    assert (found.factor <= 1.0).all()
    standard = stability.recursion(F, F, F @ [1.0, 2.0, 3.0], 1e3, factor=1.0)
    reference = naive.rls_as_printed(F, F @ [1.0, 2.0, 3.0], 1e3 * np.eye(3), np.zeros(3))
    assert standard.stiffness[-1] == pytest.approx(F[-1] @ reference[-1], rel=1e-10)
