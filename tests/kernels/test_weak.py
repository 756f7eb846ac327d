"""Weak rows: what is exact, to which order the rest holds, and a twin sample by sample."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.kernels import rows
from rotatum.kernels.status import DISABLED, SETTLING
from tests import naive
from tests.kernels.driven import T, problem, run
from tests.kernels.make import Sines

B, D = 0.02, 0.3


def spring(rng, *, cubic, period=T, low=3.0, high=60.0, offset=0.0, damping=0.0, size=400):
    """A joint moving as sums of sines: samples, the law's constants, and a bound on what is left.

    The bound is that of the hat: T^4 / 240 times the fourth derivatives of torque and law.
    """
    theta, phi = Sines(rng, 0.1, low, high), Sines(rng, 0.01, low, high)
    t = np.arange(size) * period
    k1, k3 = 120.0, 4e5 * cubic

    def law(x):
        return k1 * x + k3 * x**3

    tau = B * theta(t, 2) + damping * theta(t, 1) - law(phi(t))
    # The fourth derivative of a product of three sums of sines of at most w is below (3 w)^4.
    fourth = 2.0 * (k1 * phi.bound(4) + k3 * phi.bound(0) ** 3 * (3.0 * phi.w.max()) ** 4)
    fourth += B * theta.bound(6) + damping * theta.bound(5)
    bound = period**4 / 240.0 * fourth + damping * period**2 / 12.0 * theta.bound(3)
    # Half an ulp per angle: four of them over T^2, B times; through the law twice.
    ulp = np.spacing(offset + 1.0)
    rounding = 2.0 * B * ulp / period**2 + 2.0 * damping * ulp / period + 4.0 * k1 * ulp
    q = phi(t) + theta(t) + offset
    return q, theta(t) + offset, tau, (k1, k3), bound + rounding


# --- the pieces ---------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_hat_of_a_cubic_is_exact(degree):
    x = np.polynomial.Polynomial(np.random.default_rng(degree).standard_normal(degree + 1))
    t, T = 0.7, 0.1
    assert rows.hat(x(t - T), x(t), x(t + T)) == pytest.approx(
        naive.hat_average(x, t, T), abs=1e-14
    )


def test_hat_of_a_quartic_errs_by_the_fourth_order():
    x = np.polynomial.Polynomial([0.0, 0.0, 0.0, 0.0, 1.0])
    for h in (0.1, 0.05):
        error = rows.hat(x(-h), x(0.0), x(h)) - naive.hat_average(x, 0.0, h)
        # h^4 x'''' / 240 = h^4 / 10, exactly for a quartic; numbers of order h^4 = 1e-5 are summed.
        assert error == pytest.approx(h**4 / 10.0, rel=1e-9)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_second_difference_is_the_average_of_the_second_derivative(degree):
    x = np.polynomial.Polynomial(np.random.default_rng(degree).standard_normal(degree + 1))
    t, T = 0.7, 0.1
    second = (x(t + T) - 2.0 * x(t) + x(t - T)) / T**2
    average = naive.hat_average(x.deriv(2), t, T)
    # Rounding of numbers of order 1, times 4 / T^2.
    assert second == pytest.approx(average, abs=400 * 4e-16)


def test_central_difference_is_the_average_velocity_to_second_order_only():
    # <theta'> as it is computed spans a box, not the hat: T^2 / 12 theta''' is left over, which
    # is what the damping column costs where it is not small.
    x = np.polynomial.Polynomial([0.0, 0.0, 0.0, 1.0])
    T = 0.1
    left = (x(T) - x(-T)) / (2.0 * T) - naive.hat_average(x.deriv(), 0.0, T)
    assert left == pytest.approx(T**2 / 12.0 * 6.0, rel=1e-12)


def test_held_torque_is_exact_for_a_free_rotor():
    tau = np.random.default_rng(8).standard_normal(200)
    velocity = np.concatenate([[0.0], np.cumsum(tau)[:-1]]) * T / B
    theta = np.concatenate([[0.0], np.cumsum(velocity[:-1] * T + 0.5 * tau[:-1] * T**2 / B)])
    rowed = {}
    for held in (0, 1):
        stage, P = problem([1], cutoff=300.0, inertia=B, held=held)
        rowed[held] = run(stage, P, theta, theta, tau)["y"][2:]
    assert np.abs(rowed[1]).max() < 1e-11  # rounding: theta of 1e-2 / T^2 * B * 1e-16
    assert np.abs(rowed[0]).max() > 0.05


# --- the balance --------------------------------------------------------------------------------


@pytest.mark.parametrize("cutoff", [30.0, 100.0, 300.0, 1000.0, 3000.0])
@pytest.mark.parametrize("cubic", [0, 1])
def test_the_row_holds_whatever_the_cutoff(cutoff, cubic):
    q, theta, tau, (k1, k3), bound = spring(np.random.default_rng(9), cubic=cubic)
    stage, P = problem([1, 3], cutoff=cutoff, inertia=B)
    out = run(stage, P, q, theta, tau)
    fit = out["R"] @ [k1 * 0.01, k3 * 0.01**3]
    np.testing.assert_allclose(out["y"][2:], fit[2:], rtol=0.0, atol=bound)
    # It could fail: the same law without the low-pass on its side misses by far.
    unfiltered = k1 * (q - theta) + k3 * (q - theta) ** 3
    if cutoff < 1000.0:
        assert np.abs(out["y"] - unfiltered)[100:].max() > 100.0 * bound


@pytest.mark.parametrize("offset", [1e3, 1e6])
def test_the_row_holds_far_from_zero(offset):
    q, theta, tau, (k1, k3), bound = spring(np.random.default_rng(10), cubic=1, offset=offset)
    stage, P = problem([1, 3], cutoff=300.0, inertia=B)
    out = run(stage, P, q, theta, tau)
    fit = out["R"] @ [k1 * 0.01, k3 * 0.01**3]
    np.testing.assert_allclose(out["y"][2:], fit[2:], rtol=0.0, atol=bound)


def test_the_error_falls_with_the_fourth_power_of_the_period():
    left = []
    for period in (2e-3, 1e-3):
        q, theta, tau, (k1, _), _ = spring(
            np.random.default_rng(11),
            cubic=0,
            period=period,
            low=100.0,
            high=200.0,
            size=round(0.8 / period),
        )
        stage, P = problem([1], cutoff=100.0, inertia=B, period=period)
        out = run(stage, P, q, theta, tau)
        left.append(np.std((out["y"] - out["R"][:, 0] * k1 * 0.01)[10:]))
    # 16, but for a sixth-order share of (w T)^2 = 0.16 and the start, of which one sees more rows.
    assert left[0] / left[1] == pytest.approx(16.0, rel=0.15)


def test_the_row_with_damping_holds_to_second_order():
    q, theta, tau, (k1, _), bound = spring(np.random.default_rng(12), cubic=0, damping=D)
    stage, P = problem([1], cutoff=300.0, inertia=B, damping=D)
    out = run(stage, P, q, theta, tau)
    np.testing.assert_allclose(out["y"][2:], out["R"][2:, 0] * k1 * 0.01, rtol=0.0, atol=bound)


def test_known_and_fitted_constants_are_the_same_balance():
    # Twice the inertia, damping, an offset, a skew and a transmission damping left to columns:
    # the columns times what is missing make up for it.
    q, theta, tau, (k1, _), bound = spring(np.random.default_rng(13), cubic=0, damping=D)
    kinds = [rows.INERTIA, rows.DAMPING, rows.OFFSET]
    stage, P = problem([1], kinds, cutoff=300.0, inertia=0.5 * B, damping=0.25 * D)
    out = run(stage, P, q, theta, tau - 1.25)
    fit = out["R"] @ [0.5 * B, 0.75 * D, 1.25, k1 * 0.01]
    np.testing.assert_allclose(out["y"][2:], fit[2:], rtol=0.0, atol=bound + 1e-12)


def test_skew_and_transmission_damping_columns_are_velocities():
    t = np.arange(100) * T
    q, theta = 3.0 * t, 1.0 * t  # ramps: every operator is exact
    kinds = [rows.SKEW, rows.TRANSMISSION_DAMPING]
    stage, P = problem([1], kinds, cutoff=300.0, inertia=B)
    P["weak"]["scale"] = [2.0, 4.0, 1.0]
    out = run(stage, P, q, theta, np.zeros(100))
    # Rounding of 0.3 rad over 2 T.
    np.testing.assert_allclose(out["R"][2:, 0], 3.0 / 2.0, rtol=1e-12)
    np.testing.assert_allclose(out["R"][2:, 1], 2.0 / 4.0, rtol=1e-12)


@pytest.mark.parametrize("held", [0, 1])
def test_agrees_with_the_twin_sample_by_sample(held):
    rng = np.random.default_rng(14)
    q, theta, tau = rng.standard_normal((3, 200)) * [[1e-3], [1e-3], [1.0]]
    stage, P = problem([1, 3], cutoff=200.0, inertia=B, damping=D, held=held, scale=2e-3)
    out = run(stage, P, q, theta, tau)
    x = (q - theta) / 2e-3
    columns = np.stack([x, x * x * x], axis=1)
    y, R = naive.weak_rows(
        columns, theta, tau, period=T, cutoff=200.0, inertia=B, damping=D, held=bool(held)
    )
    # The same sums in another order: rounding of terms of B 1e-3 / T^2 = 20 N m.
    np.testing.assert_allclose(out["y"][2:], y, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(out["R"][2:], R, rtol=0.0, atol=1e-12)


def test_a_torque_sensor_goes_through_the_same_operator():
    rng = np.random.default_rng(15)
    q, theta, torque = rng.standard_normal((3, 200))
    stage, P = problem([1], cutoff=200.0, scale=1.0, torque="sensor")
    out = run(stage, P, q, theta, torque)
    y, R = naive.weak_rows(
        (q - theta)[:, None], 0.0 * theta, -torque, period=T, cutoff=200.0, inertia=0.0
    )
    np.testing.assert_allclose(out["y"][2:], y, rtol=0.0, atol=1e-13)  # rounding of order 1
    np.testing.assert_allclose(out["R"][2:], R, rtol=0.0, atol=1e-13)


# --- Coulomb friction ---------------------------------------------------------------------------


@pytest.mark.parametrize("delay", [1, 4, 31])
def test_friction_has_its_sign_from_both_sides_and_the_row_waits_for_it(delay):
    C, width = 2.0, 0.5
    q, theta, tau, (k1, _), bound = spring(np.random.default_rng(16), cubic=0)
    wide = (theta[2 * delay :] - theta[: -2 * delay]) / (2.0 * delay * T)
    sgn = np.clip(wide / width, -1.0, 1.0)
    middle = slice(delay, len(theta) - delay)
    rubbed = tau.copy()
    rubbed[middle] += C * sgn
    for kinds, known in (([], C), ([rows.COULOMB], 0.0)):
        stage, P = problem(
            [1], kinds, cutoff=300.0, inertia=B, coulomb=known, width=width, delay=delay
        )
        out = run(stage, P, q, theta, rubbed)
        fit = out["R"] @ [C, k1 * 0.01][1 - len(kinds) :]
        # The first hat is complete two samples after the first sign; both sides of friction go
        # through the same hat, so the bound is that of the balance without it.
        start = 2 * delay + 2
        np.testing.assert_allclose(out["y"][start:], fit[start:], rtol=0.0, atol=bound + 1e-12)
        assert not out["valid"][:start].any()
        assert out["valid"][start:].all()


# --- what the row says about itself -------------------------------------------------------------


def test_rows_are_valid_once_settled_and_enabled():
    stage, P = problem([1], cutoff=300.0, inertia=B, settle=3)
    zeros = np.zeros(10)
    out = run(stage, P, zeros, zeros, zeros)
    assert out["valid"].tolist() == [0] * 5 + [1] * 5
    assert (out["status"][:5] == SETTLING).all()
    assert out["fresh"].tolist() == [1] + [0] * 9
    stage, P = problem([1], cutoff=300.0, inertia=B, settle=3)
    out = run(stage, P, zeros, zeros, zeros, enable=0)
    assert not out["valid"].any()
    assert out["status"].tolist() == [SETTLING | DISABLED] * 5 + [DISABLED] * 5


def test_a_restart_forgets_everything_but_the_zero():
    rng = np.random.default_rng(17)
    q, theta, tau = rng.standard_normal((3, 60))
    stage, P = problem([1], cutoff=50.0, inertia=B)
    whole = run(stage, P, q, theta, tau, fresh=(0, 30))
    stage, P = problem([1], cutoff=50.0, inertia=B)
    tail = run(stage, P, q[30:], theta[30:], tau[30:])
    assert whole[32:].tobytes() == tail[2:].tobytes()
    assert whole["fresh"][30] == 1


def test_the_zero_is_the_mean_of_the_first_deflections():
    stage, P = problem([1], cutoff=300.0, inertia=B, scale=1.0)
    P["zero"]["samples"] = 4
    q = np.array([1.0, 2.0, 3.0, 4.0, 7.0, 7.0, 7.0, 7.0])
    out = run(stage, P, q, 0.0 * q, 0.0 * q)
    assert out["phi"][4] == 7.0 - 2.5
    assert out["F"][4, 0] == 4.5
    assert out["valid"].tolist() == [0, 0, 0, 0, 0, 1, 1, 1]
    assert out["fresh"].tolist() == [1, 1, 1, 1, 0, 0, 0, 0]


def test_a_restart_begins_the_zero_anew_while_it_is_read_and_not_afterwards():
    # A glitch of an encoder is a jump there and back: two restarts, the glitch between them.
    q = np.array([1.0, 1.0, 900.0, 1.0, 1.0, 1.0, 1.0, 5.0, 5.0])
    stage, P = problem([1], cutoff=300.0, inertia=B, scale=1.0)
    P["zero"]["samples"] = 3
    out = run(stage, P, q, 0.0 * q, 0.0 * q, fresh=(0, 2, 3, 8))
    assert out["phi"][6:].tolist() == [0.0, 4.0, 4.0]


def test_the_basis_now_is_zero_for_what_is_no_spring():
    stage, P = problem([1, 3], [rows.OFFSET], cutoff=300.0, inertia=B, scale=0.5)
    out = run(stage, P, np.full(5, 0.25), np.zeros(5), np.zeros(5))
    assert out["F"][-1].tolist() == [0.0, 0.5, 0.125]
    assert out["D"][-1].tolist() == [0.0, 2.0, 3.0 * 0.25 * 2.0]
    assert out["H"][-1].tolist() == [0.0, 0.0, 6.0 * 0.5 * 4.0]
    assert out["R"][-1].tolist() == [1.0, 0.5, 0.125]
