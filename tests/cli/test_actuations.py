"""`rotatum estimate` and `rotatum export c` on antagonistic and serial joints."""

from __future__ import annotations

import json
import subprocess
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from rotatum import write_table
from tests.cli.runs import run
from tests.report.scenes import lever_log, pair_log

LOGS = {"vsa-ii": pair_log, "awas": lever_log}
OTHER_TORQUES = (("vsa-ii", "sensor"), ("vsa-ii", "model"), ("awas", "model"), ("awas", "sensor"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """CSV logs of both devices, by their names."""
    folder = tmp_path_factory.mktemp("logs")
    for name, made in LOGS.items():
        write_table(folder / f"{name}.csv", made().columns())
    # The simulated torque is held for a sample; read as sampled it comes half of one late, which
    # looks like inertia.
    known = (files("rotatum.models") / "catalogue" / "awas.toml").read_text("utf-8")
    held = '[channels]\ntau = { hold = "held" }\n'
    (folder / "awas.toml").write_text(f"{known}\n{held}", encoding="utf-8")
    return folder


def device_of(folder: Path, name: str) -> Path | str:
    """The device as the log needs it told."""
    return folder / "awas.toml" if name == "awas" else name


def estimate(folder: Path, name: str, *options: object) -> dict[str, Any]:
    """The joint's entry of ``--json``, with the torque's source."""
    device = device_of(folder, name)
    done = run("estimate", folder / f"{name}.csv", "--device", device, *options, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    return {"torque": told["torque"], **told["joints"][name]}


def final_truth(name: str) -> float:
    return float(LOGS[name]().joints[name]["stiffness_true"][-1])


def test_the_table_lists_the_joint_and_its_transmissions(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")  # a narrower terminal folds the numbers
    done = run("estimate", folder / "vsa-ii.csv", "--device", "vsa-ii")
    assert done.code == 0, done.err
    lines = [line.split() for line in done.out.splitlines()]
    results = [line for line in lines if "N" in line and "m/rad" in line and line[-1] != "second"]
    assert [line[0] for line in results] == ["vsa-ii", "transmission", "transmission"]
    assert [line[1] for line in results[1:]] == ["1", "2"]
    assert all("informative" in line for line in results)
    total, *parts = (float(line[line.index("+-") - 1]) for line in results)
    # Told with four digits after the point.
    assert total == pytest.approx(sum(parts), abs=1.6e-4)
    assert "with gravity" in done.out  # the link is described
    assert "MSREP %" in done.out
    for end in "12":
        assert f"vsa-ii, transmission {end}" in done.out


def test_json_of_a_pair_has_both_transmissions(folder: Path) -> None:
    told = estimate(folder, "vsa-ii")
    assert [part["verdict"] for part in told["transmissions"]] == ["informative"] * 2
    # 8 s of the noise that 20 s reduce to 0.5 %.
    assert told["stiffness"]["final"] == pytest.approx(final_truth("vsa-ii"), rel=0.01)


def test_a_serial_joint_is_one_line(folder: Path) -> None:
    done = run("estimate", folder / "awas.csv", "--device", folder / "awas.toml")
    assert done.code == 0, done.err
    assert "transmission" not in done.out
    assert "awas: informative" in done.out


def test_torque_from_a_sensor(folder: Path) -> None:
    # A line and a cube are enough at the AwAS's deflections, and others compile that stage.
    few = folder / "few.toml"
    known = (folder / "awas.toml").read_text("utf-8")
    assert "orders = 3\n" in known
    few.write_text(known.replace("orders = 3\n", "orders = 2\n", 1), encoding="utf-8")
    done = run("estimate", folder / "awas.csv", "-d", few, "--torque", "sensor", "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert told["torque"] == "sensor"
    assert told["joints"]["awas"]["verdict"] == "informative"
    assert told["joints"]["awas"]["stiffness"]["final"] == pytest.approx(
        final_truth("awas"), rel=0.01
    )


# One stage more to compile for each of these.
@pytest.mark.slow
@pytest.mark.parametrize(("name", "torque"), OTHER_TORQUES)
def test_torque_from_elsewhere(folder: Path, name: str, torque: str) -> None:
    told = estimate(folder, name, "--torque", torque)
    assert told["torque"] == torque
    assert told["verdict"] == "informative"
    # Neither channel has noise here; encoders of 4059 counts a turn cost the VSA-II some 0.5 %.
    assert told["stiffness"]["final"] == pytest.approx(final_truth(name), rel=0.01)
    assert told != estimate(folder, name)


@pytest.mark.slow
def test_shrinkage_can_be_switched(folder: Path) -> None:
    default, shrunk, plain = (
        estimate(folder, "awas", *options)
        for options in ((), ("--shrinkage",), ("--no-shrinkage",))
    )
    assert shrunk["coefficients"] == default["coefficients"]
    assert plain["coefficients"] != default["coefficients"]
    # Nine terms where three do: an interval that is much wider.
    assert plain["stiffness_std"] > 1.5 * default["stiffness_std"]
    # A CSV does not say that torques are held commands: half a sample of lag, 1 % of the AwAS's.
    assert plain["stiffness"]["final"] == pytest.approx(final_truth("awas"), rel=0.03)
    done = run("estimate", folder / "awas.csv", "--device", folder / "awas.toml", "--no-shrinkage")
    assert "shrinkage none (asked for)" in " ".join(done.out.split())


@pytest.mark.parametrize("verb", ["estimate", "export"])
def test_an_unknown_torque_names_the_known_ones(folder: Path, tmp_path: Path, verb: str) -> None:
    log, out = folder / "awas.csv", tmp_path / "out"
    what = ("export", "c", "-o", out, "--period", 1e-3) if verb == "export" else ("estimate", log)
    done = run(*what, "--device", "awas", "--torque", "measured")
    assert done.code == 2
    assert "measured" in done.err
    assert "estimated, sensor, model" in " ".join(done.err.split())
    assert not out.exists()


def test_torques_a_device_cannot_give_are_refused(folder: Path) -> None:
    table = pair_log().columns()
    kept = {k: v for k, v in table.items() if not k.startswith("vsa-ii.torque_measured")}
    total = folder / "total.csv"
    write_table(total, {**kept, "vsa-ii.torque_measured": table["vsa-ii.torque_measured"]})
    done = run("estimate", total, "--device", "vsa-ii", "--torque", "sensor")
    assert done.code == 2
    assert "torque_measured1" in done.err
    assert "two transmissions apart" in " ".join(done.err.split())


@pytest.mark.parametrize("name", LOGS)
def test_an_export_equals_python(tmp_path: Path, c_compiler: str, name: str) -> None:
    out = tmp_path / "out"
    done = run("export", "c", "--device", name, "--period", 0.001, "-o", out)
    assert done.code == 0, done.err
    made = subprocess.run(
        ["make", "-C", str(out), "test", f"CC={c_compiler}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    assert "compared bit for bit" in made.stdout
