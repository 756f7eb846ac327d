"""Ménard et al. 2013 reproduced: which method is better at which noise, and by how much."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.evaluation.papers.case import Case, Outcome
from rotatum.evaluation.papers.menard2013.methods import every_method, motion, truth_of
from rotatum.evaluation.papers.menard2013.scores import (
    LAW,
    LEAST,
    Job,
    Medians,
    Scores,
    medians_of,
    score,
)
from rotatum.evaluation.papers.menard2013.section4 import CASE as CUBIC
from rotatum.evaluation.papers.menard2013.section4 import PRINTED, claims
from rotatum.evaluation.papers.menard2013.section5 import CASE as EXPONENTIAL
from rotatum.evaluation.papers.variants import with_basis

SEEDS = range(5)
USUAL, NOISY = 0.002, 0.02  # N m
NOISES = (0.0, 1e-5, 1e-4, 3e-4, 1e-3, 1e-2)  # rad
RATIO = PRINTED["Flacco et al.", "total"] / PRINTED["as printed", "total"]  # 31.8


def scores(job: Job) -> Scores:
    """As of the case, told a line and a cube, which the springs are: others compile that stage."""
    device, log = motion(job.noise, job.torque_noise, job.seed, swing=job.swing)
    told = with_basis(device, orders=2)
    return {
        (method, what): value
        for method, run in every_method(told, log).items()
        for what, value in score(told, log, run).items()
    }


def medians(torque_noise: float, noises: tuple[float, ...]) -> Medians:
    jobs = [Job(noise, torque_noise, seed) for noise in noises for seed in SEEDS]
    return medians_of(jobs, [scores(job) for job in jobs])


@pytest.fixture(scope="module")
def usual() -> Medians:
    return medians(USUAL, NOISES)


@pytest.fixture(scope="module")
def noisy() -> Medians:
    return medians(NOISY, (0.0, 1e-5))


def quickly(case: Case) -> Outcome:
    told: list[tuple[int, int | None]] = []
    outcome = case.run(lambda *done: told.append(done), True)
    assert told[-1][0] == told[-1][1]
    return outcome


def test_algebraic_beats_flaccos_settings_by_the_papers_factor(usual: Medians) -> None:
    def ratio(noise: float, what: str = "total") -> float:
        flacco = usual.of(noise, USUAL, "Flacco et al.", what)
        return flacco / usual.of(noise, USUAL, "algebraic", what)

    for noise in NOISES:
        if noise <= 1e-4:
            assert ratio(noise) >= RATIO
        # The law itself at every noise; on line from 0.3 mrad on both are mostly the noise of the
        # deflection the law is read at, some (2 noise / deflection)^2, and the ratio is 9.
        assert ratio(noise, LAW) >= RATIO
        assert ratio(noise) >= 5.0


@pytest.mark.parametrize("noise", NOISES)
def test_weak_is_not_worse_than_algebraic(usual: Medians, noise: float) -> None:
    weak, algebraic = (usual.of(noise, USUAL, method) for method in ("weak", "algebraic"))
    assert weak <= 1.1 * algebraic


def test_weak_is_ten_times_better_where_only_torques_are_noisy(noisy: Medians) -> None:
    # The slope of a window sees no constant torque and pays with noise: 20 times in the median of
    # these seeds. With a tenth of the noise it is 3 to 5 times, without any nothing is left to win
    # at 10 urad but the noise of the deflection.
    for noise in (0.0, 1e-5):
        assert noisy.of(noise, NOISY, "algebraic") > 10.0 * noisy.of(noise, NOISY, "weak")


def test_weak_is_far_better_than_the_observer_as_printed(usual: Medians) -> None:
    for noise in NOISES:
        factor = 10.0 if noise > 1e-4 else 10_000.0
        assert usual.of(noise, USUAL, "as printed") > factor * usual.of(noise, USUAL, "weak")


def test_both_printed_errors_nearly_come_out_at_ten_milliradians(usual: Medians) -> None:
    # Neither noise nor torques are printed: the same within a third is all that can be asked.
    for method in ("as printed", "Flacco et al."):
        found = usual.of(1e-2, USUAL, method)
        assert found == pytest.approx(PRINTED[method, "total"], rel=0.33)


def test_the_noise_of_the_read_out_is_what_is_left(usual: Medians) -> None:
    # sigma = 30 (phi_1^2 + phi_2^2) at deflections that are off by the noise, nothing else wrong.
    noise = 1e-3
    device, log = motion(noise, 0.0, 0)
    (logged,) = log.joints.values()
    sigma = sum(30.0 * (logged["q"] - logged[f"theta{end}"]) ** 2 for end in ("1", "2"))
    truth = truth_of(device, log, "total")
    seen = (log.time >= 2.0) & (truth > LEAST)
    least = 100.0 * float(np.mean((sigma[seen] / truth[seen] - 1.0) ** 2))
    for method in ("algebraic", "weak"):
        assert least == pytest.approx(usual.of(noise, USUAL, method), rel=0.15)


def test_claims_say_the_least_of_the_ratios_up_to_a_noise() -> None:
    flacco = {0.0: 400.0, 1e-4: 90.0, 1e-3: 8.0}
    values = {}
    for noise, error in flacco.items():
        values[noise, USUAL, False] = {
            ("weak", "total"): 0.5,
            ("algebraic", "total"): 1.0,
            ("as printed", "total"): 60_000.0,
            ("Flacco et al.", "total"): error,
            ("algebraic", LAW): 0.1,
            ("Flacco et al.", LAW): error,
        }
    first, second = claims(Medians(values), USUAL)
    assert first == (
        "2 mN m of torque noise: Flacco's settings have at least 90 times the MSREP of algebraic "
        "with up to 0.1 mrad of position noise, 8.0 times with up to 1 mrad; read out at the true "
        "deflection 900 and 80 times. The paper has 32 times."
    )
    assert "weak has at most 0.5 times" in second
    assert "at least 2.0 times that of weak, and the observer as printed 120,000 times" in second


def test_springs_that_go_slack_are_left_out_where_they_are(usual: Medians) -> None:
    device, log = motion(0.0, 0.0, 0, swing=True)
    truth = truth_of(device, log, "total")
    assert truth[log.time >= 2.0].min() < LEAST
    assert truth_of(*motion(0.0, 0.0, 0), "total")[2000:].min() > LEAST
    found = scores(Job(1e-4, USUAL, 0, swing=True))
    assert found["weak", "total"] < found["algebraic", "total"] * 1.1
    assert found["Flacco et al.", "total"] > RATIO * found["algebraic", "total"]


@pytest.mark.slow
def test_section4_has_every_condition() -> None:
    outcome = quickly(CUBIC)
    line = outcome.value("10 mrad: total, MSREP")
    assert line.paper == PRINTED["as printed", "total"]
    assert line.weak is not None
    assert line.algebraic is not None
    assert line.weak <= 1.1 * line.algebraic
    printed, wide, held = (
        outcome.value(f"no noise at all: {name}, MSREP").own
        for name in (
            "as printed",
            "P(0) = 1e+16",
            "P(0) = 1e+16, and the mean of a held torque",
        )
    )
    assert printed is not None
    assert wide is not None
    assert held is not None
    assert printed > 1000.0 * wide > 1e5 * held
    assert [figure.key for figure in outcome.figures] == ["motion", "fig2", "noise"]


@pytest.mark.slow
def test_section5_stays_within_the_papers_line() -> None:
    outcome = quickly(EXPONENTIAL)
    above = outcome.value("time with an error above 25 %")
    assert above.weak == 0.0
    assert above.algebraic == 0.0
    rms = outcome.value("relative error, rms")
    assert rms.weak is not None
    assert rms.algebraic is not None
    assert rms.own is not None
    # 20 mN m of noise on torques of 0.1 to 0.5 N m: 1 to 2 % by seed.
    assert max(rms.weak, rms.algebraic) < 4.0
    assert rms.own > 10.0 * max(rms.weak, rms.algebraic)
    for figure in outcome.figures:
        assert all(curve.x.size == curve.y.size for plot in figure.plots for curve in plot.curves)
