"""Every law: derivatives against sympy and against differences, energy, reaction, symmetry."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import sympy
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from rotatum.models import LAWS, Transmission
from tests.models.law_cases import CASES, Case

PHI, S = sympy.symbols("phi s", real=True)
DERIVATIVES = {
    "torque": (1, 0),
    "stiffness": (2, 0),
    "slope": (3, 0),
    "curvature": (4, 0),
    "energy_setpoint": (0, 1),
    "torque_setpoint": (1, 1),
    "stiffness_setpoint": (2, 1),
}
Numbers = NDArray[np.float64]

every = pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())


def _energies() -> dict[str, Callable[..., sympy.Expr]]:
    """Write the energies down, each as its source has it; the torques follow by differentiation."""

    def odd(ks: list[float]) -> sympy.Expr:
        return sum(k * PHI ** (2 * i + 2) / (2 * i + 2) for i, k in enumerate(ks))

    def full(ks: list[float]) -> sympy.Expr:
        return sum(k * PHI ** (i + 2) / (i + 2) for i, k in enumerate(ks))

    def maccepa(spring: float, lever: float, base: float, drum: float) -> sympy.Expr:
        distance = sympy.sqrt(lever**2 + base**2 - 2 * lever * base * sympy.cos(PHI))
        return spring * (distance - (base - lever) + drum * S) ** 2 / 2

    return {
        "linear": lambda k: k * PHI**2 / 2,
        "cubic": lambda k, k3: k * PHI**2 / 2 + k3 * PHI**4 / 4,
        "odd_polynomial": odd,
        "polynomial": full,
        "sinh": lambda k, a: k / a * (sympy.cosh(a * PHI) - 1),
        "exponential": lambda k, ke, a, b: (
            k / ke * (b * sympy.exp(ke * PHI) + a * sympy.exp(-ke * PHI) - 2 * sympy.sqrt(a * b))
        ),
        "fourbar": lambda k, c: k * (sympy.asin(c * sympy.sin(PHI / 2)) - PHI / 2) ** 2,
        "lever": lambda k: k * S**2 * sympy.sin(PHI) ** 2,
        "lever_ratio": lambda k, length, arm: (
            k * (length / arm * S / (length - S)) ** 2 * sympy.sin(PHI) ** 2
        ),
        "maccepa": maccepa,
    }


def _grid(case: Case) -> tuple[Numbers, Numbers]:
    phi = np.linspace(-case.reach, case.reach, 13)
    phi[6] = 0.013 * case.reach  # at rest itself all relative errors are of zero
    grid = np.meshgrid(phi, case.setpoints)
    return grid[0].ravel(), grid[1].ravel()


# A table has no formula; see test_a_table_is_scipys_curve.
FORMULAS = {name: case for name, case in CASES.items() if name != "table"}


@pytest.mark.parametrize("case", FORMULAS.values(), ids=FORMULAS.keys())
def test_derivatives_are_those_of_sympy(case: Case) -> None:
    transmission = case.transmission
    assert transmission.law is not None
    exact = {k: [sympy.Rational(x) for x in v] for k, v in transmission.given.items()}
    numbers = [v if k == "coefficients" else v[0] for k, v in exact.items()]
    energy = _energies()[transmission.law](*numbers)
    phi, setpoint = _grid(case)
    pairs = zip(phi, setpoint, strict=True)
    points = [{PHI: sympy.Rational(p), S: sympy.Rational(s)} for p, s in pairs]
    for name, (i, j) in {"energy": (0, 0), **DERIVATIVES}.items():
        formula = sympy.diff(energy, PHI, i, S, j) if i + j else energy
        # Evaluated with 40 digits, so that what is compared is our rounding and nothing else.
        truth = np.array([float(sympy.N(formula.subs(p), 40)) for p in points])
        found = getattr(transmission, name)(phi, setpoint)
        # 1e-12 of the largest value: the four-bar's arcsine loses digits near its lock, and the
        # differences of two numbers of one size lose them near rest.
        np.testing.assert_allclose(
            found, truth, rtol=0, atol=1e-12 * np.abs(truth).max(), err_msg=name
        )


@every
@pytest.mark.parametrize("name", DERIVATIVES)
def test_derivatives_are_those_of_differences(case: Case, name: str) -> None:
    i, j = DERIVATIVES[name]
    below = {(i, j): n for n, (i, j) in {"energy": (0, 0), **DERIVATIVES}.items()}
    transmission = case.transmission
    if j and not transmission.model.uses_setpoint:
        assert np.all(getattr(transmission, name)(*_grid(case)) == 0.0)
        return
    phi, setpoint = _grid(case)
    phi = phi + 1e-3 * case.reach  # off the knots of the table, where its slope jumps
    along = (0, 1) if j else (1, 0)
    lower = getattr(transmission, below[i - along[0], j - along[1]])
    h = 2e-4 * (case.reach if along[0] else max(case.setpoints))

    def at(steps: float) -> Numbers:
        values: Numbers = lower(phi + steps * h * along[0], setpoint + steps * h * along[1])
        return values

    found = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h)
    truth = getattr(transmission, name)(phi, setpoint)
    # Fourth order: (2e-4)^4 of a fifth derivative, and 1e-16 / 2e-4 of rounding.
    scale = np.abs(truth).max() + np.abs(lower(phi, setpoint)).max() / case.reach
    np.testing.assert_allclose(found, truth, rtol=0, atol=1e-8 * scale)


@every
def test_energy_is_zero_at_rest_only(case: Case) -> None:
    transmission = case.transmission
    setpoints = case.setpoints if transmission.law != "maccepa" else (0.0,)
    phi = np.linspace(-case.reach, case.reach, 201)
    for setpoint in setpoints:
        # Zero to a few roundings of the terms an energy is summed from.
        scale = transmission.energy(phi, setpoint).max()
        assert abs(transmission.energy(case.rest, setpoint)) < 1e-15 * scale
        away = phi[np.abs(phi - case.rest) > 1e-3 * case.reach]
        assert np.all(transmission.energy(away, setpoint) > 1e-15 * scale)
    # At rest there is no torque, whatever the set-point.
    assert np.all(np.abs(transmission.torque(case.rest, case.setpoints)) < 1e-8 * case.reach)


def test_the_energy_of_a_maccepa_is_its_pretensions() -> None:
    spring = CASES["maccepa"].transmission
    (kappa, *_, drum) = spring.constants
    # Extended by the drum alone: kappa (r s)^2 / 2; the motor feels kappa r (r s).
    assert spring.energy(0.0, 2.0) == pytest.approx(0.5 * kappa * (2.0 * drum) ** 2, rel=1e-12)
    assert spring.energy_setpoint(0.0, 2.0) == pytest.approx(kappa * drum**2 * 2.0, rel=1e-12)


@every
def test_oddness_is_as_declared(case: Case) -> None:
    transmission = case.transmission
    phi, setpoint = _grid(case)
    mirrored = -transmission.torque(-phi, setpoint)
    assert np.array_equal(transmission.torque(phi, setpoint), mirrored) == transmission.model.odd


def test_a_table_is_scipys_curve() -> None:
    transmission = CASES["table"].transmission
    knots, torques = transmission.given["deflection"], transmission.given["torque"]
    curve = PchipInterpolator(knots, torques)
    phi = np.linspace(-0.5, 0.6, 1001)
    for order, name in enumerate(("torque", "stiffness", "slope", "curvature")):
        truth = curve.derivative(order)(phi) if order else curve(phi)
        # The same polynomials, multiplied out in another order.
        scale = np.abs(truth).max()
        found = getattr(transmission, name)(phi)
        np.testing.assert_allclose(found, truth, rtol=0, atol=1e-13 * scale, err_msg=name)
    assert np.all(transmission.stiffness(phi) > 0.0)
    assert transmission.torque(np.array(knots)) == pytest.approx(np.array(torques), rel=1e-14)


def test_a_table_goes_on_with_its_last_stiffness() -> None:
    spring = CASES["table"].transmission
    for end, beyond in ((0.6, 0.9), (-0.5, -0.7)):
        sigma = float(spring.stiffness(end))
        step = beyond - end
        torque = float(spring.torque(end))
        assert spring.stiffness(beyond) == sigma
        assert spring.torque(beyond) == pytest.approx(torque + sigma * step, rel=1e-14)
        worked = torque * step + 0.5 * sigma * step**2
        assert spring.energy(beyond) == pytest.approx(spring.energy(end) + worked, rel=1e-14)
        assert spring.slope(beyond) == spring.curvature(beyond) == 0.0


def test_a_table_whose_rest_is_a_point_of_it() -> None:
    table = {"law": "table", "deflection": [0.0, 0.1, 0.3], "torque": [0.0, 1.0, 4.0]}
    spring = Transmission.model_validate(table)
    assert spring.energy(0.0) == 0.0
    assert spring.energy(0.2) > 0.0


@every
def test_nothing_breaks_far_outside(case: Case) -> None:
    transmission = case.transmission
    for phi in (-1e3, -3.0, -1.6, 1.6, 3.0, 1e3):
        for setpoint in (-1.0, 0.0, 0.05, 10.0):
            for name in ("energy", *DERIVATIVES):
                assert np.isfinite(getattr(transmission, name)(phi, setpoint)), (name, phi)


def test_every_law_has_a_case_and_documents_itself() -> None:
    assert {case.table["law"] for case in CASES.values()} == set(LAWS)
    for name, law in LAWS.items():
        assert law.name == name
        assert law.source
        assert law.formula
        assert all(constant.doc for constant in law.constants)
        assert law.uses_setpoint == bool(law.setpoint_unit)
