"""A log and a device file on the disk, for every test its own."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from tests.report.scenes import write_scene


class Scene(NamedTuple):
    """Files of a joint that can be estimated."""

    folder: Path
    log: Path
    device: Path


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    log, device = write_scene(tmp_path)
    return Scene(tmp_path, log, device)
