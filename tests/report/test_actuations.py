"""What reports and tables say of two transmissions on a link, and of a lever arm."""

from __future__ import annotations

import io
import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from rich.console import Console

from rotatum import Estimate, Log, estimate, load_device
from rotatum.cli.tables import print_estimate
from rotatum.evaluation import TruthScore
from rotatum.models import Channel, Device, Setpoint, Transmission
from rotatum.report.cloud import deviation
from rotatum.report.coefficients_panel import coefficients_panel
from rotatum.report.excitation_panel import excitation_panel
from rotatum.report.page import page
from rotatum.report.panel import Row
from rotatum.report.part import Part, law, parts
from rotatum.report.results import answer, fitted_lines, lines
from rotatum.report.setpoints import moves, setpoint_axis, slices
from rotatum.report.stiffness_panel import stiffness_panel
from rotatum.report.surface_panel import surface_panel
from rotatum.report.view import View, view
from tests.report.scenes import (
    lever_estimate,
    lever_log,
    pair_estimate,
    pair_log,
    small_estimate,
)

PANELS = ("stiffness", "torque", "characteristic", "excitation", "coefficients", "events")


def pair() -> View:
    return view(pair_estimate(), "vsa-ii")


def lever() -> View:
    return view(lever_estimate(), "awas")


@pytest.mark.parametrize("scene", [pair_estimate, lever_estimate])
def test_every_panel_has_data(scene: Any) -> None:
    html = page(scene())
    for key in PANELS:
        found = re.search(rf'data-plot="joint0-{key}">(.*?)</script>', html, re.DOTALL)
        assert found, key
        figure = json.loads(found[1], parse_constant=pytest.fail)
        drawn = {trace.get("yaxis", "y").removeprefix("y") or "1" for trace in figure["data"]}
        rows = [name.removeprefix("yaxis") for name in figure["layout"] if "yaxis" in name]
        assert drawn == {row or "1" for row in rows}, key


@pytest.mark.parametrize(
    ("log", "name", "lost"),
    [(pair_log, "vsa-ii", ("q", "theta1", "theta2")), (lever_log, "awas", ("q", "theta"))],
)
def test_a_log_that_tells_nothing_has_a_report_too(
    log: Any, name: str, lost: tuple[str, ...]
) -> None:
    made: Log = log()
    still = {r: 0.0 * v if r in lost else v for r, v in made.joints[name].items()}
    told = page(estimate(replace(made, joints={name: still}), load_device(name)))
    assert "no answer" in told


def test_each_law_is_its_spring() -> None:
    for part in parts(pair()):
        phi = np.linspace(-0.2, 0.2, 9)
        # the scene tells each stiffness to about a per cent; the torque is its integral
        np.testing.assert_allclose(law(part, phi), part.spring.torque(phi), rtol=0.02, atol=1e-12)


def test_the_law_hangs_on_the_set_point() -> None:
    (part,) = parts(lever())
    phi = np.linspace(-2e-3, 2e-3, 5)
    for s in (0.08, 0.09, 0.1):
        # its stiffness is 2 k s^2 to 1e-5 here; the scene tells it to about a per cent
        np.testing.assert_allclose(
            law(part, phi, s), 2.0 * 14220.0 * s**2 * phi, rtol=0.02, atol=1e-12
        )


def test_total_and_transmissions_have_their_own_truth() -> None:
    total, _, each = stiffness_panel(pair()).rows
    assert _names(total) == ["95 % interval", "stiffness", "truth"]
    assert _names(each) == ["transmission 1", "transmission 2", "truth", "truth"]
    truths = [trace for trace in each.traces if trace.get("name") == "truth"]
    log = pair_log().joints["vsa-ii"]
    for number, trace in enumerate(truths, 1):
        true = log[f"stiffness{number}_true"]
        # thinning keeps the extremes; traces are single precision
        assert max(trace["y"]) == pytest.approx(true.max(), rel=1e-6)


def test_the_correlation_of_both_errors_is_shown() -> None:
    row = excitation_panel(pair()).rows[-1]
    assert row.title.startswith("correlation")
    values = row.traces[0]["y"]
    assert np.nanmin(values) >= -1.0
    assert np.nanmax(values) <= 1.0
    assert not any("correlation" in row.title for row in excitation_panel(lever()).rows)


def test_coefficients_of_both_transmissions_share_a_plot() -> None:
    rows = coefficients_panel(pair()).rows
    assert [row.title for row in rows] == [
        "offset, N m",
        "coefficient of phi, N m/rad",
        "coefficient of phi^3, N m/rad^3",
        "coefficient of phi^5, N m/rad^5",
        "coefficient of phi^7, N m/rad^7",
    ]
    for place, row in enumerate(rows):
        for part in parts(pair()):
            curve = next(t for t in row.traces if t["showlegend"] and t["name"] == part.name)
            column = 5 * part.place + place
            std = _vsa().records["coefficients_std"][:, column]
            values = _vsa().records["coefficients"][part.known & (std > 0.0), column]
            # thinning keeps the extremes; the deflection is scaled by 0.3 rad, traces are
            # single precision
            scale = 0.3 ** (2 * place - 1) if place else 1.0
            assert np.nanmax(curve["y"]) == pytest.approx(values.max() / scale, rel=1e-6)


def test_coefficients_name_powers_and_units_of_the_set_point() -> None:
    titles = [row.title for row in coefficients_panel(lever()).rows]
    assert titles[1:5] == [
        "coefficient of phi, N m/rad",
        "coefficient of phi s, N m/(rad m)",
        "coefficient of phi s^2, N m/(rad m^2)",
        "coefficient of phi^3, N m/rad^3",
    ]


def test_the_surface_is_the_spring_and_lies_under_the_data() -> None:
    surface, cuts = surface_panel(lever()).rows
    fitted, told, data = surface.traces
    assert fitted["type"] == told["type"] == "contour"
    expected = 2.0 * 14220.0 * (1e-3 * fitted["y"][:, None]) ** 2 * 1e-3 * fitted["x"]
    top = np.abs(expected).max()
    # a per cent of the largest torque; beyond the data the law is extrapolated
    np.testing.assert_allclose(fitted["z"], expected, atol=0.02 * top)
    np.testing.assert_allclose(told["z"], expected, atol=1e-3 * top)
    levels = fitted["contours"]
    assert 6 <= (levels["end"] - levels["start"]) / levels["size"] <= 20
    for axis in ("x", "y"):
        assert fitted[axis].min() < data[axis].min()
        assert fitted[axis].max() > data[axis].max()
    # the arm is swept from 100 mm to 80 mm; slices stand a little inside
    assert {"s = 80.8 mm", "s = 90 mm", "s = 99.2 mm"} <= set(_names(cuts))


def test_a_slice_has_the_data_near_it() -> None:
    shown = lever()
    setpoint = shown.setpoint
    assert setpoint is not None
    for cut in slices(shown, setpoint):
        assert cut.near.any()
        assert np.abs(setpoint[cut.near] - cut.setpoint).max() <= 1e-3


def test_the_set_point_is_shown_in_the_unit_of_its_law() -> None:
    row = next(r for r in excitation_panel(lever()).rows if r.title == "set-point s, mm")
    # the arm at 1024 counts a turn of its motor moves in steps of 2.5/1024 mm
    assert max(row.traces[0]["y"]) == pytest.approx(100.0, abs=0.003)
    assert min(row.traces[0]["y"]) == pytest.approx(80.0, abs=0.003)


def test_a_set_point_without_a_law_is_in_the_unit_it_is_logged_in() -> None:
    shown = lever()
    plain = {"transmissions": (Transmission(),), "setpoint": Setpoint(law="direct")}
    logged = shown.joint.model_copy(update=plain)
    assert setpoint_axis(replace(shown, joint=logged)).unit == "rad"
    channels = {"setpoint": Channel(name="arm", unit="mm")}
    length = logged.model_copy(update={"channels": channels})
    assert setpoint_axis(replace(shown, joint=length)).unit == "mm"
    assert setpoint_axis(shown) == ("set-point s, mm", "mm", 1e3)


def test_a_set_point_that_stands_still_has_one_characteristic() -> None:
    shown = lever()
    assert moves(shown)
    logged = {**shown.estimate.logged, "setpoint": np.full(len(shown.estimate.records), 10.0)}
    assert not moves(replace(shown, estimate=replace(shown.estimate, logged=logged)))
    assert not moves(pair())


def test_a_torque_grows_by_the_deviation_of_the_stiffness() -> None:
    phi = np.linspace(-0.2, 0.2, 1001)
    shown = SimpleNamespace(
        estimate=SimpleNamespace(powers=[(1, 0), (3, 0)]), settled=np.ones(1001, bool)
    )
    part = SimpleNamespace(shown=shown, paired=True, field=lambda name: 3.0 + 0.0 * phi)
    grid = np.linspace(-0.2, 0.2, 41)
    # int_0^phi 3 dx = 3 |phi|, exact for the trapezoid rule
    np.testing.assert_allclose(deviation(cast(Part, part), phi, grid), 3.0 * np.abs(grid))


def test_transmissions_stand_under_their_joint() -> None:
    told = lines(pair_estimate())
    assert [line.name for line in told] == ["vsa-ii", "  transmission 1", "  transmission 2"]
    records = pair_estimate().joints["vsa-ii"].records
    scored = records["converged"] != 0
    for i, line in enumerate(told[1:]):
        score = TruthScore()
        true = pair_log().joints["vsa-ii"][f"stiffness{i + 1}_true"][scored]
        score.update(records["part_stiffness"][scored, i], math.nan, true)
        # three digits are written
        assert float(line.msrep) == pytest.approx(score.result()["msrep_percent"], rel=5e-3)
    assert [row[0] for row in fitted_lines(pair_estimate(), _vsa())] == [
        "vsa-ii, transmission 1",
        "vsa-ii, transmission 2",
    ]


def test_gravity_is_offered_where_it_makes_a_difference() -> None:
    found, q = _vsa(), pair_log().joints["vsa-ii"]["q"][-1]
    outside = found.stiffness["final"] + 0.245 * math.cos(q)  # flacco2012 eq. 6
    assert float(lines(pair_estimate())[0].external.split()[0]) == pytest.approx(outside, rel=1e-3)
    assert "gravity included, it is " in answer(pair_estimate(), found)
    for level in (lever_estimate(), small_estimate()):
        (joint,) = level.joints.values()
        assert lines(level)[0].external == ""
        assert "gravity" not in answer(level, joint)


def test_gravity_is_not_added_to_a_current() -> None:
    found, device = pair_estimate(), load_device("vsa-ii")
    channels = {"torque_measured": Channel(name="current", unit="A")}
    joint = device.joints[0].model_copy(update={"channels": channels})
    current: Device = replace(device, joints=(joint,))
    told = lines(replace(found, device=current, torque="sensor"))
    assert told[0].stiffness.endswith("A/rad")
    assert told[0].external == ""


@pytest.mark.parametrize("width", [80, 120])
def test_the_terminal_tells_transmissions_gravity_and_settings(width: int) -> None:
    told = _printed(pair_estimate(), width)
    assert re.search(r"^ +vsa-ii +0\.\d+ .*\n(?:.*\n)*? +transmission 1 +0\.2", told, re.MULTILINE)
    for word in ("with", "gravi", "vsa-ii, transmission 2", "shrinkage of high orders"):
        assert word in told.replace("high\norders", "high orders")
    assert max(len(line) for line in told.splitlines()) <= width
    assert "gravity" not in _printed(lever_estimate(), width)


def test_joints_with_the_same_settings_share_a_line() -> None:
    found = small_estimate()
    elbow = found.joints["elbow"]
    wrist = replace(elbow, name="wrist")
    joint = found.device.joints[0]
    both = replace(
        found,
        joints={"elbow": elbow, "wrist": wrist},
        device=replace(found.device, joints=(joint, joint.model_copy(update={"name": "wrist"}))),
    )
    assert "elbow, wrist: cutoff 300 rad/s" in _printed(both, 120)


def _printed(found: Estimate, width: int) -> str:
    text = io.StringIO()
    print_estimate(Console(file=text, width=width, highlight=False), found)
    return text.getvalue()


def _vsa() -> Any:
    return pair_estimate().joints["vsa-ii"]


def _names(row: Row) -> list[str]:
    return [trace["name"] for trace in row.traces if trace.get("showlegend", True)]
