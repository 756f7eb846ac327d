"""Two transmissions on one link: sums, what their errors have in common, and rows both need."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from rotatum.estimators import Estimator
from rotatum.kernels import pair
from rotatum.kernels.status import (
    CONVERGING,
    INCONSISTENT,
    LAG,
    NEGATIVE,
    PRIOR,
    SETTLING,
    STARVED,
    VERDICTS,
    WIDE,
)
from rotatum.models import device_from_tables
from rotatum.runtime.bank import Bank
from tests import naive
from tests.kernels.make import Sines, plain, record
from tests.kernels.rowbank import PairBank, RowBank

TRUTH = np.array([[3.0, 40.0], [-2.0, 25.0]])  # agonist, antagonist; the spring's column is last
LARGER = 2.5  # deflections of the antagonist


def rows(seed, n, joints, *, rho, sign=1.0, slow=0.95):
    """Rows of both sides whose noises correlate by ``rho``, regressors the same but for a factor.

    Least squares then has errors in the springs' coefficients that correlate by ``sign rho``, the
    antagonist's ``LARGER`` times smaller.
    """
    rng = np.random.default_rng(seed)
    colour = [math.sqrt(1.0 - slow**2)], [1.0, -slow]
    one = signal.lfilter(*colour, rng.standard_normal((n, joints, 1, 2)), axis=0)
    R = np.concatenate([one, sign * LARGER * one], axis=2)
    noise = rng.standard_normal((n, joints, 2))
    noise[..., 1] = rho * noise[..., 0] + math.sqrt(1.0 - rho**2) * noise[..., 1]
    return R, (R * TRUTH).sum(axis=3) + signal.lfilter(*colour, noise, axis=0)


# --- sums -----------------------------------------------------------------------------------------


def test_each_side_is_what_it_would_be_alone_and_the_total_their_sum():
    R, y = rows(100, 2048, 3, rho=0.5, sign=-1.0)
    out = PairBank(3).run(R, y)
    for i in (0, 1):
        alone = RowBank(3).run(np.ascontiguousarray(R[:, :, i]), np.ascontiguousarray(y[:, :, i]))
        for name in ("stiffness", "torque", "dstiffness", "row_torque", "row_fit", "verdict"):
            assert np.array_equal(out[f"part_{name}"][:, :, i], alone[name])
        # Block sums of a part are found behind the other one's: the same numbers.
        assert np.array_equal(out["part_stiffness_std"][:, :, i], alone["stiffness_std"])
        assert np.array_equal(out["coefficients"][:, :, 2 * i : 2 * i + 2], alone["coefficients"])
        mine = out["coefficients_std"][:, :, 2 * i : 2 * i + 2]
        assert np.array_equal(mine, alone["coefficients_std"])
    for name in ("stiffness", "torque", "dstiffness", "row_torque", "row_fit"):
        parts = out[f"part_{name}"]
        assert np.array_equal(out[name], parts[:, :, 0] + parts[:, :, 1])
    # Noise of std 1 over 2048 rows, inflated by its colour: 0.2 on a total of 65; five of them.
    assert out["stiffness"][-1] == pytest.approx(TRUTH[:, 1].sum(), abs=1.0)


def readings():
    """A pair whose parts' readings are as they are set here."""
    found = []
    for scale in (1.0, 3.0):
        reading = SimpleNamespace(
            stiffness=10.0 * scale, torque=scale, dstiffness=-scale, deflection=0.1 * scale,
            row_torque=5.0 * scale, row_fit=4.0 * scale, noise=4.0 - scale, inflation=scale,
            informative_deflection=0.2 * scale, rows=7, stiffness_std=0.5, torque_std=scale,
            verdict=2, status=0, coefficients=[scale, 2.0], coefficients_std=[0.1, 0.2],
        )  # fmt: skip
        readout = SimpleNamespace(noise2=scale**2, wrong2=0.25 * scale**2)
        evidence = SimpleNamespace(wrong=0)
        found.append(SimpleNamespace(reading=reading, readout=readout, evidence=evidence))
    return found


def test_quantities_that_do_not_add_up():
    first, second = readings()
    out = plain(record(pair.PairReading, {"v": 4}))
    pair.read(SimpleNamespace(correlation=0.25), first, second, out)
    assert out.deflection == pytest.approx(0.2)  # the mean
    assert out.noise == pytest.approx(math.hypot(3.0, 1.0))
    assert out.inflation == 3.0  # the larger
    assert out.informative_deflection == 0.2  # the smaller
    assert (out.rows, out.correlation) == (7, 0.25)
    assert out.coefficients == [1.0, 2.0, 3.0, 2.0]


# --- standard deviation and verdict of the total --------------------------------------------------


def told(first, second, *, correlation=0.0, stiffness=40.0, link2=0.0, motor2=0.0):
    """What is said of the total; its parts' stiffnesses change by 7 and -3 N m/rad^2."""
    thresholds = {"starved": 0.5, "informative": 0.1, "hold": 1.0, "shrink": 0.01}
    params, state = (
        SimpleNamespace(period=0.25, link2=link2, motor2=motor2, **thresholds),
        SimpleNamespace(narrow=0, good=0, since=0.0, converged=0, converged_at=0.0),
    )
    out = SimpleNamespace(stiffness=stiffness, part_dstiffness=[7.0, -3.0])
    pair.tell(params, state, SimpleNamespace(correlation=correlation), first, second, 1.0, 1, out)
    return out


@pytest.mark.parametrize("r", [-0.5, 0.0, 0.8, 1.0])
def test_noise_adds_with_its_correlation_and_systematic_errors_straight(r):
    out = told(*readings(), correlation=r)
    noise = 1.0 + 9.0 + 2.0 * r * 1.0 * 3.0
    assert out.stiffness_std == pytest.approx(math.sqrt(noise + (0.5 + 1.5) ** 2))
    # Parts of 1 and 3; the sign of what their torques share depends on the deflections'.
    assert out.torque_std == pytest.approx(math.sqrt(1.0 + 9.0 + 2.0 * abs(r) * 3.0))


def test_the_link_is_read_by_both_laws_and_each_motor_by_one():
    """Against sampling: where q is off both deflections are, where a motor is only one is."""
    link, motor = 0.3, 0.2
    out = told(*readings(), link2=link**2, motor2=motor**2)
    bare = told(*readings())
    rng = np.random.default_rng(106)
    q, first, second = rng.standard_normal((3, 200_000)) * [[link], [motor], [motor]]
    read = (7.0 * (q - first) - 3.0 * (q - second)).var()
    # A variance from 200,000 samples is known to 0.3 %.
    assert out.stiffness_std**2 - bare.stiffness_std**2 == pytest.approx(read, rel=0.01)


def test_a_total_may_be_sure_where_its_parts_are_not():
    first, second = readings()
    first.reading.status, second.reading.status = WIDE, WIDE | SETTLING
    out = told(first, second, correlation=-0.5)
    assert 1.96 * out.stiffness_std < 0.5 * out.stiffness
    assert (out.verdict, out.status) == (CONVERGING, SETTLING)
    assert told(first, second, stiffness=7.0).status == WIDE | SETTLING  # and on its own account


def test_what_one_side_lacks_the_total_lacks():
    first, second = readings()
    second.reading.status = PRIOR
    assert told(first, second).verdict == STARVED
    # A negative sum is no finding while the prior rules one of them.
    assert told(first, second, stiffness=-40.0).status == PRIOR
    second.reading.status = 0
    out = told(first, second, stiffness=-40.0)
    assert (out.verdict, out.status) == (INCONSISTENT, NEGATIVE)
    second.evidence.wrong = LAG
    assert told(first, second).verdict == INCONSISTENT
    assert told(first, second).status == LAG


# --- correlation in Monte Carlo -------------------------------------------------------------------


@pytest.mark.parametrize(("rho", "sign"), [(0.8, 1.0), (0.4, -1.0), (-0.4, 1.0), (0.0, 1.0)])
def test_a_known_correlation_is_found_and_makes_the_interval_right(rho, sign):
    joints, r = 300, sign * rho
    out = PairBank(joints).run(*rows(101, 4096, joints, rho=rho, sign=sign))[-1]
    off = out["part_stiffness"] - TRUTH[:, 1]
    assert np.corrcoef(off.T)[0, 1] == pytest.approx(r, abs=0.1)  # known to 0.06 at r = 0
    # 16 blocks or more: each joint's is good to (1 - r^2) / 4, their median far better.
    assert np.median(out["correlation"]) == pytest.approx(r, abs=0.1)
    total = np.abs(out["stiffness"] - TRUTH[:, 1].sum())
    covered = (total < 1.96 * out["stiffness_std"]).mean()
    assert 0.90 <= covered <= 0.99
    # Of the width for independent errors: variances n, m and 2 r sqrt(n m) against n and m.
    apart = np.hypot(*out["part_stiffness_std"].T)
    expected = math.sqrt(1.0 + 2.0 * r * LARGER / (1.0 + LARGER**2))
    assert np.median(out["stiffness_std"] / apart) == pytest.approx(expected, rel=0.1)


def test_errors_that_seem_to_cancel_are_believed_to_a_half():
    joints = 300
    out = PairBank(joints).run(*rows(101, 4096, joints, rho=-0.95))[-1]
    assert out["correlation"].min() == pair.LEAST == -0.5
    assert np.median(out["correlation"]) == pair.LEAST
    apart = np.hypot(*out["part_stiffness_std"].T)
    # 1 - sqrt(n_1 n_2) / (n_1 + n_2) of the variance of independent errors, a half at least.
    assert (out["stiffness_std"] > 0.999 * math.sqrt(0.5) * apart).all()
    total = np.abs(out["stiffness"] - TRUTH[:, 1].sum())
    assert (total < 1.96 * out["stiffness_std"]).mean() > 0.95


def test_noise_of_the_link_encoder_is_in_both():
    """The rows of `weak` themselves: q is noisy, and so are both torques on their own."""
    seeds, T, B, K = 150, 1e-3, 0.3, (150.0, 90.0)
    tables = {
        "name": "pair",
        "actuation": "antagonistic",
        "motor": [{"inertia": B}, {"inertia": B}],
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.05, "orders": 2},
        "estimator": {"method": "weak", "cutoff": 100.0, "fit": ["offset"]},
    }
    prepared = Estimator(device_from_tables(tables, "test"), period=T).prepared[0]
    rng = np.random.default_rng(102)
    t = np.arange(6000) * T
    q, phi = Sines(rng, 0.3, 2.0, 30.0), Sines(rng, 0.02, 2.0, 30.0)
    noise = 2e-4  # rad
    for sign in (1.0, -1.0):
        bank = Bank(prepared.stage, np.repeat(prepared.params, seeds))
        u = prepared.stage.input.zeros(len(t), seeds)
        u["time"], u["enable"] = t[:, None], 1
        u["q"] = q(t)[:, None] + noise * rng.standard_normal(u.shape)
        for end, k, way in (("1", K[0], 1.0), ("2", K[1], sign)):
            torque = B * (q(t, 2) - way * phi(t, 2)) - k * way * phi(t)
            u[f"theta{end}"] = (q(t) - way * phi(t))[:, None]
            # Half of what the encoder's noise is worth: of the rows' variance it has four fifths.
            own = 0.5 * k * noise * rng.standard_normal(u.shape)
            u[f"tau{end}"] = torque[:, None] + own
        out = bank.run(u)[-1]
        off = out["part_stiffness"] - K
        # Least squares' errors: q's noise times both stiffnesses, along regressors of this sign.
        assert np.corrcoef(off.T)[0, 1] == pytest.approx(0.8 * sign, abs=0.1)
        believed = max(0.8 * sign, pair.LEAST)
        assert np.median(out["correlation"]) == pytest.approx(believed, abs=0.1)
        total = np.abs(out["stiffness"] - sum(K))
        covered = (total < 1.96 * out["stiffness_std"]).mean()
        # Errors that cancel beyond what is believed leave the interval too wide, on purpose.
        assert 0.90 <= covered <= (0.99 if sign > 0.0 else 1.0)
        assert {VERDICTS[v] for v in out["verdict"]} == {"informative"}


# --- both or none ---------------------------------------------------------------------------------


def test_a_row_that_one_side_lacks_is_learnt_by_neither():
    R, y = rows(103, 1500, 1, rho=0.3)
    rng = np.random.default_rng(104)
    gone = rng.random((1500, 2)) < 0.2
    # Where one side is not valid the other reads nonsense: it must not be seen.
    wild = np.where(gone[:, None, ::-1], 1e6, y)
    bank = PairBank()
    u = bank.input(R, wild)
    u["first"]["valid"], u["second"]["valid"] = ~gone[:, :1], ~gone[:, 1:]
    out = bank.bank.run(u)[-1, 0]
    both = ~gone.any(axis=1)
    assert out["rows"] == both.sum()
    for i in (0, 1):
        spread, centre = np.full(2, 1e8), np.zeros(2)
        alpha, _ = naive.ridge(R[both, 0, i], y[both, 0, i], spread=spread, centre=centre)
        found = out["coefficients"][2 * i : 2 * i + 2]
        np.testing.assert_allclose(found, alpha, rtol=1e-7)  # rounding of the first rows


@pytest.mark.parametrize(("one", "other"), [(0, 1), (1, 0), (0, 0), (1, 1)])
def test_rows_start_and_stop_together(one, other):
    first = SimpleNamespace(valid=one, fresh=1 - one, status=SETTLING if not one else 0)
    second = SimpleNamespace(valid=other, fresh=1 - other, status=0)
    pair.together(first, second)
    assert first.valid == second.valid == one * other
    assert bool(first.fresh) == bool(second.fresh) == (one * other == 0)
    assert first.status == second.status == (0 if one else SETTLING)


def test_a_restart_of_one_side_is_a_cut_for_both():
    R, y = rows(105, 40, 1, rho=0.3)
    bank = PairBank()
    u = bank.input(R, y)
    u["second"]["fresh"][25], u["second"]["valid"][25] = 1, 0
    bank.bank.run(u)
    state = bank.bank.state[0]
    # 16 rows made a block; 9 were dropped at the cut, 14 are in the open one.
    assert (state["sums"]["closed"], state["sums"]["filled"]) == (1, 14)
    assert state["first"]["evidence"]["length"] <= 14
