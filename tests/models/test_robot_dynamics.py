"""All arms on random states: what ties M, C, g, their rates and energies together."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.models.robot_cases import ARMS, along, arm, close, rate, states

_EACH = pytest.mark.parametrize("name", ARMS)
_MANY = settings(max_examples=30)


@_EACH
@_MANY
@given(st.data())
def test_coriolis_and_its_transpose_are_the_mass_matrixs_rate(
    name: str, data: st.DataObject
) -> None:
    robot = arm(name)
    state = data.draw(states(robot.size))
    q, dq = state[0], state[1]
    c = robot.coriolis(q, dq)
    told = rate(lambda t: robot.mass(along(state, t)[0]))
    scale = float(np.abs(robot.mass(q)).max())
    close(c + c.T, told, scale)
    close(robot.mass_rate(q, dq), told, scale)


@_EACH
@_MANY
@given(st.data())
def test_coriolis_is_that_of_the_christoffel_symbols(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    q, dq, _, _ = data.draw(states(robot.size))
    n = robot.size
    slopes = np.stack([rate(lambda t, e=e: robot.mass(q + t * e)) for e in np.eye(n)], axis=2)
    # c_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) q'_k / 2
    symbols = 0.5 * (slopes + slopes.transpose(0, 2, 1) - slopes.transpose(2, 0, 1))
    scale = float(np.abs(robot.mass(q)).max())
    close(robot.coriolis(q, dq), symbols @ dq, scale)
    # dT/dq, straight from the slopes of M.
    close(robot.coriolis_transposed(q, dq), 0.5 * np.einsum("ijk,i,j", slopes, dq, dq), scale)


@_EACH
@_MANY
@given(st.data())
def test_rates_along_a_motion(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    state = data.draw(states(robot.size))
    q, dq, ddq, dddq = state
    torque = robot.inverse_dynamics(q, dq, ddq)
    scale = float(np.abs(robot.mass(q)).max() + np.abs(torque).max())
    told = rate(lambda t: robot.inverse_dynamics(*along(state, t)))
    close(robot.inverse_dynamics_rate(q, dq, ddq, dddq), told, scale)
    told = rate(lambda t: robot.gravity(along(state, t)[0]))
    close(robot.gravity_rate(q, dq), told, scale)
    told = rate(lambda t: robot.coriolis(*along(state, t)[:2])) @ dq
    close(robot.coriolis_rate(q, dq, ddq), told, scale)


@_EACH
@_MANY
@given(st.data())
def test_the_same_dynamics_by_every_way(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    q, dq, ddq, torque = data.draw(states(robot.size))
    m, c, g = robot.mass(q), robot.coriolis(q, dq), robot.gravity(q)
    size = float(np.abs(m).max() + np.abs(g).max())
    assert np.array_equal(m, m.T)
    # Sums of the same terms in another order: rounding only.
    close(robot.bias(q, dq), c @ dq + g, size, 1e-13)
    close(robot.inverse_dynamics(q, dq, ddq), m @ ddq + c @ dq + g, size, 1e-12)
    close(robot.coriolis_transposed(q, dq), c.T @ dq, size, 1e-12)
    # The condition of M multiplies the rounding.
    loss = float(np.linalg.cond(m))
    found = robot.inverse_dynamics(q, dq, robot.accelerate(q, dq, torque))
    close(found, torque, size, 1e-14 * loss + 1e-13)
    assert robot.kinetic_energy(q, dq) == pytest.approx(0.5 * dq @ m @ dq, rel=1e-12, abs=1e-14)


@_EACH
@_MANY
@given(st.data())
def test_gravity_is_the_slope_of_its_energy(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    q, dq, _, _ = data.draw(states(robot.size))
    power = rate(lambda t: np.array(robot.potential_energy(q + t * dq)))
    size = abs(robot.potential_energy(q)) + float(np.abs(robot.gravity(q)).max())
    close(power, robot.gravity(q) @ dq, size)


@_EACH
@_MANY
@given(st.data())
def test_torques_put_in_what_the_energy_gains(name: str, data: st.DataObject) -> None:
    robot = arm(name)
    state = data.draw(states(robot.size))
    q, dq, ddq, _ = state

    def energy(t: float) -> NDArray[np.float64]:
        at, speed, _ = along(state, t)
        return np.array(robot.kinetic_energy(at, speed) + robot.potential_energy(at))

    torque = robot.inverse_dynamics(q, dq, ddq)
    close(rate(energy), dq @ torque, abs(float(energy(0.0))) + float(np.abs(torque).max()))


@_EACH
def test_results_are_the_callers_own(name: str) -> None:
    robot = arm(name)
    n = robot.size
    one, other = np.full(n, 0.3), np.full(n, -0.8)
    frame = robot.frames[-1]
    calls = (
        lambda x: robot.mass(x), lambda x: robot.coriolis(x, x), lambda x: robot.gravity(x),
        lambda x: robot.bias(x, x), lambda x: robot.coriolis_transposed(x, x),
        lambda x: robot.mass_rate(x, x), lambda x: robot.gravity_rate(x, x),
        lambda x: robot.coriolis_rate(x, x, x), lambda x: robot.inverse_dynamics(x, x, x),
        lambda x: robot.inverse_dynamics_rate(x, x, x, x), lambda x: robot.accelerate(x, x, x),
        lambda x: robot.jacobian(frame, x), lambda x: robot.pose(frame, x).rotation,
        lambda x: robot.pose(frame, x).position, lambda x: robot.motion(frame, x, x, x).velocity,
        lambda x: robot.motion(frame, x, x, x).acceleration,
    )  # fmt: skip
    for call in calls:
        first = call(one)
        kept = first.copy()
        call(other)
        assert np.array_equal(first, kept)
        first[...] = np.nan
        assert np.array_equal(call(one), kept)
