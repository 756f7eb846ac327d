"""What is wrong with a model is said, and nothing is said of a right one: many seeds at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.kernels.status import (
    CURVATURE,
    DRIFT,
    INCONSISTENT,
    INFORMATIVE,
    LAG,
    NEGATIVE,
    OFFSET,
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

    def __init__(self, seeds: int) -> None:
        self.t = np.arange(round(SECONDS / T)) * T
        pairs = []
        for seed in range(seeds):
            rng = np.random.default_rng([70, seed])
            pairs.append((Sines(rng, 0.3, 2.0, 30.0), Sines(rng, 0.02, 2.0, 30.0)))
        self.theta = np.stack([m(self.t) for m, _ in pairs], axis=1)
        self.thrust = np.stack([INERTIA * m(self.t, 2) for m, _ in pairs], axis=1)
        self.phi = np.stack([d(self.t) for _, d in pairs], axis=1)
        self.late = np.stack([d(self.t - 3.0 * T) for _, d in pairs], axis=1)
        noise = np.random.default_rng(71).standard_normal(self.phi.shape)
        self.noise = NOISE * noise

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


def test_a_right_model_is_informative_and_nothing_is_wrong_with_it(motion):
    out = motion.run(STIFFNESS * motion.phi)
    assert (out["verdict"][-1] == INFORMATIVE).all()
    # A probe speaks by chance once in 700, three times in a row, and beyond 2 % of the stiffness:
    # never in 40 runs of 94 evaluations, at any time.
    assert not (out["status"] & WRONG).any()
    off = np.abs(out["stiffness"][-1] - STIFFNESS) / out["stiffness_std"][-1]
    assert (off < 1.96).mean() > 0.85  # 95 % of 40, less three of its deviations
    assert (out["stiffness_std"][-1] < 0.02 * STIFFNESS).all()


def test_a_delayed_link_encoder_is_a_lag(motion):
    # q read 3 ms late: at 20 rad/s the deflection is off by 6 % of q, of which phi is a tenth.
    late = np.roll(motion.theta + motion.phi, 3, axis=0)
    late[:3] = late[3]
    out = motion.run(STIFFNESS * motion.phi, q=late)
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.95


def test_a_torque_that_follows_the_deflection_late_is_a_lag(motion):
    out = motion.run(STIFFNESS * motion.late)
    # 3 ms at 2 to 30 rad/s: the torque of a damper of K times 3 ms, up to 9 % of it.
    assert (out["status"][-1] & LAG != 0).mean() > 0.95
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.95


def test_a_wrong_inertia_is_a_curvature(motion):
    # The motor moves with the spring here (a motor against a fixed link): theta = -phi, so that
    # an inertia which is not there bends the torque: B w^2 / K is 0.3 * 30^2 / 150 at the top.
    still = Motion.__new__(Motion)
    still.__dict__ = dict(motion.__dict__)
    t, phi = motion.t, motion.phi
    still.theta = -phi
    bend = np.gradient(np.gradient(phi, t, axis=0), t, axis=0)  # h^2 / 6 w^4: 2e-4 of it
    still.thrust = -INERTIA * bend
    wrong = still.run(STIFFNESS * phi, motor={"inertia": 0.8 * INERTIA})
    assert (wrong["status"][-1] & CURVATURE != 0).mean() > 0.95
    assert (wrong["verdict"][-1] == INCONSISTENT).mean() > 0.95
    right = still.run(STIFFNESS * phi)
    assert not (right["status"] & WRONG).any()


def test_a_stiffness_that_changes_is_a_drift(motion):
    half = motion.t[:, None] > 0.5 * SECONDS
    out = motion.run(STIFFNESS * np.where(half, 1.3, 1.0) * motion.phi)
    before = out[round(0.5 * SECONDS / T) - 1]
    assert (before["verdict"] == INFORMATIVE).all()
    # A memory of 10 s against 6 s of the new stiffness; all data together lie in between.
    assert (out["status"][-1] & DRIFT != 0).mean() > 0.9
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.95


def test_a_wrong_sign_is_negative(motion):
    out = motion.run(-STIFFNESS * motion.phi)
    assert (out["status"][-1] & NEGATIVE != 0).all()
    assert (out["verdict"][-1] == INCONSISTENT).all()


def test_a_joint_that_does_not_move_is_starved_and_never_wrong(motion):
    out = motion.run(0.0 * motion.phi, q=motion.theta)
    assert (out["verdict"] == 0).all()
    assert not (out["status"] & WRONG).any()


# --- rows that are given: what an offset column would hide ---------------------------------------


def given(seed, n=6000, joints=40):
    rng = np.random.default_rng(seed)
    x = np.stack(
        [Sines(np.random.default_rng([seed, j]), 2.0, 2.0, 30.0)(np.arange(n) * T) for j in range(joints)],
        axis=1,
    )
    R = np.stack([x, x**3], axis=2)
    return R, R @ [40.0, 10.0] + 0.5 * rng.standard_normal((n, joints))


def test_a_wrong_zero_is_an_offset():
    R, y = given(72)
    bank = RowBank(40, terms=2, memory=0.9999)
    assert not (bank.run(R, y)["status"] & WRONG).any()
    bank = RowBank(40, terms=2, memory=0.9999)
    out = bank.run(R, y + 12.0)  # a tenth of the torque's range
    assert (out["status"][-1] & OFFSET != 0).mean() > 0.9
    assert (out["verdict"][-1] == INCONSISTENT).mean() > 0.9


def test_a_probe_that_no_longer_finds_anything_falls_silent():
    # Wrong for 3 s, right for 30 s: with a memory of 1 s the tests forget, and so must the verdict.
    R, y = given(73, n=33_000, joints=8)
    y[:3000] += 30.0
    bank = RowBank(8, terms=2, memory=0.999, forgetting=0.999)
    params = bank.bank.params
    params["solver"]["forgetting"] = 0.999
    lengths = 16 * 2.0 ** np.arange(20)
    params["sums"]["fade"] = params["sums"]["fade_single"] = 0.999 ** (2.0 * lengths)
    out = bank.run(R, y)
    assert (out["status"][2999] & OFFSET != 0).mean() > 0.7
    assert not (out["status"][-1] & WRONG).any()
    assert (out["verdict"][-1] == INFORMATIVE).all()
