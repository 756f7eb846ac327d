"""The window operator: numpy's convolution, a twin, and what is exact on the grid."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.operators import CENTRED, WINDOW, Operator
from rotatum.kernels import rows, window
from tests import naive
from tests.kernels.driven import problem, run
from tests.kernels.make import Sines, plain, record

T = 1e-3
POWERS = (2, 3, 4, 5)


class Window:
    """The kernel on c terms side by side, with any weights."""

    def __init__(self, weights, terms=1, *, stride=1, phase=0, room=64):
        self.params = plain(record(window.WindowParams, {"w": room}))
        self.params.weight[: len(weights)] = list(map(float, weights[::-1]))
        self.params.length, self.params.stride = len(weights), stride
        self.params.phase = phase
        self.state = plain(record(window.WindowState, {"w": room, "c": terms}))
        window.init(self.params, self.state)

    def push(self, x):
        """Rows by the index of the set of terms they come with."""
        found = {}
        for k, row in enumerate(np.atleast_2d(x).tolist()):
            window.push(self.params, self.state, row)
            if self.state.ready:
                found[k] = list(self.state.value)
        return found


def operator(power=3, length=19, *, derivative=0, every=1):
    return Operator(WINDOW, power, (length + 1) * T, T, derivative, every)


def noise(seed, n, terms=1):
    return np.random.default_rng(seed).standard_normal((n, terms))


# --- sums -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", [1, 2, 7, 63, 64])
@pytest.mark.parametrize(("stride", "phase"), [(1, 0), (5, 0), (5, 3), (80, 79)])
def test_rows_are_weighted_sums_where_and_only_where_they_are_due(length, stride, phase):
    x, weights = noise(210, 500, 2), noise(211, length)[:, 0]
    found = Window(weights, 2, stride=stride, phase=phase).push(x)
    for i in range(2):
        expected = naive.windowed(weights, x[:, i], stride, phase)
        assert list(found) == list(expected)
        values = [value[i] for value in found.values()]
        # Up to 64 products of order 1, summed in another order.
        np.testing.assert_allclose(values, list(expected.values()), rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("length", [1, 31, 64])
def test_is_numpys_convolution(length):
    x, weights = noise(212, 300)[:, 0], noise(213, length)[:, 0]
    found = Window(weights).push(x[:, None])
    expected = np.convolve(x, weights, "valid")  # newest first, as an impulse response is
    np.testing.assert_allclose(np.array(list(found.values()))[:, 0], expected, atol=1e-13)


def test_joints_of_an_arm_have_their_rows_one_after_the_other():
    # Otherwise all seven would weigh their windows within the same sample.
    stride, joints = 14, 7
    weights = operator(length=39).weights()
    due = [
        set(Window(weights, stride=stride, phase=i * stride // joints).push(noise(214, 300)))
        for i in range(joints)
    ]
    assert not set.intersection(*due)
    assert sum(map(len, due)) == len(set.union(*due))


def test_a_restart_forgets_to_the_last_bit():
    x, weights = noise(215, 150), noise(216, 40)[:, 0]
    one = Window(weights, stride=7, phase=2)
    one.push(x[:75])
    window.restart(one.params, one.state)
    assert (one.state.ready, one.state.settled) == (0, 0)
    assert one.push(x[75:]) == Window(weights, stride=7, phase=2).push(x[75:])


def test_settled_is_a_full_window_and_idle_is_no_row():
    one, settled = Window([1.0] * 5, stride=3), []
    for k in range(7):
        one.push(noise(217 + k, 1))
        settled.append(one.state.settled)
    assert settled == [0] * 4 + [1] * 3
    one.push(noise(218, 1))  # the eighth, and second row
    before = list(one.state.value)
    assert one.state.ready == 1
    window.idle(one.state)
    assert (one.state.ready, one.state.value) == (0, before)


@pytest.mark.parametrize(("derivative", "sign"), [(0, 1.0), (1, -1.0)])
@pytest.mark.parametrize("power", POWERS)
def test_a_window_is_even_and_its_slope_is_odd(power, derivative, sign):
    x, weights = noise(219, 33), operator(power, 33, derivative=derivative).weights()
    (there,) = Window(weights).push(x).values()
    (back,) = Window(weights).push(x[::-1]).values()
    # Weights add up to 1 in size, so that rounding is that of terms of order 1.
    assert there[0] == pytest.approx(sign * back[0], abs=1e-14)


# --- exact on the grid ----------------------------------------------------------------------------


def on_positions(power, length, derivative):
    """Weights that a derivative of that order under the hats, then the window, put on positions."""
    weights = operator(power, length).weights()
    return weights, np.convolve(weights, CENTRED[derivative]) / T**derivative


@pytest.mark.parametrize("length", [9, 100, 999])
@pytest.mark.parametrize("power", POWERS)
def test_bends_of_the_window_take_constants_and_ramps_to_zero(power, length):
    weights, bends = on_positions(power, length, 2)
    ages = T * np.arange(len(bends))
    # Weights that add up to 1 count four times in the bends, over T^2: their rounding. A ramp
    # rises to the window's length.
    rounding = 4.0 * 2.0**-53 / T**2
    assert abs(bends.sum()) < rounding
    assert abs(bends @ ages) < rounding * ages[-1]
    # A parabola has the window's mean of its second derivative: all of it.
    assert bends @ (0.5 * ages**2) == pytest.approx(weights.sum(), rel=1e-9)


@pytest.mark.parametrize("length", [9, 100, 999])
@pytest.mark.parametrize("power", POWERS)
def test_slopes_of_the_window_take_a_constant_to_zero_and_a_ramp_to_minus_its_sum(power, length):
    weights, on_ends = on_positions(power, length, 1)
    slopes = -on_ends  # of w itself: summation by parts turns the sign
    ages = T * np.arange(len(slopes))
    assert abs(slopes.sum()) < 2.0**-53 / T  # weights that add up to 1, half of each twice
    assert slopes @ -ages == pytest.approx(-weights.sum(), rel=1e-12)  # time runs against age


@pytest.mark.parametrize("derivative", [0, 1])
@pytest.mark.parametrize("power", POWERS)
def test_a_million_radians_change_no_bit_of_a_row(power, derivative):
    # Positions on a grid of 2^-33 rad, finer than any encoder's: there a million is added exactly,
    # so that whatever changes is the rows' own doing.
    rng = np.random.default_rng(220)
    theta, phi, tau = Sines(rng, 0.3, 3.0, 60.0), Sines(rng, 0.01, 3.0, 60.0), noise(221, 300)
    t, grid = T * np.arange(300), 2.0**-33
    theta, phi = (np.round(x(t) / grid) * grid for x in (theta, phi))
    kinds = [rows.INERTIA, rows.DAMPING, rows.SKEW, rows.TRANSMISSION_DAMPING]
    chosen = operator(power, 99, derivative=derivative, every=10)
    stage, P = problem([1, 3], kinds, window=chosen, inertia=0.02, damping=0.3)
    near, far = (
        run(stage, P, at + theta + phi, at + theta, tau[:, 0])[["valid", "y", "R"]]
        for at in (0.0, 1e6)
    )
    assert near["valid"].sum() == 20
    assert near.tobytes() == far.tobytes()


@pytest.mark.parametrize("power", POWERS)
def test_far_away_a_row_errs_by_the_rounding_of_the_positions_alone(power):
    # Whatever positions: a million radians are known to 2^-34, and what that may do is the sum of
    # the sizes of the weights that positions have.
    theta, inertia, damping = Sines(np.random.default_rng(222), 0.3, 3.0, 60.0), 0.02, 0.3
    t, still = T * np.arange(300), np.zeros(300)
    chosen = operator(power, 99, every=10)
    stage, P = problem([1], window=chosen, inertia=inertia, damping=damping)
    near, far = (run(stage, P, still, at + theta(t), still) for at in (0.0, 1e6))
    _, bends = on_positions(power, 99, 2)
    _, slopes = on_positions(power, 99, 1)
    explained = 2.0**-34 * np.abs(inertia * bends + damping * slopes).sum()
    apart = np.abs(far["y"] - near["y"])[near["valid"] == 1]
    assert len(apart) == 20
    assert apart.max() < explained + 1e-13  # and rounding of the rows themselves, of order 1
    # It could fail: a trapezoid over the second derivative of the window leaves a constant behind,
    # h^2 / 12 times what the third derivative does between its ends: nothing from power 4 on.
    if power < 4:
        n = 100
        u = np.polynomial.Polynomial([0.0, 1.0]) * np.polynomial.Polynomial([1.0, -1.0])
        bent = (u**power).deriv(2)(np.arange(n + 1) / n)
        bent[[0, -1]] *= 0.5
        left = bent.sum() / n / (u**power).integ()(1.0) / (n * T) ** 2
        assert inertia * abs(left) * 1e6 > 100.0 * explained


# --- a whole row ----------------------------------------------------------------------------------


@pytest.mark.parametrize("derivative", [0, 1])
@pytest.mark.parametrize("power", POWERS)
@pytest.mark.parametrize("held", [0, 1])
def test_rows_of_the_motor_side_agree_with_the_twin(power, derivative, held):
    rng = np.random.default_rng(223)
    q, theta, tau = rng.standard_normal((3, 200)) * [[1e-3], [1e-3], [1.0]]
    chosen = operator(power, 39, derivative=derivative, every=4)
    stage, P = problem([1, 3], window=chosen, inertia=0.02, damping=0.3, held=held, scale=2e-3)
    out = run(stage, P, q, theta, tau)
    x = (q - theta) / 2e-3
    columns = np.stack([x, x * x * x], axis=1)
    y, R = naive.weak_terms(
        columns, theta, tau, period=T, inertia=0.02, damping=0.3, held=bool(held)
    )
    weights = naive.bump(power, 39, derivative)[::-1]
    weights = weights / np.abs(weights).sum()
    expected = {k + 2: v for k, v in naive.windowed(weights, y, 4).items()}
    assert np.flatnonzero(out["valid"]).tolist() == list(expected)
    due = list(expected)
    # Rounding of terms of B 1e-3 / T^2 = 20 N m under weights that add up to 1.
    np.testing.assert_allclose(out["y"][due], list(expected.values()), rtol=0.0, atol=1e-13)
    for i in (0, 1):
        column = list(naive.windowed(weights, R[:, i], 4).values())
        np.testing.assert_allclose(out["R"][due, i], column, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("derivative", [0, 1])
def test_the_row_holds_whatever_the_window(derivative):
    # B theta'' - tau = k phi exactly under the hats but for T^4 / 240 of fourth derivatives.
    rng = np.random.default_rng(224)
    theta, phi = Sines(rng, 0.1, 3.0, 60.0), Sines(rng, 0.01, 3.0, 60.0)
    t, B, k = T * np.arange(600), 0.02, 120.0
    tau = B * theta(t, 2) - k * phi(t)
    bound = T**4 / 240.0 * (k * phi.bound(4) + B * theta.bound(6)) * 2.0
    bound += 2.0 * B * np.spacing(1.0) / T**2  # rounding of theta
    for length in (9, 99, 399):
        chosen = operator(3, length, derivative=derivative)
        stage, P = problem([1], window=chosen, inertia=B)
        out = run(stage, P, phi(t) + theta(t), theta(t), tau)
        due = out["valid"] == 1
        assert due.sum() == 600 - 2 - length + 1
        off = out["y"][due] - out["R"][due, 0] * k * 0.01
        assert np.abs(off).max() < bound
        assert np.abs(out["y"][due]).max() > 1e4 * bound
