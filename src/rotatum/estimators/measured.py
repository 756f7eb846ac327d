"""What a log itself says of its signals, before anything is estimated from it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

ACCELERATION = "acceleration"
VELOCITY = "velocity"
JERK = "jerk"
"""Kinds of signals whose noise a lower cutoff takes away; of link and motor."""

_NONE: Mapping[tuple[str, str], float] = MappingProxyType({})


class Measured(NamedTuple):
    """Noise of a joint's positions, and how wide an operator may be for it.

    Args:
        link, motor: standard deviation of the positions' noise, rad.
        cutoffs: (``"link"`` or ``"motor"``, kind of signal) to the highest cutoff, rad/s, at which
            its noise is small against it.
    """

    link: float = 0.0
    motor: float = 0.0
    cutoffs: Mapping[tuple[str, str], float] = _NONE
