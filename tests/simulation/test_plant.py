"""The plant and its integrator against closed forms and balances: one motor, one spring."""

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from rotatum.errors import RotatumError, SimulationError
from rotatum.simulation import Body, Plant
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.friction import creep, friction, tanh
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.plant.steps import choose_substeps
from tests.simulation.plants import FREE, JOINT, LINEAR, PERIOD, clock, drive, spring

LOCKED = replace(LINEAR, motors=(Body(1e12),))  # takes 1e-12 of the motion


def test_locked_motor_oscillates_at_the_root_of_stiffness_over_inertia():
    omega = math.sqrt(200.0 / 0.8)
    run = drive(LOCKED, 5.0, start={"q": 0.1})
    # RK4's phase error is (omega h)^4 / 120 per radian, 5e-14 x 79 rad; the rest is rounding
    np.testing.assert_allclose(run["q"], 0.1 * np.cos(omega * clock(5.0)), atol=1e-11)


def test_free_joint_has_a_rigid_and_an_elastic_mode():
    mobility = 1 / 0.8 + 1 / 0.256
    omega, t = math.sqrt(200.0 * mobility), clock(5.0)
    run = drive(LINEAR, 5.0, start={"q": 0.1, "dq": 0.2})
    momentum, total = 0.8 * 0.2, 0.8 + 0.256
    phi = 0.1 * np.cos(omega * t) + 0.2 / omega * np.sin(omega * t)
    centre = (0.8 * 0.1 + momentum * t) / total
    # (omega h)^4 / 120 x 160 rad = 1e-10 of an amplitude of 0.1 rad
    np.testing.assert_allclose(run["deflection"][:, 0], phi, atol=2e-11)
    found = (0.8 * run["q"] + 0.256 * run["theta"][:, 0]) / total
    np.testing.assert_allclose(found, centre, atol=1e-11)


def test_spring_damping_and_viscous_friction_decay_as_the_formula_says():
    damped = spring("linear", stiffness=200.0, damping=0.5)
    plant = replace(LOCKED, link=Body(0.8, 0.3), transmissions=(damped,))
    decay, t = 0.8 / (2 * 0.8), clock(5.0)
    omega = math.sqrt(200.0 / 0.8 - decay**2)
    run = drive(plant, 5.0, start={"q": 0.1, "dq": -0.1 * decay})
    expected = 0.1 * np.exp(-decay * t) * np.cos(omega * t)
    np.testing.assert_allclose(run["q"], expected, atol=1e-11)  # as for the locked motor


def test_constant_torque_turns_against_full_coulomb_friction():
    plant = replace(LINEAR, link=Body(0.8, 0.0, 0.1), motors=(Body(0.256, 0.0, 0.8),))
    run = drive(plant, 4.0, tau=2.0)
    # sgn is regularised below 2e-2 rad/s, left within 20 ms: 1e-2 s x 1 rad/s^2 at the most
    mean = (run["dq"][-1] * 0.8 + run["dtheta"][-1, 0] * 0.256) / 1.056
    assert mean == pytest.approx((2.0 - 0.9) / 1.056 * 4.0, abs=1e-2)


def test_friction_is_regularised_as_documented():
    params = SimpleNamespace(damping=[0.35], coulomb=[0.8], excess=[0.0], smoothing=5e-3)
    for v, share in ((0.02, math.tanh(4.0)), (0.2, 1.0), (-0.02, -math.tanh(4.0)), (0.0, 0.0)):
        loss = friction(params, 0, v, 0.0)
        assert loss == pytest.approx(0.8 * share + 0.35 * v, rel=1e-14)


def test_tanh_is_the_hyperbolic_tangent():
    for x in np.linspace(-40.0, 40.0, 4001):
        # the difference of two numbers near 1 and of their rounding
        assert tanh(float(x)) == pytest.approx(math.tanh(x), abs=3e-16)


def test_creep_balances_torque_and_friction():
    rng = np.random.default_rng(2)
    for _ in range(500):
        damping, coulomb, net = 10.0 ** rng.uniform(-3, 2, 3) * [1, 1, rng.choice([-1, 1])]
        for C in (0.0, coulomb):
            params = SimpleNamespace(damping=[damping], coulomb=[C], excess=[0.0], smoothing=5e-3)
            v = creep(params, 0, net)
            # rounding of terms as large as the torque
            assert friction(params, 0, v, 0.0) == pytest.approx(net, rel=1e-12)


def test_energy_is_kept_without_damping():
    run = drive(FREE, 10.0, start={"q": 1.2, "dq": 0.5, "theta": 1.05, "dtheta": -1.0})
    total = FREE.energy(run)
    # asked for: 1e-6. RK4 loses (omega h)^6 / 72 of a mode's energy per step: 1e-12 in 1e5 steps
    assert np.max(np.abs(total / total[0] - 1.0)) < 1e-10


def test_momentum_changes_by_the_torques_from_outside():
    plant, t = replace(FREE, gravity_torque=0.0), clock(2.0)
    tau, tau_ext = 5.0 * np.sin(20 * t), 3.0 * np.cos(7 * t)
    run = drive(plant, 2.0, tau=tau, tau_ext=tau_ext)
    momentum = 0.8 * run["dq"] + 0.256 * run["dtheta"][:, 0]
    impulse = np.concatenate([[0.0], np.cumsum((tau + tau_ext)[:-1]) * PERIOD])
    # the spring's torque cancels in every stage of the integrator: rounding is all that is left
    np.testing.assert_allclose(momentum, impulse, atol=1e-12)


def test_work_and_losses_account_for_the_energy():
    t = clock(2.0)
    tau = 12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t)
    run = drive(JOINT, 2.0, tau=tau)
    energy, dq, dtheta = JOINT.energy(run), run["dq"], run["dtheta"][:, 0]
    work = np.sum(tau[:-1] * np.diff(run["theta"][:, 0]))  # exact: the torque is held
    eps = JOINT.smoothing
    power = 0.3 * dq**2 + 0.1 * dq * np.tanh(dq / eps)
    power += 0.35 * dtheta**2 + 0.8 * dtheta * np.tanh(dtheta / eps)
    power += 0.05 * (dq - dtheta) ** 2
    lost = np.sum(power[1:] + power[:-1]) * PERIOD / 2
    assert lost > 0.3 * work > 0.1  # the balance is about something
    # trapezoidal rule over 1 ms: relative error of order (omega T)^2 / 12 at 31 rad/s, 1e-4
    assert energy[-1] - energy[0] == pytest.approx(work - lost, abs=1e-4 * work)


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
    t = clock(seconds)
    tau = 12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t)
    one, two = (drive(plant, seconds, tau=tau, substeps=n) for n in (substeps, 2 * substeps))
    return np.max(np.abs(one["q"] - two["q"]) + np.abs(one["theta"] - two["theta"])[:, 0])


@pytest.mark.parametrize("motors", [1, 2])
def test_fastest_rate_bounds_the_eigenvalues(motors):
    rng = np.random.default_rng(5)
    for _ in range(200):
        inertia, damping, coulomb = 10.0 ** rng.uniform(-2, 2, (3, motors + 1))
        stiffness, springy = 10.0 ** rng.uniform(-2, 2, (2, motors))
        bodies = [Body(*each) for each in zip(inertia, damping, coulomb, strict=True)]
        springs = tuple(
            spring("linear", stiffness=k, damping=d)
            for k, d in zip(stiffness, springy, strict=True)
        )
        gravity = 10.0 ** rng.uniform(-2, 2)
        plant = Plant("any", "any", bodies[0], tuple(bodies[1:]), springs, gravity)
        K = _coupled(stiffness) + np.diag([gravity] + [0.0] * motors)
        D = _coupled(springy) + np.diag(damping + coulomb / plant.smoothing)
        system = np.block(
            [[0 * K, np.eye(motors + 1)], [-K / inertia[:, None], -D / inertia[:, None]]]
        )
        # rounding of the eigenvalues
        assert np.max(np.abs(np.linalg.eigvals(system))) <= plant.fastest_rate(stiffness) * 1.001


def _coupled(values):
    """Springs or dampers between body 0 and each other."""
    matrix = np.diag([np.sum(values), *values])
    matrix[0, 1:] = matrix[1:, 0] = -values
    return matrix


def test_stiff_joints_get_more_steps():
    assert choose_substeps(JOINT, PERIOD, (200.0,)) == 10
    stiff = replace(JOINT, motors=(Body(0.256, 0.256 * 1e5),))  # 1e5 1/s: AwAS's second motor
    assert choose_substeps(stiff, PERIOD, (200.0,)) >= 200
    run = drive(stiff, 0.2, start={"dtheta": 1.0})
    assert abs(run["dtheta"][-1, 0]) < 1e-2


def test_a_spring_that_hardens_on_the_way_gets_more_steps():
    # 14 rad/s at rest, 4,200 rad/s where it ends up
    hard = replace(FREE, link=Body(1e-3), transmissions=(spring("sinh", k=1e-3, a=200.0),))
    drift = {}
    for substeps in (None, 10):
        run = drive(hard, 0.5, start={"dq": 30.0}, substeps=substeps)
        energy = hard.energy(run)
        drift[substeps] = np.max(np.abs(energy / energy[0] - 1.0))
    assert choose_substeps(hard, PERIOD, hard.rest_stiffness(0.0)) == 10
    # a twentieth of 1e-6 in 10 s; with 10 steps measured 9.6e-3
    assert drift[None] < 5e-8
    assert drift[10] > 5e-3


def test_a_motion_that_stops_keeps_what_was_good():
    soft = replace(LINEAR, transmissions=(spring("linear", stiffness=200.0, limit=0.02),))
    t = clock(1.0)
    zero = np.zeros_like(t)
    inputs = Inputs(t, zero[:, None], zero + 20.0, zero, zero)
    whole, cut = run_plant(LINEAR, inputs), run_plant(soft, inputs)
    first = int(np.argmax(whole.at["deflection"][:, 0] > 0.02))
    assert whole.stopped is None
    assert isinstance(cut.stopped, SimulationError)
    assert cut.stopped.where == f"elbow, t = {t[first]:.6g} s"
    assert cut.at.size == first
    for name in cut.at.dtype.names:
        np.testing.assert_array_equal(cut.at[name], whole.at[name][:first])


def test_the_lightest_a_payload_makes_the_link_chooses_the_steps():
    stiff = replace(LINEAR, transmissions=(spring("linear", stiffness=2e4),))
    t = clock(0.1)
    zero = np.zeros_like(t)
    inputs = Inputs(t, zero[:, None], zero, zero, zero)
    lighter = replace(stiff, link=Body(0.02))
    course = run_plant(stiff, inputs, added=(np.where(t > 0.05, -0.78, 0.0), zero))
    assert (
        course.substeps == run_plant(lighter, inputs).substeps > run_plant(stiff, inputs).substeps
    )
    with pytest.raises(RotatumError, match=r"elbow, payload: .* no inertia.*more than -0\.8"):
        run_plant(stiff, inputs, added=(zero - 0.8, zero))


def test_too_few_steps_are_refused_with_the_number_needed():
    stiff = replace(JOINT, motors=(Body(0.256, 0.256 * 1e5),))
    with pytest.raises(RotatumError, match=r"elbow, substeps: too few.*38 or more"):
        choose_substeps(stiff, PERIOD, (200.0,), 10)
    with pytest.raises(RotatumError, match="too few integration steps"):
        choose_substeps(JOINT, PERIOD, (200.0,), 0)


def test_a_start_that_is_no_number_is_refused():
    with pytest.raises(RotatumError, match=r"start, dtheta.*finite"):
        drive(JOINT, 0.1, start={"dtheta": math.inf})


def test_a_start_that_does_not_exist_is_refused():
    with pytest.raises(RotatumError, match=r"'theta1'.*theta, dtheta"):
        drive(JOINT, 0.1, start={"theta1": 1.0})


def test_a_runaway_names_joint_time_and_deflection():
    with pytest.raises(
        RotatumError, match=r"^elbow, t = [\d.]+ s: .* ran away, at a deflection of"
    ):
        drive(LINEAR, 5.0, tau=1e7, tau_ext=1e7)


@pytest.mark.parametrize("compiled", ["0", "1"])
def test_a_runaway_is_found_interpreted_and_compiled(compiled, monkeypatch):
    monkeypatch.setenv("ROTATUM_JIT", compiled)
    with pytest.raises(RotatumError, match=r"t = 0\.001 s.*ran away"):
        drive(JOINT, 0.004, tau_ext=1e30)


def test_leaving_the_range_names_joint_transmission_time_deflection_and_range():
    soft = replace(LINEAR, transmissions=(spring("linear", stiffness=200.0, limit=0.02),))
    first = drive(LINEAR, 1.0, tau_ext=20.0)["deflection"][:, 0]
    at = int(np.argmax(first > 0.02))
    message = (
        rf"^elbow, t = {at * PERIOD:.6g} s: the deflection of the transmission, law \"linear\", "
        rf"leaves its range, got {first[at]:.6g}; allowed: -0.02 to 0.02 rad"
    )
    with pytest.raises(RotatumError, match=message):
        drive(soft, 1.0, tau_ext=20.0)
