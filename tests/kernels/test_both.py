"""Two transmissions that share a row: the total and each part against linear algebra."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from rotatum.kernels import both, pair
from rotatum.kernels.status import CONVERGING, INFORMATIVE, STARVED, WIDE
from tests.kernels.make import plain, record

COLUMNS, TERMS = 5, 4  # one fitted quantity; powers 1 and 3 in turns, agonist first
OWN = 3  # coefficients of a part


def case(seed=430, *, starved=0.5, link=0.0, motor=0.0):
    """Parameters, evidence, reading, row and covariance of a total, drawn at random."""
    rng = np.random.default_rng(seed)
    readout = SimpleNamespace(starved=starved, link2=link**2, motor2=motor**2)
    evidence = SimpleNamespace(inflation=2.5, variance=0.04, relative2=0.01**2, shift=0.3)
    spring = np.array([0.0, 1.0, 1.0, 1.0, 1.0])
    F, D, H = rng.uniform(0.5, 2.0, (3, COLUMNS)) * spring
    alpha, stds = rng.uniform(10.0, 20.0, COLUMNS), rng.uniform(0.1, 1.0, COLUMNS)
    reading = SimpleNamespace(
        stiffness=float(D @ alpha), stiffness_std=1.25, torque=float(F @ alpha), torque_std=0.5,
        dstiffness=float(H @ alpha), row_torque=3.0, row_fit=2.5, noise=0.2, inflation=2.5,
        informative_deflection=0.01, converged_at=4.0, converged=1, verdict=INFORMATIVE, status=0,
        rows=1000, coefficients=alpha.tolist(), coefficients_std=stds.tolist(),
    )  # fmt: skip
    row = SimpleNamespace(F=F.tolist(), D=D.tolist(), H=H.tolist(), phi=0.25, phi2=-0.125)
    root = rng.standard_normal((COLUMNS, COLUMNS))
    return readout, evidence, reading, row, root @ root.T


def parts(readout, evidence, reading, row, P, bias2=0.0):
    """The reading of both parts, as the composed stage makes it."""
    out = plain(record(pair.PairReading, {"v": 2 * OWN}))
    both.read(reading, row, out)
    masked = [0.0] * COLUMNS
    for i in range(2):
        both.mask(row, TERMS, i, masked)
        spread = float(np.array(masked) @ P @ np.array(masked))
        both.part(readout, evidence, reading, row, spread, bias2, TERMS, i, out)
    both.relate(readout, out)
    return out


def sides():
    """Columns of agonist and antagonist."""
    return np.array([1, 3]), np.array([2, 4])


def test_the_total_is_handed_on_as_it_is_told():
    readout, evidence, reading, row, P = case()
    out = parts(readout, evidence, reading, row, P)
    for name in (
        "stiffness", "stiffness_std", "torque", "torque_std", "dstiffness", "row_torque", "row_fit",
        "noise", "inflation", "informative_deflection", "converged_at", "converged", "verdict",
        "status", "rows",
    ):  # fmt: skip
        assert getattr(out, name) == getattr(reading, name)
    assert out.deflection == 0.0625  # the mean of both


def test_parts_are_told_apart_by_their_columns_and_add_up():
    readout, evidence, reading, row, P = case()
    out = parts(readout, evidence, reading, row, P)
    alpha = np.array(reading.coefficients)
    for i, own in enumerate(sides()):
        for name, basis in (("stiffness", row.D), ("torque", row.F), ("dstiffness", row.H)):
            found = getattr(out, f"part_{name}")[i]
            assert found == pytest.approx(np.array(basis)[own] @ alpha[own], rel=1e-14)
        expected = [alpha[0], *alpha[own]]
        assert out.coefficients[OWN * i : OWN * i + OWN] == expected
        stds = np.array(reading.coefficients_std)
        assert out.coefficients_std[OWN * i : OWN * i + OWN] == [stds[0], *stds[own]]
    assert sum(out.part_stiffness) == pytest.approx(out.stiffness, rel=1e-14)
    assert sum(out.part_torque) == pytest.approx(out.torque, rel=1e-14)
    assert sum(out.part_dstiffness) == pytest.approx(out.dstiffness, rel=1e-14)
    assert out.part_deflection == [0.25, -0.125]
    assert out.part_row_torque == [3.0, 3.0]
    assert out.part_row_fit == [2.5, 2.5]


def test_deviations_of_the_parts_are_those_of_their_read_outs():
    link, motor = 2e-3, 1e-3
    readout, evidence, reading, row, P = case(link=link, motor=motor)
    alpha, bias2 = np.array(reading.coefficients), 0.5
    out = parts(readout, evidence, reading, row, P, bias2)
    for i, own in enumerate(sides()):
        d, h = np.zeros(COLUMNS), np.zeros(COLUMNS)
        d[own], h[own] = np.array(row.D)[own], np.array(row.H)[own]
        # Noise, a scale error, a bias that may be all its own, and where its law is read.
        variance = 2.5 * 0.04 * d @ P @ d + (0.01 * d @ alpha) ** 2 + 0.3**2 + bias2
        variance += (h @ alpha) ** 2 * (link**2 + motor**2)
        assert out.part_stiffness_std[i] == pytest.approx(math.sqrt(variance), rel=1e-12)


def test_the_total_is_read_at_two_motors():
    # As one row's it was told with (s1' + s2')^2 for one motor; each law has a motor of its own.
    link, motor = 2e-3, 5e-3
    readout, evidence, reading, row, P = case(link=link, motor=motor)
    first, second = (np.array(row.H)[own] @ np.array(reading.coefficients)[own] for own in sides())
    rest = 1.2
    told = (first + second) ** 2 * (link**2 + motor**2)
    reading.stiffness_std = math.sqrt(rest**2 + told)
    out = parts(readout, evidence, reading, row, P)
    expected = (first + second) ** 2 * link**2 + (first**2 + second**2) * motor**2
    assert out.stiffness_std == pytest.approx(math.sqrt(rest**2 + expected), rel=1e-12)


@pytest.mark.parametrize("r", [-0.9, -0.3, 0.0, 0.6, 1.0])
def test_the_correlation_is_what_makes_variances_add_up(r):
    readout, evidence, reading, row, P = case()
    out = parts(readout, evidence, reading, row, P)
    one, other = out.part_stiffness_std
    out.stiffness_std = math.sqrt(one**2 + other**2 + 2.0 * r * one * other)
    both.relate(readout, out)
    assert out.correlation == pytest.approx(r, abs=1e-12)


@pytest.mark.parametrize(("std", "r"), [(0.0, -1.0), (1e3, 1.0)])
def test_the_correlation_stays_one(std, r):
    # Parts are told with what is systematic as if all were theirs; the total is not.
    readout, evidence, reading, row, P = case()
    out = parts(readout, evidence, reading, row, P)
    out.part_stiffness_std = [1.0, 1.0]
    out.stiffness_std = std
    both.relate(readout, out)
    assert out.correlation == r


def test_without_deviations_there_is_no_correlation():
    readout, evidence, reading, row, P = case()
    out = parts(readout, evidence, reading, row, P)
    out.part_stiffness_std = [0.0, 1.0]
    both.relate(readout, out)
    assert out.correlation == 0.0


@pytest.mark.parametrize("verdict", [CONVERGING, INFORMATIVE])
def test_a_part_that_is_not_told_apart_is_starved_whatever_the_total_is(verdict):
    # Deflections that go together: only the sum is known, each alone hardly.
    readout, evidence, reading, row, P = case()
    reading.verdict = verdict
    d = np.array(row.D)
    apart = np.zeros(COLUMNS)
    apart[[1, 2]] = 1.0 / d[[1, 2]] * [1.0, -1.0]  # moves stiffness from one to the other
    out = parts(readout, evidence, reading, row, 1e-6 * P + 1e4 * np.outer(apart, apart))
    assert out.part_verdict == [STARVED, STARVED]
    assert out.part_status == [WIDE, WIDE]
    assert (out.verdict, out.status) == (verdict, 0)
    assert out.correlation < -0.99
    # And where it is, its verdict is the total's.
    out = parts(readout, evidence, reading, row, 1e-6 * P)
    assert out.part_verdict == [verdict, verdict]
    assert out.part_status == [0, 0]
