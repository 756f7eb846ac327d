"""Powers of deflection and set-point against numpy's polynomials and the complex step."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.kernels import basis, readout, rows
from rotatum.record import Layout
from tests.kernels.make import record

SCALE, MIDDLE, HALF = 0.02, 0.08, 0.02
ODD = [1, 3, 5, 7, 9, 11]
FULL = [0, 1, 2, 3]


def evaluate(powers, setpoint_powers, phi, s):
    m = max(*powers, *setpoint_powers) + 1
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
    state = record(basis.BasisState, {"b": len(powers), "m": m})
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
