"""An arm from its links: sample by sample as in a batch, missing samples and all."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.estimators.armterms import load_provider
from rotatum.kernels.status import BRIDGED, GAP, NOT_FINITE, RESTARTED
from rotatum.models import device_from_tables
from rotatum.models.robot.planar import Planar
from tests.kernels.make import Sines

T = 1e-3
SPRINGS, DRAG = np.array([120.0, 60.0]), np.array([0.08, 0.02])


def arm() -> Estimator:
    """A planar arm whose links' damping is fitted."""
    joint = {
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.1, "orders": 1},
        "estimator": {"side": "link", "fit": ["link_damping"], "cutoff": 100.0},
    }
    tables = {
        "name": "arm",
        "joint": [{"name": "one", **joint}, {"name": "two", **joint}],
        "robot": {"model": "planar", "lengths": [0.4, 0.3], "masses": [1.2, 0.8]},
    }
    return Estimator(device_from_tables(tables, "test"), period=T)


def motion(seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, link and motor angles (N, 2) of an arm that obeys its equations."""
    robot = Planar((0.4, 0.3), (1.2, 0.8))
    rng = np.random.default_rng(460)
    joints = [Sines(rng, 0.8, 3.0, 30.0) for _ in range(2)]
    t = T * np.arange(round(seconds / T))
    q, dq, ddq = (np.stack([s(t, n) for s in joints], axis=1) for n in range(3))
    torque = -np.array([robot.inverse_dynamics(*one) for one in zip(q, dq, ddq, strict=True)])
    return t, q, q - (torque - DRAG * dq) / SPRINGS


def channels(q: np.ndarray, theta: np.ndarray) -> list[dict[str, np.ndarray]]:
    return [{"q": q[:, i].copy(), "theta": theta[:, i].copy()} for i in range(2)]


def online(loop: Estimator, t: np.ndarray, q: np.ndarray, theta: np.ndarray) -> list[Any]:
    found = []
    for k in range(len(t)):
        loop.update(q=q[k], theta=theta[k], time=float(t[k]))
        found.append(loop.groups[0].out.copy())
    return found


def test_both_joints_are_found_with_their_damping() -> None:
    t, q, theta = motion(8.0)
    (out,) = arm().run(t, channels(q, theta))
    last = out[-1]
    # T^4 of differences across samples: 1e-6 of the torque. The damping is 2 % of a torque.
    np.testing.assert_allclose(last["stiffness"], SPRINGS, rtol=1e-5)
    np.testing.assert_allclose(last["coefficients"][:, 0], DRAG, rtol=1e-3)


def test_a_loop_gives_what_a_batch_gives_to_the_bit() -> None:
    t, q, theta = motion(1.5)
    q[400, 1] = np.nan  # of one joint: a bad sample of the arm
    kept = np.r_[0:700, 704:1500]  # four samples lost
    t, q, theta = t[kept], q[kept], theta[kept]
    t[1200:] += 0.5  # a gap too long to bridge
    (batch,) = arm().run(t, channels(q, theta))
    loop = np.stack(online(arm(), t, q, theta))
    assert loop.tobytes() == batch.tobytes()
    # Every sample has its own status; bridged ones none of their own.
    status = batch["status"]
    assert (status[400] & NOT_FINITE).all()
    assert (status[401] & BRIDGED).all()
    assert (status[700] & BRIDGED).all()
    assert (status[1200] & (GAP | RESTARTED) == GAP | RESTARTED).all()
    assert np.array_equal(batch["time"], np.stack([t, t], axis=1))
    assert (batch["rows"][-1] > 1000).all()


def test_a_batch_is_the_same_in_pieces() -> None:
    t, q, theta = motion(1.5)
    q[333, 0] = np.nan
    (whole,) = arm().run(t, channels(q, theta))
    loop, pieces = arm(), []
    for first, last in ((0, 333), (333, 334), (334, 1000), (1000, 1500)):
        part = slice(first, last)
        pieces += loop.run(t[part], channels(q[part], theta[part]))
    assert np.concatenate(pieces).tobytes() == whole.tobytes()


def test_a_reset_forgets_everything() -> None:
    t, q, theta = motion(0.4)
    loop = arm()
    first = np.stack(online(loop, t, q, theta))
    loop.reset()
    again = np.stack(online(loop, t, q, theta))
    assert first.tobytes() == again.tobytes()


def test_the_load_is_what_the_links_ask_of_the_joints() -> None:
    """p' - C^T q' + g = M q'' + C q' + g, by differences of the momentum along a motion."""
    robot = Planar((0.4, 0.3), (1.2, 0.8))
    load = load_provider(robot, robot.with_payload("tip", 1.0))
    rng = np.random.default_rng(461)
    joints = [Sines(rng, 0.8, 3.0, 10.0) for _ in range(2)]
    h = 1e-4
    t = 0.3 + h * np.arange(-2, 3)
    q, dq, ddq = (np.stack([s(t, n) for s in joints], axis=1) for n in range(3))
    said = [load(a, b) for a, b in zip(q, dq, strict=True)]
    heavy = robot.with_payload("tip", 1.0)
    for arm_of, momentum, force in (
        (robot, "momentum", "force"),
        (None, "payload_momentum", "payload_force"),
    ):
        p = [getattr(one, momentum) for one in said]
        rate = (8.0 * (p[3] - p[1]) - (p[4] - p[0])) / (12.0 * h)
        asked = rate - getattr(said[2], force)
        expected = heavy.inverse_dynamics(q[2], dq[2], ddq[2])
        bare = robot.inverse_dynamics(q[2], dq[2], ddq[2])
        expected = bare if arm_of is robot else expected - bare
        # h^4 / 30 of fifth derivatives of 10 rad/s: 1e-12 of it; rounding of p = 1 over h: 1e-11.
        assert asked == pytest.approx(expected, abs=1e-9)
