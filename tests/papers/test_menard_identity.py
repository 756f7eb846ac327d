"""menard2013 eqs 16-22: the identity that holds, the printed ones that do not, and our rows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
import sympy
from numpy.polynomial import Polynomial

from rotatum.estimators.operators import WINDOW, Operator
from tests.kernels.driven import problem, run
from tests.kernels.make import Sines

U = Polynomial([0.0, 1.0])
NODES, AREAS = np.polynomial.legendre.leggauss(200)
NODES, AREAS = 0.5 * (NODES + 1.0), 0.5 * AREAS


def w(one: int, other: int) -> Polynomial:
    """w_(k,m)(u) = (1 - u)^k u^m."""
    return (1.0 - U) ** one * U**other


W33 = w(3, 3)
G1 = w(3, 0) - 9.0 * w(2, 1) + 9.0 * w(1, 2) - w(0, 3)
G2 = -w(3, 1) + 3.0 * w(2, 2) - w(1, 3)
G3 = -0.5 * w(3, 2) + 0.5 * w(2, 3)


class Side(NamedTuple):
    """One motor and its spring, moving smoothly: eqs 1-2 hold exactly.

    sigma = sum_j a_j phi^j / j! (eq. 18), tau = J q'' + b q' - f(phi).
    """

    J: float
    b: float
    a: np.ndarray
    q: Sines
    phi: Sines

    def force(self, t):
        phi = self.phi(t)
        return sum(a * phi ** (j + 1) / math.factorial(j + 1) for j, a in enumerate(self.a))

    def torque(self, t):
        return self.J * self.q(t, 2) + self.b * self.q(t, 1) - self.force(t)


def random_side(seed: int, *, b: float | None = None) -> Side:
    """Motions of some radians and springs of one to five terms, constants of any size."""
    rng = np.random.default_rng(seed)
    q, phi = (Sines(rng, size, 3.0, 30.0) for size in (2.0, 1.0))
    terms = rng.integers(1, 6)
    a = rng.choice([-1.0, 1.0], terms) * rng.uniform(2.0, 20.0, terms)
    J, damping = rng.uniform(0.01, 0.5), rng.uniform(0.5, 5.0)
    return Side(J, damping if b is None else b, a, q, phi)


def integral(kernel: Polynomial, signal, t: float, T: float) -> float:
    """Gauss-Legendre of 200 nodes: exact to rounding up to 150 rad within a window, as in phi^5."""
    return float(AREAS @ (kernel(NODES) * signal(t + T * (NODES - 1.0))))


def C(side: Side, t: float, T: float) -> float:
    """Eq. 20: u = 1 is now."""
    moved = integral(side.J * G1 + T * side.b * G2, side.q, t, T)
    return moved + T**2 * integral(G3, side.torque, t, T)


def b(side: Side, t: float, T: float) -> np.ndarray:
    """The last line of eq. 21, with u = 1 now as in eq. 20."""
    slope = W33.deriv()
    terms = (
        integral(slope, lambda s, j=j: side.phi(s) ** (j + 1) / math.factorial(j + 1), t, T)
        for j in range(len(side.a))
    )
    return T**2 / 6.0 * np.array(list(terms))


def off(found: np.ndarray, expected: np.ndarray) -> float:
    """Relative error over a record."""
    return float(np.linalg.norm(found - expected) / np.linalg.norm(expected))


TIMES = np.linspace(1.0, 9.0, 25)


# --- what holds -----------------------------------------------------------------------------------


@pytest.mark.parametrize("T", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("seed", range(20))
def test_the_identity_holds_for_any_motion_and_any_polynomial_spring(seed, T):
    side = random_side(300 + seed)
    left = np.array([C(side, t, T) for t in TIMES])
    right = np.array([side.a @ b(side, t, T) for t in TIMES])
    # Rounding, in the shortest window of a part of J a thousand times what the parts add up to.
    assert off(left, right) < 1e-10


def test_the_papers_kernels_are_derivatives_of_one_window():
    u = sympy.Symbol("u")
    window = (1 - u) ** 3 * u**3
    for kernel, order, factor in ((G1, 3, 6), (G2, 2, -6), (G3, 1, -6)):
        printed = sum(sympy.nsimplify(c) * u**i for i, c in enumerate(kernel.coef))
        assert sympy.expand(printed - sympy.diff(window, u, order) / factor) == 0
    # So C = T^2 / 6 int w33' (J q'' + b q' - tau): the weak form, tested with w33'.


# --- what is printed ------------------------------------------------------------------------------


def backwards(kernel: Polynomial) -> Polynomial:
    """g(1 - u)."""
    return kernel(1.0 - U)


def printed_orientation(side: Side, t: float, T: float) -> tuple[float, float]:
    """Both sides with eq. 28's ``g[m]`` on ``y[l - m]``: u = 0 is now, in eqs 20 and 21."""
    moved = integral(backwards(side.J * G1 + T * side.b * G2), side.q, t, T)
    left = moved + T**2 * integral(backwards(G3), side.torque, t, T)
    slope = backwards(W33.deriv())
    right = sum(
        a * integral(slope, lambda s, j=j: side.phi(s) ** (j + 1) / math.factorial(j + 1), t, T)
        for j, a in enumerate(side.a)
    )
    return left, T**2 / 6.0 * right


@pytest.mark.parametrize("seed", range(20))
def test_the_orientation_of_eq_28_breaks_the_identity(seed):
    side = random_side(300 + seed)
    left, right = np.array([printed_orientation(side, t, 0.2) for t in TIMES]).T
    # Twice the share of the damping, which is no small one here.
    assert off(left, right) > 0.1
    damping = np.array([2.0 * 0.2 * side.b * integral(G2, side.q, t, 0.2) for t in TIMES])
    np.testing.assert_allclose(left - right, damping, rtol=0.0, atol=1e-10 * np.abs(left).max())


def test_without_damping_the_orientation_would_not_show():
    # G1 and G3 are odd about the middle, as w33' is: all of the identity changes its sign.
    side = random_side(320, b=0.0)
    left, right = np.array([printed_orientation(side, t, 0.2) for t in TIMES]).T
    assert off(left, right) < 1e-10
    forwards = np.array([C(side, t, 0.2) for t in TIMES])
    assert off(-left, forwards) < 1e-10


@pytest.mark.parametrize("seed", range(5))
def test_eqs_16_and_17_have_the_wrong_sign(seed):
    side, T = random_side(340 + seed), 0.3

    def power(s):  # sigma(phi) phi'
        phi = side.phi(s)
        sigma = sum(a * phi**j / math.factorial(j) for j, a in enumerate(side.a))
        return sigma * side.phi(s, 1)

    printed = np.array([T**7 / 6.0 * integral(W33, power, t, T) for t in TIMES])
    right = np.array([T**4 * C(side, t, T) for t in TIMES])
    assert off(printed, -right) < 1e-10
    # Eq. 16 is eq. 17 with nu = T u; so is its sign. The second line of eq. 21 turns it once more.
    parts = np.array([-(T**3) / 6.0 * integral(W33, power, t, T) for t in TIMES])
    assert off(parts, np.array([side.a @ b(side, t, T) for t in TIMES])) < 1e-10


# --- the package's rows ---------------------------------------------------------------------------


def algebraic_rows(side: Side, T: float, period: float) -> tuple[np.ndarray, ...]:
    """Times, C and b_j of the rows of ``algebraic`` in the paper's normalisation, every 20 ms.

    Rows are divided by the sum of their weights' sizes, which is int |w33'| = 2 / 64 but for the
    grid; the paper has T^2 / 6 before the integral, and (j + 1)! below each power.
    """
    powers = [j + 1 for j in range(len(side.a))]
    chosen = Operator(WINDOW, 3, T, period, 1, round(0.02 / period))
    stage, P = problem(
        powers, window=chosen, inertia=side.J, damping=side.b, period=period, scale=1.0
    )
    t = period * np.arange(round(3.0 * T / period) + 1)
    q, phi = side.q(t), side.phi(t)
    out = run(stage, P, q + phi, q, side.torque(t))
    due = out["valid"] == 1
    common = T**2 / 6.0 * (2.0 / 64.0)
    factorials = np.array([math.factorial(p) for p in powers])
    return t[due], common * out["y"][due], common * out["R"][due] / factorials


@pytest.mark.parametrize("seed", [360, 361, 362])
def test_the_rows_of_algebraic_become_the_papers_to_second_order(seed):
    """The hats interpolate w33' linearly, and its central difference is of order h^2 itself."""
    side, T = random_side(seed), 0.2
    apart = []
    for period in (4e-3, 2e-3, 1e-3):
        times, y, R = algebraic_rows(side, T, period)
        assert times[0] == pytest.approx(T)
        left = np.array([C(side, t, T) for t in times])
        right = np.array([b(side, t, T) for t in times])
        columns = (off(R[:, j], right[:, j]) for j in range(len(side.a)))
        apart.append([off(y, left), *columns])
    ratios = np.array(apart[:-1]) / np.array(apart[1:])
    # 4, but for a share of order h^3 that falls with the period: 6 %, then 3 %.
    off4 = np.abs(ratios - 4.0).max(axis=1)
    assert off4[1] < 0.6 * off4[0]
    assert off4[1] < 0.04 * 4.0
    assert np.max(apart[-1]) < 2e-3  # of C most, whose parts of J and tau partly cancel


@pytest.mark.parametrize(("known", "order"), [(0.0, 4), (None, 2)])
def test_the_balance_of_the_rows_holds_whatever_each_side_misses(known, order):
    """One test function on both sides: what is left is the hats' T^4, or T^2 of the damping's."""
    side, T = random_side(363, b=known), 0.2
    left = []
    for period in (4e-3, 2e-3):
        times, y, R = algebraic_rows(side, T, period)
        left.append(off(R @ side.a, y))
    assert left[0] / left[1] == pytest.approx(2.0**order, rel=0.1)
    if order == 4:
        assert left[1] < 1e-2 * off(y, np.array([C(side, t, T) for t in times]))
