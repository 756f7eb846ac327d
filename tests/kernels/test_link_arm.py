"""Rows of a joint of an arm: momentum and force come two samples late, the balance holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.estimators.armterms import load_provider
from rotatum.estimators.gains import steady_gains
from rotatum.kernels import kinematic, link, rows
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from tests.kernels.driven import T, problem
from tests.kernels.linked import SCALE, D, G, K, M, moving, pendulum, run
from tests.kernels.make import Sines, plain, record


def central(q, period=T):
    """Velocity across five samples, of the middle one: known from the third to the last but two."""
    inner, outer = q[3:-1] - q[1:-3], q[4:] - q[:-4]
    return (8.0 * inner - outer) / (12.0 * period)


def told(robot, q, period=T):
    """Momentum and force of every joint as they come: two samples late, 0 while unknown."""
    load = load_provider(robot, None)
    found = {"momentum": np.zeros_like(q), "force": np.zeros_like(q)}
    for k, velocity in enumerate(central(q, period)):
        said = load(q[k + 2], velocity)
        found["momentum"][k + 4], found["force"][k + 4] = said.momentum, said.force
    return found


def arm_rows(q, theta, period=T, kinds=(), **more):
    """Rows of a joint of an arm."""
    stage, P = problem(
        [1], kinds, side="link", scale=SCALE, period=period, arm=1, delay=link.AHEAD,
        **{k: more.pop(k) for k in ("damping", "coulomb", "width") if k in more},
    )  # fmt: skip
    # Momentum and force are known from the fifth sample on, the first that is used.
    return run(stage, P, q, theta, **more)


def test_an_arm_of_one_link_is_the_pendulum_but_for_the_test_function():
    q, t = Sines(np.random.default_rng(413), 1.0, 2.0, 40.0), T * np.arange(500)
    angle, theta = moving(q, t, damping=0.0)
    said = told(Pendulum(M, G), angle[:, None])
    out = arm_rows(angle, theta, **{k: v[:, 0] for k, v in said.items()})
    stage, P = pendulum(damping=0.0)
    alone = run(stage, P, angle, theta)
    # Boxes are twice as wide as hats, T^2 / 6 against T^2 / 12 of a second derivative; both rows of
    # the same instant, two samples apart; what each started from has left after 0.1 s.
    apart = np.abs(out["y"][102:] - alone["y"][100:-2])
    w = q.w.max()
    second = M * q.bound(4) + G * (q.bound(2) + q.bound(1) ** 2)
    assert apart.max() < T**2 / 12.0 * second * 1.01
    # Each is balanced by its own columns to the fourth order; the momentum's velocity errs by
    # T^4 / 30 of the fifth derivative, Simpson's mean by T^4 / 180.
    off = np.abs(out["y"] - out["R"][:, 0] * K * SCALE)[6:]
    sine = G * 14.0 * (1.0 + q.bound(0)) ** 4 * w**4
    bound = T**4 * (M * q.bound(6) * (1.0 / 30.0 + 1.0 / 90.0) + sine / 90.0)
    assert off.max() < bound + 8.0 * M * np.spacing(2.0) / T**2
    assert apart.max() > 3.0 * off.max()


PLANAR = Planar((0.4, 0.3), (1.2, 0.8))
SPRINGS = np.array([120.0, 60.0])


def planar(period, seconds=0.6):
    """A planar arm with gravity moving as it likes: link and motor angles, (N, 2)."""
    rng = np.random.default_rng(414)
    joints = [Sines(rng, 0.8, 3.0, 30.0) for _ in range(2)]
    t = period * np.arange(round(seconds / period))
    q, dq, ddq = (np.stack([s(t, n) for s in joints], axis=1) for n in range(3))
    torque = -np.array([PLANAR.inverse_dynamics(*one) for one in zip(q, dq, ddq, strict=True)])
    return q, dq, torque


@pytest.mark.parametrize("joint", [0, 1])
def test_a_coupled_arm_is_balanced_joint_by_joint_to_the_fourth_order(joint):
    left = []
    for period in (2e-3, 1e-3):
        q, _, torque = planar(period)
        theta = q - torque / SPRINGS
        said = told(PLANAR, q, period)
        own = {k: v[:, joint] for k, v in said.items()}
        out = arm_rows(q[:, joint], theta[:, joint], period, **own)
        fit = out["R"][:, 0] * SPRINGS[joint] * SCALE
        skip = round(0.1 / period)  # what is of order one at the start has left
        left.append(np.abs(out["y"] - fit)[skip:].max() / np.abs(fit).max())
    # Fourth order, but for a share of (w T)^2: products of three sines of 30 rad/s move at 90.
    assert left[0] / left[1] == pytest.approx(16.0, rel=0.1)
    assert left[1] < 1e-6
    # It could fail: with what the arm says one sample later.
    late = {k: np.roll(v, 1) for k, v in own.items()}
    other = arm_rows(q[:, joint], theta[:, joint], **late)
    assert np.abs(other["y"] - fit)[100:].max() > 1e-3 * np.abs(fit).max()


def test_a_payload_is_its_column():
    # An arm that carries 0.5 kg and is described without it: the column times 0.5 is what lacks.
    q, _, _ = planar(T)
    load = load_provider(PLANAR, PLANAR.with_payload("tip", 1.0))
    bare, full = told(PLANAR, q), told(PLANAR.with_payload("tip", 0.5), q)
    share = {name: np.zeros(len(q)) for name in ("payload_momentum", "payload_force")}
    for k, velocity in enumerate(central(q)):
        said = load(q[k + 2], velocity)
        share["payload_momentum"][k + 4] = said.payload_momentum[0]
        share["payload_force"][k + 4] = said.payload_force[0]
    first = q[:, 0]
    own = {k: v[:, 0] for k, v in bare.items()}
    light = arm_rows(first, first, kinds=(rows.PAYLOAD,), **own, **share)
    heavy = arm_rows(first, first, **{k: v[:, 0] for k, v in full.items()})
    # M, C and g are affine in a mass: rounding of torques of order 10, momenta of 10 over T.
    np.testing.assert_allclose(
        (light["y"] - heavy["y"])[6:], 0.5 * light["R"][6:, 0], rtol=0.0, atol=1e-10
    )
    assert np.abs(light["R"][6:, 0]).max() > 1.0


def causal(q, bandwidth):
    """Velocity of the steady kinematic Kalman filter, which knows no later sample."""
    alpha, beta = steady_gains(bandwidth, T)
    p = plain(record(kinematic.KinematicParams, period=T, position_gain=alpha, velocity_gain=beta))
    s = plain(record(kinematic.KinematicState))
    kinematic.start(p, s, float(q[0]))
    found = [0.0]
    for z in q[1:].tolist():
        kinematic.observe(p, s, z)
        found.append(s.velocity)
    return np.array(found)


def fitted_damping(q, theta, velocity):
    """Link damping by least squares from momenta M times a velocity, told two samples late."""
    momentum = M * np.concatenate([[0.0, 0.0], velocity[:-2]])
    force = -G * np.sin(np.concatenate([[0.0, 0.0], q[:-2]]))
    out = arm_rows(q, theta, kinds=(rows.LINK_DAMPING,), momentum=momentum, force=force)
    R, y = out["R"][500:], out["y"][500:]
    return np.linalg.lstsq(R, y, rcond=None)[0][0]


def test_a_velocity_that_comes_late_is_taken_for_damping():
    """The reason for differences across a sample: lag times M q''' is a drag, -M lag w^2 q'.

    A Kalman filter of 150 rad/s is sqrt(2) / 150 s late; at w that is M sqrt(2) w^2 / 150 of
    damping: with M = 0.02 kg m^2 and w = 8 rad/s 0.012 N m s/rad, a quarter of D = 0.05.
    """
    q, t = Sines(np.random.default_rng(415), 1.0, 6.0, 9.0), T * np.arange(4000)
    angle, theta = moving(q, t)
    exact = np.concatenate([[0.0] * 2, central(angle), [0.0] * 2])
    # (w T)^4 = 7e-9 of every part of the balance.
    assert fitted_damping(angle, theta, exact) == pytest.approx(D, rel=1e-7)
    late = fitted_damping(angle, theta, causal(angle, 150.0))
    weight = q.size**2 * q.w**2
    expected = M * math.sqrt(2.0) / 150.0 * (weight @ q.w**2) / weight.sum()
    assert expected > 0.2 * D
    # To first order in w / 150, of the tones' mean: a tenth.
    assert abs(late - D) == pytest.approx(expected, rel=0.2)
