"""A pendulum on a spring, and its rows from the link's side."""

from __future__ import annotations

import numpy as np

from tests.kernels.driven import T, drive, problem, starts

M, D, G, K = 0.02, 0.05, 0.8, 30.0
SCALE = 0.01


def run(stage, params, q, theta, *, fresh=(0,), enable=1, **more):
    """All rows of the link side."""
    return drive(
        stage, params, q=q, theta=theta, enable=enable, fresh=starts(len(q), fresh), **more
    )


def pendulum(kinds=(), **settings):
    """Stage and parameters of a pendulum's rows with one linear column of the basis."""
    chosen = {"inertia": M, "damping": D, "gravity": G, **settings}
    return problem([1], kinds, side="link", scale=SCALE, **chosen)


def moving(q, t, *, inertia=M, damping=D, gravity=G):
    """Angles of a joint whose spring of K N m/rad carries its link exactly."""
    torque = -(inertia * q(t, 2) + damping * q(t, 1) + gravity * np.sin(q(t)))
    return q(t), q(t) - torque / K


def bound_of(q, *, period=T, inertia=M, damping=D, gravity=G):
    """What the hats leave of a motion: T^4 / 240 of fourth derivatives, T^2 / 12 of damping."""
    w = q.w.max()
    # sin q has fourth derivatives up to (1 + 6 + 3 + 4) products of q's: all below 14 (1 + a) w^4.
    sine = gravity * 14.0 * (1.0 + q.bound(0)) ** 4 * w**4
    left = period**4 / 240.0 * (2.0 * inertia * q.bound(6) + damping * q.bound(5) + 2.0 * sine)
    # The damping of balance and spring: the box of <q'> against the hat of phi.
    left += period**2 / 12.0 * damping * q.bound(3)
    return left + 8.0 * inertia * np.spacing(2.0) / period**2  # rounding of q
