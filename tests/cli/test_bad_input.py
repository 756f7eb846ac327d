"""Bad input: exit code 2, one sentence that names the thing, no traceback, no partial file."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Scene
from tests.cli.runs import run
from tests.report.scenes import DEVICE, small_log


def refused(
    scene: Scene, *words: str, log: Path | None = None, options: tuple[str, ...] = ()
) -> None:
    """Estimate, expecting code 2 and a sentence with these words; nothing new in the folder."""
    before = sorted(scene.folder.iterdir())
    done = run("estimate", log or scene.log, "--device", scene.device, "--json", *options)
    assert done.code == 2
    assert done.out == ""
    said = done.err.splitlines()[-1]
    assert said.startswith("error: ")
    for word in words:
        assert word in said, said
    assert sorted(scene.folder.iterdir()) == before


def columns(scene: Scene) -> dict[str, np.ndarray]:
    return {name: x.copy() for name, x in small_log().columns().items()}


def write_csv(path: Path, table: dict[str, np.ndarray]) -> None:
    rows = np.column_stack(list(table.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(table), comments="", fmt="%.10g")


# The log


def test_missing_log(scene: Scene) -> None:
    refused(scene, "nowhere.csv", log=scene.folder / "nowhere.csv")


def test_log_is_a_folder(scene: Scene) -> None:
    refused(scene, log=scene.folder)


@pytest.mark.parametrize("name", ["run.npz", "run.mat", "run.parquet", "run.h5"])
def test_a_file_that_is_something_else(scene: Scene, name: str) -> None:
    path = scene.folder / name
    path.write_bytes(scene.log.read_bytes())
    refused(scene, name, log=path)


def test_truncated_files(scene: Scene) -> None:
    whole = scene.folder / "whole.npz"
    np.savez(whole, **columns(scene))
    cut = scene.folder / "cut.npz"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    refused(scene, "cut.npz", log=cut)
    cut = scene.folder / "cut.csv.gz"
    cut.write_bytes(gzip.compress(scene.log.read_bytes())[:5000])
    refused(scene, "cut.csv.gz", log=cut)


def test_unknown_channel_suggests(scene: Scene) -> None:
    text = DEVICE.replace("[channels]", '[channels]\nq = "elbow.qq"')
    scene.device.write_text(text)
    refused(scene, "elbow.qq", "Did you mean")


def test_a_missing_channel_is_named(scene: Scene) -> None:
    table = columns(scene)
    del table["elbow.tau"]
    write_csv(scene.log, table)
    refused(scene, "tau")


def test_the_channel_a_method_needs_is_named(scene: Scene) -> None:
    scene.device.write_text(DEVICE.partition("[channels]")[0])
    table = columns(scene)
    del table["elbow.tau"]
    write_csv(scene.log, table)
    refused(scene, "method weak with estimated torque lacks the channel tau of joint elbow")


def test_channels_of_different_length(scene: Scene) -> None:
    table = columns(scene)
    table["elbow.q"] = table["elbow.q"][:-5]
    path = scene.folder / "run.npz"
    np.savez(path, **table)
    refused(scene, "run.npz", log=path)


def test_cells_that_are_no_numbers(scene: Scene) -> None:
    text = scene.log.read_text().splitlines()
    text[50] = text[50].replace(text[50].split(",")[1], "twelve", 1)
    scene.log.write_text("\n".join(text))
    refused(scene, "twelve")


def test_a_channel_without_numbers(scene: Scene) -> None:
    table = columns(scene)
    table["elbow.q"][:] = np.nan
    write_csv(scene.log, table)
    refused(scene, "q")


def test_a_clock_that_stands(scene: Scene) -> None:
    table = columns(scene)
    table["time"][:] = 1.0
    write_csv(scene.log, table)
    refused(scene, "clock")


def test_a_log_too_short(scene: Scene) -> None:
    write_csv(scene.log, {name: x[:99] for name, x in columns(scene).items()})
    refused(scene, "too short", "99", "100 samples")


def test_a_period_that_is_not_the_devices(scene: Scene) -> None:
    scene.device.write_text(DEVICE.replace("[estimator]", "[estimator]\nperiod = 0.002"))
    refused(scene, "period", "0.002")


def test_odd_samples_are_survived(scene: Scene) -> None:
    table = columns(scene)
    table["elbow.q"][1000:1003] = np.nan
    table["elbow.tau"][2000:2200] = np.inf
    table["time"][1500] = table["time"][1490]
    write_csv(scene.log, table)
    done = run("estimate", scene.log, "--device", scene.device)
    assert done.code in (0, 1)
    assert "skipped" in done.err


# The device


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("inertia = 4e-5", "inertia = 0.0", ("motor.inertia", "greater than 0")),
        ("inertia = 4e-5", "inertia = -4e-5", ("motor.inertia", "greater than 0")),
        ("gear_ratio = 80", "gear_ratio = 0", ("motor.gear_ratio", "must not be 0")),
        ("gear_ratio = 80", "gear_ration = 80", ("gear_ration", "Did you mean", "gear_ratio")),
        ('hold = "held"', 'unit = "Nmmm"', ("Nmmm", "N mm")),
        ('method = "weak"', 'method = "weka"', ("weka", "weak")),
        ("orders = 1", "orders = 1\norders = 2", ("TOML",)),
    ],
)
def test_bad_device_files(scene: Scene, old: str, new: str, words: tuple[str, ...]) -> None:
    assert old in DEVICE
    scene.device.write_text(DEVICE.replace(old, new, 1))
    refused(scene, "elbow.toml", *words)


def test_missing_device_suggests(scene: Scene) -> None:
    done = run("estimate", scene.log, "--device", "series-dmeo")
    assert done.code == 2
    assert 'Did you mean "series-demo"' in " ".join(done.err.split())


# The command line


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--method", "weka"), ("unknown method", "weak")),
        (("--side", "links"), ("unknown side", "link")),
        (("--torque", "sensr"), ("unknown torque", "sensor")),
        (("--solver", "du"), ("unknown solver", "ud")),
        (("--fit", "inertai"), ("inertai", "inertia")),
        (("--fit", "skew,damping"), ("same column",)),
        (("--cutoff", "0"), ("cutoff", "rad/s")),
        (("--cutoff", "nan"), ("cutoff", "rad/s")),
        (("--forgetting", "2"), ("forgetting",)),
        (("--joint", "wrist"), ("wrist", "elbow")),
    ],
)
def test_bad_settings(scene: Scene, options: tuple[str, ...], words: tuple[str, ...]) -> None:
    refused(scene, *words, options=options)


def test_unknown_options_and_verbs_suggest(scene: Scene) -> None:
    done = run("estimate", scene.log, "--devise", scene.device)
    assert done.code == 2
    assert "--device" in done.err
    done = run("estmate", scene.log)
    assert done.code == 2
    assert "estimate" in done.err
    assert run("estimate", scene.log).code == 2
    assert run("estimate", scene.log, "--device", scene.device, "--cutoff", "fast").code == 2


# The output


@pytest.mark.parametrize("option", ["-o", "--report"])
def test_outputs_that_cannot_be_written_are_refused_before_the_work(
    scene: Scene, option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("the work began")

    monkeypatch.setattr("rotatum.evaluation.estimate", never)
    ending = ".csv" if option == "-o" else ".html"
    refused(scene, "does not exist", options=(option, str(scene.folder / "no" / f"x{ending}")))
    refused(scene, "is a folder", options=(option, str(scene.folder)))
    refused(scene, "same file", "input", options=(option, str(scene.log)))
    refused(scene, "same file", "input", options=(option, str(scene.device)))
    both = str(scene.folder / "both.csv")
    refused(scene, "same file", "result", options=("-o", both, "--report", both))


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission(scene: Scene) -> None:
    locked = scene.folder / "locked"
    locked.mkdir(mode=0o555)
    refused(scene, "not writable", options=("-o", str(locked / "out.csv")))


def test_an_ending_without_format(scene: Scene) -> None:
    refused(scene, ".xlsx", ".parquet", options=("-o", str(scene.folder / "out.xlsx")))


def test_a_full_disk_leaves_no_partial_file(scene: Scene) -> None:
    (scene.folder / "full.csv").symlink_to("/dev/full")
    refused(scene, "full.csv", "No space left", options=("-o", str(scene.folder / "full.csv")))
