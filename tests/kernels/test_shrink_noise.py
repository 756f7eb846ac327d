"""What shrinking high orders is worth, and what it costs: the whole estimator on many noises."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kernels.rowbank import RowBank

ORDERS, ROWS, JOINTS = 4, 4096, 200


def odd(x):
    return np.stack([x ** (2 * k + 1) for k in range(ORDERS)], axis=-1)


def slopes(x):
    return np.stack([(2 * k + 1) * x ** (2 * k) for k in range(ORDERS)], axis=-1)


def estimates(truth, noise, first, *, seed=90):
    """Readings of joints that move over their whole range, and their coefficients' errors."""
    rng = np.random.default_rng(seed)
    x = np.sin(
        np.cumsum(rng.uniform(0.002, 0.02, (ROWS, JOINTS)), axis=0) + 6.0 * rng.random(JOINTS)
    )
    R = odd(x)
    y = R @ truth + noise * rng.standard_normal((ROWS, JOINTS))
    bank = RowBank(JOINTS, columns=ORDERS, terms=ORDERS, first=first)
    out = bank.run(R, y, D=slopes(x))
    off = out["stiffness"][-1] - slopes(x[-1]) @ truth
    error = slopes(np.linspace(-1.0, 1.0, 41)) @ (out["coefficients"][-1] - truth).T
    return out[-1], off, float((error**2).mean()), bank.bank.state


@pytest.mark.parametrize("seed", [90, 91, 92])
def test_orders_that_are_not_there_cost_little(seed):
    truth = np.array([40.0, 0.0, 0.0, 0.0])
    shrunk, off, less, _ = estimates(truth, 1.0, 1, seed=seed)
    _, _, full, _ = estimates(truth, 1.0, None, seed=seed)
    assert less < full / 3.0
    # And the interval knows: it covers, at a fraction of the width.
    covered = (np.abs(off) < 1.96 * shrunk["stiffness_std"]).mean()
    assert covered > 0.92  # 95 % of 200, less two of its deviations


def test_orders_beyond_doubt_are_least_squares():
    truth = np.array([40.0, 20.0, -10.0, 5.0])
    shrunk, off, less, state = estimates(truth, 1e-3, 1)
    _, _, full, _ = estimates(truth, 1e-3, None)
    assert less == pytest.approx(full, rel=1e-3)
    assert (state["shrink"]["weight"] > 1.0 - 1e-4).all()
    assert (np.abs(off) < 1.96 * shrunk["stiffness_std"]).mean() > 0.92


@pytest.mark.parametrize("size", [0.1, 0.3, 3.0])
def test_what_shrinking_takes_is_in_the_interval(size):
    # The seventh power at which a weight is between 0 and 1, where shrinking costs most.
    out, off, _, state = estimates(np.array([40.0, 0.0, 0.0, size]), 1.0, 1)
    covered = (np.abs(off) < 1.96 * out["stiffness_std"]).mean()
    noise = (np.abs(off) < 1.96 * np.sqrt(state["readout"]["noise2"])).mean()
    # Not the 95 % of an order that is there or is not: how much was taken is itself uncertain.
    assert covered > 0.75
    assert covered > noise + 0.05
