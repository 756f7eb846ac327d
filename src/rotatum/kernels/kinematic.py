"""Kinematic Kalman filter: position and velocity from an encoder, without a model of the joint."""

from __future__ import annotations

import math
from typing import Any

from rotatum.record import Record, integer, number

MODIFIED = 1


class KinematicParams(Record):
    """A double integrator driven by white acceleration, its position measured."""

    period = number("time between samples", unit="s", symbol="T")
    mode = integer("0: constant gains; 1: the modified filter of flacco2012, gains recomputed")
    position_gain = number("constant gain of the position", symbol="alpha")
    velocity_gain = number("constant gain of the velocity, times the period", symbol="beta")
    acceleration = number("variance of the acceleration", unit="rad^2/s^4", symbol="V_a")
    largest = number("measurement variance at rest", unit="rad^2", symbol="V_max")
    smallest = number("measurement variance at speed", unit="rad^2", symbol="V_min")
    steepness = number("steepness of the change between the two", symbol="alpha")
    count_speed = number("one encoder count per sample", unit="rad/s", symbol="w_s")


class KinematicState(Record):
    """Filtered position and velocity with their covariance."""

    position = number("filtered position", unit="rad", symbol="x")
    velocity = number("filtered velocity", unit="rad/s", symbol="xdot")
    pp = number("variance of the position", unit="rad^2")
    pv = number("covariance of both", unit="rad^2/s")
    vv = number("variance of the velocity", unit="rad^2/s^2")
    count = integer("samples since (re)start")


def init(params: Any, state: Any) -> None:
    """Nothing seen yet."""
    state.count = 0


def start(params: Any, state: Any, z: float) -> None:
    """Begin at rest where the encoder stands."""
    state.position = z
    state.velocity = 0.0
    state.pp = params.largest
    state.pv = 0.0
    state.vv = params.acceleration * params.period * params.period
    state.count = 1


def observe(params: Any, state: Any, z: float) -> None:
    """One sample of flacco2012 eqs 18-20.

    ``xi(k) = [[1, T], [0, 1]] xi(k-1) + mu``, ``z = [1, 0] xi + v``, with
    ``Q = V_a Gamma Gamma^T``, ``Gamma = (T^2/2, T)``.

    Departure: eq. 20 prints ``|xdot| w_s``, which has a dimension; its text means the counts
    moved per sample, ``|xdot| / w_s``. The exponent is clamped.
    """
    T = params.period
    ahead = state.position + T * state.velocity
    e = z - ahead
    if params.mode == MODIFIED:
        _modified(params, state, ahead, e)
    else:
        state.position = ahead + params.position_gain * e
        state.velocity = state.velocity + params.velocity_gain * e / T
    state.count = state.count + 1


def _modified(params: Any, state: Any, ahead: float, e: float) -> None:
    T = params.period
    V = params.acceleration
    exponent = (math.fabs(state.velocity) / params.count_speed - 1.0) * params.steepness
    if exponent > 500.0:
        exponent = 500.0
    R = (params.largest - params.smallest) / (1.0 + math.exp(exponent)) + params.smallest
    pp = state.pp + T * (2.0 * state.pv + T * state.vv) + 0.25 * V * T * T * T * T
    pv = state.pv + T * state.vv + 0.5 * V * T * T * T
    vv = state.vv + V * T * T
    S = pp + R
    kp = pp / S
    kv = pv / S
    state.position = ahead + kp * e
    state.velocity = state.velocity + kv * e
    state.pp = pp - kp * pp
    state.pv = pv - kp * pv
    state.vv = vv - kv * pv
