"""The page of an observation: complete, self-contained, drawn."""

from __future__ import annotations

import io
import json
import re
import subprocess
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from rotatum import observe
from rotatum.cli.observation_table import print_observation
from rotatum.evaluation import Observation
from rotatum.report import write_observation
from rotatum.report.observation_lines import (
    observation_rows,
    observation_sentences,
    observation_settings,
    titles,
)
from rotatum.report.observation_page import observation_page
from tests.evaluation.observed_arms import own_accelerations
from tests.report.test_rendering import FLAGS


@lru_cache(maxsize=1)
def found() -> Observation:
    log, device = own_accelerations()
    lever = {**log.joints["lever"], "q": log.joints["lever"]["q_true"] + 1e-4}
    lever = {role: x for role, x in lever.items() if not role.endswith("_true")}
    known = {"straight": log.joints["straight"], "lever": lever}
    third = {r: x for r, x in log.joints["hardening"].items() if not r.endswith("_true")}
    joints = {**known, "hardening": third}
    return replace(observe(replace(log, joints=joints), device), warnings=("it <stutters>",))


@lru_cache(maxsize=1)
def html() -> str:
    return observation_page(found())


def plotted(identity: str) -> list[dict[str, Any]]:
    text = re.search(rf'data-plot="{identity}">(.*?)</script>', html(), re.S)
    assert text
    data: list[dict[str, Any]] = json.loads(text[1])["data"]
    return data


def test_the_table_has_errors_in_mrad_where_something_is_known() -> None:
    head = titles(found())
    straight, lever, hardening = observation_rows(found())
    assert len(head) == len(straight) == len(lever) == len(hardening) == 9
    score = found().joints["straight"].score
    assert score is not None
    assert straight[5] == f"{1e3 * score.q_rms:.3g}"
    assert float(straight[7]) == pytest.approx(1e3 * score.rigid_rms, rel=5e-3)  # three digits
    # the encoder was 0.1 mrad off on purpose
    assert float(lever[5]) == pytest.approx(0.1, rel=0.1)
    assert lever[8] == "-", "no encoder tells a velocity"
    assert hardening[5:] == ("-",) * 4
    blind = replace(found(), joints={"hardening": found().joints["hardening"]})
    assert len(titles(blind)) == len(observation_rows(blind)[0]) == 5


def test_sentences_say_what_errors_are_against_and_what_is_not_told() -> None:
    told = observation_sentences(found())
    assert len(told) == 2
    assert told[0].startswith("straight: rms and largest error")
    assert "against the truth" in told[0]
    assert told[1].startswith("lever: rms and largest error")
    assert "its link encoder" in told[1]
    joint = found().joints["straight"]
    joints = {"a": replace(joint, name="a", determined=False, told=0.0, score=None),
              "b": replace(joint, name="b", determined=False, told=0.0, score=None),
              "c": replace(joint, name="c", told=0.975, score=None)}  # fmt: skip
    blind = replace(found(), joints=joints)
    assert observation_sentences(blind)[0].startswith("a, b are not determined by the sensors")
    assert [row[1] for row in observation_rows(blind)] == ["no", "no", "97.5 %"]


def test_joints_with_the_same_poles_are_told_at_once() -> None:
    first, second = observation_settings(found())
    assert first == "straight, lever, hardening: two pairs of poles at 250 rad/s, damping 0.8"
    assert "accelerations from straight.acc, lever.acc, hardening.acc" in second
    joint = found().joints["lever"]
    (one, two), gyro = joint.design.pairs, 80.0
    design = joint.design._replace(pairs=(one, two._replace(frequency=90.0)), gyro=gyro)
    joints = {**found().joints, "lever": replace(joint, design=design)}
    told = observation_settings(replace(found(), joints=joints))
    assert told[1] == (
        "lever: poles at 250 rad/s, damping 0.8 and at 90 rad/s, damping 0.8; gyroscopes with "
        "80 1/s"
    )


def test_the_terminal_has_the_table_and_the_sentences() -> None:
    out = io.StringIO()
    print_observation(Console(file=out, width=120, markup=False), found())
    text = out.getvalue()
    for words in (*titles(found()), "three: full state; 1,000 samples", "250 rad/s", "us a sample"):
        assert words in text, words


def test_the_page_has_all_of_it_and_fetches_nothing() -> None:
    for words in ("Full state of three", "straight", "lever", "hardening", "deluca2007",
                  "An acceleration-based state observer", "settling"):  # fmt: skip
        assert words in html(), words
    assert "it &lt;stutters&gt;" in html()
    assert not re.findall(r"<(?:script|img|iframe)[^>]*\ssrc=", html())
    assert html().count("plotly.js v") == 1


@pytest.mark.parametrize(
    ("place", "panel", "names"),
    [
        (0, "deflection", ["observed", "truth"]),
        (0, "velocity", ["observed", "truth"]),
        (0, "errors", ["of a rigid joint", "of the observer", "of the observer"]),
        (1, "deflection", ["link encoder", "observed"]),
        (1, "velocity", ["observed"]),
        (2, "deflection", ["observed"]),
    ],
)
def test_every_panel_draws_what_is_known(place: int, panel: str, names: list[str]) -> None:
    assert [trace["name"] for trace in plotted(f"joint{place}-{panel}")] == names


def test_a_joint_with_nothing_known_has_no_errors() -> None:
    assert 'id="joint1-errors"' in html()
    assert 'id="joint2-errors"' not in html()


def test_deflections_are_in_mrad_and_q_less_theta() -> None:
    """A cosine of 15 mrad goes from 0 to 30 mrad."""
    truth = next(t for t in plotted("joint0-deflection") if t["name"] == "truth")
    y = np.asarray(_decoded(truth))
    # drawn in single precision
    assert (y.min(), y.max()) == pytest.approx((0.0, 30.0), abs=0.05)


def _decoded(trace: dict[str, Any]) -> np.ndarray:
    import base64

    y = trace["y"]
    return y if isinstance(y, list) else np.frombuffer(base64.b64decode(y["bdata"]), y["dtype"])


@pytest.mark.slow
def test_the_page_is_drawn_by_a_browser(chromium: str, tmp_path: Path) -> None:
    path = write_observation(found(), tmp_path / "state.html")
    done = subprocess.run(
        [chromium, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}",
         "--dump-dom", path.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert not [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert 'data-ready="11"' in done.stdout
