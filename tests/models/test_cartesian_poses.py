"""Cartesian stiffness of poses that are known by hand, singular ones among them, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

import rotatum as rt
from rotatum.errors import DeviceError, RotatumError
from rotatum.models.robot.cartesian import cartesian_stiffness
from rotatum.models.robot.pendulum import Pendulum
from rotatum.models.robot.planar import Planar
from tests.models.robot_cases import arm


def test_an_elbow_at_a_right_angle() -> None:
    """Upper link hanging down, lower one along x: the Jacobian by hand."""
    robot, (l1, l2), k = Planar((0.5, 0.3), (1.0, 1.0), gravity=0.0), (0.5, 0.3), (80.0, 20.0)
    told = cartesian_stiffness(robot, "tip", (0.0, np.pi / 2), k, directions=("x", "z"))
    jacobian = np.array([[l1, 0.0], [l2, l2]])
    compliance = jacobian @ np.diag(1.0 / np.array(k)) @ jacobian.T
    # Rounding of a few products.
    np.testing.assert_allclose(told.compliance, compliance, rtol=1e-13, atol=1e-17)
    np.testing.assert_allclose(told.matrix, np.linalg.inv(compliance), rtol=1e-12)
    assert told.length == pytest.approx(np.hypot(l1, l2), rel=1e-14)
    assert told.stable
    # Its directions across the plane are fixed, and cost the others nothing.
    whole = cartesian_stiffness(robot, "tip", (0.0, np.pi / 2), k)
    assert whole.fixed == ("y",)
    assert (whole.rank, whole.condition) == (2, np.inf)
    np.testing.assert_allclose(whole.matrix[::2, ::2], told.matrix, rtol=1e-12)
    assert whole.matrix[1, 1] == np.inf
    assert np.isnan(whole.matrix[[0, 1, 1, 2], [1, 0, 2, 1]]).all()


def test_gravity_stiffens_what_hangs_and_a_push_buckles_it() -> None:
    spring, weight, length, push = 2.0, 3.0, 0.5, 14.0
    robot = Pendulum(0.4, weight, length)
    hanging = cartesian_stiffness(robot, "tip", [0.0], [spring], directions=("x",))
    assert hanging.matrix[0, 0] == pytest.approx((spring + weight) / length**2, rel=1e-14)
    upright = cartesian_stiffness(robot, "tip", [np.pi], [spring], directions=("x",))
    assert upright.matrix[0, 0] == pytest.approx((spring - weight) / length**2, rel=1e-14)
    pushed = cartesian_stiffness(
        robot, "tip", [0.0], [spring], force=(0.0, 0.0, push), directions=("x",)
    )
    told = (spring + weight - push * length) / length**2
    assert pushed.matrix[0, 0] == pytest.approx(told, rel=1e-14)
    assert [case.stable for case in (hanging, upright, pushed)] == [True, False, False]


@pytest.mark.parametrize(("bend", "singular"), [(0.0, True), (1e-5, True), (1e-2, False)])
def test_a_stretched_arm_is_not_given_a_number(bend: float, singular: bool) -> None:
    robot, k = Planar((0.5, 0.5), (1.0, 1.0)), (50.0, 30.0)
    told = cartesian_stiffness(
        robot, "tip", (0.6, bend), k, stiffness_std=(1.0, 1.0), directions=("x", "z")
    )
    # Columns of 1 and 0.5 m, almost parallel: 1.25 over the determinant 0.25 sin(bend).
    if bend:
        assert told.condition * bend == pytest.approx(5.0, rel=1e-3)
    assert told.std is not None
    assert told.compliance_std is not None
    assert np.isfinite(told.compliance).all()
    assert np.isfinite(told.compliance_std).all()
    if not singular:
        assert (told.rank, told.fixed) == (2, ())
        # Second powers of the condition, 250, in 16 digits.
        np.testing.assert_allclose(told.matrix @ told.compliance, np.eye(2), atol=1e-9)
        return
    assert (told.rank, told.fixed) == (1, ("x", "z"))
    assert told.condition > 1e5
    assert np.array_equal(np.diag(told.matrix), [np.inf, np.inf])
    assert np.isnan([told.matrix[0, 1], told.matrix[1, 0], *told.std.ravel()]).all()
    assert np.isnan(told.antisymmetric).all()


def test_a_stretched_arm_gives_way_across() -> None:
    """Hanging straight down: z is fixed, and x has the compliance by hand."""
    robot = Planar((0.5, 0.3), (1.0, 1.0), gravity=0.0)
    told = cartesian_stiffness(robot, "tip", (0.0, 0.0), (50.0, 30.0), directions=("x", "z"))
    across = 0.8**2 / 50.0 + 0.3**2 / 30.0
    assert told.fixed == ("z",)
    assert told.compliance[0, 0] == pytest.approx(across, rel=1e-13)
    assert told.matrix[0, 0] == pytest.approx(1.0 / across, rel=1e-12)


def test_what_nothing_resists() -> None:
    robot = Planar((0.5, 0.3), (1.0, 1.0), gravity=0.0)
    # A limp elbow lets the tip go; one that does not move it is a motion inside.
    limp = cartesian_stiffness(robot, "tip", (0.0, 0.4), (50.0, 0.0), directions=("x",))
    # Beside 50 N m/rad over (0.8 m)^2, a rounding.
    assert abs(limp.matrix[0, 0]) <= 1e-12
    loose = cartesian_stiffness(robot, "tip", (0.0, np.pi / 2), (50.0, 0.0), directions=("x",))
    assert np.isnan(loose.matrix).all()
    for case in (limp, loose):
        assert np.isnan(case.compliance).all()
        assert not case.stable
    # A frame on the only axis does not move at all.
    axis = cartesian_stiffness(Pendulum(0.4, 3.0, 0.5), "link", [0.3], [5.0])
    assert (axis.rank, axis.fixed, axis.length) == (0, ("x", "y", "z"), 1.0)
    assert not axis.compliance.any()


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"q": (0.0,)}, "q must be 2 finite numbers"),
        ({"stiffness": (1.0, np.nan)}, "stiffness must be 2 finite numbers"),
        ({"stiffness": ("stiff", 1.0)}, "stiffness must be 2 finite numbers"),
        ({"stiffness_std": (1.0, -1.0)}, "stiffness_std must be at least 0"),
        ({"force": (1.0, 2.0)}, "force must be 3 finite numbers"),
        ({"moment": np.zeros(6)}, "moment must be 3 finite numbers"),
        ({"directions": ("x", "yaw")}, "no such direction, got 'yaw'; allowed: x, y, z, rx"),
        ({"directions": ("x", "x")}, "directions must be named once each"),
        ({"directions": ()}, "at least one"),
        ({"tolerance": 0.0}, "tolerance must be between 0 and 1"),
    ],
)
def test_arguments_that_cannot_be(change: dict[str, object], what: str) -> None:
    sound: dict[str, object] = {"q": (0.1, 0.2), "stiffness": (1.0, 2.0)}
    with pytest.raises(RotatumError, match=what):
        rt.cartesian_stiffness(arm("planar"), "tip", **{**sound, **change})


def test_no_arm_and_no_such_frame() -> None:
    with pytest.raises(DeviceError, match=r"needs an arm.*table \[robot\]"):
        rt.cartesian_stiffness(rt.load_device("series-demo").build_robot(), "tip", [0.1], [1.0])
    with pytest.raises(DeviceError, match='Did you mean "tip"'):
        rt.cartesian_stiffness(arm("planar"), "tipp", (0.1, 0.2), (1.0, 2.0))
