"""Gains of one joint: the poles they give, against its equations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.control.pole_placement import ElasticJoint, PolePair, motor_gains, state_gains
from rotatum.errors import RotatumError

AXIS1 = ElasticJoint(motor=14.33, link=169.0, stiffness=474075.0, damping=55.1, viscous=9.0)
positive = st.floats(0.05, 20.0)


@given(positive, positive, st.floats(10.0, 1e5), st.floats(0.0, 0.3), positive, positive)
def test_the_poles_are_where_they_are_asked_for(motor, link, stiffness, rate, slow, fast):
    damping = rate * np.sqrt(stiffness * min(motor, link))
    joint = ElasticJoint(motor, link, stiffness, damping, viscous=0.1 * damping)
    pairs = [PolePair(slow, 0.8), PolePair(joint.free_frequency * fast, 0.4)]
    closed = joint.closed(state_gains(joint, *pairs))
    wanted = np.polymul(pairs[0].polynomial, pairs[1].polynomial)
    # of the characteristic polynomial, each coefficient by the power of the largest of all rates
    scale = max(pairs[0].frequency, pairs[1].frequency, joint.free_frequency) ** np.arange(5)
    np.testing.assert_allclose(np.poly(closed) / scale, wanted / scale, rtol=0, atol=1e-8)


def test_scipy_places_the_same_poles():
    from scipy.signal import place_poles

    slow, fast = PolePair(30.0, 0.9), PolePair(190.0, 0.3)
    poles = np.concatenate([np.roots(pair.polynomial) for pair in (slow, fast)])
    free = AXIS1.closed(np.zeros(4))
    push = np.array([[0.0], [0.0], [1.0 / AXIS1.motor], [0.0]])
    theirs = place_poles(free, push, poles).gain_matrix[0]
    # conditioning of their problem in these units: 5e5 against 1
    np.testing.assert_allclose(state_gains(AXIS1, slow, fast), theirs, rtol=1e-6)


def test_both_laws_are_as_stiff_at_rest_and_without_a_spring_the_motor_law_has_its_poles():
    pair = PolePair(30.0, 0.7)
    full = state_gains(AXIS1, pair, PolePair(AXIS1.free_frequency, 0.3))
    motor = motor_gains(AXIS1, pair)
    assert full[0] + full[1] == pytest.approx(motor[0], rel=1e-12)
    stiff = ElasticJoint(14.33, 169.0, 1e12, viscous=9.0)
    slow = np.sort_complex(np.linalg.eigvals(stiff.closed(motor_gains(stiff, pair))))
    slow = slow[np.abs(slow) < 1e3]
    # rounding of a pole at 2.7e5 rad/s in the same matrix
    np.testing.assert_allclose(np.poly(slow), pair.polynomial, rtol=1e-3)


def test_the_motor_law_loses_its_damping_where_the_mode_is_near_the_bandwidth():
    pair = PolePair(30.0, 1.0)
    least = []
    for locked in (150.0, 30.0):
        joint = ElasticJoint(motor=14.33, link=169.0, stiffness=169.0 * locked**2)
        poles = np.linalg.eigvals(joint.closed(motor_gains(joint, pair)))
        least.append(np.min(-poles.real / np.abs(poles)))
    # of the 1 asked for: five times above it most is left, at it a third
    assert least[0] > 0.6
    assert least[1] < 0.35


@pytest.mark.parametrize("field", ["motor", "link", "stiffness"])
def test_impossible_joints_and_poles_are_refused(field):
    numbers = {"motor": 1.0, "link": 1.0, "stiffness": 1.0, field: 0.0}
    with pytest.raises(RotatumError, match=f"joint.{field}"):
        ElasticJoint(**numbers)
    with pytest.raises(RotatumError, match=r"poles\.damping"):
        PolePair(30.0, -1.0)
