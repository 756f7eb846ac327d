"""Links at rest: the paper's iteration, an independent root finder, and springs that buckle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq, root

from rotatum import load_device
from rotatum.errors import MethodError
from rotatum.estimators.full_state.rest import links_at_rest
from rotatum.models.joint import Joint
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar

R3 = load_device("manutec-r3")
ARM = R3.build_robot()
# 1 kg at 1 m: 9.81 N m at most.
POLE = Pendulum(1.1, 9.81)


def _spring(law, **constants):
    return Joint(name="j", transmissions=({"law": law, **constants},))


def test_it_is_where_the_iteration_of_the_paper_ends():
    stiffness = np.array([joint.transmission.given["stiffness"][0] for joint in R3.joints])
    theta = np.array([0.1, 1.4, 0.2])
    q = theta.copy()
    for _ in range(8):  # each leaves 6e-4 of the error
        q = theta - ARM.gravity(q) / stiffness
    found = links_at_rest(ARM, R3.joints, theta)
    np.testing.assert_allclose(found.q, q, atol=1e-14)
    assert found.trustworthy
    # 883 N m on 352800 N m/rad, stretched out with 15 kg; bent by 0.17 rad it is 0.99 of that
    assert q[1] - theta[1] == pytest.approx(883.0 / 352800.0, rel=0.02)
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-9)
    # the rate of contraction is the largest eigenvalue of K^-1 dg/dq, which need not be symmetric
    rate = np.abs(np.linalg.eigvals(ARM.gravity_gradient(q) / stiffness[:, None])).max()
    assert found.contraction == pytest.approx(rate, rel=1e-9)


def test_nonlinear_and_antagonistic_springs_against_a_root_finder():
    arm = Planar((0.5, 0.5), (0.4, 0.3))
    hard = {"law": "cubic", "stiffness": 3.0, "cubic": 400.0}
    one = Joint(name="one", transmissions=(hard,))
    two = Joint(name="two", actuation="antagonistic", transmissions=(hard,))
    theta, theta2 = np.array([1.2, -0.3]), np.array([0.0, -0.1])

    def left(q):
        def torque(phi):
            return 3.0 * phi + 400.0 * phi**3

        second = torque(q[1] + 0.3) + torque(q[1] + 0.1)
        return arm.gravity(q) + np.array([torque(q[0] - 1.2), second])

    expected = root(left, theta, tol=1e-13)
    assert expected.success
    found = links_at_rest(arm, (one, two), theta, theta2=theta2)
    np.testing.assert_allclose(found.q, expected.x, atol=1e-10)
    assert found.converged
    assert found.stable
    # the same from elsewhere, and with the springs' rest moved along with the motors
    again = links_at_rest(arm, (one, two), theta, theta2=theta2, start=theta + 0.4)
    np.testing.assert_allclose(again.q, found.q, atol=1e-11)
    zero = np.array([0.05, -0.02])
    moved = links_at_rest(arm, (one, two), theta - zero, theta2=theta2 - zero, zero=zero)
    np.testing.assert_allclose(moved.q, found.q, atol=1e-11)


def test_a_law_with_an_end_is_not_left_on_the_way():
    spring = _spring("linear", stiffness=20.0)
    limited = spring.transmission.model_copy(update={"limit": 0.3})
    joint = spring.model_copy(update={"transmissions": (limited,)})
    found = links_at_rest(POLE, (joint,), np.array([np.pi / 2]))
    # 9.81 N m on 20 N m/rad ask for 0.45 rad: there is no rest within the maker's limit
    assert not found.converged
    assert abs(found.q[0] - np.pi / 2) <= 0.3


def test_soft_springs_buckle_and_it_says_so():
    upright = np.array([np.pi])
    soft, stiff = _spring("linear", stiffness=6.0), _spring("linear", stiffness=12.0)
    holds = links_at_rest(POLE, (stiff,), upright)
    assert holds.trustworthy
    assert holds.contraction == pytest.approx(9.81 / 12.0)
    falls = links_at_rest(POLE, (soft,), upright)
    assert falls.converged
    assert not falls.stable
    assert not falls.trustworthy
    # Leaning by 0.1 rad it falls to where spring and weight balance, and stays there.
    leaning = links_at_rest(POLE, (soft,), upright - 0.1)
    expected = brentq(lambda q: 6.0 * (q - np.pi + 0.1) + 9.81 * np.sin(q), 0.5, 2.5)
    assert leaning.converged
    assert leaning.stable
    assert leaning.q[0] == pytest.approx(expected, abs=1e-11)
    # The paper's iteration goes elsewhere: it does not contract on the way.
    assert links_at_rest(POLE, (soft,), upright - 0.1, start=upright + 1.9).q[0] > np.pi


def test_what_is_no_number_does_not_raise_and_what_is_missing_does():
    stiff = _spring("linear", stiffness=12.0)
    for bad in (np.nan, np.inf):
        found = links_at_rest(POLE, (stiff,), np.array([bad]))
        assert not found.converged
        assert not found.trustworthy
    with pytest.raises(MethodError, match="law"):
        links_at_rest(POLE, (Joint(name="j"),), np.array([1.0]))
    pair = Joint(name="j", actuation="antagonistic",
                 transmissions=({"law": "linear", "stiffness": 1.0},))  # fmt: skip
    with pytest.raises(MethodError, match="both motors"):
        links_at_rest(POLE, (pair,), np.array([1.0]))
