"""What an observer will do, from its matrices: noise, biases, wrong torques, bandwidth."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.full_state.drivetrain import Drivetrain
from rotatum.estimators.full_state.poles import DEFAULT, Pair, Pairs, discretise, injection
from rotatum.estimators.observers.figures import fallen, settle
from rotatum.estimators.observers.recursion import Recursion

Array = NDArray[np.float64]

INPUTS = ("theta", "torque", "acceleration", "rate")
OUTPUTS = ("theta_hat", "q_hat", "dtheta_hat", "dq_hat", "deflection", "torque")
_LINK = OUTPUTS.index("q_hat")
_FORGOTTEN = 1e-3  # share of a start's error that is left where it counts as forgotten
_SLOWEST = 1.0  # rad/s: an observer that takes seconds to settle helps no loop


class Design(NamedTuple):
    """An observer of one joint.

    Args:
        drivetrain: motor and spring.
        period: T [s].
        pairs: the poles of its error.
        gyro: gain of a gyroscope on the link [1/s], 0: none.
        held: the torque is a command, constant until the next sample; else it is sampled.
    """

    drivetrain: Drivetrain
    period: float
    pairs: Pairs = DEFAULT
    gyro: float = 0.0
    held: bool = False

    def at(self, frequency: float) -> Design:
        """Return it with the first pair at a frequency [rad/s], the second in proportion."""
        first, second = self.pairs
        ratio = second.frequency / first.frequency
        pairs = (Pair(frequency, first.damping), Pair(frequency * ratio, second.damping))
        return self._replace(pairs=pairs)


class Noise(NamedTuple):
    """Errors of the measurements.

    Args:
        resolution: of the motor's encoder, at the joint [rad]; its error is taken for uniform and
            white, standard deviation resolution / sqrt 12. It is neither where the motor hardly
            moves: the error is then that of a constant angle of at most half of it.
        torque: standard deviation [N m], white.
        acceleration: of the link's [rad/s^2], white.
        rate: of the gyroscope [rad/s], white.
        acceleration_bias: bound of a constant error [rad/s^2].
        torque_bias: bound of a constant error [N m].
    """

    resolution: float = 0.0
    torque: float = 0.0
    acceleration: float = 0.0
    rate: float = 0.0
    acceleration_bias: float = 0.0
    torque_bias: float = 0.0

    @property
    def variances(self) -> Array:
        """(4,) of theta, torque, acceleration and rate."""
        deviations = (self.resolution / math.sqrt(12.0), self.torque, self.acceleration, self.rate)
        return np.square(deviations)


class Figures(NamedTuple):
    """Figures of a design; each (6,): theta, q, theta', q', deflection, elastic torque.

    Args:
        deviation: standard deviation by noise.
        acceleration_error: left by a constant error of the acceleration, per rad/s^2.
        torque_error: left by a constant error of the torque, per N m.
        torque_peak: the most that any error of the torque within 1 N m can do.
        bandwidth: [rad/s]; below it the link's position comes from the motor's and the torque,
            above it from the acceleration and the gyroscope.
        settle: samples until a wrong start is forgotten to a thousandth.
    """

    deviation: Array
    acceleration_error: Array
    torque_error: Array
    torque_peak: Array
    bandwidth: float
    settle: int

    def stiffness_error(self, share: float, torque: float) -> Array:
        """(6,) left by a wrong stiffness under a constant elastic torque.

        To the observer the motor's torque is too large by (K - K_true)(q - theta). The elastic
        torque it tells is right: at rest it balances the motor's, whatever the stiffness.

        Args:
            share: of the true stiffness that the observer's is too large by; -0.1: 10 % too small.
            torque: elastic torque [N m].

        Raises:
            MethodError: a share that leaves no stiffness.
        """
        if not share > -1.0:
            raise MethodError("no stiffness is left", where="share", value=share, allowed="> -1")
        beyond = share * torque  # of K (q - theta), true deflection, above the elastic torque
        error = self.torque_error * beyond
        error[-1] += beyond
        return error


def recursion_of(design: Design) -> Recursion:
    """Return the observer as a recursion from `INPUTS` to `OUTPUTS`.

    Args:
        design: without Coulomb friction, which is not linear.

    Raises:
        MethodError: poles that are not stable or too fast, or a drivetrain that cannot be.
    """
    drivetrain = design.drivetrain.checked()
    B, K, D = drivetrain.inertia, drivetrain.stiffness, drivetrain.damping
    k, d, c = K / B, D / B, (D + drivetrain.motor_damping) / B
    G = np.zeros((4, 4))
    G[:, 0] = injection(design.pairs, design.gyro) - [c, k, 0.0, 0.0]
    G[1, 1] = 1.0 / B
    G[2:, 2] = d, k
    G[3, 3] = design.gyro * k
    C = np.zeros((6, 4))
    C[0, 0] = 1.0
    C[1, 2:] = 1.0 / k, -d / k**2
    C[2, :2] = -c, 1.0
    C[3, 3] = 1.0 / k
    C[4] = C[1] - C[0]
    C[5] = K * C[4]
    E, before, after = discretise(design.pairs, design.period, design.gyro)
    first, last = before @ G, after @ G
    if design.held:
        first[:, 1] += last[:, 1]
        last[:, 1] = 0.0
    F = np.hstack([first, last])
    return Recursion(E, F, C @ E, C @ F, len(INPUTS), 0)


def figures(design: Design, noise: Noise) -> Figures:
    """Compute the figures of a design; nothing is simulated.

    Args:
        design: an observer; Coulomb friction is left out.
        noise: of the measurements; its biases do not count here.

    Raises:
        MethodError: poles that are not stable or too fast, or a drivetrain that cannot be.
    """
    recursion = recursion_of(design)
    covariance = recursion.noise(np.diag(noise.variances))
    steady = _steady(recursion)
    steps = settle(recursion, _FORGOTTEN)
    # The rest of the response is below a thousandth of a thousandth of what is summed.
    peak = np.abs(recursion.impulse(2 * steps + 10)[:, :, 1]).sum(axis=0)

    def from_motor(angles: Array) -> Array:
        seen, w = recursion.response(angles)[:, _LINK], angles / design.period
        return np.asarray(np.abs(1.0 + np.square(w) * seen[:, 2] - 1j * w * seen[:, 3]))

    return Figures(
        np.sqrt(np.diag(covariance)),
        steady[:, 2],
        steady[:, 1],
        peak,
        fallen(from_motor) / design.period,
        steps,
    )


def forgotten(design: Design) -> int:
    """Samples until a wrong start is forgotten to a thousandth.

    Args:
        design: an observer.
    """
    return settle(recursion_of(design), _FORGOTTEN)


def link_error(design: Design, noise: Noise) -> float:
    """Root mean square of the link position's error [rad]: its noise, and the worst of its biases.

    Args:
        design: an observer.
        noise: of the measurements.
    """
    recursion = recursion_of(design)
    variance = float(recursion.noise(np.diag(noise.variances))[_LINK, _LINK])
    steady = np.abs(_steady(recursion)[_LINK])
    bias = steady[1] * noise.torque_bias + steady[2] * noise.acceleration_bias
    return math.sqrt(variance + bias**2)


def quietest(
    design: Design,
    noise: Noise,
    lowest: float | None = None,
    highest: float | None = None,
    count: int = 100,
) -> Design:
    """Choose the frequency of the poles with the least `link_error`, over a grid.

    Slow poles leave the biases of the acceleration and integrate its noise; fast ones
    differentiate the encoder: there is a least in between. The joint's needs bound it from below:
    a start must be forgotten, and a wrong stiffness or torque must not matter, soon enough.

    Args:
        design: the dampings, the ratio of the two frequencies and everything else are kept.
        noise: of the measurements.
        lowest: [rad/s]; None: 1.
        highest: [rad/s]; None: half of the fastest the period allows.
        count: of frequencies, in a geometric row.

    Raises:
        MethodError: bounds that are not in order or too fast for the period, or no noise at all.
    """
    if not link_error(design, noise) > 0.0:
        raise MethodError("without noise every frequency is as good", where="noise", value=noise)
    fastest = max(abs(r) for pair in design.at(1.0).pairs for r in pair.roots)
    low = _SLOWEST if lowest is None else lowest
    high = 0.5 * math.pi / design.period / fastest if highest is None else highest
    if not 0.0 < low < high:
        raise MethodError("the frequencies are not in order", where="lowest, highest",
                          value=(low, high))  # fmt: skip
    candidates = [design.at(float(w)) for w in np.geomspace(low, high, count)]
    return min(candidates, key=lambda each: link_error(each, noise))


def _steady(recursion: Recursion) -> Array:
    """(6, 4) what constant inputs lead to."""
    whole = sum((recursion.block(recursion.K, age) for age in range(2)), np.zeros(1))
    return np.asarray(recursion.G @ recursion.rest() + whole)
