"""Joint accelerations from accelerometers: exact, damped without a jump, honest of the unseen."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rotatum import load_device
from rotatum.errors import RotatumError
from rotatum.estimators.full_state.accelerations import SHARE, JointAccelerations
from rotatum.estimators.full_state.damped import damped_inverse
from rotatum.kernels.status import NOT_FINITE, SINGULAR, UNSEEN
from rotatum.models.inertial import Accelerometer, Gyroscope
from rotatum.models.robot.planar import Planar

R3 = load_device("manutec-r3").build_robot()
IMU = Accelerometer(name="imu", frame="body4", position=(0.0, 0.1, 0.1), rpy=(0.3, -0.2, 1.0))
GYRO = Gyroscope(name="gyro", frame="body4")
LINK4 = JointAccelerations(R3, [IMU], [GYRO])
BENT = np.array([0.4, 0.8, 0.9])
DQ, DDQ = np.array([0.7, -0.5, 1.1]), np.array([3.0, -8.0, 12.0])
# Largest slope of x / (x^2 + (1 - x)^2) in 0 to 1; above, that of 1/x is smaller.
X = np.linspace(0.0, 1.0, 100001)
H = X / (X**2 + (1.0 - X) ** 2)
LIPSCHITZ = np.abs(np.diff(H) / np.diff(X)).max() * (1.0 + 1e-4)


def test_away_from_singular_poses_it_is_exact():
    found = LINK4.solve(BENT, DQ, LINK4.map.readings(BENT, DQ, DDQ))
    # rounding of 30 m/s^2 over the condition, 10
    np.testing.assert_allclose(found.motion, DDQ, atol=1e-12)
    np.testing.assert_allclose(found.share, 1.0, atol=1e-13)
    assert found.condition == pytest.approx(np.linalg.cond(LINK4.map.matrix(BENT)))
    assert not found.status.any()
    assert LINK4.columns == ("imu.ax", "imu.ay", "imu.az")


@given(
    T=arrays(np.float64, (2, 4, 3), elements=st.floats(-0.2, 0.2, allow_subnormal=False)),
    size=st.sampled_from([1.0, 0.1, 0.01]),
)
def test_the_inverse_is_lipschitz_bounded_and_exact_above_the_threshold(T, size):
    e = 0.05
    one = damped_inverse(T[0], e, 3)
    other = damped_inverse(T[0] + size * T[1], e, 3)
    change = np.linalg.norm(other.matrix - one.matrix)
    # An odd function of singular values has its scalar Lipschitz constant in the Frobenius norm.
    assert change <= LIPSCHITZ / e**2 * np.linalg.norm(size * T[1]) + 1e-12
    assert np.linalg.norm(one.matrix, 2) <= H.max() / e * (1.0 + 1e-6)
    np.testing.assert_allclose(one.share, np.diag(one.matrix @ T[0]), atol=1e-13)
    assert np.all((one.share > -1e-13) & (one.share < 1.0 + 1e-13))
    strong = T[0] + np.eye(4, 3)
    if np.linalg.svd(strong)[1][-1] > e:
        plain = np.linalg.pinv(strong)
        np.testing.assert_allclose(damped_inverse(strong, e, 3).matrix, plain, atol=1e-12)


def _crossing(steps=1500):
    """Through both singularities of Fig. 2: over axis 1, then stretched; (K, 3) and seconds."""
    t = np.linspace(0.0, 1.5, steps)
    share = np.clip((t - 0.2) / 1.1, 0.0, 1.0)
    share = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return np.column_stack([0.2 * t, -1.6 + 2.4 * share, 2.2 - 3.0 * share]), t


def test_crossing_both_singular_poses_of_figure_2_nothing_jumps():
    q, t = _crossing()
    period = t[1]
    dq = np.gradient(q, period, axis=0)
    maps = [LINK4.map.both(*state) for state in zip(q, dq, strict=True)]
    T, W = (np.array(x) for x in zip(*maps, strict=True))
    ddq = np.column_stack([5.0 * np.cos(20.0 * t + k) for k in range(3)])
    noise = 0.1 * np.random.default_rng(5).standard_normal(W.shape)
    y = np.einsum("kij,kj->ki", T, ddq) + W + noise
    found = [LINK4.solve(*sample) for sample in zip(q, dq, y, strict=True)]
    error = np.array([x.motion for x in found]) - ddq
    # Both were crossed: over axis 1 the first joint is lost, stretched out a mix of 2 and 3.
    lost = np.array([(x.status & SINGULAR) != 0 for x in found])
    smallest = np.linalg.svd(T, compute_uv=False)[:, -1]
    assert np.sum(np.diff(np.sign(np.linalg.det(T))) != 0) == 2
    assert lost[:, 0].any()
    assert (lost[:, 1] | lost[:, 2]).any()
    # Flags where and only where a lever arm is short: the share of a direction is 0.9 at 3/4 of it.
    assert np.array_equal(lost, np.array([x.share for x in found]) < SHARE)
    assert not lost[smallest > 0.75 * LINK4.lever].any()
    assert lost.any(axis=1)[smallest < 0.2 * LINK4.lever].all()
    assert not lost.any(axis=1)[t < 0.1].any()
    # From sample to sample the error changes by no more than the inverse, the noise and the motion.
    moved = np.linalg.norm(np.diff(T, axis=0), axis=(1, 2))
    heard = np.linalg.norm(y - W, axis=1)
    other = np.linalg.norm(np.diff(y - W, axis=0), axis=1)
    allowed = LIPSCHITZ / LINK4.lever**2 * moved * heard[:-1] + H.max() / LINK4.lever * other
    jump = np.linalg.norm(np.diff(error, axis=0), axis=1)
    assert np.all(jump <= allowed + np.linalg.norm(np.diff(ddq, axis=0), axis=1))
    # Undamped it does jump: the same readings through the plain inverse.
    plain = np.array([np.linalg.solve(*x) for x in zip(T, y - W, strict=True)]) - ddq
    # Damped, the error is at most what is damped away and the noise's bound of 5 deviations.
    bound = np.linalg.norm(ddq, axis=1) + 5.0 * 0.1 * np.sqrt(3.0) * H.max() / LINK4.lever
    assert np.all(np.linalg.norm(error, axis=1) <= bound)
    assert np.abs(plain).max() > 3.0 * bound.max()


def test_what_is_damped_away_stays_at_the_prior():
    q, _ = _crossing()
    at = q[np.argmin([abs(np.linalg.det(LINK4.map.matrix(x))) for x in q])]
    y = LINK4.map.readings(at, DQ, DDQ)
    # a prior that is right makes it right at any pose
    np.testing.assert_allclose(LINK4.solve(at, DQ, y, DDQ).motion, DDQ, atol=1e-12)
    left = LINK4.solve(at, DQ, y).motion - DDQ
    resolution = LINK4.inverse(at).matrix @ LINK4.map.matrix(at)
    np.testing.assert_allclose(left, (resolution - np.eye(3)) @ DDQ, atol=1e-11)
    assert np.linalg.norm(left) > 1.0


def test_fewer_readings_than_joints_say_whom_they_determine():
    arm = Planar((0.5, 0.4), (1.0, 0.7))
    q, dq, ddq = np.array([0.4, 0.9]), np.array([1.0, -2.0]), np.array([3.0, 7.0])
    upper = Accelerometer(name="upper", frame="link1", position=(0.0, 0.0, -0.3))
    below = JointAccelerations(arm, [upper])
    assert below.determined.tolist() == [True, False]
    found = below.solve(q, dq, below.map.readings(q, dq, ddq), np.array([0.0, 99.0]))
    # the second joint's prior is returned and bears on nothing
    np.testing.assert_allclose(found.motion, [3.0, 99.0], atol=1e-12)
    assert found.status.tolist() == [0, UNSEEN]
    tip = Accelerometer(name="tip", frame="link2", position=(0.0, 0.0, -0.4), axes=("x",))
    one = JointAccelerations(arm, [tip])
    assert not one.determined.any()
    np.testing.assert_array_equal(one.solve(q, dq, np.array([5.0])).motion, 0.0)
    assert JointAccelerations(arm, [upper, tip]).determined.all()
    assert LINK4.determined.all()
    nothing = JointAccelerations(arm, [])
    assert nothing.solve(q, dq, np.zeros(0)).status.tolist() == [UNSEEN, UNSEEN]


def test_a_gyroscope_tells_the_first_axis_and_the_sum_of_the_parallel_ones():
    assert LINK4.gyro_determined.tolist() == [True, False, False]
    shown = LINK4.gyro_map.matrix(BENT) @ DQ
    found = LINK4.rates(BENT, shown)
    np.testing.assert_allclose(found.motion, [DQ[0], 0.0, 0.0], atol=1e-13)
    np.testing.assert_allclose(found.share, [1.0, 0.5, 0.5], atol=1e-13)
    more = Gyroscope(name="two", frame="body2")
    both = JointAccelerations(R3, [IMU], [GYRO, more])
    found = both.rates(BENT, both.gyro_map.matrix(BENT) @ DQ)
    np.testing.assert_allclose(found.motion, DQ, atol=1e-13)


def test_missing_readings_are_left_out_and_nothing_raises():
    three = (IMU, IMU.model_copy(update={"name": "two", "frame": "body2", "rpy": (0.0, 0.0, 0.0)}))
    arm = JointAccelerations(R3, three)
    y = arm.map.readings(BENT, DQ, DDQ)
    y[1] = np.nan
    found = arm.solve(BENT, DQ, y)
    # what is left still determines them all
    np.testing.assert_allclose(found.motion, DDQ, atol=1e-11)
    assert (found.status == NOT_FINITE).all()
    found = LINK4.solve(BENT, DQ, np.full(3, np.nan))
    np.testing.assert_array_equal(found.motion, 0.0)
    assert found.condition == np.inf
    assert (found.status == NOT_FINITE | SINGULAR).all()
    for bad in (np.nan, np.inf, 1e300):
        for broken in (LINK4.solve(BENT * bad, DQ, y[:3]), LINK4.solve(BENT, DQ * bad, y[:3])):
            np.testing.assert_array_equal(broken.motion, 0.0)
            np.testing.assert_array_equal(broken.share, 0.0)
        assert (LINK4.rates(BENT, np.full(3, bad)).status & NOT_FINITE).all()


@pytest.mark.parametrize("quiet", [0.02, 0.1, 1.0])
def test_the_covariance_is_that_of_repeated_readings(quiet):
    two = IMU.model_copy(update={"name": "two", "position": (0.3, 0.0, 0.2)})
    arm = JointAccelerations(R3, [IMU, two], noise={"imu": quiet, "two": 0.5})
    std = np.repeat([quiet, 0.5], 3)
    drawn = std * np.random.default_rng(1).standard_normal((500, 6))
    y = arm.map.readings(BENT, DQ, DDQ)
    found = np.array([arm.solve(BENT, DQ, y + d).motion for d in drawn])
    expected = arm.covariance(BENT)
    size = np.sqrt(np.diag(expected))
    # 4.5 deviations of a covariance of 500 draws, which is at most root 2 of the sizes
    atol = 4.5 * np.sqrt(2.0 / 500)
    np.testing.assert_allclose(np.cov(found.T) / np.outer(size, size),
                               expected / np.outer(size, size), atol=atol)  # fmt: skip
    # no linear unbiased estimate is less noisy: weights are the readings' precision
    T = arm.map.matrix(BENT)
    least = np.linalg.inv((T / std[:, None] ** 2).T @ T)
    np.testing.assert_allclose(expected, least, rtol=1e-9)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(RotatumError, match=r"noise of a sensor.*imo.*imu"):
        JointAccelerations(R3, [IMU], noise={"imo": 1.0})
    with pytest.raises(RotatumError, match=r"noise\.gyro.*positive"):
        JointAccelerations(R3, [IMU], [GYRO], noise={"imu": 1.0})
    with pytest.raises(RotatumError, match="lever"):
        JointAccelerations(R3, [IMU], lever=0.0)


def test_it_fits_into_the_loop():
    y = LINK4.map.readings(BENT, DQ, DDQ)
    taken = []
    for _ in range(300):
        begin = time.perf_counter()
        LINK4.solve(BENT, DQ, y)
        taken.append(time.perf_counter() - begin)
    # 60 us on a free core; a busy machine may take several times that
    assert min(taken) < 3e-4
