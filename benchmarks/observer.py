"""The observer of one joint behind its guard: ``Bank.run`` and exported C against C by hand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import native
from benchmarks.batch import Disagreement
from benchmarks.native import NATIVE_FLAGS, SAME_FLAGS, Native, hand_code
from benchmarks.table import Figure
from benchmarks.timing import Runner, interleaved, ratio, say
from rotatum.estimators.full_state.stage import design_of, luenberger_params, luenberger_stage
from rotatum.models import load_device
from rotatum.record import Records
from rotatum.runtime import Bank

PERIOD, SAMPLES = 1e-3, 20_000
SLICE = slice(10_000, 12_500)  # short runs, so that interruptions hit few of them
LOST = slice(3000, 3004)  # bridged, so that the agreement is about more than good samples
TOLERANCE = 1e-9  # relative: sums in another order, through poles that forget in 50 samples


def figures(directory: Path, repetitions: int) -> list[Figure]:
    """Measure ratios, medians over turns; raise ``Disagreement`` first if results differ.

    Args:
        directory: for the C.
        repetitions: turns.
    """
    say("observer: compiling the bank and the C versions ...")
    stage = luenberger_stage()
    (joint, *_) = load_device("manutec-r3").joints
    params = luenberger_params(stage, [joint], [design_of(joint, PERIOD, held=True)])
    u = _motion(stage.input.zeros(SAMPLES, 1))
    bank = Bank(stage, params)
    expected = bank.run(u)
    exported = native.exported_code(stage, directory)
    versions = {
        "hand native": Native(hand_code("luenberger"), NATIVE_FLAGS, directory, _words(params[0])),
        "hand same": Native(hand_code("luenberger"), SAME_FLAGS, directory, _words(params[0])),
        "exported same": Native(exported, SAME_FLAGS, directory, params.view(np.uint8)),
    }
    for name, version in versions.items():
        _check(name, version, u, expected)
    say("observer: timing Bank.run and C ...")
    short = np.ascontiguousarray(u[SLICE])
    out = stage.output.zeros(*short.shape)
    runners = {"bank": Runner(bank.reset, lambda: _discard(bank.run(short, out)))}
    for name, version in versions.items():
        runners[name] = Runner(version.start, _run(version, short.reshape(-1), out.reshape(-1)))
    seconds = interleaved(runners, repetitions)
    best = {name: 1e9 * min(times) / len(short) for name, times in seconds.items()}

    def figure(what: str, top: str, bottom: str, target: float) -> Figure:
        quiet = best[top] / best[bottom]
        note = f"at their best {best[top]:.0f} / {best[bottom]:.0f} ns a sample = {quiet:.2f} x"
        return Figure(f"observer: {what}", ratio(seconds, top, bottom), "x", target, note=note)

    return [
        figure("Bank.run / C by hand, native", "bank", "hand native", 2.0),
        figure("exported C / C by hand, same flags", "exported same", "hand same", 2.0),
    ]


def _motion(u: Records) -> Records:
    """Fill samples with a swinging joint: every term of the observer has work to do."""
    t = PERIOD * np.arange(len(u))[:, None]
    u["time"] = t
    u["theta"] = 0.5 * np.sin(3.0 * t)
    u["acceleration"] = -4.5 * np.sin(3.0 * t) + np.cos(50.0 * t)
    u["torque"] = 800.0 * np.sin(2.0 * t)
    u["coupling"] = 0.078 * np.cos(5.0 * t)
    u["stiffness"][SAMPLES // 2 :] = 4.5e5 * (1.0 + 0.1 * np.sin(t[: SAMPLES - SAMPLES // 2]))
    u["seen"] = 1
    u["theta"][LOST] = np.nan
    return u


def _words(record: Any) -> NDArray[np.int64]:
    """Return the joint_params of the C written by hand."""
    guard, inner = record["guard"], record["inner"]
    inverse, width = float(inner["inverse_inertia"]), float(inner["width"])
    d = float(inner["damping"]) * inverse
    c = d + float(inner["motor_damping"]) * inverse
    direct = inner["gains"] - np.array([c, 0.0, 0.0, 0.0])

    def columns(hold: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([hold @ direct, hold[:, 1], d * hold[:, 2], hold[:, 3]])

    values: list[Any] = [guard["period"], 1.0 / guard["period"], guard["jump"][0], guard["wrap"][0]]
    values += [guard["missing"], inner["held"], inner["settle"], inner["transition"]]
    values += [columns(inner["before"]), columns(inner["after"]), inner["gyro"], inverse, d, c]
    values += [inner["damping"], inner["coulomb"], width, 1.0 / width]
    values += [inner[name] for name in ("stiffness", "softest", "stiffest", "change")]
    return np.concatenate([np.atleast_1d(v).reshape(-1).view(np.int64) for v in values])


def _check(name: str, version: Native, u: Records, expected: Records) -> None:
    out = np.zeros(expected.shape, expected.dtype)
    version.start()
    version.run(u[:, 0].copy(), out[:, 0])
    for field in expected.dtype.names or ():
        a, b = out[field], expected[field]
        worst = float(np.abs(a - b).max() / np.abs(b).max())
        allowed = 0.0 if field == "status" else TOLERANCE
        if not worst <= allowed:
            raise Disagreement(f"{field} of observer, {name}: C differs by {worst:.2g} of it")


def _discard(out: Any) -> None:
    """Make a task of a function that returns something."""


def _run(version: Native, u: Records, out: Records) -> Callable[[], None]:
    return lambda: version.run(u, out)
