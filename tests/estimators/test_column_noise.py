"""What the positions' noise does to columns and left side, against rows of noise alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rotatum.estimators.measured import Measured
from rotatum.estimators.noise import column_noise
from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.kernels.link import AHEAD
from rotatum.models import device_from_tables
from tests.kernels.driven import T, drive, starts

LINK, MOTOR = 3e-4, 1e-4  # rad
B, M = 0.02, 0.05
SAMPLES = 15_000


def prepared(request: Request, *, arm: bool = False) -> Prepared:
    tables: dict[str, object] = {
        "name": "one",
        "motor": {"inertia": B},
        "link": {"inertia": M},
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.1, "orders": 2},
    }
    device = device_from_tables(tables, "test")
    settings = settle(device.joints[0], device, T, request)
    return prepare(device.joints[0], settings, period=T, holds={}, zeros=[0.0], arm=arm)


def rows_of_noise(one: Prepared, **more: Any) -> Any:
    """Rows where nothing moves but the noise of both encoders."""
    rng = np.random.default_rng(450)
    q, theta = LINK * rng.standard_normal(SAMPLES), MOTOR * rng.standard_normal(SAMPLES)
    if one.shape.arm:
        speed = np.convolve(q, (-1.0, 8.0, 0.0, -8.0, 1.0), "full")[: len(q)] / (12.0 * T)
        more["momentum"] = M * speed
    stage, params = rows_stage(one.shape), one.parts[0]["rows"]
    out = drive(stage, params, q=q, theta=theta, enable=1, fresh=starts(len(q)), **more)
    return out[out["valid"] == 1]


MOTOR_FIT = ("inertia", "damping", "transmission_damping")
LINK_FIT = ("link_damping", "skew", "transmission_damping")
CASES = {
    "poles": Request(cutoff=300.0, fit=MOTOR_FIT),
    "three poles": Request(cutoff=300.0, order=3, fit=("skew", "offset")),
    "window": Request(window=0.02, stride=1, order=2, fit=("damping",)),
    "algebraic": Request("algebraic", window=0.02, stride=1, fit=MOTOR_FIT),
    "link": Request(side="link", cutoff=300.0, fit=LINK_FIT),
    "link, window": Request(side="link", window=0.02, stride=1, fit=LINK_FIT),
}


@pytest.mark.parametrize("name", list(CASES))
def test_columns_carry_as_much_noise_as_is_said(name: str) -> None:
    request = CASES[name]
    one = prepared(Request(**{**vars(request), "measured": Measured(LINK, MOTOR)}))
    fitted = "inertia" in one.settings.fit
    known = M if one.settings.side == "link" else (0.0 if fitted else B)
    told = column_noise(one.joint, one.settings, one.powers, known, False)
    out = rows_of_noise(one)
    line = one.columns.index("phi^1")
    # 15,000 rows, correlated over ten: variances are known to 3.7 %. Three of it.
    for h in range(line + 1):
        assert out["R"][:, h].var() == pytest.approx(told.columns[h], rel=0.11, abs=1e-20)
    assert told.columns[one.columns.index("phi^3")] == 0.0  # no noise of its own at no deflection
    assert out["suspect"].var() == pytest.approx(told.acceleration, rel=0.11)
    # What y and the deflection have in common is B <n'^2>, on either side of the joint. A fitted
    # inertia is not known: that it is in y all the same goes by its own column.
    shared = 0.0 if fitted else np.cov(out["y"], out["R"][:, line])[0, 1]
    size = out["y"].std() * out["R"][:, line].std()
    assert told.common[line] == pytest.approx(shared, abs=0.05 * size)
    assert fitted or told.common[line] > 0.1 * size  # and it is no small share


def test_a_residual_and_its_basis_have_next_to_no_noise_in_common() -> None:
    one = prepared(Request("residual", fit=(), measured=Measured(LINK, MOTOR)))
    told = column_noise(one.joint, one.settings, one.powers, B, False)
    out = rows_of_noise(one)
    # A twentieth of what white noise through the same filter would share, B 2 var(n) / T^2.
    whole = B * 2.0 * MOTOR**2 / T**2 / 0.1
    assert abs(np.cov(out["y"], out["R"][:, 0])[0, 1]) < whole / 20.0
    assert told.common == (0.0, 0.0)
    # The kinematic filter before the basis takes some of its noise: what is said is an upper bound.
    assert 0.5 * told.columns[0] < out["R"][:, 0].var() < told.columns[0]


def test_the_momentum_of_an_arm_is_a_longer_difference() -> None:
    request = Request(
        side="link", cutoff=300.0, fit=("link_damping",), measured=Measured(LINK, MOTOR)
    )
    one = prepared(request, arm=True)
    assert int(one.parts[0]["rows"]["link"]["delay"]) == AHEAD
    told = column_noise(one.joint, one.settings, one.powers, M, True)
    out = rows_of_noise(one)
    assert out["R"][:, 0].var() == pytest.approx(told.columns[0], rel=0.11)
    # Of the deflection Simpson's mean, not the hat's: a little more of what is fast.
    assert out["R"][:, 1].var() == pytest.approx(told.columns[1], rel=0.115)
    # y is the momentum's difference: nothing else moves.
    assert out["y"].var() == pytest.approx(M**2 * told.acceleration, rel=0.11)
    shared = np.cov(out["y"], out["R"][:, 1])[0, 1]
    size = out["y"].std() * out["R"][:, 1].std()
    assert told.common[1] == pytest.approx(shared, abs=0.05 * size)
