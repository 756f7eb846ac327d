"""An elastic joint whose motion is known exactly, and the observer that watches it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.poles import error_matrix, injection
from rotatum.estimators.full_state.stage import fill_luenberger
from rotatum.kernels import luenberger
from tests.kernels.make import plain, record

Array = NDArray[np.float64]
FINE = 20  # steps within a period, to see what lies between the samples
STATES = ("theta_hat", "q_hat", "dtheta_hat", "dq_hat")


class Motion(NamedTuple):
    """Samples: state (N, 4) of theta, q, theta', q'; q'' (N,); held torque (N,).

    ``between`` is how far theta and q'' stray from a straight line between two samples.
    """

    x: Array
    acceleration: Array
    torque: Array
    between: tuple[float, float]


def moved(design: Design, mass: float, torque: Array, start: Array, load: float = 0.0) -> Motion:
    """Move motor, spring and a link of some inertia under a held torque, by exponentials.

    ``load`` is a constant torque on the link, of which no observer is told.
    """
    B, K, D, C, _ = design.drivetrain
    A = np.zeros((6, 6))  # theta, q, theta', q', motor's torque, link's
    A[0, 2] = A[1, 3] = 1.0
    A[2] = np.array([-K, K, -D - C, D, 1.0, 0.0]) / B
    A[3] = np.array([K, -K, D, -D, 0.0, 1.0]) / mass
    small = expm(A * design.period / FINE)
    x = np.array([*start, 0.0, load])
    states = np.empty((len(torque) * FINE, 6))
    for i in range(len(states)):
        if i % FINE == 0:
            x[4] = torque[i // FINE]
        states[i] = x
        x = small @ x
    seen = {"theta": states[:, 0], "acceleration": states @ A[3]}
    between = tuple(_astray(v) for v in seen.values())
    return Motion(
        states[::FINE, :4], seen["acceleration"][::FINE], torque, (between[0], between[1])
    )


def _astray(values: Array) -> float:
    at = np.arange(len(values))
    inside = at <= at[-1] // FINE * FINE
    line = np.interp(at[inside], at[::FINE], values[::FINE])
    return float(np.abs(values[inside] - line).max())


def hold_bound(design: Design, motion: Motion) -> Array:
    """(4,) the most that straight lines between samples can do to the estimate.

    The deviation from the line, times the area under the magnitude of the continuous response.
    """
    B, K, D, C, _ = design.drivetrain
    k, d, c = K / B, D / B, (D + C) / B
    A = error_matrix(design.pairs, design.gyro)
    G = np.stack([injection(design.pairs) - [c, k, 0.0, 0.0], [0.0, 0.0, d, k]], axis=1)
    out = np.linalg.inv(to_w(design))
    h = design.period / 10.0
    step, response, area = expm(A * h), G.copy(), np.zeros((4, 2))
    for _ in range(2000):
        area += h * np.abs(out @ response)
        response = step @ response
    return np.asarray(1.1 * area @ motion.between)  # 1.1: the sum for the integral


def to_w(design: Design, stiffness: float | None = None) -> Array:
    """(4, 4) from theta, q, theta', q' to the kernel's w."""
    B, K, D, C, _ = design.drivetrain
    k, d = (K if stiffness is None else stiffness) / B, D / B
    return np.array([[1.0, 0, 0, 0], [d + C / B, 0, 1.0, 0], [0, k, 0, d], [0, 0, 0, k]])


class Observer:
    """The kernel on one joint, interpreted."""

    def __init__(self, design: Design, **params: Any) -> None:
        one = record(luenberger.LuenbergerParams)
        fill_luenberger(one, design)
        for name, value in params.items():
            one[name] = value
        self.design = design
        self.params = plain(one)
        for name in ("transition", "before", "after"):  # m[i, j] of Python numbers: fast to read
            matrix = getattr(self.params, name)
            setattr(self.params, name, {at: float(matrix[at]) for at in np.ndindex(4, 4)})
        self.sample = plain(record(luenberger.LuenbergerSample, seen=1))
        self.state = plain(record(luenberger.LuenbergerState))
        self.out = plain(record(luenberger.LuenbergerEstimate))
        luenberger.init(self.params, self.state)

    def push(self, **values: float) -> Array:
        """Take one sample; (4,) theta, q, theta', q'."""
        sample = SimpleNamespace(**vars(self.sample))
        for name, value in values.items():
            setattr(sample, name, value)
        luenberger.step(self.params, self.state, sample, self.out)
        return np.array([getattr(self.out, name) for name in STATES])

    def watch(self, motion: Motion, **values: Array) -> Array:
        """Take all samples of a motion; (N, 4)."""
        given = {"theta": motion.x[:, 0], "acceleration": motion.acceleration}
        given |= {"torque": motion.torque} | values
        return np.array(
            [self.push(**{n: float(v[k]) for n, v in given.items()}) for k in range(len(motion.x))]
        )

    def put(self, x: Array) -> None:
        """Set the estimate."""
        self.state.w = list(to_w(self.design, self.state.stiffness) @ x)
