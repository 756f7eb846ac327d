"""The simulator as a multiple of real time, and what a sweep adds to the work of a case."""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from benchmarks.table import Figure
from benchmarks.timing import Runner, Task, interleaved, say
from rotatum.evaluation.sweep import parse_vary, plan_of, sweep
from rotatum.models import Device, Joint, load_device
from rotatum.simulation import Ramps, hold, multisine, simulate_joint
from rotatum.simulation.device import simulate
from rotatum.simulation.drivers.commands import position_drives
from rotatum.simulation.drivers.drives import JointDrives
from rotatum.simulation.scenario import load_scenario

PERIOD = 1e-3
JOINT_SECONDS, SUBSTEPS = 20.0, 10
ARM_SECONDS = 2.0
BANDWIDTH = 100.0  # rad/s, of the position controllers
TURN = 0.5  # rad, to and fro in the arm's time
CASES = 20  # of the sweep


class Motion(NamedTuple):
    """What is simulated.

    Args:
        what: in the table.
        seconds: simulated.
        run: simulates them.
        target: multiple of real time; None: none.
    """

    what: str
    seconds: float
    run: Task
    target: float | None = None


def figures(directory: Path, repetitions: int) -> list[Figure]:
    """Measure single joint, arms and sweep, each at its best of several runs.

    Args:
        directory: for the sweep's table.
        repetitions: turns.
    """
    say("timing the simulator ...")
    motions = (_joint(), *_arms())
    for motion in motions:
        motion.run()  # compiles what is not yet
    seconds = interleaved({m.what: Runner(_nothing, m.run) for m in motions}, repetitions)
    return [*(_figure(m, seconds[m.what]) for m in motions), _sweep(directory, repetitions)]


def _nothing() -> None:
    """Have nothing to prepare."""


def _figure(motion: Motion, seconds: list[float]) -> Figure:
    """A multiple of real time has nothing to be compared with in the same turn: the best counts."""
    best = motion.seconds / min(seconds)
    note = f"best of {len(seconds)}, median {motion.seconds / median(seconds):.3g}"
    what = f"{motion.what}, times real time"
    return Figure(what, best, "x", motion.target, at_least=True, note=note)


def _joint() -> Motion:
    (joint,) = load_device("series-demo").joints
    drive = multisine(rms=2.0, low=0.5, high=10.0, count=20, seed=1)

    def run() -> None:
        simulate_joint(
            joint,
            seconds=JOINT_SECONDS,
            period=PERIOD,
            drives={"tau": drive},
            substeps=SUBSTEPS,
        )

    return Motion(f"single joint at 1 kHz, {SUBSTEPS} sub-steps", JOINT_SECONDS, run, 200.0)


def _arms() -> tuple[Motion, ...]:
    seven, three = load_device("seven-axis"), load_device("manutec-r3")
    two = load_scenario("flacco2012/section6.3").with_values({"seconds": ARM_SECONDS})

    def pair() -> None:
        two.run()

    moved = {joint.name: _moved(joint, k) for k, joint in enumerate(seven.joints)}
    return (
        Motion("7-axis arm, position control", ARM_SECONDS, lambda: _arm(seven, moved), 3.0),
        Motion("7-axis arm, free", ARM_SECONDS, lambda: _arm(seven, _quiet(seven)), 3.0),
        Motion("manutec-r3, free", ARM_SECONDS, lambda: _arm(three, _quiet(three))),
        Motion("2R arm of two VSA-IIs", ARM_SECONDS, pair),
    )


def _moved(joint: Joint, k: int) -> JointDrives:
    """Position control to and fro, every other joint the other way."""
    turn = TURN if k % 2 == 0 else -TURN
    path = Ramps((0.0, 0.5 * ARM_SECONDS, ARM_SECONDS), (0.0, turn, 0.0))
    return position_drives(joint, path, bandwidth=BANDWIDTH, index=k)


def _quiet(device: Device) -> dict[str, JointDrives]:
    return {joint.name: {"tau": hold(0.0)} for joint in device.joints}


def _arm(device: Device, drives: dict[str, JointDrives]) -> None:
    simulate(device, seconds=ARM_SECONDS, period=PERIOD, drives=drives)


def _sweep(directory: Path, repetitions: int) -> Figure:
    """What a case takes in one process beside simulating and estimating; planning included."""
    scenario = load_scenario("trouble/clean").with_values({"seconds": 1.0, "estimate.start": 0.5})
    varied = [parse_vary("sensors.encoders.link=4096,65536")]
    beside, inside = [], []
    for turn in range(repetitions + 1):
        begin = time.perf_counter()
        plan = plan_of(scenario.tables, scenario.source, varied, seeds=CASES // 2)
        found = sweep(plan, directory / "sweep.csv", workers=1)
        spent = time.perf_counter() - begin
        work = float(np.sum([r["simulate_seconds"] + r["estimate_seconds"] for r in found]))
        if turn > 0:  # the first warms caches
            beside.append(1e3 * (spent - work) / len(found))
            inside.append(1e3 * work / len(found))
    note = (
        f"best of {repetitions}, median {median(beside):.3g} ms; work {min(inside):.3g} ms of 1 s"
    )
    return Figure("a sweep's case beside its work", min(beside), "ms", note=note)
