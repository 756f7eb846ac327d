"""The constants of the hand-written C, taken from the parameter record of the stage it mirrors."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.native import Native, hand_code
from benchmarks.scenario import Case

# What joint_prepare adds: to the whole, and to each transmission beside its operator's.
DERIVED, DERIVED_EACH = 2, 6

# The words of a transmission_config before its operator's, as paths in a transmission's params.
TRANSMISSION = (
    "rows.zero.samples",
    "rows.weak.held",
    "evidence.lag",
    "rows.basis.scale",
    "rows.weak.inertia",
    "rows.weak.damping",
    "solver.forgetting",
    "evidence.memory",
    "solver.spread.0",
    "evidence.common",
    "evidence.accuracy",
    "evidence.bias",
    "evidence.noise.1",
    "evidence.shared.1",
)

# Terms under the window and samples from row to row.
WINDOW = (199, 20)

# The last words of a joint_config.
READOUT = ("starved", "informative", "hold", "shrink", "link2", "motor2")


def hand_version(case: Case, flags: tuple[str, ...], directory: Path) -> Native:
    """Compile the hand-written version of a case with the constants of its params."""
    record = case.params[0]
    inner = record["inner"]
    parts = [inner["first"], inner["second"]] if "first" in inner.dtype.names else [inner]
    transmissions, derived = [], DERIVED
    for part in parts:
        _check(part)
        operator, more = _operator(part)
        words = [_value(part, path) for path in TRANSMISSION]
        transmissions.append(_words(*words, *operator))
        derived += len(transmissions[-1]) + DERIVED_EACH + more
    config = _config(record, transmissions)
    params = np.zeros(len(config) + derived, np.int64)
    native = Native(hand_code(case.name), flags, directory, params)
    native.shared.joint_prepare(
        ctypes.c_void_p(params.ctypes.data), ctypes.c_void_p(config.ctypes.data)
    )
    return native


def _config(record: Any, transmissions: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    """Return the words of a joint_config."""
    guard, inner, n = record["guard"], record["inner"], len(transmissions)
    sums, readout = inner["sums"], inner["readout"]
    jumps = guard["jump"].tolist()
    _expect("guard.jump", jumps, [jumps[0]] * (n + 1) + [0.0] * n)
    _expect("guard.wrap", guard["wrap"][n + 1 :].tolist(), [0.0] * n)
    _expect("guard.limit", guard["limit"][: n + 1].tolist(), [0.0] * (n + 1))
    head = (guard["period"], guard["missing"], jumps[0])
    return np.concatenate(
        [
            _words(*head, guard["wrap"][: n + 1], guard["limit"][n + 1 :]),
            *transmissions,
            _words(sums["shortest"], sums["fade"], sums["fade_single"]),
            _words(*(readout[name] for name in READOUT)),
        ]
    )


def _operator(part: Any) -> tuple[tuple[Any, ...], int]:
    """Return the values of an operator_config, and how many words operator_params has."""
    operator = part["rows"]["operator"]
    if "pole" in operator.dtype.names:
        _expect("rows.operator.order", [int(operator["order"])], [2])
        return (operator["settle"], operator["pole"]), 1
    made = [int(operator[name]) for name in ("length", "stride", "phase")]
    _expect("rows.operator", made, [*WINDOW, 0])
    weights = operator["weight"][: WINDOW[0]]
    return (weights,), len(weights)


def _check(part: Any) -> None:
    """Stop if a transmission is not as the hand-written version takes for granted."""
    p = len(part["solver"]["spread"])
    fixed: dict[str, list[float]] = {
        "rows.zero.zero": [0.0],
        "rows.basis.power": list(range(1, 2 * p - 2, 2)),
        "rows.weak.kind": [6] + [0] * (p - 1),
        "rows.weak.delay": [0],
        "solver.variance": [1.0],
        "solver.centre": [0.0] * p,
        "solver.spread": [float(part["solver"]["spread"][0])] * p,
        "evidence.mute": [0] * 5,
        "evidence.known": [0.0] * p,
        "evidence.given": [0.0] * p,
        "evidence.noise": _straight(part, "noise"),
        "evidence.shared": _straight(part, "shared"),
        "evidence.scale2": [0.0],
        "shrink.first": [2],
    }
    for path, expected in fixed.items():
        _expect(path, _value(part, path).reshape(-1).tolist(), expected)
    _expect("rows.weak.scale", [float(part["rows"]["weak"]["scale"][0])], [1.0])


def _straight(part: Any, name: str) -> list[float]:
    """Return what a vector of the evidence is where only the straight line's entry is not 0."""
    vector = part["evidence"][name]
    return [0.0, float(vector[1]), *[0.0] * (len(vector) - 2)]


def _expect(path: str, found: list[float], expected: list[float]) -> None:
    if found != expected:
        raise AssertionError(f"C by hand takes for granted that {path} is {expected}, not {found}")


def _value(record: Any, path: str) -> NDArray[Any]:
    for key in path.split("."):
        record = record[int(key)] if key.isdigit() else record[key]
    return np.asarray(record)


def _words(*values: Any) -> NDArray[np.int64]:
    """Return numbers of 8 bytes as they lie in memory."""
    return np.concatenate([np.atleast_1d(value).reshape(-1).view(np.int64) for value in values])
