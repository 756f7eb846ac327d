"""`rotatum export c`: a project that proves itself."""

from __future__ import annotations

import json
import subprocess

from tests.cli.conftest import Scene
from tests.cli.runs import run
from tests.report.scenes import DEVICE


def test_an_export_equals_python(scene: Scene, c_compiler: str) -> None:
    out = scene.folder / "out"
    done = run("export", "c", "--device", scene.device, "--period", 1e-3, "-o", out)
    assert done.code == 0, done.err
    assert f"make -C {out} test" in done.out
    made = subprocess.run(
        ["make", "-C", str(out), "test", f"CC={c_compiler}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    assert "100000 samples" in made.stdout.replace(",", "")
    assert "equal" in made.stdout


def test_the_log_can_be_the_test_vector(scene: Scene) -> None:
    out = scene.folder / "out"
    done = run("export", "c", "-d", scene.device, "--log", scene.log, "-o", out, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert told["samples"] == 100_000
    assert told["joints"] == ["elbow"]
    assert {"Makefile", "test_vector.bin"} <= set(told["files"])
    again = run("export", "c", "-d", scene.device, "--log", scene.log, "-o", out)
    assert again.code == 0, "an earlier export is replaced"


def test_a_period_has_to_come_from_somewhere(scene: Scene) -> None:
    done = run("export", "c", "--device", scene.device, "-o", scene.folder / "out")
    assert done.code == 2
    assert "--period" in done.err


def test_other_peoples_files_are_left_alone(scene: Scene) -> None:
    before = sorted(scene.folder.iterdir())
    done = run("export", "c", "-d", scene.device, "--period", 1e-3, "-o", scene.folder)
    assert done.code == 2
    assert sorted(scene.folder.iterdir()) == before


def test_joints_of_different_kinds_are_told_apart(scene: Scene) -> None:
    table = DEVICE.replace('name = "elbow"\n', "").replace("\n[", "\n[joint.")
    elbow = f'[[joint]]\nname = "elbow"\n{table}'
    wrist = elbow.replace("elbow", "wrist").replace('fit = ["offset"]', "fit = []")
    scene.device.write_text(f'name = "arm"\n{elbow}{wrist}')
    options = ("export", "c", "-d", scene.device, "--period", 1e-3, "-o", scene.folder / "out")
    done = run(*options, "--joint", "shoulder")
    assert done.code == 2
    assert "elbow, wrist" in done.err
    assert run(*options, "--joint", "elbow").code == 0


def test_the_link_side_of_one_joint_is_exported(scene: Scene, c_compiler: str) -> None:
    out = scene.folder / "out"
    options = ("export", "c", "-d", scene.device, "--period", 1e-3, "-o", out)
    done = run(*options, "--side", "link")
    assert done.code == 0, done.err
    made = subprocess.run(
        ["make", "-C", str(out), "test", f"CC={c_compiler}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    assert "equal" in made.stdout


def test_the_link_side_of_an_arm_is_not(scene: Scene) -> None:
    options = ("export", "c", "--side", "link", "--period", 1e-3, "-o", scene.folder / "out")
    done = run(*options, "-d", "planar-vsa-ii")
    assert done.code == 2
    assert "robot model" in done.err
    assert "--side motor" in done.err
