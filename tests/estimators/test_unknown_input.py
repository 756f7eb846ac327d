"""Exact unknown-input observers: existence, matrices, convergence; the paper's own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvals

from rotatum.errors import MethodError
from rotatum.estimators.observers.decoupled import exact_observer
from rotatum.estimators.observers.existence import exists, require
from rotatum.estimators.observers.system import invertibility, observability, scaled, system
from rotatum.estimators.observers.triple import printed_observer, triple_integrator
from tests.estimators.observed import mixed, redundant, simulate, siso

T = 2.0**-8  # a power of two: products and quotients with it round nowhere


def conditions(given, observer):
    """A1 and A2 of trumic2022 Proposition 1, in units in which all matrices are of order one."""
    s = scaled(given)
    L = observer.recursion.lag
    F = observer.F / s.x[:, None] * np.tile(s.y, L + 1)
    E = observer.E / s.x[:, None] * s.x
    A, B, C, _ = s.system
    wanted = np.hstack([B, np.zeros((len(A), L * B.shape[1]))])
    return F @ invertibility(*s.system, L) - wanted, E - A + F @ observability(A, C, L)


def errors(given, recursion, seed=0, samples=300):
    """Estimates minus truth for inputs of any kind: white noise, a step, a growing sine.

    In units of what rounding of the outputs does to them: 1000 times 2^-53 of the largest, through
    the recursion's impulse response.
    """
    rng = np.random.default_rng(seed)
    m = given.sizes[1]
    k = np.arange(samples)
    u = rng.standard_normal((samples, m)) + 5.0 * (k > 100)[:, None]
    u += (0.02 * k * np.sin(0.3 * k))[:, None]
    x, y = simulate(given, u, x0=2.0)
    out = recursion.run(y)
    first = recursion.window - 1 - recursion.lag
    truth = np.hstack([x, u])[first : first + len(out)]
    amplified = np.abs(recursion.impulse(100)).sum(axis=0) @ np.abs(y).max(axis=0)
    return (out - truth) / (1000.0 * 2.0**-53 * (amplified + np.abs(truth).max(axis=0)))


SYSTEMS = {
    "zero at 0.6": (siso(0.6), 1),
    "two inputs, three outputs": (redundant(), 1),
    "with feedthrough": (redundant(7, 5, feedthrough=True), 0),
    "feedthrough and integrators": (mixed(), 2),
    "triple integrator": (triple_integrator(5e-3), 3),
    "two triple integrators": (triple_integrator(1e-3, 2), 3),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_smallest_delay_is_found_and_a_shorter_one_refused(name):
    given, delay = SYSTEMS[name]
    found = exists(given)
    assert found.ok
    assert found.delay == delay
    if delay > 0:
        with pytest.raises(MethodError, match=f"allowed: {delay} or more"):
            exact_observer(given, delay - 1)


@pytest.mark.parametrize("extra", [0, 1, 3])
@pytest.mark.parametrize("name", SYSTEMS)
def test_deadbeat_forgets_its_start_in_finite_time(name, extra):
    given, delay = SYSTEMS[name]
    observer = exact_observer(given, delay + extra)
    n = given.sizes[0]
    for residual in conditions(given, observer):
        assert np.abs(residual).max() < 1e-12  # rounding of matrices of order one
    apart = errors(given, observer.recursion)
    # Zeros decay at their own pace, 0.6^60 = 5e-14; without any, n steps are enough.
    steps = 60 if len(observer.fixed) else n
    assert np.abs(apart[steps:]).max() < 1.0


@pytest.mark.parametrize("name", SYSTEMS)
def test_poles_stand_where_they_were_asked_for(name):
    given, delay = SYSTEMS[name]
    fixed = exists(given).zeros
    wanted = np.linspace(0.2, 0.7, given.sizes[0] - len(fixed))
    observer = exact_observer(given, delay, wanted)
    s = scaled(given)
    found = np.linalg.eigvals(observer.E / s.x[:, None] * s.x)
    every = np.sort(np.concatenate([wanted, fixed.real]))
    np.testing.assert_allclose(np.sort(found.real), every, atol=1e-8)
    assert np.abs(found.imag).max() < 1e-8
    assert np.abs(errors(given, observer.recursion)[200:]).max() < 1.0  # 0.7^200 = 1e-31
    for residual in conditions(given, observer):
        assert np.abs(residual).max() < 1e-12


def test_complex_poles_and_bad_ones():
    given = redundant()
    poles = [0.3 + 0.4j, 0.3 - 0.4j, 0.1, 0.2]
    found = np.linalg.eigvals(exact_observer(given, 1, poles).E)
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(poles), atol=1e-8)
    for bad in ([0.1, 0.2], [0.1, 0.2, 0.3, 1.0], [0.1, 0.2, 0.3, 0.4j]):
        with pytest.raises(MethodError, match="poles"):
            exact_observer(given, 1, bad)


def pencil_zeros(given):
    """Invariant zeros of a square system: finite eigenvalues of Rosenbrock's pencil."""
    A, B, C, D = given
    n, _, _ = given.sizes
    system_matrix = np.block([[A, B], [C, D]])
    unit = np.zeros_like(system_matrix)
    unit[:n, :n] = np.eye(n)
    found = eigvals(system_matrix, unit)
    return in_order(found[np.abs(found) < 1e6])


def in_order(roots):
    """Sorted, pairs the same way round whatever the rounding."""
    return np.sort_complex(np.round(roots, 9))


@pytest.mark.parametrize("seed", range(6))
def test_fixed_modes_are_the_invariant_zeros(seed):
    rng = np.random.default_rng(seed)
    m = 1 + seed % 2
    A, B, C = (rng.standard_normal(s) for s in ((5, 5), (5, m), (m, 5)))
    D = rng.standard_normal((m, m)) if seed > 3 else None
    given = system(A / 2.0, B, C, D)
    wanted = pencil_zeros(given)
    assert len(wanted) > 0
    # Single zeros of a well-scaled pencil: rounding times its condition.
    np.testing.assert_allclose(in_order(exists(given).zeros), wanted, atol=1e-8)


def test_an_unstable_zero_is_refused_and_named():
    found = exists(siso(1.25))
    assert not found.ok
    assert found.delay == 1
    np.testing.assert_allclose(found.unstable, [1.25], atol=1e-9)
    with pytest.raises(MethodError, match=r"invariant zeros that do not decay \(1\.25\)"):
        exact_observer(siso(1.25), 1)
    with pytest.raises(MethodError, match=r"\(1\)"):
        require(siso(1.0), 1)  # an integrated output: on the circle


def test_an_unobservable_mode_counts_as_a_zero():
    given = system(np.diag([0.5, 1.1]), [[1.0], [0.0]], [[1.0, 0.0]])
    np.testing.assert_allclose(exists(given).unstable, [1.1], atol=1e-9)


def test_more_inputs_than_outputs_and_inputs_alike_are_refused():
    A = np.diag([0.5, 0.4])
    with pytest.raises(MethodError, match="no delay makes the inputs recoverable"):
        exact_observer(system(A, np.eye(2), [[1.0, 1.0]]), 4)
    with pytest.raises(MethodError, match="inputs act alike"):
        exact_observer(system(A, [[1.0, 2.0], [1.0, 2.0]], np.eye(2)), 1)
    with pytest.raises(MethodError, match="C: shape does not fit"):
        system(A, np.eye(2), [[1.0, 1.0, 1.0]])


def test_the_matrices_of_equation_12():
    given = triple_integrator(T)
    O3 = [[1, 0, 0], [1, T, 0], [1, 2 * T, T**2], [1, 3 * T, 3 * T**2]]
    H3 = np.zeros((4, 4))
    H3[3, 0] = T**3
    assert observability(given.A, given.C, 3).tolist() == O3
    assert invertibility(*given, 3).tolist() == H3.tolist()


@pytest.mark.parametrize("joints", [1, 3])
def test_the_printed_observer_obeys_its_conditions(joints):
    given, observer = triple_integrator(T, joints), printed_observer(T, joints)
    H, O3 = invertibility(*given, 3), observability(given.A, given.C, 3)
    wanted = np.hstack([given.B, np.zeros((3 * joints, 3 * joints))])
    assert np.array_equal(observer.F @ H, wanted)  # exact: T is a power of two
    assert (observer.E == given.A - observer.F @ O3).all()
    assert not np.linalg.matrix_power(observer.E, 3).any()
    each = np.eye(joints)
    np.testing.assert_allclose(observer.J, np.kron([[0.0, 0.0, 1.0 / T, 0.0]], each), atol=1e-12)


def test_joints_are_copies_of_one():
    one, three = printed_observer(T), printed_observer(T, 3)
    order = np.arange(9).reshape(3, 3).T.ravel()  # joint by joint, as P of the paper's proof
    blocks = np.kron(np.eye(3), one.E)
    assert (three.E[np.ix_(order, order)] == blocks).all()
    window = np.arange(12).reshape(4, 3).T.ravel()
    assert (three.F[np.ix_(order, window)] == np.kron(np.eye(3), one.F)).all()
    q = np.random.default_rng(2).standard_normal((50, 3))
    together = three.recursion.run(q)
    for joint in range(3):
        alone = one.recursion.run(q[:, joint])
        # One takes E and F of three joints, zeros included: the order of additions differs.
        np.testing.assert_allclose(together[:, joint::3], alone, rtol=1e-9, atol=1e-6)


def equation_13(q, T):
    """The decentralised rule as printed."""
    x = np.zeros(3)
    u = []
    for now in q:
        beta = now - x[0]
        u.append(beta / T**3 - 3.0 / T**2 * x[1] - 3.0 / T * x[2])
        x = np.array([x[0] + T * x[1], x[1] + T * x[2],
                      beta / T**2 - 3.0 / T * x[1] - 2.0 * x[2]])  # fmt: skip
    return np.array(u)


@pytest.mark.parametrize("period", [T, 5e-3])
def test_deadbeat_is_the_third_backward_difference(period):
    q = 0.3 * np.random.default_rng(3).standard_normal(200)
    difference = np.convolve(q, [1.0, -3.0, 3.0, -1.0], "valid")
    # Rounding of q and of eight terms up to 3 q.
    tolerance = {"rtol": 0.0, "atol": 30.0 * 2.0**-52}
    for U in (
        equation_13(q, period)[3:],
        printed_observer(period).recursion.run(q)[:, 3],
        exact_observer(triple_integrator(period), 3).recursion.run(q)[:, 3],
    ):
        np.testing.assert_allclose(U[3:] * period**3, difference[3:], **tolerance)


def test_the_residual_takes_the_output_of_the_states_own_instant():
    """Eq. 6 prints the newest output there: right for D = 0 only."""
    given, L = mixed(), 2
    observer = exact_observer(given, L)
    u = np.random.default_rng(8).standard_normal((200, 2))
    _, y = simulate(given, u, x0=1.0)
    found = observer.recursion.run(y)
    X = found[:, :3]
    moved = X[1:] - X[:-1] @ given.A.T
    for age, right in ((L, True), (0, False)):
        residual = y[L - age :][: len(moved)] - X[:-1] @ given.C.T
        U = np.hstack([moved, residual]) @ observer.J.T
        apart = np.abs(U - u[: len(U)])[60:].max()  # a zero at 0.2: 0.2^60 is nothing
        assert (apart < 1e-12) == right
        if right:
            np.testing.assert_allclose(found[:-1, 3:], U, atol=1e-12)
