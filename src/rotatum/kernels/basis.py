"""Bases of the elastic torque: products of powers of deflection and set-point, normalised."""

from __future__ import annotations

from typing import Any

from rotatum.record import Record, integer, number, vector

ROOM = 3
"""What the powers of the deflection take beyond the highest one."""


class BasisParams(Record):
    """``F_h = x^i_h s^j_h``, x and s scaled by their declared ranges."""

    scale = number("deflection at x = 1, half the declared range", unit="rad")
    middle = number("set-point at s = 0", unit="unit of the set-point")
    half = number("set-point at s = 1, less the middle", unit="unit of the set-point")
    setpoint_order = integer("highest power of the set-point")
    power = vector("b", "power of the deflection, per term", kind="int", symbol="i_h")
    setpoint_power = vector("b", "power of the set-point, per term", kind="int", symbol="j_h")


class BasisState(Record):
    """The terms and their derivatives at one deflection and set-point."""

    x = vector("r", "0, 0, then powers 0, 1, ... of the scaled deflection")
    s = vector("m", "powers 0, 1, ... of the scaled set-point")
    F = vector("b", "terms", symbol="F")
    D = vector("b", "first derivative with respect to deflection", unit="1/rad", symbol="F_phi")
    H = vector("b", "second derivative", unit="1/rad^2", symbol="F_phiphi")
    S = vector("b", "derivative with respect to the set-point", symbol="F_s")


def evaluate(params: Any, state: Any, phi: float, setpoint: float) -> None:
    """Fill F, dF/dphi, d2F/dphi2 and dF/ds (flacco2012 eqs 26, 29, 36 in normalised coordinates).

    Departure: the paper's powers of radians and metres depend on the unit (see the docs on
    normalisation); here every term is of order one over the declared range.
    """
    rate = 1.0 / params.scale
    x = phi * rate
    # Powers below 0 only ever stand beside a factor of 0: no term needs a branch.
    state.x[0] = 0.0
    state.x[1] = 0.0
    state.x[2] = 1.0
    for i in range(3, len(state.x)):
        state.x[i] = state.x[i - 1] * x
    for h in range(len(state.F)):
        i = params.power[h]
        state.F[h] = state.x[i + 2]
        state.D[h] = i * state.x[i + 1] * rate
        state.H[h] = i * (i - 1) * state.x[i] * rate * rate
    if params.setpoint_order > 0:
        _setpoint(params, state, setpoint)


def _setpoint(params: Any, state: Any, setpoint: float) -> None:
    s = (setpoint - params.middle) / params.half
    state.s[0] = 1.0
    for j in range(1, len(state.s)):
        state.s[j] = state.s[j - 1] * s
    for h in range(len(state.F)):
        j = params.setpoint_power[h]
        state.S[h] = 0.0
        if j >= 1:
            state.S[h] = j * state.s[j - 1] * state.F[h] / params.half
        state.F[h] = state.F[h] * state.s[j]
        state.D[h] = state.D[h] * state.s[j]
        state.H[h] = state.H[h] * state.s[j]
