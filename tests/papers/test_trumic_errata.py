"""Where Trumić et al. 2022 as printed does not work: what is pinned nowhere else, by equation."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.errors import MethodError
from rotatum.estimators.observers.jerk import jerk_observer
from rotatum.estimators.observers.triple import printed_observer
from rotatum.evaluation.papers.trumic2022.printed import (
    Rows,
    least_squares,
    printed,
    read_out,
    rows_of,
    through,
)
from rotatum.evaluation.papers.trumic2022.simulation import EXACT
from rotatum.models import load_device
from tests.papers.test_trumic_reproduced import T, error, simulated


def test_eq_13_in_its_own_recursion_is_four_differences_of_four_instants() -> None:
    """Noise-free: the state is that of k - 3, k - 2.5, k - 2, the input that of k - 1.5."""
    t = T * np.arange(400)
    w = 3.0
    q = np.sin(w * t)
    a1, a2, a3 = 3.0 / T**2, 3.0 / T, 1.0 / T**3
    x = np.zeros((len(t) + 1, 3))
    u = np.zeros(len(t))
    for k in range(len(t)):
        beta = q[k] - x[k, 0]
        u[k] = a3 * beta - a1 * x[k, 1] - a2 * x[k, 2]
        x[k + 1, :2] = x[k, :2] + T * x[k, 1:]
        x[k + 1, 2] = a1 / 3.0 * beta - a2 * x[k, 1] - 2.0 * x[k, 2]
    found = printed_observer(T).recursion.run(q)
    # Rounding of q in a third difference: 2^-52 / T^3 = 2e-9.
    np.testing.assert_allclose(found[10:, 3], u[13:], atol=1e-7)
    np.testing.assert_allclose(found[10:, :3], x[13:-1], atol=1e-7)
    late = t[13:]
    np.testing.assert_allclose(x[13:-1, 0], q[10:-3], atol=1e-12)
    # Each is a centred difference of its instant, (w T)^2 / 24 = 1e-5 off or a few times that.
    for value, expected, scale in (
        (x[13:-1, 1], w * np.cos(w * (late - 2.5 * T)), w),
        (x[13:-1, 2], -(w**2) * np.sin(w * (late - 2.0 * T)), w**2),
        (u[13:], -(w**3) * np.cos(w * (late - 1.5 * T)), w**3),
    ):
        assert np.abs(value - expected).max() < 1e-4 * scale


def test_motors_as_they_were_three_samples_ago_do_not_fit_the_observers_speed() -> None:
    device, log = simulated("avsa", EXACT)
    observer = printed_observer(T).recursion
    delayed = error(device, log, printed(device, log, delayed=True))
    same = error(device, log, through(device, log, observer))
    aligned = error(device, log, through(device, log, jerk_observer(T, bandwidth=None).recursion))
    # A speed half a sample older: w T / 2 = 0.8 % of the link's speed, next to a deflection's
    # speed that is a fortieth of it, is an error of some 30 % of the rows.
    assert delayed > 0.04
    assert delayed > 1e3 * max(same, aligned)
    assert aligned < 0.001


def test_a_serial_joint_has_ten_coefficients_untied_and_six_tied() -> None:
    device, log = simulated("svsa", EXACT)
    observer = jerk_observer(T, bandwidth=None).recursion
    scores = {}
    for tied, count in ((False, 10), (True, 6)):
        rows = rows_of(device, log, observer, tied=tied)
        assert rows.psi.shape[1] == count
        scores[tied] = error(device, log, read_out(device, log, least_squares(rows, T)))
    # Without noise either will do; the four more are of the same polynomial.
    assert max(scores.values()) < 6e-3
    rows = rows_of(device, log, observer)
    tied_ = rows_of(device, log, observer, tied=True)
    # d/dt of theta_c^j phi^(2i+1) / (2i+1): both blocks at once.
    s = observer.run(log.joints["awas"]["setpoint"])
    phi = (observer.run(log.joints["awas"]["q"]) - observer.run(log.joints["awas"]["theta"]))[:, 0]
    k = slice(100, 200)
    expected = rows.psi[4:][k, 2] + phi[k] * 2.0 * s[k, 0] * s[k, 1]
    np.testing.assert_allclose(tied_.psi[4:][k, 2], expected, rtol=1e-9, atol=1e-12)


def test_least_squares_is_rls_with_its_prior() -> None:
    rng = np.random.default_rng(3)
    psi = rng.standard_normal((60, 3))
    p = psi @ np.array([2.0, -1.0, 0.5]) + 0.1 * rng.standard_normal(60)
    P, pi = 10.0 * np.eye(3), np.zeros(3)
    for row, y in zip(psi[:40], p[:40], strict=True):
        K = P @ row / (1.0 + row @ P @ row)
        pi = pi + K * (y - row @ pi)
        P = P - np.outer(K, row @ P)
    # Periods of 5 ms: solved every 20 samples, held until the next.
    found = least_squares(Rows(p, psi), T, spread=10.0)
    np.testing.assert_allclose(found[40], pi, rtol=1e-9)
    assert np.array_equal(found[40], found[59])
    assert not found[:20].any()


def test_the_printed_estimator_is_one_of_a_single_link() -> None:
    _, log = simulated("avsa", EXACT)
    arm = load_device("planar-qbmove").only(["joint1"])
    with pytest.raises(MethodError, match="single link"):
        rows_of(arm, log, printed_observer(T).recursion)
