"""`rotatum estimate --method rotatum`, its deadbeat, and selective updates."""

from __future__ import annotations

import json

import pytest

from tests.cli.conftest import Scene
from tests.cli.runs import run
from tests.report.scenes import STIFFNESS


def test_the_method_needs_no_side_and_says_its_lag_and_bandwidth(scene: Scene) -> None:
    done = run("estimate", scene.log, "-d", scene.device, "--method", "rotatum")
    assert done.code == 0
    for words in ("link side", "ms late", "noise of the jerk", "bandwidth", "Hz", "informative"):
        assert words in done.out, words
    told = json.loads(
        run("estimate", scene.log, "-d", scene.device, "--method", "rotatum", "--json").out
    )
    assert (told["method"], told["side"]) == ("rotatum", "link")
    # noise of a hundredth on the jerk leaves the stiffness of 4 s better than one per cent
    assert told["joints"]["elbow"]["stiffness"]["final"] == pytest.approx(STIFFNESS, rel=0.01)


def test_the_deadbeat_on_counted_positions_is_code_1_and_json_stays_json(scene: Scene) -> None:
    options = ("--method", "rotatum", "--cutoff", "inf")
    done = run("estimate", scene.log, "-d", scene.device, *options)
    assert done.code == 1
    assert "deadbeat, 2 ms late" in done.out
    raw = run("estimate", scene.log, "-d", scene.device, *options, "--json").out
    assert "Infinity" not in raw
    assert "NaN" not in raw
    joint = json.loads(raw)["joints"]["elbow"]
    assert joint["verdict"] == "starved"
    assert joint["delay"] == pytest.approx(0.002)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--method", "rotatum", "--side", "motor"), "on the link's side"),
        (("--method", "rotatum", "--window", 0.2), "not a window"),
        (("--method", "rotatum", "--cutoff", 1), "or inf"),
        (("--method", "rotatum", "--cutoff", "nan"), "does not fit"),
        (("--cutoff", "inf"), "does not fit"),
        (("--method", "rotatum", "--fit", "link_damping"), "cannot fit this"),
        (("--selective", -1), "0 (all is) or more"),
        (("--selective", 1e-5), "does not tell such a speed from a standstill"),
    ],
)
def test_what_it_cannot_have_is_code_2(
    scene: Scene, options: tuple[object, ...], told: str
) -> None:
    done = run("estimate", scene.log, "-d", scene.device, *options)
    assert done.code == 2
    # Lines are folded where the terminal ends.
    assert told in " ".join(done.err.split())
    assert done.out == ""
