"""The verdict, as a table: what makes a joint starved, converging, informative or inconsistent."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from rotatum.kernels import evidence, readout
from rotatum.kernels.probes import PROBES, verdict_bits
from rotatum.kernels.status import (
    CONVERGING,
    DEFLECTION,
    INCONSISTENT,
    INFORMATIVE,
    LAG,
    NEGATIVE,
    OFFSET,
    PRIOR,
    STARVED,
    TABLE,
    VERDICTS,
    WIDE,
)
from tests.kernels.make import plain, record

T = 0.25  # four samples a second, so that holding for 1 s takes four


class Judge:
    """The verdict on a run of stiffnesses with their deviations."""

    def __init__(self, *, accuracy=0.0):
        thresholds = {"starved": 0.5, "informative": 0.1, "hold": 1.0, "shrink": 0.01}
        self.params = plain(record(readout.ReadoutParams, period=T, **thresholds))
        self.state = plain(record(readout.ReadoutState))
        self.evidence = SimpleNamespace(evaluated=1, wrong=0, deflection=0.01)
        self.settings = SimpleNamespace(spread=[1e8], accuracy=accuracy)
        self.row = SimpleNamespace(D=[2.0], status=0)
        self.time = 0.0

    def __call__(self, relative, *, stiffness=100.0, spread=1.0, counted=1):
        """Verdict and status for half an interval of ``relative`` times the stiffness."""
        out = SimpleNamespace(stiffness=stiffness, stiffness_std=relative * abs(stiffness) / 1.96)
        self.time += T
        found = self.evidence
        status = readout.status_of(self.params, found, self.settings, self.row, spread, out)
        wrong = found.wrong
        if status & PRIOR == 0:
            wrong = wrong | evidence.negative(out.stiffness, out.stiffness_std)
        readout.decide(self.params, self.state, status, wrong, self.time, counted, out)
        self.out = out
        return out.verdict, out.status


@pytest.mark.parametrize(
    ("relative", "verdict", "status"),
    [
        (0.51, STARVED, WIDE),
        (0.49, CONVERGING, 0),
        (0.11, CONVERGING, 0),
        (0.09, CONVERGING, 0),
        (0.0, CONVERGING, 0),
    ],
)
def test_width_of_the_interval(relative, verdict, status):
    assert Judge()(relative) == (verdict, status)


def test_informative_after_a_second_of_narrow_intervals_and_converged_a_second_later():
    judge = Judge()
    verdicts = [judge(0.09)[0] for _ in range(6)]
    assert verdicts == [CONVERGING] * 3 + [INFORMATIVE] * 3
    assert judge.out.converged == 0
    judge(0.09)
    # Informative since the fourth sample, t = 1 s, for four samples.
    assert (judge.out.converged, judge.out.converged_at) == (1, 1.0)
    # One wide interval starts the second anew; converged_at stays what it was.
    assert judge(0.11)[0] == CONVERGING
    assert [judge(0.09)[0] for _ in range(4)] == [CONVERGING] * 3 + [INFORMATIVE]
    for _ in range(8):
        judge(0.09)
    assert (judge.out.converged, judge.out.converged_at) == (1, 1.0)


def test_an_interruption_begins_the_wait_for_convergence_again():
    judge = Judge()
    for relative in (0.09,) * 6 + (0.2,) + (0.09,) * 7:
        judge(relative)
    # Informative at samples 4-6, then from sample 11 (t = 2.75 s) on.
    assert (judge.out.converged, judge.out.converged_at) == (1, 2.75)


def test_a_repeated_reading_is_not_counted():
    judge = Judge()
    for _ in range(3):
        judge(0.09)
    for _ in range(20):  # samples refused by the guard: the last output again
        assert judge(0.09, counted=0)[0] == CONVERGING
    assert judge(0.09)[0] == INFORMATIVE


def test_starved_while_the_prior_is_hardly_narrowed():
    judge = Judge()
    # The prior's variance in the direction D = 2 is 4e8; a hundredth of it is the line.
    assert judge(0.01, spread=4.01e6) == (STARVED, PRIOR)
    assert judge(0.01, spread=3.99e6) == (CONVERGING, 0)
    judge.evidence.evaluated = 0  # no noise level yet: nothing is known, however small the spread
    assert judge(0.01, spread=0.0) == (STARVED, PRIOR)


@pytest.mark.parametrize(("accuracy", "bits"), [(0.0025, WIDE), (0.0026, WIDE | DEFLECTION)])
def test_says_when_the_encoders_are_to_blame(accuracy, bits):
    # 1.96 accuracy over half of an informative deflection of 0.01 rad.
    judge = Judge(accuracy=accuracy)
    assert judge(0.6) == (STARVED, bits)


def test_inconsistent_wins_over_everything():
    judge = Judge()
    judge.evidence.wrong = LAG | OFFSET
    assert judge(0.01) == (INCONSISTENT, LAG | OFFSET)
    assert judge(0.9) == (INCONSISTENT, LAG | OFFSET | WIDE)
    for _ in range(10):
        judge(0.01)
    assert judge.out.converged == 0  # narrow for long, but never informative
    judge.evidence.wrong = 0
    assert judge(0.01) == (INFORMATIVE, 0)  # the interval has been narrow all along


def test_a_negative_stiffness_is_never_informative():
    judge = Judge()
    assert judge(0.01, stiffness=-100.0) == (INCONSISTENT, NEGATIVE)
    assert judge(0.7, stiffness=-100.0)[0] == STARVED  # not beyond doubt
    verdicts = {judge(0.05, stiffness=-100.0)[0] for _ in range(10)}
    assert verdicts == {INCONSISTENT}
    # While the prior rules, a negative number is no finding.
    assert judge(0.01, stiffness=-100.0, spread=1e8) == (STARVED, PRIOR)


def test_zero_stiffness_with_zero_std_is_not_informative():
    judge = Judge()
    assert {judge(0.0, stiffness=0.0)[0] for _ in range(10)} <= {STARVED, CONVERGING}


def test_negative_beyond_doubt_is_three_deviations():
    assert evidence.negative(-3.1, 1.0) == NEGATIVE
    assert evidence.negative(-2.9, 1.0) == 0
    assert evidence.negative(1.0, 0.0) == 0


def probes(share, doubt, *, streak=0, wrong=0):
    four = PROBES
    return SimpleNamespace(
        share=[share] * four, doubt=[doubt] * four, streak=[streak] * four, wrong=wrong
    )


PROBED = ("lag", "inertia", "offset", "drift", "velocity")
ALL = sum(row.bit for row in TABLE if row.name in PROBED)
SETTINGS = SimpleNamespace(bias=0.02, mute=[0] * PROBES)


def test_a_probe_must_speak_three_times_in_a_row():
    state = probes(0.05, 3.0)
    found = []
    for share in (0.05, 0.05, 0.01, 0.05, 0.05, 0.05):
        state.share = [share] * PROBES
        verdict_bits(SETTINGS, state, 0.0)
        found.append(state.wrong)
    assert found == [0, 0, 0, 0, 0, ALL]


@pytest.mark.parametrize(
    ("share", "doubt", "relative", "wrong"),
    [
        (0.021, 2.6, 0.0, ALL),
        (0.019, 2.6, 0.0, 0),  # below the tolerated error
        (0.021, 2.4, 0.0, 0),  # may be chance
        (0.021, 2.6, 0.03, 0),  # covered by the interval
        (0.031, 2.6, 0.03, ALL),
    ],
)
def test_a_probe_speaks_beyond_tolerance_interval_and_chance(share, doubt, relative, wrong):
    state = probes(share, doubt, streak=2)
    verdict_bits(SETTINGS, state, relative)
    assert state.wrong == wrong


@pytest.mark.parametrize(
    ("share", "doubt", "wrong"),
    [(0.011, 1.6, ALL), (0.009, 9.0, 0), (0.5, 1.4, 0), (0.015, 2.0, ALL)],
)
def test_a_probe_falls_silent_at_half(share, doubt, wrong):
    state = probes(share, doubt, wrong=ALL)
    verdict_bits(SETTINGS, state, 0.0)
    assert state.wrong == wrong


def test_every_bit_has_one_name_and_one_place():
    bits = [row.bit for row in TABLE]
    assert bits == [1 << k for k in range(len(bits))]
    assert len({row.name for row in TABLE}) == len(TABLE)
    assert VERDICTS == ("starved", "converging", "informative", "inconsistent")


@pytest.mark.parametrize(("rows", "variance"), [(0.0, 1.0), (50.0, 0.04)])
def test_before_it_is_judged_a_deviation_is_that_of_the_residuals_so_far(rows, variance):
    state = judged(evaluated=0, rows=rows, squares=2.0, variance=0.0, noise=0.0)
    out = SimpleNamespace(stiffness=50.0, torque=4.0, dstiffness=7.0, coefficients_std=[0.0])
    readout.deviations(positions(), SimpleNamespace(), state, 1e8, 0.0, 4.0, 0.0, out)
    assert out.stiffness_std == pytest.approx(math.sqrt(variance * 1e8))
    assert out.torque_std == pytest.approx(math.sqrt(variance * 4.0))


def test_deviations_are_those_of_the_read_out():
    # A systematic error of 0.02 rad in 0.1 rad of deflection.
    state = judged(inflation=2.0, variance=0.25, noise=0.5, relative2=0.2**2, shift=3.0)
    out = SimpleNamespace(stiffness=50.0, torque=4.0, dstiffness=7.0, coefficients_std=[0.0])
    memory = SimpleNamespace()
    readout.deviations(positions(), memory, state, 8.0, 1.5, 0.5, 0.7, out)
    relative = 0.2**2
    noise, wrong = 2 * 0.25 * 8.0, 50.0**2 * relative + 3.0**2 + 1.5
    assert out.stiffness_std == pytest.approx(math.sqrt(noise + wrong))
    # Both parts are kept: with another transmission beside it, only the noise has a correlation.
    assert (memory.noise2, memory.wrong2) == pytest.approx((noise, wrong))
    assert out.torque_std == pytest.approx(math.sqrt(2 * 0.25 * 0.5 + 4.0**2 * relative + 0.7))
    assert out.noise == 0.5
    assert np.array_equal(out.coefficients_std, [0.3])


def test_the_noise_of_where_the_law_is_read_is_in_both_deviations():
    """Against sampling: a cubic law with known coefficients read at noisy positions."""
    k, c, phi, link, motor = 100.0, 4e5, 0.01, 2e-4, 1e-4
    state = judged(variance=0.0, noise=0.0)
    sigma, slope = k + 3.0 * c * phi**2, 6.0 * c * phi
    out = SimpleNamespace(stiffness=sigma, torque=0.0, dstiffness=slope, coefficients_std=[0.0])
    memory = SimpleNamespace()
    readout.deviations(positions(link, motor), memory, state, 0.0, 0.0, 0.0, 0.0, out)
    rng = np.random.default_rng(50)
    read = phi + link * rng.standard_normal(200_000) - motor * rng.standard_normal(200_000)
    # A std from 200,000 samples is known to 0.16 %; curvature adds (n / phi)^2 / 2 = 0.03 %.
    assert out.stiffness_std == pytest.approx((k + 3.0 * c * read**2).std(), rel=5e-3)
    assert out.torque_std == pytest.approx((k * read + c * read**3).std(), rel=5e-3)
    # Neither noise of the fit nor systematic: beside another transmission it has its own rule.
    assert (memory.noise2, memory.wrong2) == (0.0, 0.0)


def judged(**values):
    """The evidence of rows: nothing wrong, one coefficient."""
    usual = {"evaluated": 1, "inflation": 1.0, "deflection": 0.1, "relative2": 0.0, "shift": 0.0}
    return SimpleNamespace(**usual | values | {STDS: [0.3]})


def positions(link=0.0, motor=0.0):
    """Noise of the positions the law is read at, rad."""
    return SimpleNamespace(link2=link**2, motor2=motor**2)


STDS = next(n for n, f in evidence.EvidenceState.fields().items() if "each coefficient" in f.doc)
