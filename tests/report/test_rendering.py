"""The page in a browser: no console error, every panel has a size, at both widths."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from rotatum import Estimate, write_report
from tests.report.scenes import lever_estimate, pair_estimate, small_estimate

# What keeps a headless browser quiet and off the network.
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--hide-scrollbars",
    "--virtual-time-budget=10000",
    "--enable-logging=stderr",
    "--v=0",
]
# The page stands in a frame, because a browser's window cannot be as narrow as a telephone's.
FRAME = """<!DOCTYPE html><body>
<script>addEventListener("message", (e) => { document.body.dataset.sizes = e.data; });</script>
<iframe src="report.html" style="border:0;width:WIDTHpx;height:3000px"></iframe>"""
PROBE = """
<script>addEventListener("load", () => setTimeout(async () => {
  const places = Array.from(document.querySelectorAll(".plot"));
  await Plotly.relayout(places[0], { "xaxis.range[0]": 1, "xaxis.range[1]": 2 });
  await new Promise((done) => setTimeout(done, 500));
  const told = places.map((place) => {
    const drawn = place.querySelector(".main-svg").getBoundingClientRect();
    const marks = place.querySelectorAll(".plot path, .heatmaplayer image").length;
    return [place.id, drawn.width, drawn.height, place.clientWidth, marks].join(" ");
  });
  const zoomed = document.getElementById("joint0-torque")._fullLayout.xaxis.range;
  const page = document.documentElement;
  told.push(["page", page.scrollWidth, innerWidth, zoomed].join(" "));
  parent.postMessage(told.join(";"), "*");
}, 1000));</script>
"""


class Seen(NamedTuple):
    """What the browser said."""

    dom: str
    console: list[str]


@pytest.mark.parametrize("width", [1280, 400])
@pytest.mark.parametrize("scene", [small_estimate, pair_estimate, lever_estimate])
def test_every_panel_is_drawn_inside_the_page(
    chromium: str, tmp_path: Path, width: int, scene: Callable[[], Estimate]
) -> None:
    path = write_report(scene(), tmp_path / "report.html")
    path.write_text(path.read_text("utf-8").replace("</body>", f"{PROBE}</body>"), "utf-8")
    frame = tmp_path / "frame.html"
    frame.write_text(FRAME.replace("WIDTH", str(width)))
    seen = _render(chromium, frame, tmp_path)
    assert seen.console == []
    told = re.search(r'data-sizes="([^"]+)"', seen.dom)
    assert told, "the page did not come to its end"
    *panels, page = told[1].split(";")
    assert len(panels) == 6
    for panel in panels:
        name, *numbers = panel.split()
        drawn, height, room, marks = (float(number) for number in numbers)
        assert 0.0 < drawn <= room + 1.0, f"{name} is {drawn} px wide in {room} px"
        assert height > 80.0, f"{name} is {height} px high"
        assert marks > 0, f"{name} shows nothing"
    _, content, window, zoomed = page.split()
    assert int(window) == width
    assert int(content) <= width, "the page scrolls sideways"
    assert zoomed == "1,2", "zooming into the time of one plot zooms into all"


def test_an_error_on_the_console_would_be_seen(chromium: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.html"
    path.write_text("<!DOCTYPE html><script>console.error('broken')</script>")
    assert any("broken" in line for line in _render(chromium, path, tmp_path).console)


def _render(chromium: str, path: Path, folder: Path) -> Seen:
    profile = f"--user-data-dir={folder / 'profile'}"
    run = subprocess.run(
        [chromium, *FLAGS, profile, "--window-size=1400,3000", "--dump-dom", path.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return Seen(run.stdout, [line for line in run.stderr.splitlines() if "CONSOLE" in line])
