"""The plant and its integrator against closed forms, balances and an independent integrator."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotatum.errors import RotatumError
from rotatum.simulation.integrate import choose_substeps, integrate
from rotatum.simulation.plant import SeriesPlant, State, accelerations, energy, fastest_rate

PERIOD = 1e-3
# A robot's elbow: link 0.8 kg m^2, rotor 4e-5 kg m^2 behind a gear of 80, 200 N m/rad hardening.
JOINT = SeriesPlant(0.8, 0.3, 0.1, 15.0, 0.256, 0.35, 0.8, 200.0, 600.0, 0.05)
FREE = JOINT._replace(
    link_damping=0.0, link_coulomb=0.0, motor_damping=0.0, motor_coulomb=0.0, spring_damping=0.0
)
LINEAR = FREE._replace(gravity_torque=0.0, cubic=0.0)


def _run(plant, seconds, *, start=None, tau=0.0, tau_ext=0.0, substeps=None):
    time = np.arange(round(seconds / PERIOD) + 1) * PERIOD
    torques = (np.broadcast_to(np.asarray(x, float), time.shape) for x in (tau, tau_ext))
    return integrate(plant, time, *torques, start=start, substeps=substeps)


def test_locked_motor_oscillates_at_the_root_of_stiffness_over_inertia():
    # a rotor of 1e12 kg m^2 is a locked one: it takes 1e-12 of the motion
    plant = LINEAR._replace(motor_inertia=1e12)
    omega = math.sqrt(200.0 / 0.8)
    run = _run(plant, 5.0, start=State(q=0.1))
    # RK4's phase error is (omega h)^4 / 120 per radian, 5e-14 x 79 rad; the rest is rounding
    np.testing.assert_allclose(run.q, 0.1 * np.cos(omega * run.time), atol=1e-11)


def test_free_joint_has_a_rigid_and_an_elastic_mode():
    mobility = 1 / 0.8 + 1 / 0.256
    omega = math.sqrt(200.0 * mobility)
    run = _run(LINEAR, 5.0, start=State(q=0.1, dq=0.2))
    momentum, total = 0.8 * 0.2, 0.8 + 0.256
    phi = 0.1 * np.cos(omega * run.time) + 0.2 / omega * np.sin(omega * run.time)
    centre = (0.8 * 0.1 + momentum * run.time) / total
    # (omega h)^4 / 120 x 160 rad = 1e-10 of an amplitude of 0.1 rad
    np.testing.assert_allclose(run.q - run.theta, phi, atol=2e-11)
    np.testing.assert_allclose((0.8 * run.q + 0.256 * run.theta) / total, centre, atol=1e-11)


def test_spring_damping_and_viscous_friction_decay_as_the_formula_says():
    plant = LINEAR._replace(motor_inertia=1e12, spring_damping=0.5, link_damping=0.3)
    decay, omega = 0.8 / (2 * 0.8), math.sqrt(200.0 / 0.8 - (0.8 / (2 * 0.8)) ** 2)
    run = _run(plant, 5.0, start=State(q=0.1, dq=-0.1 * decay))
    expected = 0.1 * np.exp(-decay * run.time) * np.cos(omega * run.time)
    np.testing.assert_allclose(run.q, expected, atol=1e-11)  # as for the locked motor


def test_constant_torque_turns_against_full_coulomb_friction():
    plant = LINEAR._replace(motor_coulomb=0.8, link_coulomb=0.1)
    run = _run(plant, 4.0, tau=2.0)
    # sgn is regularised below 2e-2 rad/s, left within 20 ms: 1e-2 s x 1 rad/s^2 at the most
    mean = (run.dq[-1] * 0.8 + run.dtheta[-1] * 0.256) / 1.056
    assert mean == pytest.approx((2.0 - 0.9) / 1.056 * 4.0, abs=1e-2)


def test_friction_is_regularised_as_documented():
    at = {v: accelerations(JOINT, State(dtheta=v), 0.0, 0.0)[1] for v in (0.02, 0.2)}
    for v, share in ((0.02, math.tanh(4.0)), (0.2, 1.0)):
        spring = 0.05 * v
        assert at[v] == pytest.approx(-(0.8 * share + 0.35 * v + spring) / 0.256, rel=1e-12)


def test_energy_is_kept_without_damping():
    run = _run(FREE, 10.0, start=State(q=1.2, dq=0.5, theta=1.05, dtheta=-1.0))
    total = np.array([energy(FREE, State(*s)) for s in _states(run)])
    drift = np.max(np.abs(total / total[0] - 1.0))
    # asked for: 1e-6. RK4 loses (omega h)^6 / 72 of a mode's energy per step: 1e-12 in 1e5 steps
    assert drift < 1e-10


def test_momentum_changes_by_the_torques_from_outside():
    plant = FREE._replace(gravity_torque=0.0)
    t = np.arange(2001) * PERIOD
    tau, tau_ext = 5.0 * np.sin(20 * t), 3.0 * np.cos(7 * t)
    run = _run(plant, 2.0, tau=tau, tau_ext=tau_ext)
    momentum = 0.8 * run.dq + 0.256 * run.dtheta
    impulse = np.concatenate([[0.0], np.cumsum((tau + tau_ext)[:-1]) * PERIOD])
    # the spring's torque cancels in every stage of the integrator: rounding is all that is left
    np.testing.assert_allclose(momentum, impulse, atol=1e-12)


def test_work_and_losses_account_for_the_energy():
    t = np.arange(2001) * PERIOD
    tau = 12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t)
    run = _run(JOINT, 2.0, tau=tau)
    gained = energy(JOINT, State(*_states(run)[-1])) - energy(JOINT, State())
    work = np.sum(tau[:-1] * np.diff(run.theta))  # exact: the torque is held
    eps = JOINT.smoothing
    power = 0.3 * run.dq**2 + 0.1 * run.dq * np.tanh(run.dq / eps)
    power += 0.35 * run.dtheta**2 + 0.8 * run.dtheta * np.tanh(run.dtheta / eps)
    power += 0.05 * (run.dq - run.dtheta) ** 2
    lost = np.sum(power[1:] + power[:-1]) * PERIOD / 2
    assert lost > 0.3 * work > 0.1  # the balance is about something
    # trapezoidal rule over 1 ms: relative error of order (omega T)^2 / 12 at 31 rad/s, 1e-4
    assert gained == pytest.approx(work - lost, abs=1e-4 * work)


def test_trajectory_agrees_with_scipy():
    # friction smoothed over 0.05 rad/s, so that the reference's own error stays below 1e-10
    plant = JOINT._replace(smoothing=0.05)
    t = np.arange(301) * PERIOD
    tau, tau_ext = 12.0 * np.sin(9 * t) + 4.0, 3.0 * np.cos(7 * t)
    run = _run(plant, 0.3, tau=tau, tau_ext=tau_ext)
    state = np.zeros(4)
    for k in range(300):
        state = solve_ivp(
            _right_hand_side,
            (0.0, PERIOD),
            state,
            method="DOP853",
            args=(plant, tau[k], tau_ext[k]),
            rtol=1e-12,
            atol=1e-14,
        ).y[:, -1]
    # 10 steps of 0.1 ms; the step-halving test below states the error without smoothing
    np.testing.assert_allclose(_states(run)[-1], state, rtol=1e-9)


def _right_hand_side(_, y, plant, tau, tau_ext):
    """Written out again from the equations, not taken from the package."""
    q, dq, th, dth = y
    spring = 200 * (q - th) + 600 * (q - th) ** 3 + 0.05 * (dq - dth)
    link = tau_ext - spring - 15 * np.sin(q) - 0.3 * dq - 0.1 * np.tanh(dq / plant.smoothing)
    motor = tau + spring - 0.35 * dth - 0.8 * np.tanh(dth / plant.smoothing)
    return [dq, link / 0.8, dth, motor / 0.256]


def test_halving_the_step_shows_fourth_order():
    errors = [_halving_error(FREE, substeps, seconds=2.0) for substeps in (1, 2, 4)]
    for coarse, fine in itertools.pairwise(errors):
        # 2^4 in the limit; at omega h = 0.03 the next order is a few per cent
        assert coarse / fine == pytest.approx(16.0, rel=0.1)


def test_error_of_the_default_step_with_friction():
    # Measured 1.0e-6 rad: crossing the regularised sign within a few steps costs the order there.
    # A count of a 65,536-count encoder is a hundred times larger.
    assert _halving_error(JOINT, 10, seconds=5.0) < 2e-6


def _halving_error(plant, substeps, *, seconds):
    t = np.arange(round(seconds / PERIOD) + 1) * PERIOD
    tau = 12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t)
    runs = [_run(plant, seconds, tau=tau, substeps=n) for n in (substeps, 2 * substeps)]
    return np.max(np.abs(runs[0].q - runs[1].q) + np.abs(runs[0].theta - runs[1].theta))


def test_fastest_rate_bounds_the_eigenvalues():
    rng = np.random.default_rng(5)
    for _ in range(200):
        p = SeriesPlant(*10.0 ** rng.uniform(-2, 2, 8), 0.0, 10.0 ** rng.uniform(-2, 2))
        base = np.array([0.0, 0.0, 0.0, 0.0])
        columns = [_linearised(p, base + 1e-9 * e) / 1e-9 for e in np.eye(4)]
        # differences of 1e-9 around rest: linear to 1e-6 at the steepest smoothing
        assert np.max(np.abs(np.linalg.eigvals(np.array(columns).T))) <= fastest_rate(p) * 1.001


def _linearised(plant, state):
    link, motor = accelerations(plant, tuple(state), 0.0, 0.0)
    return np.array([state[1], link, state[3], motor])


def test_stiff_joints_get_more_steps():
    assert choose_substeps(JOINT, PERIOD) == 10
    stiff = JOINT._replace(motor_damping=0.256 * 1e5)  # 1e5 1/s: AwAS's second motor
    count = choose_substeps(stiff, PERIOD)
    assert count >= 200
    run = _run(stiff, 0.2, start=State(dtheta=1.0))
    assert abs(run.dtheta[-1]) < 1e-2


def test_too_few_steps_are_refused_with_the_number_needed():
    stiff = JOINT._replace(motor_damping=0.256 * 1e5)
    with pytest.raises(RotatumError, match="too few integration steps"):
        choose_substeps(stiff, PERIOD, 10)
    with pytest.raises(RotatumError, match="too few integration steps"):
        choose_substeps(JOINT, PERIOD, 0)


def test_divergence_names_the_time():
    runaway = LINEAR._replace(cubic=-1e4)
    with pytest.raises(RotatumError, match="ran away"):
        _run(runaway, 5.0, start=State(q=0.5))


def _states(run):
    return np.column_stack([run.q, run.dq, run.theta, run.dtheta])
