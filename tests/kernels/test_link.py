"""Rows of the link side: the balance of a pendulum, and of a pair of springs on it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.estimators.operators import WINDOW, Operator
from rotatum.kernels import rows
from rotatum.kernels.status import DISABLED, SETTLING
from tests import naive
from tests.kernels.driven import T, problem
from tests.kernels.linked import SCALE, D, G, K, M, bound_of, moving, pendulum, run
from tests.kernels.make import Sines

# --- a pendulum -----------------------------------------------------------------------------------


def test_a_parabola_is_balanced_exactly():
    # q'' constant, q' a straight line: every operator is exact, hat, difference and low-pass alike.
    t = T * np.arange(300)
    q = 0.3 - 0.7 * t + 2.0 * t**2
    torque = -(M * 4.0 + D * (4.0 * t - 0.7))
    stage, P = pendulum(gravity=0.0)
    out = run(stage, P, q, q - torque / K)
    assert np.abs(out["y"][2:]).max() > 0.05
    # Rounding of angles of order 1, 4 M / T^2 of them; of the deflection K.
    np.testing.assert_allclose(out["y"][2:], out["R"][2:, 0] * K * SCALE, rtol=0.0, atol=2e-11)


@pytest.mark.parametrize("cutoff", [30.0, 300.0, 3000.0])
@pytest.mark.parametrize("damping", [0.0, D])
def test_the_balance_of_a_swinging_pendulum_holds(cutoff, damping):
    q, t = Sines(np.random.default_rng(400), 1.0, 2.0, 40.0), T * np.arange(500)
    angles = moving(q, t, damping=damping)
    stage, P = pendulum(cutoff=cutoff, damping=damping)
    out = run(stage, P, *angles)
    bound = bound_of(q, damping=damping)
    np.testing.assert_allclose(out["y"][2:], out["R"][2:, 0] * K * SCALE, rtol=0.0, atol=bound)
    # It could fail: without gravity, or with the deflection of one sample later.
    stage, P = pendulum(cutoff=cutoff, damping=damping, gravity=0.0)
    other = run(stage, P, *angles)
    assert np.abs(other["y"] - other["R"][:, 0] * K * SCALE)[2:].max() > 30.0 * bound


@pytest.mark.parametrize(("damping", "order"), [(0.0, 4), (D, 2)])
def test_the_error_falls_with_the_period(damping, order):
    left = []
    for period in (2e-3, 1e-3):
        q = Sines(np.random.default_rng(401), 0.5, 60.0, 120.0)
        t = period * np.arange(round(0.6 / period))
        stage, P = pendulum(period=period, damping=damping, cutoff=100.0)
        out = run(stage, P, *moving(q, t, damping=damping))
        left.append(np.std((out["y"] - out["R"][:, 0] * K * SCALE)[10:]))
    # But for a share of (w T)^2 = 0.06 more and for the start.
    assert left[0] / left[1] == pytest.approx(2.0**order, rel=0.1)


@pytest.mark.parametrize(
    ("kind", "name", "delay"),
    [
        (rows.LINK_DAMPING, "damping", 0),
        (rows.LINK_COULOMB, "coulomb", 3),
        (rows.GRAVITY_TORQUE, "gravity", 0),
    ],
)
def test_a_column_is_what_the_known_constant_would_do(kind, name, delay):
    rng = np.random.default_rng(402)
    q, theta = rng.standard_normal((2, 100))  # of any motion whatever
    common = {"coulomb": 0.3, "width": 0.5, "delay": delay}
    known = {"damping": D, "gravity": G, **common}
    stage, P = pendulum((kind,), **known)
    one = run(stage, P, q, theta)
    stage, P = pendulum((kind,), **known | {name: known[name] + 0.7})
    more = run(stage, P, q, theta)
    begin = 2 + 2 * delay
    # y = known + column * what is missing: rounding of M / T^2 = 2e4 times angles of order 1.
    np.testing.assert_allclose(
        one["y"][begin:] - more["y"][begin:], 0.7 * one["R"][begin:, 0], rtol=0.0, atol=4e-11
    )
    assert np.abs(one["R"][begin:, 0]).max() > 0.1
    assert one["R"][:, 1].tobytes() == more["R"][:, 1].tobytes()


def test_columns_are_divided_by_their_scale():
    q, theta = np.random.default_rng(403).standard_normal((2, 50))
    kinds = (rows.LINK_DAMPING, rows.OFFSET)
    stage, P = pendulum(kinds)
    plain_rows = run(stage, P, q, theta)["R"][2:]
    P["link"]["scale"] = [4.0, 0.5, 1.0]
    np.testing.assert_allclose(
        run(stage, P, q, theta)["R"][2:], plain_rows / [4.0, 0.5, 1.0], rtol=1e-14
    )
    assert set(plain_rows[:, 1]) == {1.0}


def test_a_damper_beside_the_spring_is_its_column():
    q, t = Sines(np.random.default_rng(404), 1.0, 2.0, 40.0), T * np.arange(500)
    phi, d = Sines(np.random.default_rng(405), 0.02, 2.0, 40.0), 0.1
    # Whatever the link does: its inertia times q'' is what spring and damper give.
    torque = K * phi(t) + d * phi(t, 1)
    theta = q(t) - phi(t)
    stage, P = problem(
        [1], [rows.TRANSMISSION_DAMPING], side="link", scale=SCALE, inertia=0.0, arm=1, delay=2
    )
    out = run(stage, P, q(t), theta, force=np.concatenate([[0.0] * 2, -torque[:-2]]) * -1.0)
    fit = out["R"] @ [d, K * SCALE]
    # The box of phi' is exact; of K phi and the force alike Simpson's T^4 / 180; of d phi' the
    # force has Simpson's mean of its derivative.
    bound = T**4 / 180.0 * (2.0 * K * phi.bound(4) + d * phi.bound(5)) + 1e-12
    np.testing.assert_allclose(out["y"][6:], fit[6:], rtol=0.0, atol=bound)


def test_motors_read_late_are_a_skew():
    # theta comes from `late` before: phi is too large by late theta', which the column has.
    q, t = Sines(np.random.default_rng(406), 1.0, 2.0, 40.0), T * np.arange(500)
    late = 2e-5
    _, theta = moving(q, t)
    _, then = moving(q, t - late)
    stage, P = pendulum((rows.SKEW,))
    out = run(stage, P, q(t), then)
    left = out["y"] - out["R"] @ [-K * late, K * SCALE]
    second = np.abs(np.gradient(np.gradient(theta, T), T)).max()
    # The second order of the delay; the box of theta' against the hat of phi, of 40 rad/s at most.
    bound = bound_of(q) + K * (0.5 * late**2 + late * T**2 / 12.0 * 40.0) * second
    assert np.abs(left[2:]).max() < bound
    assert K * late * np.abs(out["R"][2:, 0]).max() > 10.0 * bound


# --- friction -------------------------------------------------------------------------------------


@pytest.mark.parametrize("delay", [1, 4, 31])
def test_friction_has_its_sign_from_both_sides_and_the_row_waits_for_it(delay):
    C, width = 0.4, 0.5
    q, t = Sines(np.random.default_rng(407), 1.0, 2.0, 40.0), T * np.arange(400)
    _, theta = moving(q, t)
    wide = np.zeros(400)
    wide[delay:-delay] = (q(t)[2 * delay :] - q(t)[: -2 * delay]) / (2.0 * delay * T)
    rubbed = theta + C * np.clip(wide / width, -1.0, 1.0) / K
    for kinds, known in (((), C), ((rows.LINK_COULOMB,), 0.0)):
        stage, P = pendulum(kinds, coulomb=known, width=width, delay=delay)
        out = run(stage, P, q(t), rubbed)
        fit = out["R"] @ [C, K * SCALE][1 - len(kinds) :]
        begin = 2 * delay + 2
        # Friction goes through the same hat on both sides.
        np.testing.assert_allclose(out["y"][begin:], fit[begin:], rtol=0.0, atol=bound_of(q))
        assert not out["valid"][:begin].any()
        assert out["valid"][begin:].all()


def test_everything_waits_with_the_friction():
    rng = np.random.default_rng(408)
    q, theta = rng.standard_normal((2, 200))
    stage, P = pendulum(delay=9, width=1.0)
    late = run(stage, P, q, theta)
    stage, P = pendulum()
    soon = run(stage, P, q[9:], theta[9:])
    assert late["y"][20:].tobytes() == soon["y"][2:182].tobytes()
    assert late["R"][20:].tobytes() == soon["R"][2:182].tobytes()
    # What is read out is of now all the same.
    np.testing.assert_allclose(late["F"][:, 0] * SCALE, q - theta, rtol=0.0, atol=1e-15)


# --- what a row says of itself --------------------------------------------------------------------


def test_suspect_is_the_links_acceleration_and_drag_its_movement():
    t = T * np.arange(100)
    q = 1.0 + 3.0 * t + 2.5 * t**2
    stage, P = pendulum()
    out = run(stage, P, q, q)
    np.testing.assert_allclose(out["suspect"][2:], 5.0, rtol=0.0, atol=4.0 * 2.3e-16 / T**2)
    speed = out["drag"][2:] / (2.0 * T)
    # A smoothed ramp comes as much later as the low-pass delays, the start's steady state apart.
    lag = 2.0 * math.exp(-0.3) / (1.0 - math.exp(-0.3)) * T
    assert speed[-1] == pytest.approx(3.0 + 5.0 * (t[-2] - lag), rel=1e-9)


def test_rows_are_valid_once_settled_and_enabled():
    zeros = np.zeros(10)
    stage, P = pendulum(settle=3)
    out = run(stage, P, zeros, zeros)
    assert out["valid"].tolist() == [0] * 5 + [1] * 5
    assert (out["status"][:5] == SETTLING).all()
    assert out["fresh"].tolist() == [1] + [0] * 9
    out = run(stage, P, zeros, zeros, enable=0)
    assert not out["valid"].any()
    assert out["status"].tolist() == [SETTLING | DISABLED] * 5 + [DISABLED] * 5


@pytest.mark.parametrize("delay", [0, 5])
def test_a_restart_forgets_everything_but_the_zero(delay):
    q, theta = np.random.default_rng(409).standard_normal((2, 90))
    stage, P = pendulum(delay=delay, width=1.0)
    whole = run(stage, P, q, theta, fresh=(0, 40))
    tail = run(stage, P, q[40:], theta[40:])
    begin = 2 * delay + 2
    assert whole[40 + begin :].tobytes() == tail[begin:].tobytes()
    assert whole["fresh"][40 : 40 + 2 * delay + 1].all()


def test_the_zero_is_the_mean_of_the_first_deflections():
    stage, P = pendulum()
    P["zero"]["samples"] = 4
    q = np.array([1.0, 2.0, 3.0, 4.0, 7.0, 7.0, 7.0, 7.0])
    out = run(stage, P, q, 0.0 * q)
    assert out["phi"][4] == 7.0 - 2.5
    assert out["valid"].tolist() == [0, 0, 0, 0, 0, 1, 1, 1]


# --- two transmissions ----------------------------------------------------------------------------


def test_a_pair_is_the_sum_of_what_each_motor_alone_gives():
    rng = np.random.default_rng(410)
    q, theta, theta2 = rng.standard_normal((3, 60))
    kinds = (rows.LINK_DAMPING, rows.OFFSET)
    settings = {"inertia": M, "damping": D, "gravity": G, "side": "link", "scale": 0.5}
    stage, P = problem([1, 3], kinds, actuation="antagonistic", **settings)
    P["zero"]["zero"], P["zero2"]["zero"] = 0.25, -0.125
    both = run(stage, P, q, theta, theta2=theta2)
    for which, angle in ((0, theta), (1, theta2)):
        stage, P = problem([1, 3], kinds, **settings)
        P["zero"]["zero"] = (0.25, -0.125)[which]
        alone = run(stage, P, q, angle)
        assert both["y"].tobytes() == alone["y"].tobytes()
        for name in ("R", "F", "D", "H"):
            own = np.ascontiguousarray(both[name][:, 2 + which :: 2])
            assert own.tobytes() == np.ascontiguousarray(alone[name][:, 2:]).tobytes()
            assert both[name][:, :2].tobytes() == alone[name][:, :2].tobytes()
        assert both[("phi", "phi2")[which]].tobytes() == alone["phi"].tobytes()


def test_the_balance_of_a_pair_holds():
    q, t = Sines(np.random.default_rng(411), 1.0, 2.0, 40.0), T * np.arange(500)
    squeeze, K2 = Sines(np.random.default_rng(412), 0.05, 1.0, 20.0), 50.0
    torque = -(M * q(t, 2) + G * np.sin(q(t)))
    phi = squeeze(t)
    phi2 = (torque - K * phi) / K2
    stage, P = problem(
        [1], side="link", actuation="antagonistic", scale=SCALE, inertia=M, gravity=G
    )
    out = run(stage, P, q(t), q(t) - phi, theta2=q(t) - phi2)
    fit = out["R"] @ [K * SCALE, K2 * SCALE]
    bound = bound_of(q, damping=0.0) + T**4 / 120.0 * K * squeeze.bound(4)
    np.testing.assert_allclose(out["y"][2:], fit[2:], rtol=0.0, atol=bound)
    # What both motors share in skew and damping is their mean.
    kinds = (rows.SKEW, rows.TRANSMISSION_DAMPING)
    stage, P = problem([1], kinds, side="link", actuation="antagonistic", inertia=M)
    ramps = run(stage, P, 4.0 * t, 1.0 * t, theta2=2.0 * t)
    np.testing.assert_allclose(ramps["R"][2:, :2], [[1.5, 2.5]] * 498, rtol=1e-12)


def test_both_zeros_are_waited_for():
    stage, P = problem([1], side="link", actuation="antagonistic", scale=1.0, inertia=M)
    P["zero"]["samples"], P["zero2"]["samples"] = 3, 5
    q = np.arange(9.0)
    out = run(stage, P, q, 0.0 * q, theta2=1.0 + 0.0 * q)
    assert out["phi"][-1] == 8.0 - 1.0
    assert out["phi2"][-1] == 7.0 - (0.0 + 1.0 + 2.0 + 3.0 + 4.0) / 5.0 + 1.0
    assert out["valid"].tolist() == [0] * 6 + [1] * 3


# --- windows --------------------------------------------------------------------------------------


def test_windows_take_the_same_terms():
    q, theta = np.random.default_rng(416).standard_normal((2, 150))
    chosen = Operator(WINDOW, 2, 0.04, T, 0, 7)
    stage, P = pendulum((rows.LINK_DAMPING,), window=chosen)
    found = run(stage, P, q, theta)
    # Poles so fast that nothing is filtered: the terms themselves.
    stage, P = pendulum((rows.LINK_DAMPING,), cutoff=1e5)
    terms = run(stage, P, q, theta)[2:]
    expected = naive.windowed(chosen.weights(), terms["y"], 7)
    due = np.flatnonzero(found["valid"])
    assert (due - 2).tolist() == list(expected)
    # Rounding of terms of 4 M / T^2 = 8e4.
    np.testing.assert_allclose(found["y"][due], list(expected.values()), rtol=0.0, atol=1e-10)
    for i in (0, 1):
        column = list(naive.windowed(chosen.weights(), terms["R"][:, i], 7).values())
        np.testing.assert_allclose(found["R"][due, i], column, rtol=0.0, atol=1e-11)
