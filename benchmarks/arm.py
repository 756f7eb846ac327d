"""The link side of a whole arm, one sample from the encoders to the stiffness of every joint.

Against one inverse dynamics of the same arm by pinocchio, which is what trumic2022's Remark 5
counts in; and over the number of joints, which it says the cost is linear in.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.table import Figure
from benchmarks.timing import Runner, interleaved, ratio, say
from rotatum.estimators import Estimator
from rotatum.models import Device, load_device
from rotatum.models.device import device_from_tables

PERIOD = 1e-3
SAMPLES = 200
JOINTS = (2, 4, 8, 15, 30)
METHODS: dict[str, dict[str, Any]] = {
    "rotatum, deadbeat": {"method": "rotatum", "cutoff": math.inf},
    "rotatum, 100 rad/s": {"method": "rotatum", "cutoff": 100.0},
    "weak": {"method": "weak", "side": "link", "cutoff": 100.0, "fit": ("offset",)},
}
LINK = """
<link name="l{i}"><inertial><origin xyz="0 0.02 0.15"/><mass value="1.5"/>
<inertia ixx="0.01" iyy="0.01" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """
<joint name="j{i}" type="revolute"><parent link="l{before}"/><child link="l{i}"/>
<origin xyz="0 0 0.3" rpy="{roll} 0 0"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="100" velocity="5"/></joint>"""


class Loop:
    """An arm moving on sines, joint by joint of another frequency.

    Args:
        device: with a robot.
        options: of the estimator.
    """

    def __init__(self, device: Device, options: dict[str, Any]) -> None:
        n = len(device.joints)
        t = np.arange(2 * SAMPLES)[:, None] * PERIOD
        rates = np.linspace(1.0, 6.0, n)
        self.q: NDArray[np.float64] = 0.3 * np.sin(rates * t + np.arange(n))
        self.theta = self.q - 0.005 * np.sin(rates * t)
        self.loop = Estimator(device, period=PERIOD, **options)
        robot = device.build_robot()
        assert robot is not None
        self.robot = robot

    def ready(self) -> None:
        """Fill the filters."""
        self.loop.reset()
        for k in range(SAMPLES):
            self.loop.update(q=self.q[k], theta=self.theta[k])

    def run(self) -> None:
        """Take as many samples again."""
        for k in range(SAMPLES, 2 * SAMPLES):
            self.loop.update(q=self.q[k], theta=self.theta[k])

    def dynamics(self) -> None:
        """As many inverse dynamics."""
        for k in range(SAMPLES, 2 * SAMPLES):
            self.robot.inverse_dynamics(self.q[k], self.theta[k], self.q[k])


def figures(directory: Path, repetitions: int) -> list[Figure]:
    """Measure the seven-axis arm, and chains of 2 to 30 joints.

    Args:
        directory: for the chains' URDF files.
        repetitions: turns.
    """
    return _seven(repetitions) + _chains(directory, repetitions)


def _seven(repetitions: int) -> list[Figure]:
    device = load_device("seven-axis")
    say("seven-axis arm: compiling ...")
    loops = {name: Loop(device, options) for name, options in METHODS.items()}
    runners = {name: Runner(loop.ready, loop.run) for name, loop in loops.items()}
    runners["dynamics"] = Runner(lambda: None, next(iter(loops.values())).dynamics)
    say("seven-axis arm: timing ...")
    seconds = interleaved(runners, repetitions)
    best = {name: 1e6 * min(times) / SAMPLES for name, times in seconds.items()}
    found = []
    for name in loops:
        quiet = best[name] / best["dynamics"]
        note = f"at their best {best[name]:.1f} / {best['dynamics']:.2f} us = {quiet:.1f} x"
        what = f"seven-axis, {name}: one sample / one inverse dynamics"
        found.append(Figure(what, ratio(seconds, name, "dynamics"), "x", 15.0, note=note))
    return found


def _chains(directory: Path, repetitions: int) -> list[Figure]:
    found = []
    for name in ("rotatum, deadbeat", "weak"):
        say(f"chains of {JOINTS} joints, {name}: compiling ...")
        loops = {n: Loop(chain(directory, n), METHODS[name]) for n in JOINTS}
        say(f"chains, {name}: timing ...")
        runners = {str(n): Runner(loop.ready, loop.run) for n, loop in loops.items()}
        seconds = interleaved(runners, repetitions)
        times = [float(np.median(seconds[str(n)])) / SAMPLES for n in JOINTS]
        exponent = float(np.polyfit(np.log(JOINTS), np.log(times), 1)[0])
        told = ", ".join(f"{n}: {1e6 * t:.0f}" for n, t in zip(JOINTS, times, strict=True))
        what = f"chains, {name}: exponent of the time over the number of joints"
        found.append(Figure(what, exponent, "", 1.1, note=f"us a sample: {told}"))
    return found


def chain(directory: Path, n: int) -> Device:
    """Return an arm of n links, every axis turned against the one before.

    Args:
        directory: for its URDF file.
        n: joints.
    """
    path = directory / f"chain{n}.urdf"
    links = "".join(LINK.format(i=i) for i in range(n + 1))
    turned = [0.5 * math.pi * (-1) ** i for i in range(n + 1)]
    joints = "".join(JOINT.format(i=i, before=i - 1, roll=turned[i]) for i in range(1, n + 1))
    path.write_text(f'<robot name="chain">{links}{joints}</robot>')
    each = {
        "transmission": {"law": "linear", "stiffness": 1e4},
        "basis": {"deflection_range": 0.01, "orders": 1},
    }
    tables: dict[str, Any] = {
        "name": "chain",
        "robot": {"urdf": str(path)},
        "joint": [{"name": f"j{i}", **each} for i in range(1, n + 1)],
    }
    return device_from_tables(tables, str(path))
