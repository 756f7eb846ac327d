"""Trumić et al. 2022 reproduced: what the printed estimator reaches, and ours beside it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

import rotatum as rt
from rotatum.estimators.observers.jerk import jerk_observer
from rotatum.evaluation.metrics import msrep_percent
from rotatum.evaluation.papers.trumic2022.designs import designs, jerk_noise
from rotatum.evaluation.papers.trumic2022.experiments import experiment, moving_and_held
from rotatum.evaluation.papers.trumic2022.printed import printed, through
from rotatum.evaluation.papers.trumic2022.runs import Track, relative_error, track
from rotatum.evaluation.papers.trumic2022.simulation import COUNTS, EXACT, PRINTED, Job, motion
from rotatum.evaluation.papers.trumic2022.simulation import tracks as methods
from rotatum.evaluation.papers.trumic2022.uncertainty import (
    DEADBEAT,
    FITTED,
    SELECTED,
    claims,
    tracks,
)
from rotatum.logs import Log
from rotatum.models import Device

T = 5e-3  # s, the paper's
SECONDS, START = 30.0, 15.0


@lru_cache(maxsize=4)
def simulated(name: str, counts: float, period: float = T) -> tuple[Device, Log]:
    return motion(Job(name, period, counts), SECONDS)


def error(device: Device, log: Log, stiffness: np.ndarray) -> float:
    (joint,) = device.joints
    late = log.time >= START
    truth = log.joints[joint.name]["stiffness_true"]
    return msrep_percent(stiffness[late], truth[late])


@pytest.mark.parametrize("name", PRINTED)
def test_without_quantisation_the_paper_is_as_good_as_it_says(name: str) -> None:
    device, log = simulated(name, EXACT)
    centred = jerk_observer(T, bandwidth=None).recursion
    assert error(device, log, printed(device, log)) <= PRINTED[name]
    assert error(device, log, through(device, log, centred)) <= PRINTED[name]


def test_its_own_encoder_is_not_filtered_out() -> None:
    device, log = simulated("avsa", COUNTS)
    assert error(device, log, printed(device, log)) > 100.0
    noise, late, scores = {}, {}, {}
    for name, observer in designs(T).items():
        noise[name] = jerk_noise(observer, 2e-4)
        late[name] = observer.lag
        scores[name] = error(device, log, through(device, log, observer))
    first, poles, longer, one_instant, *rest = scores
    # Exact observers are one filter, whatever their poles and delay: equal to rounding, amplified
    # by 1 / T^3 = 8e6 and the least squares.
    for other in (poles, longer):
        assert noise[other] == pytest.approx(noise[first], rel=1e-9)
        assert scores[other] == pytest.approx(scores[first], rel=1e-3)
    assert late[longer] == 6
    assert scores[one_instant] < 0.5 * scores[first]
    assert all(noise[name] < 0.1 * noise[one_instant] for name in rest)
    # The best of them buy five orders of magnitude.
    assert min(scores[name] for name in rest) < 1e-5 * scores[one_instant]


def test_setup_b_from_its_links() -> None:
    """Show 3 on a part of the motion; damping is fitted, for the stage others compile."""
    scenario = rt.load_scenario("trumic2022/setup-b").with_values({"seconds": 20.0})
    fit = ("link_damping",)
    found = rt.estimate(scenario.run(), scenario.device, side="link", fit=fit, start=12.0)
    for joint in found.joints.values():
        assert joint.truth is not None
        assert joint.truth["msrep_percent"] <= 0.001
        assert joint.verdict == "informative"


def test_the_ready_scenarios_are_estimated_from_the_link() -> None:
    for name in rt.scenario_names():
        if name.startswith("trumic2022/"):
            asked = rt.load_scenario(name).estimate
            assert (asked.method, asked.side, asked.torque) == ("weak", "link", None), name


def test_tracks_are_scored_from_every_sample_and_thinned() -> None:
    time = np.arange(1000) / 100.0
    truth = np.full(1000, 5.0)
    found = track(time, np.where(time < 5.0, 9.0, 5.05), truth, 5.0)
    # 1 % off throughout: 0.01 in MSREP.
    assert found.msrep == pytest.approx(0.01)
    assert found.mean == pytest.approx(1.0)
    assert len(found.time) == 200


def test_claims_name_what_is_worse_and_what_is_not_told() -> None:
    def run(mean: float, *confounded: tuple[str, ...]) -> list[Track]:
        x = np.ones(2)
        return [Track(x, x, x, 0.0, mean, "informative", confounded)] * 2

    each = {DEADBEAT: run(5.0), "rotatum": run(2.0), "weak": run(1.0)}
    said = claims(
        {
            "mass": each | {"weak": run(3.0), FITTED: run(100.0, ("payload", "stiffness"))},
            "length": each | {FITTED: run(9.0)},
            "viscous friction": each | {FITTED: run(0.1)},
            "static friction": each | dict(zip(SELECTED, map(run, (0.5, 7.0, 0.6)), strict=True))
            | {FITTED: run(0.1)},
        }
    )  # fmt: skip
    assert "under: mass (joint 1), mass (joint 2)." in said[0]
    assert said[1].endswith("under: viscous friction (joint 1), viscous friction (joint 2).")
    assert said[2].startswith("It is not under: length (joint 1), length (joint 2), static")
    assert said[3].endswith("under: mass (joint 1), mass (joint 2).")


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED)
def test_show_1_rotatum_without_and_with_encoders(name: str) -> None:
    exact = methods(*motion(Job(name, 1e-3, EXACT)))
    for method in ("rotatum", "rotatum, deadbeat", "weak"):
        assert exact[method].msrep <= PRINTED[name]
    seen = methods(*motion(Job(name, T, COUNTS)))
    assert seen["as printed"].msrep > 100.0
    assert seen["rotatum, deadbeat"].verdict == "starved"
    assert seen["rotatum"].msrep < 0.01 * seen["rotatum, deadbeat"].msrep
    # A thousand times lower under quantisation alone: of the stiff SEA too.
    assert seen["weak"].msrep < 1e-3 * seen["rotatum, deadbeat"].msrep


@pytest.mark.slow
def test_show_2_friction_fitted_or_left_out() -> None:
    viscous = tracks("viscous friction")
    static = tracks("static friction")
    for i in (0, 1):
        assert viscous[FITTED][i].mean < 0.1 * viscous["rotatum"][i].mean
        # To rates between two turns of the link a constant torque is nothing: as good as a column.
        assert static[SELECTED[2]][i].mean < 0.001 * static[DEADBEAT][i].mean
        assert static[SELECTED[2]][i].mean < 3.0 * static[SELECTED[0]][i].mean
        assert static[SELECTED[0]][i].mean < 0.001 * static["rotatum"][i].mean


@pytest.mark.slow
def test_show_2_a_common_factor_of_the_masses_is_one_of_the_stiffness() -> None:
    both = tracks("mass")
    for i in (0, 1):
        # 1 - 1/1.2 = 16.7 %, by whichever method.
        assert both["weak"][i].mean == pytest.approx(100.0 / 6.0, rel=0.01)
        assert both["rotatum"][i].mean == pytest.approx(100.0 / 6.0, rel=0.05)
    assert ("payload", "stiffness") in both[FITTED][1].confounded
    one = tracks("mass of the second link alone")
    # The first link's known mass gives the scale.
    assert one[FITTED][0].mean < 0.01 * min(one[m][0].mean for m in ("rotatum", "weak"))
    assert ("payload", "stiffness") in one[FITTED][1].confounded


@pytest.mark.slow
def test_shows_3_and_4_the_experiments() -> None:
    for name in ("setup-a", "setup-b"):
        runs, _ = experiment(name)
        assert all(run.msrep <= 0.001 for run in runs["weak"].values())
    runs, _ = experiment("experiment-1dof")
    for method in ("rotatum", "weak"):
        (run,) = runs[method].values()
        _, held = moving_and_held(run, 15.0)
        assert np.abs(relative_error(held.stiffness, held.truth)).max() <= 2.0
        # The stiffness moves all the while.
        assert held.truth.max() > 1.5 * held.truth.min()
        assert run.verdict == "starved"
