"""Run a plant in time: classical Runge-Kutta, fixed sub-steps, inputs held over each sample."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import RotatumError
from rotatum.simulation.plant import SeriesPlant, State, accelerations, fastest_rate
from rotatum.simulation.trajectory import Trajectory

SUBSTEPS = 10
# RK4 is stable up to step * rate = 2.78; a fifth of that keeps the fastest mode accurate as well
STEP_RATE = 0.5
STEP_RATE_LIMIT = 2.7
# a deflection or turn beyond this is a diverged simulation of any joint
POSITION_LIMIT = 1e6


def choose_substeps(plant: SeriesPlant, period: float, substeps: int | None = None) -> int:
    """Return the sub-steps per sample: 10, or as many as the plant's fastest rate asks for.

    Raises `RotatumError` if `substeps` is given and the integration would be unstable with it.
    """
    rate = fastest_rate(plant) * period
    if substeps is None:
        return max(SUBSTEPS, math.ceil(rate / STEP_RATE))
    if substeps < 1 or rate / substeps > STEP_RATE_LIMIT:
        raise RotatumError(
            "too few integration steps per sample for the fastest motion of this joint",
            where="substeps",
            value=substeps,
            allowed=f"{max(1, math.ceil(rate / STEP_RATE_LIMIT))} or more",
        )
    return substeps


def advance(
    plant: SeriesPlant, state: State, tau: float, tau_ext: float, *, step: float, count: int
) -> State:
    """Return the state after `count` Runge-Kutta steps of `step` [s] under constant torques."""
    q, dq, th, dth = state
    half, sixth = 0.5 * step, step / 6.0
    quarter = half * half
    for _ in range(count):
        # the positions' slopes are velocities, so their stages are written out: no k_i for them
        a1, b1 = accelerations(plant, (q, dq, th, dth), tau, tau_ext)
        q2, th2 = q + half * dq, th + half * dth
        a2, b2 = accelerations(plant, (q2, dq + half * a1, th2, dth + half * b1), tau, tau_ext)
        q3, th3 = q2 + quarter * a1, th2 + quarter * b1
        a3, b3 = accelerations(plant, (q3, dq + half * a2, th3, dth + half * b2), tau, tau_ext)
        q4, th4 = q + step * (dq + half * a2), th + step * (dth + half * b2)
        a4, b4 = accelerations(plant, (q4, dq + step * a3, th4, dth + step * b3), tau, tau_ext)
        q += step * (dq + sixth * (a1 + a2 + a3))
        th += step * (dth + sixth * (b1 + b2 + b3))
        dq += sixth * (a1 + 2.0 * (a2 + a3) + a4)
        dth += sixth * (b1 + 2.0 * (b2 + b3) + b4)
    return State(q, dq, th, dth)


def integrate(
    plant: SeriesPlant,
    time: NDArray[np.float64],
    tau: NDArray[np.float64],
    tau_ext: NDArray[np.float64],
    *,
    start: State | None = None,
    substeps: int | None = None,
) -> Trajectory:
    """Return the plant's motion under torques held from each instant to the next.

    Parameters
    ----------
    time
        (N,) s, evenly spaced.
    tau, tau_ext
        (N,) N m, on the motor and on the link; the last ones act on nothing.
    start
        State at ``time[0]``; at rest, hanging, spring unloaded if not given.
    substeps
        Runge-Kutta steps per sample (`choose_substeps`).

    Raises `RotatumError` naming the time where the motion diverges.
    """
    period = float(time[1] - time[0])
    count = choose_substeps(plant, period, substeps)
    step = period / count
    state = start if start is not None else State()
    states = np.empty((time.size, 4))
    states[0] = state
    # Python floats: numpy scalars would make the loop three times slower
    torques = zip(tau[:-1].tolist(), tau_ext[:-1].tolist(), strict=True)
    for k, (motor, link) in enumerate(torques, start=1):
        try:
            state = advance(plant, state, motor, link, step=step, count=count)
        except ValueError as error:  # math.sin of infinity
            raise _diverged(float(time[k])) from error
        if not (abs(state.q) < POSITION_LIMIT and abs(state.theta) < POSITION_LIMIT):
            raise _diverged(float(time[k]))
        states[k] = state
    q, dq, theta, dtheta = np.ascontiguousarray(states.T)
    return Trajectory(time, q, dq, theta, dtheta, tau, tau_ext)


def _diverged(time: float) -> RotatumError:
    return RotatumError(
        "the simulated joint ran away",
        where=f"t = {time:.6g} s",
        hint="Lower the torque, check the sign of the cubic constant, or give more substeps.",
    )
