"""What is wrong with a model is said, and nothing is said of a right one: many seeds at once."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.kernels import status
from rotatum.kernels.status import (
    DRIFT,
    INCONSISTENT,
    INFORMATIVE,
    LAG,
    NEGATIVE,
    OFFSET,
    VELOCITY,
    WRONG,
)
from rotatum.models import device_from_tables
from rotatum.runtime.bank import Bank
from tests.kernels.make import Sines
from tests.kernels.rowbank import RowBank

T = 1e-3
SECONDS = 12
INERTIA, STIFFNESS = 0.3, 150.0
NOISE = 0.05  # N m, white: 5 % of a typical elastic torque


def joint(**changes: Any) -> Any:
    """A joint whose weak rows fit a stiffness and an offset: one term, two columns."""
    tables = {
        "name": "one",
        "motor": {"inertia": INERTIA},
        "transmission": {"zero": 0.0},
        "estimator": {"method": "weak", "cutoff": 100.0, "fit": ["offset"]},
    }
    device = device_from_tables(tables | changes, "test")
    return Estimator(device, period=T).prepared[0]


class Motion:
    """Motors and deflections moving as sums of sines, one per seed."""

    def __init__(self, seeds: int, low: float = 2.0) -> None:
        self.t = np.arange(round(SECONDS / T)) * T
        pairs = []
        for seed in range(seeds):
            rng = np.random.default_rng([70, seed])
            pairs.append((Sines(rng, 0.3, low, 30.0), Sines(rng, 0.02, low, 30.0)))
        self.theta = np.stack([m(self.t) for m, _ in pairs], axis=1)
        self.thrust = np.stack([INERTIA * m(self.t, 2) for m, _ in pairs], axis=1)
        self.phi = np.stack([d(self.t) for _, d in pairs], axis=1)
        self.bend = np.stack([d(self.t, 2) for _, d in pairs], axis=1)
        noise = np.random.default_rng(71).standard_normal(self.phi.shape)
        self.noise = NOISE * noise

    def moved(self, theta: np.ndarray) -> Motion:
        """The same deflections, with motors that move as some multiple of them."""
        other = copy(self)
        other.theta = theta
        other.thrust = INERTIA * self.bend * theta[1] / self.phi[1]
        return other

    def run(self, elastic: np.ndarray, *, q: np.ndarray | None = None, **changes: Any) -> Any:
        """Readings of every sample and seed, the true elastic torque being given."""
        prepared = joint(**changes)
        seeds = self.phi.shape[1]
        bank = Bank(prepared.stage, np.repeat(prepared.params, seeds))
        u = prepared.stage.input.zeros(*self.phi.shape)
        u["time"], u["enable"] = self.t[:, None], 1
        u["theta"] = self.theta
        u["q"] = self.theta + self.phi if q is None else q
        u["tau"] = self.thrust - elastic + self.noise
        return bank.run(u)


@pytest.fixture(scope="module")
def motion() -> Motion:
    return Motion(40)


@pytest.fixture(scope="module")
def quick() -> Motion:
    return Motion(40, low=10.0)


def test_a_right_model_is_informative_and_nothing_is_wrong_with_it(motion):
    out = motion.run(STIFFNESS * motion.phi)
    assert (out["verdict"][-1] == INFORMATIVE).all()
    # A probe speaks by chance once in 700, three times in a row, and beyond 2 % of the stiffness:
    # never in 40 runs of 94 evaluations, at any time.
    assert not (out["status"] & WRONG).any()
    off = np.abs(out["stiffness"][-1] - STIFFNESS) / out["stiffness_std"][-1]
    assert (off < 1.96).mean() > 0.85  # 95 % of 40, less three of its deviations
    assert (out["stiffness_std"][-1] < 0.02 * STIFFNESS).all()


def test_encoders_that_do_not_read_at_once_are_a_velocity(motion):
    # The link read 3 ms late: the deflection is off by 3 ms times its velocity, most of which is
    # the motor's, so that the slope is attenuated and no shift of the fitted torque shows it.
    late = np.roll(motion.theta + motion.phi, 3, axis=0)
    late[:3] = late[3]
    out = motion.run(STIFFNESS * motion.phi, q=late)[-1]
    off = np.abs(out["stiffness"] / STIFFNESS - 1.0)
    half = 1.96 * out["stiffness_std"] / STIFFNESS
    assert np.median(off) > 0.1
    # Whoever is off by more than 3 % and the interval is told; nobody else need be.
    told = out["status"] & VELOCITY != 0
    assert told[off > np.maximum(half, 0.03)].mean() > 0.9


def test_a_torque_that_follows_the_deflection_late_is_a_lag(quick):
    # 20 ms at 10 to 30 rad/s: a phase of 0.2 to 0.6, so that 4 to 30 % of the torque's power is
    # out of phase with the deflection. Below 2 % nobody's stiffness is off, and nothing is said.
    late = np.roll(quick.phi, 20, axis=0)
    out = quick.run(STIFFNESS * late)
    assert (out["status"][-1] & LAG != 0).mean() > 0.95
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.95
    little = quick.run(STIFFNESS * np.roll(quick.phi, 2, axis=0))
    assert not (little["status"] & WRONG).any()
    assert np.abs(little["stiffness"][-1] / STIFFNESS - 1.0).max() < 0.01


def test_a_late_link_encoder_is_a_lag(quick):
    # With the motor moving against the link, q is a copy of the deflection, and late: 20 ms.
    against = quick.moved(-2.0 * quick.phi)
    out = against.run(STIFFNESS * quick.phi, q=np.roll(-quick.phi, 20, axis=0))
    assert (out["status"][-1] & LAG != 0).mean() > 0.95
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.95


@pytest.mark.parametrize("factor", [0.5, 0.8, 0.95, 1.3])
def test_a_wrong_inertia_is_said_wherever_it_moves_the_stiffness(motion, factor):
    # The link is held: theta = -phi, and what is wrong of the inertia bends the torque.
    held = motion.moved(-motion.phi)
    last = held.run(STIFFNESS * motion.phi, motor={"inertia": factor * INERTIA})[-1]
    off = np.abs(last["stiffness"] / STIFFNESS - 1.0)
    half = 1.96 * last["stiffness_std"] / last["stiffness"]
    wrong = off > np.maximum(0.03, half)  # the tolerated 2 %, and a margin; beyond the interval
    flagged = last["status"] & status.INERTIA != 0
    assert wrong.sum() >= 3
    assert flagged[wrong].mean() > 0.9
    assert (last["verdict"][wrong] == INCONSISTENT).mean() > 0.9
    assert not flagged[off < 0.01].any()


def test_the_right_inertia_of_a_held_link_is_not_wrong(motion):
    out = motion.moved(-motion.phi).run(STIFFNESS * motion.phi)
    assert not (out["status"] & WRONG).any()


def test_a_stiffness_that_changes_is_a_drift(motion):
    half = motion.t[:, None] > 0.5 * SECONDS
    out = motion.run(STIFFNESS * np.where(half, 1.3, 1.0) * motion.phi)
    before = out[round(0.5 * SECONDS / T) - 1]
    assert (before["verdict"] == INFORMATIVE).all()
    # A memory of 10 s against 6 s of the new stiffness; all data together lie in between.
    # Where the interval has widened to the drift itself, there is nothing to say.
    last = out[-1]
    flagged = last["status"] & DRIFT != 0
    assert flagged.mean() > 0.8
    assert (1.96 * last["stiffness_std"] > 0.05 * last["stiffness"])[~flagged].all()
    assert (last["verdict"][flagged] == INCONSISTENT).all()


def test_a_wrong_sign_is_negative(motion):
    out = motion.run(-STIFFNESS * motion.phi)
    assert (out["status"][-1] & NEGATIVE != 0).all()
    assert (out["verdict"][-1] == INCONSISTENT).all()


def test_a_joint_that_does_not_move_is_starved_and_never_wrong(motion):
    out = motion.run(0.0 * motion.phi, q=motion.theta)
    assert (out["verdict"] == 0).all()
    assert not (out["status"] & WRONG).any()


# --- rows that are given: what an offset column would hide ---------------------------------------


SLOPE = (1.0, 0.0)  # of x and x^3 at rest


def given(seed, n, joints):
    rng = np.random.default_rng(seed)
    t = np.arange(n) * T
    tones = [Sines(np.random.default_rng([seed, j]), 2.0, 10.0, 60.0) for j in range(joints)]
    x = np.stack([tone(t) for tone in tones], axis=1)
    R = np.stack([x, x**3], axis=2)
    return R, R @ [40.0, 10.0] + 0.5 * rng.standard_normal((n, joints))


def test_a_wrong_zero_is_an_offset():
    R, y = given(72, 12_000, 40)
    right = RowBank(40, terms=2, memory=0.9984).run(R, y, D=SLOPE)
    assert not (right["status"] & WRONG).any()
    # 0.4 of the torque's rms: 16 % of its power.
    wrong = RowBank(40, terms=2, memory=0.9984).run(R, y + 0.4 * y.std(axis=0), D=SLOPE)
    last = wrong[-1]
    flagged = last["status"] & OFFSET != 0
    # Said, but for intervals that the offset itself has made as wide.
    assert flagged.mean() > 0.7
    assert (1.96 * last["stiffness_std"] > 0.1 * last["stiffness"])[~flagged].all()
    assert (last["verdict"][flagged] == INCONSISTENT).all()


def test_a_probe_that_no_longer_finds_anything_falls_silent():
    # Wrong for 6 s, right for 30 s: with a memory of 1 s the tests forget, and so does the verdict.
    R, y = given(73, 36_000, 8)
    y[:6000] += 0.6 * y.std(axis=0)
    bank = RowBank(8, terms=2, memory=0.984, forgetting=0.999)
    params = bank.bank.params
    params["solver"]["forgetting"] = 0.999
    lengths = 16 * 2.0 ** np.arange(20)
    params["sums"]["fade"] = params["sums"]["fade_single"] = 0.999 ** (2.0 * lengths)
    out = bank.run(R, y, D=SLOPE)
    assert (out["status"][:6000] & OFFSET != 0).any(axis=0).mean() > 0.7
    assert not (out["status"][-1] & WRONG).any()
    assert (out["verdict"][-1] == INFORMATIVE).all()
