"""`rotatum simulate`."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from rotatum import load_device, read_log
from rotatum.cli.simulate import settings
from rotatum.simulation.scenario import load_scenario, scenario_names
from tests.cli.runs import run

SHORT = ("--seconds", "0.5")


def test_the_ready_scenarios_are_listed() -> None:
    done = run("simulate")
    assert done.code == 0
    assert all(name in done.out for name in scenario_names())
    told = json.loads(run("simulate", "--json").out)
    assert [each["name"] for each in told] == list(scenario_names())
    assert all(each["about"] for each in told)


def test_a_copy_of_a_ready_scenario_is_the_scenario(tmp_path: Path) -> None:
    copy = tmp_path / "mine.toml"
    copy.write_text(run("simulate", "trouble/skew", "--show").out)
    assert "name" not in tomllib.loads(copy.read_text())
    mine, ready = load_scenario(copy), load_scenario("trouble/skew")
    assert (mine.joints, mine.plant) == (ready.joints, ready.plant)


def test_log_and_device_file_belong_together(tmp_path: Path) -> None:
    place = tmp_path / "run.csv"
    done = run("simulate", "trouble/coarse-encoder", "-o", place, *SHORT, "--seed", 3)
    assert done.code == 0, done.err
    assert "times real time" in " ".join(done.out.split())
    assert f"rotatum estimate {place} --device {tmp_path / 'run.toml'}" in done.out
    device = load_device(tmp_path / "run.toml")
    assert device.joints[0].encoders.link == 4096.0
    assert device.joints[0].channels["tau"].hold == "held"
    log = read_log(place, device)
    assert log.samples == 500
    same = load_scenario("trouble/coarse-encoder").with_values({"seconds": 0.5}).run(3)
    for role in ("q", "theta", "tau"):
        # CSV keeps 12 significant digits
        expected = same.joints["series-demo"][role]
        np.testing.assert_allclose(log.joints["series-demo"][role], expected, rtol=1e-11)


def test_json_says_what_was_simulated(tmp_path: Path) -> None:
    done = run("simulate", "flacco2012/table1", "-o", tmp_path / "a.npz", *SHORT, "--json")
    told = json.loads(done.out)
    assert told["samples"] == 500
    assert told["times_real_time"] > 0.0
    assert told["device"] == str(tmp_path / "a.toml")
    assert told["estimate"] == {"method": "weak", "start": 2.0}
    joint = told["joints"]["vsa-ii"]
    assert len(joint["deflection"]) == 2
    # Two four-bar springs at rest, 2 k (C - 1)^2 / 4 each (flacco2012 eqs 47 and 48), which harden
    at_rest = 2 * 2 * 2.5 * (np.sqrt(2.0) - 1.0) ** 2 / 4
    assert joint["stiffness"][0] == pytest.approx(at_rest, rel=1e-6)
    assert joint["stiffness"][1] > at_rest


def test_keys_are_set_from_the_command_line(tmp_path: Path) -> None:
    options = ("--set", "sensors.encoders.link=512", "--set", "truth.motor.coulomb=0.0")
    done = run("simulate", "trouble/clean", "-o", tmp_path / "a.npz", *SHORT, *options)
    assert done.code == 0, done.err
    text = (tmp_path / "a.toml").read_text()
    assert tomllib.loads(text)["encoders"]["link"] == 512
    assert "motor.coulomb" in text.splitlines()[1]
    assert settings(["a=[1, 2]", "b=awas", "c = 'x'"]) == {"a": [1, 2], "b": "awas", "c": "x"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("trouble/skwe", "-o", "a.csv"), 'Did you mean "trouble/skew"'),
        (("trouble/skew",), "--output"),
        (("trouble/skew", "-o", "none/a.csv"), "does not exist"),
        (("trouble/skew", "-o", "a.csv", "--set", "seconds"), "KEY=VALUE"),
        (("trouble/skew", "-o", "a.csv", "--set", "sensors.dely.q=1"), '"delay"'),
        (("trouble/skew", "-o", "a.csv", "--set", "effects.backlash=-1"), "backlash"),
        (("trouble/skew", "-o", "a.csv", "--seconds", "-1"), "greater than 0"),
        (("trouble/skew", "-o", "a.txt", "--seconds", "0.1"), "ending"),
    ],
)
def test_bad_input_is_said_in_a_sentence(
    options: tuple[str, ...], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run("simulate", *options)
    assert done.code == 2
    assert said in done.err
    assert not list(tmp_path.iterdir())


def test_a_motion_that_stops_leaves_what_there_is(tmp_path: Path) -> None:
    place = tmp_path / "run.csv"
    # A spring that bears 1.2 rad, and a torque that grows until it has wound it up further.
    options = ("--set", "drives.tau1.amplitude=3.0", "--set", "drives.tau1.frequency=0.2")
    done = run("simulate", "flacco2012/table1", "-o", place, "--seconds", "3", *options)
    assert done.code == 2
    assert "vsa-ii" in done.err
    assert not place.exists()
    (log,) = tmp_path.glob("run.stopped-at-*s.csv")
    assert log.name in done.err
    (device,) = tmp_path.glob("run.stopped-at-*s.toml")
    read = read_log(log, load_device(device))
    assert 0 < read.samples < 3000
    assert float(log.name.split("-")[-1].removesuffix("s.csv")) == pytest.approx(
        read.time[-1], abs=1e-3
    )
