"""The page: complete, self-contained, safe, there whole or not at all."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotatum import Estimate, RotatumError, estimate, plot, write_report
from rotatum.kernels.status import STARVED
from rotatum.report.page import page
from rotatum.report.part import law, parts
from rotatum.report.view import view
from tests.report.scenes import STIFFNESS, small_device, small_estimate, small_log

PANELS = ("stiffness", "torque", "characteristic", "excitation", "coefficients", "events")


@pytest.fixture(scope="module")
def html() -> str:
    return page(small_estimate())


def test_every_panel_is_there_with_data(html: str) -> None:
    for key in PANELS:
        data = _plot(html, f"joint0-{key}")
        assert data["data"], key
        assert any(len(trace["x"]) for trace in data["data"]), key


def test_the_answer_comes_first(html: str) -> None:
    answer = re.search(r"elbow: the stiffness is [\d.]+ ± [\d.]+ N m/rad", html)
    assert answer
    assert answer.start() < html.index("<main>")


def test_settings_warnings_and_papers_are_told() -> None:
    warned = replace(small_estimate(), warnings=("the clock <stutters>",))
    html = page(warned)
    assert "default: 300 rad/s" in html or "(device file)" in html
    assert "the clock &lt;stutters&gt;" in html
    assert "Modeling &amp; Simulation" in html  # messenger2021, which weak cites
    assert "How to read the verdict" in html


def test_nothing_is_fetched(html: str) -> None:
    assert not re.findall(r"<(?:script|img|iframe)[^>]*\ssrc=", html)
    assert re.findall(r"<link[^>]*>", html) == ['<link rel="icon" href="data:,">']
    assert "@import" not in html
    assert html.count("plotly.js v") == 1


def test_names_are_not_markup() -> None:
    bad = '<script>alert("x")</script>'
    found = small_estimate()
    device = small_device()
    joint = device.joints[0].model_copy(update={"name": bad})
    result = replace(found.joints["elbow"], name=bad)
    html = page(
        replace(
            found,
            source=bad,
            device=replace(device, name=bad, source=bad, joints=(joint,)),
            joints={bad: result},
        )
    )
    assert bad not in html
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert" in html


def test_curves_are_thinned_and_keep_their_extremes(html: str) -> None:
    traces = _plot(html, "joint0-torque")["data"]
    assert all(_length(trace["x"]) <= 4000 for trace in traces)


def test_the_law_is_the_spring() -> None:
    (part,) = parts(view(small_estimate(), "elbow"))
    phi = np.linspace(-0.05, 0.05, 5)
    # the log tells the stiffness to far better than a per cent
    np.testing.assert_allclose(law(part, phi), STIFFNESS * phi, rtol=0.01, atol=1e-9)


def test_a_log_that_tells_nothing_has_a_report_too(tmp_path: Path) -> None:
    log = small_log()
    still = {role: np.zeros(log.samples) for role in ("q", "theta", "tau")}
    found = estimate(replace(log, joints={"elbow": still}), small_device())
    assert int(found.joints["elbow"].records["verdict"][-1]) == STARVED
    text = write_report(found, tmp_path / "report.html").read_text("utf-8")
    assert "does not tell the stiffness" in text
    assert "NaN" not in re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL)


def test_a_report_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    full = tmp_path / "report.html"
    full.symlink_to("/dev/full")
    with pytest.raises(RotatumError, match="cannot be written"):
        write_report(small_estimate(), full)
    with pytest.raises(RotatumError, match="does not exist"):
        write_report(small_estimate(), tmp_path / "nowhere" / "report.html")
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_plot_is_a_figure_of_the_joint() -> None:
    found = small_estimate()
    figure = plot(found)
    assert figure.layout.title.text == "elbow: informative"
    names = {trace.name for trace in figure.data}
    assert {"stiffness", "95 % interval", "truth", "row y", "fitted law", "data"} <= names
    times = [axis for axis in figure.select_xaxes() if axis.matches == "x"]
    assert len(times) == 4  # verdict, interval, torque and what is left over zoom with stiffness
    assert len(found.plot().data) == len(figure.data)


def test_plot_suggests_the_joint_that_was_meant() -> None:
    with pytest.raises(RotatumError, match='Did you mean "elbow"'):
        plot(small_estimate(), "elbwo")


def test_several_joints_have_a_section_each() -> None:
    found: Estimate = small_estimate()
    device = small_device()
    other = device.joints[0].model_copy(update={"name": "wrist"})
    html = page(
        replace(
            found,
            device=replace(device, joints=(*device.joints, other)),
            joints={**found.joints, "wrist": replace(found.joints["elbow"], name="wrist")},
        )
    )
    assert '<a href="#joint1">wrist</a>' in html
    assert _plot(html, "joint1-stiffness")["data"]


def _plot(html: str, identity: str) -> dict[str, list[dict[str, object]]]:
    """Return the figure embedded for a place that exists."""
    assert f'id="{identity}"' in html
    found = re.search(rf'data-plot="{identity}">(.*?)</script>', html, re.DOTALL)
    assert found, identity
    figure: dict[str, list[dict[str, object]]] = json.loads(found[1])
    return figure


def _length(values: object) -> int:
    """Length of an array as plotly writes it: a list, or bytes in base64 with their type."""
    if isinstance(values, dict):
        return len(values["bdata"]) * 3 // 4 // int(values["dtype"][-1])
    assert isinstance(values, list)
    return len(values)
