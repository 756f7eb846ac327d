"""What every test may ask for: reproducible examples, public logs, a C compiler, a browser."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("rotatum", derandomize=True, deadline=None, database=None)
settings.load_profile("rotatum")

ROOT = Path(__file__).resolve().parent.parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip, saying so, what takes minutes of compilation, unless it is asked for."""
    if os.environ.get("ROTATUM_SLOW", "0") != "0":
        return
    reason = pytest.mark.skip(reason="minutes of compilation: ROTATUM_SLOW=1, or make test-all")
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(reason)


@pytest.fixture(scope="session")
def project() -> Path:
    """The checkout's top folder."""
    return ROOT


@pytest.fixture(scope="session")
def shared_data() -> Callable[[str], Path]:
    """``shared_data("utokyo-two-inertia/MultisineTypeA.mat")``: a public log, or the test skips.

    Looks in the folder named by ``ROTATUM_DATA``, then in ``shared/data`` beside the checkout.
    """
    folders = [ROOT.parent / "shared" / "data"]
    if named := os.environ.get("ROTATUM_DATA"):
        folders.insert(0, Path(named))

    def find(name: str) -> Path:
        for folder in folders:
            if (folder / name).exists():
                return folder / name
        pytest.skip(f"the public log {name} is not here: point ROTATUM_DATA at a copy")

    return find


@pytest.fixture(scope="session")
def c_compiler() -> str:
    """Path of a C compiler (``CC``, else cc, gcc or clang), or the test skips."""
    return _program("a C compiler", os.environ.get("CC"), "cc", "gcc", "clang")


@pytest.fixture(scope="session")
def chromium() -> str:
    """Path of a Chromium for headless rendering, or the test skips."""
    return _program("Chromium", "chromium", "chromium-browser", "google-chrome")


def _program(what: str, *names: str | None) -> str:
    found = next((p for n in names if n and (p := shutil.which(n))), None)
    if found is None:
        pytest.skip(f"{what} is not installed")
    return found
