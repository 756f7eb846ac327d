"""Friction of one body, as kernels."""

from __future__ import annotations

import math
from typing import Any


def friction(params: Any, j: int, velocity: float, load: float) -> float:
    """Viscous, Coulomb and Stribeck friction of a body, and what a load adds.

    ``D v + (C + (S - C) exp(-(v / v_s)^2) + load) tanh(v / smoothing)``; Bo and Pavelescu's form
    of Stribeck's curve with exponent 2 (Armstrong-Helouvry, Dupont, Canudas de Wit 1994).
    """
    loss: float = params.damping[j] * velocity
    dry = params.coulomb[j] + load
    if params.excess[j] != 0.0:
        ratio = velocity / params.stribeck[j]
        dry = dry + params.excess[j] * math.exp(-ratio * ratio)
    # tanh is the dearest operation of the loop, so bodies without dry friction skip it
    if dry != 0.0:
        loss = loss + dry * tanh(velocity / params.smoothing)
    return loss


def tanh(x: float) -> float:
    """Hyperbolic tangent out of the exponential, to 1e-16."""
    size = math.fabs(x)
    e = 0.0
    if size < 20.0:
        e = math.exp(-2.0 * size)
    t = (1.0 - e) / (1.0 + e)
    if x < 0.0:
        return -t
    return t


def creep(params: Any, j: int, net: float) -> float:
    """Velocity at which friction alone balances a torque: ``D v + C tanh(v / eps) = net``.

    For net > 0 the left side is concave, so Newton's steps from a point below the root never
    pass it; the larger of ``net / (D + C / eps)`` and ``(net - C) / D`` is below and close.
    """
    D: float = params.damping[j]
    C: float = params.coulomb[j]
    if C == 0.0:
        return net / D
    size = math.fabs(net)
    v: float = size / (D + C / params.smoothing)
    if (size - C) / D > v:
        v = (size - C) / D
    for _ in range(8):
        t = tanh(v / params.smoothing)
        steep = D + C / params.smoothing * (1.0 - t * t)
        v = v + (size - D * v - C * t) / steep
    if net < 0.0:
        return -v
    return v
