"""The page of a comparison: complete, self-contained, drawn."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rotatum import Comparison, RotatumError
from rotatum.evaluation import ComparedMethod
from rotatum.evaluation.agreement import Curve
from rotatum.evaluation.candidates import CANDIDATES
from rotatum.evaluation.comparison import LeftOut
from rotatum.evaluation.recommend import recommend
from rotatum.report import plot_comparison, write_comparison
from rotatum.report.comparison_lines import (
    comparison_cells,
    comparison_notes,
    left_out_lines,
    outcome,
)
from rotatum.report.comparison_page import comparison_page
from rotatum.report.palette import METHODS
from tests.report.scenes import STIFFNESS, small_device, small_log
from tests.report.test_rendering import FLAGS

TIME = 0.01 * np.arange(400)


def method(place: int, truth: bool, verdict: str = "informative") -> ComparedMethod:
    """A made-up result, each method a tenth of a per cent above the one before."""
    candidate = CANDIDATES[place]
    stiffness = np.where(TIME < 0.5, np.nan, STIFFNESS * (1.0 + 1e-3 * place))
    known = np.full(len(TIME), STIFFNESS) if truth else None
    score = {"mse": 0.04, "msrep_percent": 1e-4, "coverage_percent": 93.0}
    return ComparedMethod(
        joint="elbow",
        name=candidate.name,
        method=candidate.method,
        side=candidate.side,
        torque=candidate.torque,
        windowed=candidate.windowed,
        width="300 rad/s, 2 poles",
        stiffness=float(stiffness[-1]),
        stiffness_std=0.5,
        verdict=verdict,
        reason=f"{verdict}: because <of> things",
        converged_at=1.5,
        delay=0.0077,
        ns_per_sample=500.0,
        fitted={},
        truth=score if truth else None,
        disagreement={"rms_percent": 0.123, "within_percent": 88.0} if place else None,
        curve=Curve(TIME, stiffness, np.full(len(TIME), 0.5), known, 1),
    )


def comparison(truth: bool = True) -> Comparison:
    log, device = small_log(), small_device()
    return Comparison(
        source="run.csv",
        device=device,
        period=1e-3,
        samples=4000,
        seconds=4.0,
        methods=tuple(method(k, truth) for k in (0, 1, 5)),
        left_out=(LeftOut("elbow", "residual", "motor", "the log has no tau"),),
        references={"elbow": CANDIDATES[0].label},
        score_from={"elbow": 1.5},
        recommendation=recommend(log, device),
        warnings=("the clock <stutters>",),
    )


def plotted(html: str) -> dict[str, Any]:
    found = re.search(r'data-plot="joint0-stiffness">(.*?)</script>', html, re.S)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


def test_with_a_truth_the_table_has_its_scores() -> None:
    head, rows = comparison_cells(comparison())
    assert head == [
        "method", "side", "stiffness, N m/rad", "verdict", "MSREP %", "truth inside %",
        "converged s", "late ms", "ns a sample",
    ]  # fmt: skip
    assert rows[0] == [
        "weak", "motor", "200.00 +- 0.98", "informative", "0.0001", "93", "1.50", "7.7", "500"
    ]  # fmt: skip
    assert comparison_notes(comparison()) == [
        "elbow: scored from 1.5 s on, against the log's truth"
    ]


def test_without_one_it_has_the_difference_from_the_reference() -> None:
    head, rows = comparison_cells(comparison(truth=False))
    assert head[4:6] == ["differs by %", "within both %"]
    assert rows[0][4:6] == ["reference", ""]
    assert rows[1][4:6] == ["0.123", "88"]
    assert comparison_notes(comparison(truth=False)) == [
        "elbow: scored from 1.5 s on, against weak, motor side"
    ]


def test_what_is_left_out_is_told_once_for_joints_that_lack_the_same() -> None:
    assert left_out_lines(comparison()) == ["residual, motor side: the log has no tau."]
    two = replace(
        comparison(),
        left_out=(
            LeftOut("elbow", "residual", "motor", "the log has no tau"),
            LeftOut("wrist", "residual", "motor", "the log has no tau"),
        ),
        references={"elbow": "a", "wrist": "b"},
    )
    assert left_out_lines(two) == ["residual, motor side (elbow, wrist): the log has no tau."]


def test_the_recommended_method_is_held_against_what_it_did() -> None:
    found = comparison()
    advice = replace(found.recommendation.joints["elbow"], torque="estimated")
    assert outcome(found, advice) == "It ended informative here: weak, motor side."
    bad = replace(found, methods=(method(0, True, "starved"), *found.methods[1:]))
    said = outcome(bad, advice)
    assert said.startswith("It ended starved here (weak, motor side), informative: weak, window")
    assert outcome(found, replace(advice, torque="sensor")) == "", "it did not run"


def test_the_page_has_all_of_it_and_fetches_nothing() -> None:
    html = comparison_page(comparison())
    words = ("Methods compared", "Left out", "Recommended", "Verdicts, and why", "300 rad/s")
    for word in words:
        assert word in html, word
    assert "the clock &lt;stutters&gt;" in html
    assert "because &lt;of&gt; things" in html
    assert not re.findall(r"<(?:script|img|iframe)[^>]*\ssrc=", html)
    assert html.count("plotly.js v") == 1


def test_every_curve_is_drawn_with_its_band_and_the_truth_dashed() -> None:
    traces = plotted(comparison_page(comparison()))["data"]
    curves = {t["name"]: t for t in traces if t.get("name") and t["yaxis"] == "y"}
    bands = [t for t in traces if t.get("fill") == "tonexty"]
    assert len(bands) == 3
    assert curves["truth"]["line"]["dash"] == "dash"
    assert curves["weak, link side"]["line"]["dash"] == "dot"
    off = {t["name"]: t for t in traces if t["yaxis"] == "y2"}
    assert set(off) == {m.label for m in comparison().methods}


def test_the_difference_is_that_from_the_truth_or_the_reference() -> None:
    """Method 5 is 0.5 % above the truth, and above method 0, which is the truth."""
    for truth in (True, False):
        figure = plot_comparison(comparison(truth))
        lower = {t.name: np.asarray(t.y) for t in figure.data if t.yaxis == "y2"}
        known = lower["weak, link side"][np.isfinite(lower["weak, link side"])]
        # drawn in single precision
        assert known == pytest.approx(np.full(len(known), 0.5), rel=1e-6)
        assert ("weak, motor side" in lower) is truth


def test_every_method_has_a_colour_of_its_own() -> None:
    assert set(METHODS) == {candidate.label for candidate in CANDIDATES}
    assert len(set(METHODS.values())) == len(METHODS)


def test_an_unknown_joint_is_refused() -> None:
    with pytest.raises(RotatumError, match="elbow"):
        plot_comparison(comparison(), "elbwo")


def test_the_page_is_drawn_by_a_browser(chromium: str, tmp_path: Path) -> None:
    import subprocess

    path = write_comparison(comparison(), tmp_path / "methods.html")
    done = subprocess.run(
        [chromium, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", path.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert not [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert 'data-ready="1"' in done.stdout
