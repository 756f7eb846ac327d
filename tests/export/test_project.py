"""An exported project builds without warnings, equals Python bit for bit, and notices when not."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from rotatum.errors import OutputError
from rotatum.export import export_c
from rotatum.export.vector import HEAD
from rotatum.record import Records
from rotatum.runtime.errors import StageError
from tests.export.stages import LOWPASS

SAMPLES = 3210  # three whole blocks and a part of one

pytestmark = pytest.mark.usefixtures("c_compiler")


def records(joints: int = 2) -> tuple[Records, Records]:
    params, u = LOWPASS.params.zeros(joints), LOWPASS.input.zeros(SAMPLES, joints)
    params["pole"] = np.linspace(0.5, 0.9, joints)
    params["order"] = 2
    u["x"] = np.random.default_rng(3).normal(size=u.shape)
    u["x"][7] = np.nan
    return params, u


def make(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["make", "-C", str(folder), "test"], capture_output=True, text=True)


def run(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [str(folder / "selftest"), str(folder / "test_vector.bin"), *options]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    params, u = records()
    done = export_c(LOWPASS, params, tmp_path / "out", inputs=u, joints=["hip", "knee"])
    assert done.samples == SAMPLES
    assert sorted(p.name for p in done.directory.iterdir()) == list(done.files)
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    return done.directory


def test_make_test_passes_and_says_what_it_compared(project: Path) -> None:
    done = make(project)
    assert done.returncode == 0, done.stdout + done.stderr
    # Stored: the first 1000 and every 100th after, of two joints with one output each.
    stored = 2 * (HEAD + (SAMPLES - HEAD + 99) // 100)
    assert f"all {2 * SAMPLES} values compared bit for bit ({stored} one by one)" in done.stdout
    assert run(project, "--tolerance", "1e-9").returncode == 0


def test_other_constants_are_noticed_and_located(project: Path) -> None:
    header = project / "lowpass_params.h"
    header.write_text(header.read_text().replace(".pole = 0.9", ".pole = 0.9000000000000001"))
    done = make(project)
    assert done.returncode != 0
    assert "joint 1, field x: C " in done.stdout
    assert "DIFFERENT" in done.stdout
    assert "joint 0" not in done.stdout
    # The two poles are 1e-16 apart, far below the tolerance, and the filter forgets.
    assert run(project, "--tolerance", "1e-9").returncode == 0
    assert run(project, "--tolerance", "1e-18").returncode == 1


def test_a_difference_between_stored_samples_is_noticed(tmp_path: Path) -> None:
    params, u = records(1)
    y = np.array(export_outputs(params, u))
    y["x"][2222, 0] = np.nextafter(y["x"][2222, 0], 9.0)
    export_c(LOWPASS, params, tmp_path / "out", inputs=u[:, 0], outputs=y[:, 0])
    done = make(tmp_path / "out")
    assert done.returncode != 0
    assert "samples 2000 to 2999: an output that is not stored differs" in done.stdout


def export_outputs(params: Records, u: Records) -> Records:
    from rotatum.runtime.bank import Bank

    return Bank(LOWPASS, params).run(u)


def test_a_damaged_vector_is_refused(project: Path) -> None:
    assert make(project).returncode == 0
    vector = project / "test_vector.bin"
    whole = vector.read_bytes()
    vector.write_bytes(whole[:-100])
    assert (run(project).returncode, "ends too early" in run(project).stderr) == (2, True)
    vector.write_bytes(b"x" + whole[1:])
    assert run(project).returncode == 2


def test_names_and_fields_are_explained(project: Path) -> None:
    readme = (project / "README.md").read_text()
    assert "hip, knee" in readme
    assert "| `x` |" in readme
    assert "@" not in readme
    assert "/* knee */" in (project / "lowpass_params.h").read_text()


def test_an_earlier_export_is_replaced(project: Path) -> None:
    assert make(project).returncode == 0
    params, u = records(1)
    export_c(LOWPASS._replace(name="other"), params, project, inputs=u)
    assert not (project / "lowpass.c").exists()
    assert make(project).returncode == 0


def test_an_empty_folder_is_used(tmp_path: Path) -> None:
    params, u = records(1)
    export_c(LOWPASS, params, tmp_path, inputs=u)
    assert (tmp_path / "Makefile").exists()


def test_a_folder_with_other_files_is_left_alone(project: Path) -> None:
    (project / "main.c").write_text("mine")
    before = {p.name: p.read_bytes() for p in project.iterdir()}
    params, u = records(1)
    with pytest.raises(OutputError, match=r"main\.c"):
        export_c(LOWPASS, params, project, inputs=u)
    assert {p.name: p.read_bytes() for p in project.iterdir()} == before


def test_a_file_in_the_way_is_named(tmp_path: Path) -> None:
    params, u = records(1)
    (tmp_path / "out").write_text("a file")
    with pytest.raises(OutputError, match="is a file"):
        export_c(LOWPASS, params, tmp_path / "out", inputs=u)
    with pytest.raises(OutputError, match="cannot be written"):
        export_c(LOWPASS, params, tmp_path / "out" / "below", inputs=u)


def test_a_full_disk_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("rotatum.export.project.write_vector", full)
    params, u = records(1)
    with pytest.raises(OutputError, match="No space left"):
        export_c(LOWPASS, params, tmp_path / "out", inputs=u)
    assert list(tmp_path.iterdir()) == []


def test_records_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    params, u = records()
    with pytest.raises(StageError, match=r"shape \(N, 2\)"):
        export_c(LOWPASS, params, tmp_path / "out", inputs=u[:, 0])
    with pytest.raises(StageError):
        export_c(LOWPASS, params, tmp_path / "out", inputs=u, joints=["one"])


def test_the_header_is_for_cpp_too(project: Path) -> None:
    cpp = shutil.which("c++") or shutil.which("g++")
    if cpp is None:
        pytest.skip("no C++ compiler is installed")
    (project / "t.cpp").write_text(
        '#include "lowpass.h"\nint main() { lowpass_state_t s; (void)s; }\n'
    )
    flags = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
    done = subprocess.run([cpp, *flags, str(project / "t.cpp")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
