"""Flacco et al. 2012, section 6.3: the arm of two VSA-IIs, each joint estimated alone."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import rotatum as rt
from rotatum.evaluation.papers.case import Outcome
from rotatum.evaluation.papers.flacco2012.arm import CASE, JOINTS, scenario
from rotatum.evaluation.papers.flacco2012.modality import SCORED_FROM
from tests.cli.runs import run

# MSREP of each of the four transmissions, %. Promised are 0.1; over ten seeds the worst is 0.0305,
# of the elbow's first: before its sawtooth jumps at 5 s little of its law is seen. Then: 0.0014.
PROMISED = 0.1
USUAL = 0.03


@pytest.fixture(scope="module")
def log() -> rt.Log:
    return scenario().run(0)


@pytest.fixture(scope="module")
def found(log: rt.Log) -> rt.Estimate:
    return rt.estimate(log, scenario().device, start=SCORED_FROM)


@pytest.fixture(scope="module")
def outcome() -> Outcome:
    told: list[tuple[int, int | None]] = []
    outcome = CASE.run(lambda *done: told.append(done), True)
    assert told[-1][0] == told[-1][1]
    return outcome


def test_all_four_transmissions_are_found(found: rt.Estimate) -> None:
    for name in JOINTS:
        joint = found.joints[name]
        assert joint.verdict == "informative"
        assert joint.truth is not None
        # 95 % nominal; neighbouring samples share their error, so that of one motion scatters.
        assert joint.truth["coverage_percent"] >= 85.0
        for part in joint.parts:
            assert part.truth is not None
            assert part.truth["msrep_percent"] <= USUAL


def test_a_joint_needs_nothing_of_the_other(log: rt.Log, found: rt.Estimate) -> None:
    for name in JOINTS:
        device = scenario().device.only([name])
        alone = rt.estimate(replace(log, joints={name: log.joints[name]}), device)
        # The same arithmetic on the same numbers: equal to the bit.
        for field in ("stiffness", "part_stiffness", "coefficients"):
            assert np.array_equal(
                alone.joints[name].records[field], found.joints[name].records[field]
            )


def test_through_the_program(tmp_path: Path, found: rt.Estimate) -> None:
    table, device = tmp_path / "x.csv", tmp_path / "x.toml"
    done = run("simulate", "flacco2012/section6.3", "-o", table)
    assert done.code == 0, done.err
    done = run("estimate", table, "--device", device, "--from", "2", "--json")
    assert done.code == 0, done.err
    joints = json.loads(done.out)["joints"]
    assert set(joints) == set(JOINTS)
    for name in JOINTS:
        parts = joints[name]["transmissions"]
        assert [part["verdict"] for part in parts] == ["informative"] * 2
        for part, own in zip(parts, found.joints[name].parts, strict=True):
            assert part["truth"]["msrep_percent"] <= PROMISED
            # The period read off the table is 1e-13 of itself shorter, which moves by a sample
            # when filters count as settled and orders are weighed anew.
            apart = 0.02 * own.stiffness_std
            assert part["stiffness"] == pytest.approx(own.stiffness, abs=apart)


@pytest.mark.slow
def test_the_case_by_the_papers_settings_and_by_weak(outcome: Outcome) -> None:
    for name, part in product(JOINTS, ("1", "2", "total")):
        for label in (f"{name} {part}, MSREP", f"{name} {part}, MSREP, worst of 3 seeds"):
            line = outcome.value(label)
            assert line.own is not None
            assert line.weak is not None
            # As on one joint the paper's prior, not the noise, sets the level: Table 1 prints
            # 0.02 to 0.07, and the same settings leave up to 0.096 here over ten seeds.
            assert 0.03 <= line.own <= PROMISED
            assert line.weak <= USUAL
    plots = [plot for figure in outcome.figures for plot in figure.plots]
    assert len(plots) == 4 + 2 * 2 * 3  # motion; joints, stiffness and error, parts
    for plot in plots:
        assert all(np.all(np.isfinite(curve.y)) for curve in plot.curves)


@pytest.mark.slow
def test_the_workspace_is_explored_in_the_horizontal_plane_only(outcome: Outcome) -> None:
    def way(plane: str, name: str) -> float:
        ends = [outcome.value(f"{plane}{name}, {end} angle").own for end in ("highest", "lowest")]
        assert ends[0] is not None
        assert ends[1] is not None
        return ends[0] - ends[1]

    assert way("", "shoulder") > 2.0 * np.pi
    assert way("", "elbow") > 6.0
    assert way("vertical plane: ", "shoulder") < 0.15
    load = outcome.value("gravity torque at the shoulder, arm stretched out").own
    assert load is not None
    # 0.345 kg at 0.5 m, and 0.1 kg at 0.25 m and at 0.75 m: 0.2725 kg m times 9.81 m/s^2
    assert load == pytest.approx(0.2725 * 9.81, rel=1e-12)
    # At rest under both motors' 0.1 N m the arm leans by 0.1 / 2.67 rad; the swing overshoots.
    assert way("vertical plane: ", "shoulder") > 2.0 * 0.1 / load


@pytest.mark.slow
def test_gravity_does_not_matter_to_the_motors_side(outcome: Outcome) -> None:
    for name in JOINTS:
        line = outcome.value(f"vertical plane: {name} total, MSREP")
        assert line.weak is not None
        assert line.weak <= USUAL
