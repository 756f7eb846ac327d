"""Inputs and params for a stage of which nothing but its layouts is known."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rotatum.record import Field, Layout, Records
from rotatum.runtime.stage import Stage

PERIOD = 1e-3
"""Time between random samples, s."""

_TONES = 5


def leaves(layout: Layout, prefix: str = "") -> Iterator[tuple[str, Field]]:
    """Yield the dotted name and the field of everything in a record that is no record itself."""
    for name, f in layout.fields.items():
        if isinstance(f.kind, Layout):
            yield from leaves(f.kind, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", f


def leaf(records: Records, name: str) -> Records:
    """Return a view of the field with a dotted name."""
    for part in name.split("."):
        records = records[part]
    return records


def random_inputs(stage: Stage, samples: int, joints: int = 1, seed: int = 0) -> Records:
    """Make ``(samples, joints)`` smooth random inputs.

    Every float field is a sum of tones of 0.1 to 20 Hz, of order one; a field ``time`` is a regular
    clock of 1 ms; integers, which are switches, are 1.
    """
    rng = np.random.default_rng(seed)
    inputs = stage.input.zeros(samples, joints)
    clock: NDArray[np.float64] = np.arange(samples, dtype=np.float64) * PERIOD
    for name, f in leaves(stage.input):
        values = leaf(inputs, name)
        if name == "time":
            values[...] = clock[:, np.newaxis]
        elif f.kind == "int":
            values[...] = 1
        else:
            for index in np.ndindex(values.shape[1:]):
                values[(slice(None), *index)] = _tones(rng, clock)
    return inputs


def random_params(stage: Stage, joints: int = 1, seed: int = 0) -> Records:
    """Make ``(joints,)`` params: floats between 0.1 and 0.9, integers 1."""
    rng = np.random.default_rng(seed)
    params = stage.params.zeros(joints)
    for name, f in leaves(stage.params):
        values = leaf(params, name)
        values[...] = 1 if f.kind == "int" else rng.uniform(0.1, 0.9, values.shape)
    return params


def _tones(rng: np.random.Generator, clock: NDArray[np.float64]) -> NDArray[np.float64]:
    frequency = np.exp(rng.uniform(np.log(0.1), np.log(20.0), _TONES))
    phase, size = rng.uniform(0.0, 2.0 * np.pi, _TONES), rng.uniform(0.1, 0.5, _TONES)
    waves = size * np.sin(2.0 * np.pi * frequency * clock[:, np.newaxis] + phase)
    total: NDArray[np.float64] = waves.sum(axis=1)
    return total
