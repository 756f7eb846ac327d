"""The page in a browser: no console error, every panel has a size, at both widths."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

from rotatum import write_report
from tests.report.scenes import small_estimate

# What keeps a headless browser quiet and off the network.
FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-sync "
    "--disable-background-networking --disable-component-update --hide-scrollbars "
    "--virtual-time-budget=10000 --enable-logging=stderr --v=0"
).split()
PROBE = """
<script>window.addEventListener("load", () => setTimeout(() => {
  const told = Array.from(document.querySelectorAll(".plot")).map((place) => {
    const svg = place.querySelector(".main-svg").getBoundingClientRect();
    const paths = place.querySelectorAll(".plot path, .heatmaplayer image").length;
    const right = Math.max(...Array.from(place.querySelectorAll(".legend, .g-xtitle, .annotation"))
      .map((e) => e.getBoundingClientRect().right));
    return [place.id, svg.width, svg.height, place.clientWidth, paths, right].join(" ");
  });
  const page = document.documentElement;
  document.body.dataset.sizes = told.join(";") + ";page " + page.scrollWidth + " " + innerWidth;
}, 1000));</script>
"""


class Seen(NamedTuple):
    """What the browser said."""

    dom: str
    console: list[str]


@pytest.mark.parametrize("width", [1280, 400])
def test_every_panel_is_drawn_inside_the_page(chromium: str, tmp_path: Path, width: int) -> None:
    path = write_report(small_estimate(), tmp_path / "report.html")
    path.write_text(path.read_text("utf-8").replace("</body>", f"{PROBE}</body>"), "utf-8")
    seen = _render(chromium, path, width, tmp_path)
    assert seen.console == []
    told = re.search(r'data-sizes="([^"]+)"', seen.dom)
    assert told, "the page did not come to its end"
    *panels, page = told[1].split(";")
    assert len(panels) == 6
    for panel in panels:
        name, *numbers = panel.split()
        drawn, height, room, paths, _ = (float(n.replace("-Infinity", "0")) for n in numbers)
        assert 0.0 < drawn <= room + 1.0, f"{name} is {drawn} px wide in {room} px"
        assert height > 80.0, f"{name} is {height} px high"
        assert paths > 0, f"{name} shows nothing"
    _, content, window = page.split()
    assert int(content) <= int(window), "the page scrolls sideways"


def test_an_error_on_the_console_would_be_seen(chromium: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.html"
    path.write_text("<!DOCTYPE html><script>console.error('broken')</script>")
    assert any("broken" in line for line in _render(chromium, path, 1280, tmp_path).console)


def _render(chromium: str, path: Path, width: int, folder: Path) -> Seen:
    profile = f"--user-data-dir={folder / 'profile'}"
    run = subprocess.run(
        [chromium, *FLAGS, profile, f"--window-size={width},3000", "--dump-dom", path.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return Seen(run.stdout, [line for line in run.stderr.splitlines() if "CONSOLE" in line])
