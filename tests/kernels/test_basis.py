"""Powers of deflection and set-point against numpy's polynomials and the complex step."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.kernels import basis, readout, rows
from rotatum.models import device_from_tables
from rotatum.record import Layout
from tests.kernels.make import record

SCALE, MIDDLE, HALF = 0.02, 0.08, 0.02
ODD = [1, 3, 5, 7, 9, 11]
FULL = [0, 1, 2, 3]


def evaluate(powers, setpoint_powers, phi, s):
    top = max(*powers, *setpoint_powers)
    p = record(
        basis.BasisParams,
        {"b": len(powers)},
        scale=SCALE,
        middle=MIDDLE,
        half=HALF,
        power=powers,
        setpoint_power=setpoint_powers,
        setpoint_order=max(setpoint_powers),
    )
    state = record(basis.BasisState, {"b": len(powers), "m": top + 1, "r": top + basis.ROOM})
    basis.evaluate(p, state, phi, s)
    return state


def term(i, j, phi, s):
    return (phi / SCALE) ** i * ((s - MIDDLE) / HALF) ** j


@pytest.mark.parametrize("phi", [-0.03, -1e-5, 0.0, 0.007, 0.02])
@pytest.mark.parametrize("powers", [ODD, FULL])
def test_terms_and_derivatives_of_the_deflection(powers, phi):
    state = evaluate(powers, [0] * len(powers), phi, 0.3)
    for h, i in enumerate(powers):
        law = np.polynomial.Polynomial([0.0] * i + [SCALE**-i])
        # Powers by repeated products instead of pow: a few ulps.
        assert state.F[h] == pytest.approx(law(phi), rel=1e-14, abs=1e-300)
        assert state.D[h] == pytest.approx(law.deriv()(phi), rel=1e-14, abs=1e-300)
        assert state.H[h] == pytest.approx(law.deriv(2)(phi), rel=1e-14, abs=1e-300)


@pytest.mark.parametrize("phi", [-0.03, 0.007])
@pytest.mark.parametrize("s", [0.055, 0.08, 0.1])
def test_products_with_the_setpoint(phi, s):
    pairs = [(i, j) for j in range(3) for i in ODD]
    state = evaluate([i for i, _ in pairs], [j for _, j in pairs], phi, s)
    step = 1e-30  # the complex step has no cancellation
    for h, (i, j) in enumerate(pairs):
        by_phi = term(i, j, phi + 1j * step, s).imag / step
        by_s = term(i, j, phi, s + 1j * step).imag / step
        assert state.F[h] == pytest.approx(term(i, j, phi, s), rel=1e-13, abs=1e-300)
        assert state.D[h] == pytest.approx(by_phi, rel=1e-13, abs=1e-300)
        assert state.S[h] == pytest.approx(by_s, rel=1e-13, abs=1e-300)
        # D is exact by now: its central difference over a hundredth of the range, whose error is
        # h^2 / 6 of a third derivative: (i / phi)^2 h^2 / 6, 5e-6 at most.
        h2 = 1e-5
        ahead = evaluate([i], [j], phi + h2, s).D[0]
        behind = evaluate([i], [j], phi - h2, s).D[0]
        assert state.H[h] == pytest.approx((ahead - behind) / (2 * h2), rel=5e-5, abs=1e-9)


@pytest.mark.parametrize("s", [0.055, 0.08, 0.1])
def test_derivative_by_the_setpoint_against_differences(s):
    pairs = [(i, j) for j in range(4) for i in (0, 1, 3)]
    powers, setpoint_powers = [i for i, _ in pairs], [j for _, j in pairs]
    at = evaluate(powers, setpoint_powers, 0.007, s)
    h = 1e-4 * HALF
    ahead = evaluate(powers, setpoint_powers, 0.007, s + h)
    behind = evaluate(powers, setpoint_powers, 0.007, s - h)
    difference = (np.array(ahead.F) - behind.F) / (2.0 * h)
    # Exact up to s^2; of s^3 the third derivative, 6 / HALF^3, leaves h^2 / 6 of it: 1e-8 / HALF.
    # Rounding: an ulp of terms of up to 2, over h.
    np.testing.assert_allclose(at.S, difference, rtol=0.0, atol=1.1e-8 / HALF + 4e-16 / h)
    assert [at.S[k] for k, (_, j) in enumerate(pairs) if j == 0] == [0.0] * 3


LEVER = {
    "name": "lever",
    "actuation": "serial",
    "motor": {"inertia": 0.3},
    "setpoint": {"law": "lever", "r0": 0.1, "b": 4e-4},
    "basis": {
        "deflection_range": SCALE,
        "orders": 2,
        "setpoint_range": [0.06, 0.12],
        "setpoint_orders": 2,
    },
}


@pytest.mark.parametrize("angle", [-60.0, 0.0, 12.5, 100.0])
def test_the_lever_law_is_in_middle_and_half(angle):
    # r = r0 - b theta_c is a straight line, so that powers of the normalised arm are powers of the
    # normalised angle: the kernels read what is logged.
    prepared = Estimator(device_from_tables(LEVER, "test"), period=1e-3).prepared[0]
    (part,) = prepared.parts
    p = part["rows"]["basis"]
    state = record(basis.BasisState, {"b": 6, "m": 4, "r": basis.ROOM + 3})
    phi, arm, step = 0.013, 0.1 - 4e-4 * angle, 1e-30
    basis.evaluate(p, state, phi, angle)
    terms = list(zip(p["power"].tolist(), p["setpoint_power"].tolist(), strict=True))
    assert sorted(terms) == [(i, j) for i in (1, 3) for j in range(3)]
    assert [tuple(power) for power in prepared.powers] == terms
    for h, (i, j) in enumerate(terms):

        def law(r, i=i, j=j):
            return (phi / SCALE) ** i * ((r - 0.09) / 0.03) ** j

        # Rounding of the angle's middle and half, twice: a few ulps of numbers of order 1.
        assert state.F[h] == pytest.approx(law(arm), rel=1e-12, abs=1e-15)
        by_arm = law(arm + 1j * step).imag / step
        assert state.S[h] == pytest.approx(-4e-4 * by_arm, rel=1e-12, abs=1e-15)
    # A coefficient is of the torque at full deflection and at an end of the arm's range.
    scales = [SCALE**i * 0.03**j for i, j in terms]
    assert prepared.scales[-6:] == pytest.approx(scales, rel=1e-12)


def test_the_ends_of_the_setpoints_range_are_one():
    prepared = Estimator(device_from_tables(LEVER, "test"), period=1e-3).prepared[0]
    p = prepared.parts[0]["rows"]["basis"]
    state = record(basis.BasisState, {"b": 6, "m": 4, "r": basis.ROOM + 3})
    for arm, s in ((0.06, -1.0), (0.09, 0.0), (0.12, 1.0)):
        basis.evaluate(p, state, SCALE, (0.1 - arm) / 4e-4)
        assert state.s.tolist() == pytest.approx([s**k for k in range(4)], rel=1e-12, abs=1e-14)


def test_normalised_terms_are_of_order_one_over_the_range():
    # What makes 18 monomials up to phi^11 well enough conditioned to be fitted at all.
    state = evaluate(ODD, [0] * 6, SCALE, 0.0)
    assert state.F.tolist() == [1.0] * 6


def test_readout_is_the_law_of_eqs_27_and_28():
    # flacco2012 eqs 27 and 28 in radians, against the normalised basis.
    alpha = np.array([12.0, -3e3, 5e6])
    phi = 0.013
    state = evaluate([1, 3, 5], [0, 0, 0], phi, 0.0)
    row = rows.Row.layout(p=3).zeros(1)[0]
    out: Layout = readout.Reading.layout(p=3).zeros(1)[0]
    rows.read_basis(state, row)
    readout.read(row, alpha * SCALE ** np.array([1, 3, 5]), out)
    n = np.arange(3)
    sigma = ((2 * n + 1) * alpha * phi ** (2 * n)).sum()
    slope = sum((4 * h * h + 2 * h) * alpha[h] * phi ** (2 * h - 1) for h in (1, 2))
    assert out.stiffness == pytest.approx(sigma, rel=1e-13)  # three terms, a few ulps each
    assert out.dstiffness == pytest.approx(slope, rel=1e-13)
    assert out.torque == pytest.approx((alpha * phi ** (2 * n + 1)).sum(), rel=1e-13)
