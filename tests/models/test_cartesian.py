"""Cartesian stiffness against where arms rest under changed forces, and what it must obey."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotatum.models.robot.cartesian import DIRECTIONS, CartesianStiffness, cartesian_stiffness
from tests.models.resting_cases import Resting
from tests.models.robot_cases import ARMS, arm, close, rate, states

Array = NDArray[np.float64]

_EACH = pytest.mark.parametrize("name", ARMS)


@_EACH
@settings(max_examples=15)
@given(st.data())
def test_gradients_against_differences(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    q = data.draw(states(robot.size))[0]
    frame = data.draw(st.sampled_from(robot.frames))
    wrench = np.array(data.draw(st.lists(st.floats(-2.0, 2.0), min_size=6, max_size=6)))
    turns = np.eye(robot.size)

    told = np.stack([rate(lambda t, e=e: robot.gravity(q + t * e)) for e in turns], axis=1)
    scale = float(np.abs(robot.gravity(q)).max())
    close(robot.gravity_gradient(q), told, scale)

    told = np.stack(
        [rate(lambda t, e=e: robot.jacobian(frame, q + t * e).T @ wrench) for e in turns], axis=1
    )
    close(robot.wrench_gradient(frame, q, wrench), told, scale=float(np.abs(wrench).sum()))

    first = robot.gravity_gradient(q)
    kept = first.copy()
    robot.gravity_gradient(q + 1.0)
    assert np.array_equal(first, kept)


# Solving leaves 1e-14 of an angle, and a step turns by 1e-3 rad: differences keep 1e-11. The
# condition of J, below 200 in these poses, takes two digits more from a stiffness.
_COMPLIANCE, _STIFFNESS = 1e-10, 1e-8


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("name", "frame", "directions"),
    [
        ("planar", "tip", ("x", "z")),
        ("planar", "tip", ("z",)),
        ("planar-loaded", "tip", ("x", "ry")),
        ("seven-axis", "flange", DIRECTIONS),
        ("seven-axis", "flange", ("x", "y", "z")),
        ("seven-axis", "link4", ("x", "z")),
        ("r3", "flange", DIRECTIONS),
        ("r3-elastic", "flange", ("z", "x", "y")),
    ],
)
def test_stiffness_is_that_of_the_rest_under_changed_forces(
    name: str, frame: str, directions: tuple[str, ...], seed: int
) -> None:
    resting = Resting.drawn(name, frame, seed)
    rows = [DIRECTIONS.index(d) for d in directions]
    compliance = resting.compliance()[np.ix_(rows, rows)]
    told = resting.told(directions)
    assert told.rank == len(directions)
    assert not told.fixed
    assert told.condition < 200.0
    close_in_size(told.compliance, compliance, _COMPLIANCE)
    # Columns are forces for unit displacements: their errors against their own size.
    for found, force in zip(told.matrix.T, np.linalg.inv(compliance).T, strict=True):
        close_in_size(found, force, _STIFFNESS)


def close_in_size(found: Array, told: Array, tolerance: float) -> None:
    """Error against the largest number of what is told, by norms."""
    assert np.linalg.norm(found - told) <= tolerance * np.linalg.norm(told)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["r3", "seven-axis"])
def test_only_a_moment_makes_it_asymmetric(name: str, seed: int) -> None:
    resting = Resting.drawn(name, "flange", seed)
    told = resting.told(DIRECTIONS)
    x, y, z = resting.wrench[3:]
    half = np.zeros((6, 6))
    half[3:, 3:] = -0.5 * np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # Rounding of numbers of the matrix's size, times the condition.
    size = float(np.abs(told.matrix).max())
    assert np.abs(told.antisymmetric - half).max() <= 1e-13 * size
    np.testing.assert_allclose(told.symmetric + told.antisymmetric, told.matrix, atol=1e-15 * size)
    pushed = cartesian_stiffness(
        resting.robot, "flange", resting.q, resting.stiffness, force=resting.wrench[:3]
    )
    assert np.abs(pushed.antisymmetric).max() <= 1e-13 * np.abs(pushed.matrix).max()


def test_an_arm_with_joints_to_spare_gives_way_inside() -> None:
    resting = Resting.drawn("seven-axis", "flange", 5)
    told = cartesian_stiffness(
        resting.robot, "flange", resting.q, resting.stiffness, force=resting.wrench[:3]
    )
    # Rounding times a condition of a few, squared.
    np.testing.assert_allclose(told.matrix @ told.compliance, np.eye(3), atol=1e-12)
    jacobian = resting.robot.jacobian("flange", resting.q)[:3]
    # The paper's formula with the Moore-Penrose inverse: stiffer in some, softer in no direction.
    held = np.linalg.pinv(jacobian)
    clamped = held.T @ told.joint_stiffness @ held
    size = np.abs(told.matrix).max()
    assert np.linalg.eigvalsh(clamped - told.symmetric)[0] > -1e-12 * size
    assert np.linalg.norm(clamped @ told.compliance, 2) > 1.05
    # And with the inverse the docstring names.
    softened = np.linalg.solve(told.joint_stiffness, jacobian.T)
    ways = softened @ np.linalg.inv(jacobian @ softened)
    paper = ways.T @ told.joint_stiffness @ ways
    np.testing.assert_allclose(told.matrix, paper, atol=1e-12 * size)


@pytest.mark.parametrize(
    ("name", "frame", "directions"),
    [("planar", "tip", ("x", "z")), ("seven-axis", "flange", ("x", "y", "z", "rx"))],
)
def test_deviations_are_those_of_drawn_joints(
    name: str, frame: str, directions: tuple[str, ...]
) -> None:
    resting = Resting.drawn(name, frame, 1)
    mean, draws = resting.stiffness, 800
    std = 0.02 * mean * np.linspace(0.5, 1.5, mean.size)

    def at(stiffness: Array) -> CartesianStiffness:
        return cartesian_stiffness(
            resting.robot, frame, resting.q, stiffness, stiffness_std=std,
            force=resting.wrench[:3], moment=resting.wrench[3:], directions=directions,
        )  # fmt: skip

    rng = np.random.default_rng(3)
    drawn = [at(mean + std * rng.standard_normal(mean.size)) for _ in range(draws)]
    told = at(mean)
    assert told.std is not None
    assert told.compliance_std is not None
    # A deviation from 800 draws is known to 2.5 %, and 3 % of curvature are 0.1 %: four times.
    found = np.std([case.matrix for case in drawn], axis=0)
    np.testing.assert_allclose(told.std, found, rtol=0.1)
    found = np.std([case.compliance for case in drawn], axis=0)
    np.testing.assert_allclose(told.compliance_std, found, rtol=0.1)


def test_deviations_are_exact_slopes() -> None:
    """One uncertain joint at a time: the magnitude of the derivative."""
    resting = Resting.drawn("seven-axis", "flange", 2)
    force, moment = resting.wrench[:3], resting.wrench[3:]
    for turn in np.eye(7):

        def at(stiffness: Array, turn: Array = turn) -> CartesianStiffness:
            return cartesian_stiffness(
                resting.robot, "flange", resting.q, stiffness, stiffness_std=turn,
                force=force, moment=moment,
            )  # fmt: skip

        def along(t: float, turn: Array = turn) -> Array:
            case = at(resting.stiffness + 1e3 * t * turn)
            return np.stack([case.matrix, case.compliance])

        matrix, compliance = np.abs(rate(along)) / 1e3
        told = at(resting.stiffness)
        # Differences keep 1e-16 of the numbers over steps of 1 N m/rad.
        atol = 1e-14 * np.abs(told.matrix).max()
        np.testing.assert_allclose(told.std, matrix, rtol=1e-8, atol=atol)
        atol = 1e-14 * np.abs(told.compliance).max()
        np.testing.assert_allclose(told.compliance_std, compliance, rtol=1e-8, atol=atol)
