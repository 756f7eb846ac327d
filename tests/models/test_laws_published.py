"""Laws against closed forms and numbers published by others, written down here once more."""

from __future__ import annotations

from math import asin, cosh, exp, log, pi, sin, sinh, sqrt

import numpy as np
import pytest

from rotatum.errors import DeviceError
from rotatum.models import Setpoint, Transmission
from tests.models.law_cases import CASES, MACCEPA


def spring(**table: object) -> Transmission:
    return Transmission.model_validate(table)


@pytest.mark.parametrize("q", [-0.2, 0.0, 0.1, 0.25])
def test_two_sinh_springs_are_a_qbmove(q: float) -> None:
    k, a, x, delta = 0.0222, 6.7328, 0.05, 0.53
    one = spring(law="sinh", k=k, a=a)
    phi = np.array([q - (x + delta), q - (x - delta)])
    tau = 2 * k * cosh(a * delta) * sinh(a * (q - x))
    sigma = 2 * a * k * cosh(a * delta) * cosh(a * (q - x))
    # The sum cancels to a tenth of its terms at q = x: 1e-15 of 0.5 N m.
    assert one.torque(phi).sum() == pytest.approx(tau, rel=1e-12, abs=1e-14)
    assert one.stiffness(phi).sum() == pytest.approx(sigma, rel=1e-13)


def test_two_unequal_sinh_springs_by_their_data_sheet() -> None:
    k1, a1, k2, a2 = 0.0227, 6.7328, 0.0216, 6.9602
    phi1, phi2 = 0.61, -0.37
    one, other = spring(law="sinh", k=k1, a=a1), spring(law="sinh", k=k2, a=a2)
    total = k1 * sinh(a1 * phi1) + k2 * sinh(a2 * phi2)
    energy = k1 / a1 * (cosh(a1 * phi1) - 1) + k2 / a2 * (cosh(a2 * phi2) - 1)
    assert one.torque(phi1) + other.torque(phi2) == pytest.approx(total, rel=1e-13)
    # cosh - 1 loses two digits here, the square of the half argument none.
    assert one.energy(phi1) + other.energy(phi2) == pytest.approx(energy, rel=1e-13)
    # parameters of the data sheet at a preset of 0.53 rad: 5.7 N m/rad, as tabulated elsewhere
    told = one.stiffness(0.53) + other.stiffness(-0.53)
    assert told == pytest.approx(5.7, abs=0.05)


@pytest.mark.parametrize("q2", [0.005, 0.02, 0.04])
@pytest.mark.parametrize("phi", [-0.3, 0.12, 0.3])
def test_the_awas_ii_of_the_plugin(q2: float, phi: float) -> None:
    ks, length, rt = 10.0, 0.05, 0.015
    law = spring(law="lever_ratio", spring=ks, length=length, arm=rt)
    factor = 2 * ks * ((length / rt) * q2 / (length - q2)) ** 2
    cosine = np.cos(phi)
    assert law.torque(phi, q2) == pytest.approx(factor * sin(phi) * cosine, rel=1e-13)
    assert law.stiffness(phi, q2) == pytest.approx(factor * (2 * cosine**2 - 1), rel=1e-13)


def test_the_bavs_of_the_plugin() -> None:
    a, b, k, ke = 1.21e-6, 2.38e-6, 1.60e5, 8.71
    agonist = spring(law="exponential", k=k, ke=ke, a=a, b=b)
    antagonist = spring(law="exponential", k=k, ke=ke, a=b, b=a)
    for phi in (-0.27, 0.0, 0.1, 0.27):
        torque = k * (b * exp(ke * phi) - a * exp(-ke * phi))
        # At the rest of one the two exponentials cancel to a few digits less.
        assert agonist.torque(phi) == pytest.approx(torque, rel=1e-13)
        assert antagonist.torque(-phi) == pytest.approx(-torque, rel=1e-13)
    # As tabulated: about 5.0 N m/rad per side at 0, about 4.0 N m at 0.27 rad.
    assert agonist.stiffness(0.0) == pytest.approx(5.0, abs=0.05)
    assert agonist.torque(0.27) == pytest.approx(4.0, abs=0.05)
    rest = log(a / b) / (2 * ke)
    assert agonist.energy(rest) == pytest.approx(0.0, abs=1e-30)
    assert abs(agonist.torque(rest)) < 1e-15


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (sqrt(2), {0.2: 1.070, 0.3: 1.164, 0.4: 1.307, 0.6: 1.809}),
        (2.0, {0.2: 1.127, 0.3: 1.308, 0.4: 1.612, 0.6: 2.996}),
    ],
)
def test_the_four_bar_by_its_geometry(ratio: float, expected: dict[float, float]) -> None:
    law = spring(law="fourbar", spring=2.5, ratio=ratio)
    rest = 2.5 * (ratio - 1) ** 2 / 2
    assert law.stiffness(0.0) == pytest.approx(rest, rel=1e-14)
    for phi, relative in expected.items():
        # Tabulated to three decimals, in a table computed apart from this code.
        assert law.stiffness(phi) / rest == pytest.approx(relative, abs=6e-4)


def test_the_four_bar_ends_just_before_it_locks() -> None:
    law = CASES["fourbar"].transmission
    low, high = law.limits()
    assert high == -low
    assert high == pytest.approx(2 * asin(0.999 / sqrt(2)), rel=1e-15)
    assert high < pi / 2
    # Beyond, the torque goes on as a line: no jump, and the stiffness of the edge.
    torque, sigma = float(law.torque(high)), float(law.stiffness(high))
    assert law.torque(high + 0.5) == pytest.approx(torque + 0.5 * sigma, rel=1e-14)
    assert law.stiffness(high + 0.5) == sigma
    assert law.slope(high + 0.5) == law.curvature(high + 0.5) == 0.0


def test_the_lever_by_flaccos_equations() -> None:
    ks, r0, b, angle, phi = 14220.0, 0.1, 3.979e-4, 20.0, 0.004
    setpoint = Setpoint(law="lever", r0=r0, b=b)
    r = setpoint.value(angle)
    assert r == r0 - b * angle
    law = spring(law="lever", spring=ks)
    assert law.torque(phi, r) == pytest.approx(ks * r**2 * sin(2 * phi), rel=1e-14)
    assert law.stiffness(phi, r) == pytest.approx(2 * ks * r**2 * np.cos(2 * phi), rel=1e-14)
    # eq. 52
    reaction = law.energy_setpoint(phi, r) * setpoint.slope
    assert reaction == pytest.approx(-2 * ks * b * r * sin(phi) ** 2, rel=1e-14)
    # Tabulated apart from this code: 71, 139, 230, 284, 410 N m/rad.
    arms = np.array([0.05, 0.07, 0.09, 0.1, 0.12])
    told = law.stiffness(0.0, arms)
    assert told == pytest.approx(np.array([71, 139, 230, 284, 410]), abs=0.6)


def test_the_maccepa_as_published() -> None:
    law = CASES["maccepa"].transmission
    kappa, B, C, r = MACCEPA["spring"], MACCEPA["lever"], MACCEPA["base"], MACCEPA["drum"]
    alpha, u2 = 0.4, 1.5
    distance = sqrt(B**2 + C**2 - 2 * B * C * np.cos(alpha))
    torque = kappa * B * C * sin(alpha) * (1 + (r * u2 - (C - B)) / distance)
    assert law.torque(alpha, u2) == pytest.approx(torque, rel=1e-13)
    low, high = law.limits(u2)
    assert low == -high
    # Where the torque stops growing; its derivative is of the order of 1 N m/rad.
    assert abs(law.stiffness(high, u2)) < 1e-12
    grid = np.linspace(0.0, 3.0, 3001)
    peak = grid[np.argmax(law.torque(grid, u2))]
    assert high == pytest.approx(peak, abs=1e-3)


def test_the_range_of_a_polynomial_ends_where_it_softens() -> None:
    # k phi + k3 phi^3 with k3 < 0: sigma is 0 at sqrt(k / (3 |k3|)).
    low, high = CASES["cubic, softening"].transmission.limits()
    assert (low, high) == pytest.approx((-sqrt(250 / 3e4), sqrt(250 / 3e4)), rel=1e-12)
    assert CASES["cubic"].transmission.limits() == (-np.inf, np.inf)
    assert CASES["odd_polynomial, toy"].transmission.limits() == (-np.inf, np.inf)
    # sigma = 1 + 2 phi: softens on one side only.
    one_sided = spring(law="polynomial", coefficients=[1.0, 1.0])
    assert one_sided.limits() == (pytest.approx(-0.5, rel=1e-12), np.inf)
    # sigma = (1 - phi)^2 touches 0 and grows again.
    touching = spring(law="polynomial", coefficients=[1.0, -1.0, 1.0 / 3.0])
    assert touching.limits()[0] == -np.inf
    assert spring(law="linear", stiffness=1.0).limits() == (-np.inf, np.inf)


def test_preload_and_limit() -> None:
    plain = spring(law="fourbar", spring=2.5, ratio=1.5)
    loaded = spring(law="fourbar", spring=2.5, ratio=1.5, preload=0.3, limit=1.0)
    phi = np.linspace(-0.5, 0.5, 7)
    assert np.array_equal(loaded.torque(phi), plain.torque(phi + 0.3))
    assert np.array_equal(loaded.curvature(phi), plain.curvature(phi + 0.3))
    # -1.0 to 1.0 of deflection + preload; the law alone would allow 1.45.
    assert loaded.limits() == (pytest.approx(-1.3), pytest.approx(0.7))
    loaded.check(phi)
    with pytest.raises(DeviceError, match=r'the deflection leaves.*"fourbar".*0\.9.*-1\.3 to 0\.7'):
        loaded.check([0.1, 0.9, np.nan, 0.8])


def test_what_left_the_range_is_named() -> None:
    lever = CASES["lever"].transmission
    lever.check([0.1, np.nan], [0.05, 0.1])
    with pytest.raises(DeviceError, match=r"set-point leaves.*got -0\.01.*0 to inf m"):
        lever.check(0.1, [0.05, -0.01])
    with pytest.raises(DeviceError, match=r"deflection leaves.*got -1\.0"):
        lever.check([-1.0, 0.2], 0.05)
    maccepa = CASES["maccepa"].transmission
    # Its range depends on the set-point, here on very many of them.
    setpoints = np.linspace(1.0, 3.0, 5000)
    ends = np.array([maccepa.limits(float(s))[1] for s in setpoints[::500]])
    maccepa.check(0.99 * ends, setpoints[::500])
    maccepa.check(np.full(5000, 0.99 * ends.min()), setpoints)
    with pytest.raises(DeviceError, match="deflection leaves"):
        maccepa.check(np.full(5000, 1.01 * ends.max()), setpoints)


def test_arrays_broadcast_and_scalars_are_arrays_too() -> None:
    lever = CASES["lever"].transmission
    surface = lever.torque(np.zeros((4, 1)) + 0.1, np.full(3, 0.05))
    assert surface.shape == (4, 3)
    assert lever.torque(0.1, 0.05).shape == ()
    assert surface[2, 1] == lever.torque(0.1, 0.05)
    assert lever.constants.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        lever.constants[0] = 1.0


def test_a_transmission_without_a_law_says_so() -> None:
    with pytest.raises(DeviceError, match=r"transmission: needs a law; allowed: linear, cubic"):
        spring().torque(0.1)
