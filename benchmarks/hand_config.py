"""The constants of the hand-written C, taken from the parameter record of the stage it mirrors."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from benchmarks.native import Code, Native
from rotatum.record import Records

# In the order of weak_series_config. Where from: the path in the stage's params.
FIELDS: dict[str, str] = {
    "period": "guard.period",
    "missing": "guard.missing",
    "jump": "guard.jump.0",
    "torque_limit": "guard.limit.2",
    "wrap_q": "guard.wrap.0",
    "wrap_theta": "guard.wrap.1",
    "zero_samples": "inner.rows.zero.samples",
    "settle": "inner.rows.weak.settle",
    "held": "inner.rows.weak.held",
    "range": "inner.rows.basis.scale",
    "pole": "inner.rows.weak.pole",
    "inertia": "inner.rows.weak.inertia",
    "damping": "inner.rows.weak.damping",
    "forgetting": "inner.solver.forgetting",
    "memory": "inner.evidence.memory",
    "prior": "inner.solver.spread.0",
    "lag": "inner.evidence.lag",
    "block": "inner.sums.shortest",
    "common": "inner.evidence.common",
    "accuracy": "inner.evidence.accuracy",
    "noise": "inner.evidence.noise.0",
    "bias": "inner.evidence.bias",
    "starved": "inner.readout.starved",
    "informative": "inner.readout.informative",
    "hold": "inner.readout.hold",
    "shrink": "inner.readout.shrink",
    "fade": "inner.sums.fade",
    "fade_probe": "inner.sums.fade_single",
}
DERIVED = 8  # doubles that weak_series_prepare adds

# What the hand-written version takes for granted.
FIXED: dict[str, list[float]] = {
    "inner.rows.basis.power": [1, 3, 5],
    "inner.rows.weak.kind": [0, 0, 0, 6],
    "inner.rows.weak.scale": [1.0] * 4,
    "inner.rows.weak.delay": [0],
    "inner.solver.variance": [1.0],
    "inner.solver.centre": [0.0] * 4,
    "inner.evidence.mute": [0] * 5,
    "inner.evidence.known": [0.0] * 4,
    "inner.evidence.given": [0.0] * 4,
    "inner.evidence.noise.1": [0.0],
    "inner.evidence.noise.2": [0.0],
    "inner.evidence.noise.3": [0.0],
}


def _value(record: Any, path: str) -> Any:
    for key in path.split("."):
        record = record[int(key)] if key.isdigit() else record[key]
    return np.asarray(record)


def hand_version(code: Code, flags: tuple[str, ...], directory: Any, params: Records) -> Native:
    """Compile the hand-written version with the constants of a ``(1,)`` params record."""
    record = params[0]
    for path, expected in FIXED.items():
        if _value(record, path).reshape(-1).tolist() != expected:
            raise AssertionError(f"{code.source.name} takes for granted that {path} is {expected}")
    values = {name: _value(record, path) for name, path in FIELDS.items()}
    kinds = [(name, v.dtype.kind + "8", v.shape) for name, v in values.items()]
    config = np.zeros(1, np.dtype(kinds, align=True))
    for name, value in values.items():
        config[name][0] = value
    native = Native(code, flags, directory, np.zeros(config.nbytes + 8 * DERIVED, np.uint8))
    native.shared.weak_series_prepare(
        ctypes.c_void_p(native.params.ctypes.data), ctypes.c_void_p(config.ctypes.data)
    )
    return native
