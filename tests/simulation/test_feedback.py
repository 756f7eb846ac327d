"""Feedback: position control against linear systems theory, gravity, presets, limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.signal import cont2discrete

from rotatum.errors import DeviceError, RotatumError
from rotatum.simulation import sine
from rotatum.simulation.drivers.commands import co_contraction, position_drives
from rotatum.simulation.drivers.compensation import GravityCompensation, Pendulums, gravity_of
from rotatum.simulation.drivers.control import Gains, PositionControl
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.drivers.limits import LimitedFeedback
from rotatum.simulation.drivers.paths import Ramps, hold
from tests.simulation.joints import AWAS, VSA, joint_of, series_joint

PERIOD = 1e-3


def seen(time=0.0, *, q=(0.0,), theta=((0.0,),), dtheta=None, names=("arm",)):
    theta = {name: np.array(row) for name, row in zip(names, theta, strict=True)}
    still = {name: np.zeros_like(row) for name, row in theta.items()}
    moving = still if dtheta is None else {names[0]: np.array(dtheta)}
    links = np.array(q)
    return Seen(time, links, 0.0 * links, theta, moving, 0.0 * links, still)


def march(a, b, law, steps, names=("arm",)):
    """Return the states (steps, 4) q, q', theta, theta' of a linear joint under a held torque."""
    ad, bd, *_ = cont2discrete((a, b[:, None], np.eye(4), np.zeros((4, 1))), PERIOD)
    states = [np.zeros(4)]
    for k in range(steps - 1):
        x = states[-1]
        now = seen(k * PERIOD, q=x[:1], theta=[x[2:3]], dtheta=x[3:], names=names)
        states.append(ad @ x + bd[:, 0] * law.torque(now))
    return np.array(states)


def elastic_joint(m=0.8, b=0.256, k=200.0, d=0.3):
    """Return A, B of a link m and a rotor b on a spring k, both with friction d."""
    rows = [[0, 1, 0, 0], [-k / m, -d / m, k / m, 0], [0, 0, 0, 1], [k / b, 0, -k / b, -d / b]]
    return np.array(rows), np.array([0.0, 0.0, 0.0, 1 / b])


def test_the_closed_loop_is_the_matrix_exponential_of_its_equations():
    a, b = elastic_joint()
    gains = Gains.of_bandwidth(0.256, 40.0, 0.8)
    law = PositionControl("arm", hold(0.1), gains)
    states = march(a, b, law, 400)
    # with the torque held over a period: x+ = (Ad - Bd K) x + Bd Kp theta_d, summed in closed form
    held = expm(PERIOD * np.block([[a, b[:, None]], [np.zeros((1, 5))]]))
    row = np.array([0.0, 0.0, gains.kp, gains.kd])
    loop = held[:4, :4] - np.outer(held[:4, 4], row)
    rest = np.linalg.solve(np.eye(4) - loop, held[:4, 4] * gains.kp * 0.1)
    values, vectors = np.linalg.eig(loop)
    parts = np.linalg.solve(vectors, -rest)
    expected = [rest + (vectors @ (values**n * parts)).real for n in range(400)]
    # rounding of 400 steps, velocities up to 2 rad/s
    np.testing.assert_allclose(states, expected, atol=1e-11)
    # without gravity the spring is slack at the end: the motor stands where it was told
    np.testing.assert_allclose(rest, [0.1, 0.0, 0.1, 0.0], atol=1e-12)


def test_the_bandwidth_is_the_rotor_s_natural_frequency():
    gains = Gains.of_bandwidth(0.02, 50.0, 0.3)
    poles = np.roots([0.02, gains.kd, gains.kp])
    np.testing.assert_allclose(np.abs(poles), 50.0)
    np.testing.assert_allclose(-poles.real / np.abs(poles), 0.3)


GAIN = st.floats(0.01, 100.0)


FRICTION = st.just(0.0) | st.floats(1e-8, 10.0)


@given(GAIN, st.just(0.0) | GAIN, st.floats(1e-4, 1.0), FRICTION, st.floats(1e-4, 0.1))
def test_gains_that_keep_a_rotor_steady_have_their_poles_in_the_circle(kp, kd, b, d, period):
    rows = [[0, 1, 0], [0, -d / b, 1 / b], [0, 0, 0]]
    held = expm(period * np.array(rows))
    loop = held[:2, :2] - np.outer(held[:2, 2], [kp, kd])
    radius = np.max(np.abs(np.linalg.eigvals(loop)))
    # on the circle itself rounding decides
    assume(abs(radius - 1.0) > 1e-9)
    assert Gains(kp, kd).keep_steady(b, d, period) == (radius < 1.0)


def test_the_longest_period_of_a_free_rotor_is_that_of_the_book():
    # Kd T < 2 B and Kp T < 2 Kd; halved 30 times
    assert Gains(1.0, 0.2).longest_period(0.01, 0.0, 1.0) == pytest.approx(0.1, rel=1e-8)
    assert Gains(8.0, 0.1).longest_period(0.01, 0.0, 1.0) == pytest.approx(0.025, rel=1e-7)
    assert Gains(1.0, 0.0).longest_period(0.01, 0.0, 1.0) < 1e-9
    # gravity compensation alone asks nothing of the period
    assert Gains(0.0, 0.0).keep_steady(0.01, 0.0, 1.0)


def test_with_its_inertia_fed_forward_a_motor_follows_its_path():
    """A rotor of its own (the spring is cut): only what is held over a period is missed."""
    a, b = elastic_joint(k=0.0, d=0.0)
    path = Ramps((0.05, 0.45), (0.0, 0.5))
    gains = Gains.of_bandwidth(0.256, 60.0)
    time = PERIOD * np.arange(500)
    off = {}
    for inertia in (0.0, 0.256):
        law = PositionControl("arm", path, gains, inertia=inertia).sampled(time)
        off[inertia] = np.max(np.abs(march(a, b, law, 500)[:, 2] - path(time)))
    # without: B a / Kp, a = 10 h / (sqrt 3 T^2) for long enough ramps; less as it comes and goes
    assert 0.5 < off[0.0] / (10 * 0.5 / (math.sqrt(3) * 0.4**2) / 60.0**2) < 1.0
    # with: the torque is half a period late, T/2 of the jerk 60 h / T^3 (469 rad/s^3), over w^2
    assert off[0.256] < PERIOD / 2 * 60 * 0.5 / 0.4**3 / 60.0**2


def test_sampled_and_unsampled_controllers_are_the_same_law():
    time = PERIOD * np.arange(200)
    law = PositionControl(
        "arm", sine(0.2, 3.0), Gains(3.0, 0.1), inertia=0.2, feedforward=sine(1.0, 2.0)
    )
    ready = law.sampled(time)
    for t in time[::17]:
        now = seen(t, theta=[[0.05]], dtheta=[0.4])
        expected = 3.0 * (0.2 * math.sin(6 * math.pi * t) - 0.05)
        expected += 0.1 * (0.2 * 6 * math.pi * math.cos(6 * math.pi * t) - 0.4)
        expected -= 0.2 * 0.2 * (6 * math.pi) ** 2 * math.sin(6 * math.pi * t)
        expected += math.sin(4 * math.pi * t)
        assert law.torque(now) == pytest.approx(expected, rel=1e-12)
        # sines of many times at once may round otherwise than of one
        assert ready.torque(now) == pytest.approx(law.torque(now), rel=1e-14)


def test_a_joint_held_against_gravity_stands_where_its_spring_lets_it():
    joint = series_joint()  # G = 15 N m, spring 200 phi + 1500 phi^3
    gravity = gravity_of([joint])
    (law,) = position_drives(joint, hold(0.6), bandwidth=30.0, gravity=gravity).values()
    q = 0.55
    now = seen(q=[q], theta=[[0.6]], names=(joint.name,))
    # at the commanded angle only gravity is left
    assert law.torque(now) == pytest.approx(15.0 * math.sin(q), rel=1e-14)
    motors = position_drives(
        joint, hold(0.6), bandwidth=30.0, gravity=gravity_of([joint], at="motor")
    )
    assert motors["tau"].torque(now) == pytest.approx(15.0 * math.sin(0.6), rel=1e-14)


def test_gravity_of_an_arm_is_reckoned_once_an_instant_for_all_motors():
    class Arm:
        asked = 0

        def gravity(self, q):
            self.asked += 1
            return np.array([q[0] + q[1], q[1]])

    arm = Arm()
    gravity = GravityCompensation(arm, ("shoulder", "elbow"))
    laws = [
        PositionControl(name, hold(0.0), Gains(0.0, 0.0), gravity=gravity, index=i)
        for i, name in enumerate(gravity.joints)
    ]
    for q, expected in (((1.0, 2.0), [3.0, 2.0]), ((5.0, 7.0), [12.0, 7.0])):
        now = seen(q=q, theta=[[0.0], [0.0]], names=gravity.joints)
        assert [law.torque(now) for law in laws] == expected
    assert arm.asked == 2


def test_agonist_and_antagonist_go_apart_by_the_preset():
    joint = joint_of(VSA)
    gravity = gravity_of([joint])
    drives = position_drives(
        joint, sine(0.3, 0.5), preset=Ramps((0.0, 1.0), (0.1, 0.4)), bandwidth=100.0,
        gravity=gravity,
    )  # fmt: skip
    time = np.linspace(0.0, 2.0, 41)
    low, high = drives["tau1"].path, drives["tau2"].path
    np.testing.assert_allclose((low(time) + high(time)) / 2, sine(0.3, 0.5)(time), atol=1e-15)
    preset = Ramps((0.0, 1.0), (0.1, 0.4))
    np.testing.assert_allclose((high(time) - low(time)) / 2, preset(time), atol=1e-15)
    now = seen(q=[0.3], theta=[[low(0.0), high(0.0)]], names=(joint.name,))
    at_rest = [replace(law, path=hold(float(law.path(0.0)))) for law in drives.values()]
    # together the two bear the joint's gravity
    total = sum(law.torque(now) for law in at_rest)
    assert total == pytest.approx(0.245 * math.sin(0.3), rel=1e-13)


def test_co_contraction_stands_while_the_preset_moves():
    joint = joint_of(VSA)
    preset = Ramps((0.0, 2.0), (0.1, 0.5))
    drives = co_contraction(joint, preset, position=0.2, bandwidth=(80.0, 120.0), damping=0.7)
    time = np.linspace(0.0, 2.0, 41)
    np.testing.assert_allclose(drives["tau1"].path(time), 0.2 - preset(time), atol=1e-15)
    np.testing.assert_allclose(drives["tau2"].path(time), 0.2 + preset(time), atol=1e-15)
    assert drives["tau1"].gains == Gains.of_bandwidth(1e-4, 80.0, 0.7)
    assert drives["tau2"].gains == Gains.of_bandwidth(1e-4, 120.0, 0.7)


def test_gains_are_of_the_rotor_as_the_joint_feels_it():
    joint = joint_of(AWAS)  # 2.3e-5 kg m^2 behind a gear of 50
    (law,) = position_drives(joint, hold(0.0), bandwidth=100.0).values()
    assert law.gains.kp == pytest.approx(2.3e-5 * 50**2 * 100.0**2, rel=1e-14)
    assert law.gains.kd == pytest.approx(2 * 2.3e-5 * 50**2 * 100.0, rel=1e-14)
    own = position_drives(joint, hold(0.0), gains=[Gains(7.0, 0.5)])
    assert own["tau"].gains == Gains(7.0, 0.5)


def test_feedback_gives_no_more_than_its_motor_can():
    motor = {"inertia": 4e-5, "gear_ratio": -80.0, "torque_limit": 0.5}
    joint = series_joint(motor=motor)
    (law,) = position_drives(joint, hold(1.0), bandwidth=30.0).values()
    limited = LimitedFeedback(law, joint.motors[0].reflected_torque_limit, "arm, tau")
    near, far = (seen(theta=[[x]], names=(joint.name,)) for x in (0.9, -5.0))
    assert limited.torque(near) == law.torque(near)
    assert limited.torque(far) == 40.0
    assert limited.torque(seen(theta=[[5.0]], names=(joint.name,))) == -40.0
    with pytest.raises(RotatumError, match=r"arm, tau, t = 0.25 s.*finite number, got nan"):
        limited.torque(seen(0.25, theta=[[math.nan]], names=(joint.name,)))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Gains(-1.0, 0.0), "gains.kp"),
        (lambda: Gains(1.0, math.nan), "gains.kd"),
        (lambda: Gains.of_bandwidth(1.0, 0.0), "position.bandwidth"),
        (lambda: Gains.of_bandwidth(1.0, 1.0, -0.5), "position.damping"),
        (lambda: GravityCompensation(Pendulums((1.0,)), ("arm",), "lnik"), "Did you mean 'link'"),
        (lambda: position_drives(series_joint(), hold(0.0)), "either a bandwidth or gains"),
        (
            lambda: position_drives(
                series_joint(), hold(0.0), bandwidth=1.0, gains=[Gains(1.0, 1.0)]
            ),
            "either a bandwidth or gains",
        ),
        (
            lambda: position_drives(joint_of(VSA), hold(0.0), bandwidth=(1.0, 2.0, 3.0)),
            "vsa, bandwidth: needs one for each of its 2 motors, got 3",
        ),
        (
            lambda: position_drives(joint_of(VSA), hold(0.0), gains=[Gains(1.0, 1.0)]),
            "vsa, gains: needs one for each of its 2 motors, got 1",
        ),
        (
            lambda: position_drives(series_joint(), hold(0.0), bandwidth=9.0, preset=hold(0.1)),
            "preset: a joint with series actuation has no preset",
        ),
        (
            lambda: co_contraction(joint_of(AWAS), hold(0.1), bandwidth=9.0),
            "awas: co-contraction needs two motors",
        ),
        (
            lambda: PositionControl("arm", hold(0.0), Gains(1.0, 1.0), feedforward=np.log).sampled(
                np.array([0.5, np.nan])
            ),
            "arm, motor 1",
        ),
    ],
)
def test_impossible_controllers_say_what_is_wrong(make, says):
    with pytest.raises(RotatumError, match=says):
        make()


def test_position_control_needs_the_rotor_s_inertia():
    joint = series_joint(motor={"damping": 0.1})
    with pytest.raises(DeviceError, match=r"demo-elbow: position control needs motor.inertia"):
        position_drives(joint, hold(0.0), bandwidth=9.0)
