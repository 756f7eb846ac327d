"""The observer of deluca2007 against the paper's own coordinates, and against exact motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rotatum.estimators.full_state.design import Design, recursion_of
from rotatum.estimators.full_state.drivetrain import Drivetrain
from rotatum.estimators.full_state.poles import Pair, discretise, gains
from rotatum.kernels import luenberger
from rotatum.kernels.status import NOT_FINITE, RESTARTED, SETTLING, UNSEEN
from tests import naive
from tests.kernels.observing import STATES, Observer, hold_bound, moved, to_w

T = 1e-3
AXIS = Drivetrain(inertia=14.33, stiffness=474e3, damping=55.0, motor_damping=9.0)  # r3, axis 1
PAIRS = (Pair(250.0, 0.8), Pair(180.0, 0.6))
DESIGN = Design(AXIS, T, PAIRS, held=True)
LIGHT, LOADED = 100.0, 115.0  # kg m^2: 15 kg at a metre, untold


def close(found, expected, share):
    """Whether all of each column agrees, to a share of the column's largest."""
    apart = np.abs(found - expected).max(axis=0)
    assert np.all(apart <= share * np.abs(expected).max(axis=0)), apart


def torques(n=300, seed=400):
    """Held torques, N m: steps of random size."""
    return 100.0 * np.random.default_rng(seed).standard_normal(n // 20 + 1).repeat(20)[:n]


def signals(n=300, seed=401):
    """Any theta, torque and acceleration: they need not belong to a joint."""
    rng, t = np.random.default_rng(seed), T * np.arange(n)[:, None]
    waves = np.sin(t * rng.uniform(2.0, 200.0, (1, 12)) + rng.uniform(0.0, 6.0, (1, 12)))
    theta, torque, acceleration = (waves[:, 4 * i : 4 * i + 4].sum(axis=1) for i in range(3))
    return {"theta": theta, "torque": 1e3 * torque, "acceleration": 20.0 * acceleration}


def run(observer, given):
    n = len(given["theta"])
    return np.array([observer.push(**{k: float(v[i]) for k, v in given.items()}) for i in range(n)])


def twin(design, given, stiffness, start):
    each = [gains(design.pairs, design.drivetrain._replace(stiffness=K)) for K in stiffness]
    return naive.acceleration_observer(
        np.array(each),
        inertia=design.drivetrain.inertia,
        stiffness=stiffness,
        damping=design.drivetrain.damping,
        motor_damping=design.drivetrain.motor_damping,
        period=design.period,
        start=start,
        held=design.held,
        **given,
    )


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("changing", [False, True])
def test_is_equation_6_with_the_gains_of_remark_3(held, changing):
    n = 120
    design, given = DESIGN._replace(held=held), signals(n)
    stiffness = np.full(n, AXIS.stiffness)
    if changing:  # steps up and down by a half, and a slow wave
        stiffness *= 1.0 + 0.5 * np.sign(np.sin(0.2 * np.arange(n))) + 0.2 * np.sin(np.arange(n))
    found = run(Observer(design), {**given, "stiffness": stiffness})
    expected = twin(design, given, stiffness, [given["theta"][0], given["theta"][0], 0.0, 0.0])
    # Runge and Kutta in steps h: (|lambda| h)^4 = 6e-10, |lambda| the 280 rad/s of the motor on its
    # spring at the stiffest, h = T / 20; no pole is faster.
    close(found, expected, 1e-8)


def test_with_a_gyroscope_is_the_recursion_of_its_design():
    design = Design(AXIS, T, PAIRS, gyro=120.0, held=False)
    given = signals() | {"rate": np.cos(30.0 * T * np.arange(300))}
    recursion = recursion_of(design)
    names = ("theta", "torque", "acceleration", "rate")
    outputs = np.stack([given[name] for name in names], axis=1)
    outputs[0, 1:] = 0.0  # the kernel starts at rest: the recursion's start, too, must be it
    for name, column in zip(names, outputs.T, strict=True):
        given[name] = column
    observer = Observer(design)
    found = run(observer, given)
    # From rest the recursion has theta = q: a state that stands with this theta and no torque.
    expected = recursion.run(outputs)[:, :4]
    # Rounding of w, whose entries differ by a0 T^3 = 4: 300 sums of 1e-16, q being w3 / k.
    close(found[1:], expected, 1e-11)


@pytest.mark.parametrize("mass", [LIGHT, LOADED])
def test_a_wrong_start_dies_as_designed_whatever_the_payload(mass):
    start = np.array([0.3, 0.3002, 5.0, 4.99])  # the observer: at rest, no deflection
    motion = moved(DESIGN, mass, torques(), start, load=-80.0)
    error = motion.x - Observer(DESIGN).watch(motion)
    W = to_w(DESIGN)
    powers, expected = discretise(PAIRS, T).transition, [W @ error[0]]
    np.testing.assert_array_equal(error[0], start - [0.3, 0.3, 0.0, 0.0])
    for _ in range(len(error) - 1):
        expected.append(powers @ expected[-1])
    designed = np.array(expected) @ np.linalg.inv(W).T
    bound = hold_bound(DESIGN, motion)
    # What is not designed is what lies between the samples: a bound, not a fit; and rounding.
    assert np.all(np.abs(error - designed) <= bound + 1e-12)
    # The bound is far below the error that is watched, so that the claim means something.
    assert np.all(bound < 0.1 * np.abs(designed).max(axis=0))


def test_two_payloads_leave_the_same_error_to_rounding():
    start, tau = np.array([0.3, 0.3002, 5.0, 4.99]), torques()
    errors = []
    for mass in (LIGHT, LOADED):
        motion = moved(DESIGN, mass, tau, start, load=-8.0 * mass)
        right = Observer(DESIGN)
        right.push(theta=start[0], torque=float(tau[0]), acceleration=motion.acceleration[0])
        right.put(start)
        told = []
        for theta, u, a in zip(motion.x[1:, 0], tau[1:], motion.acceleration[1:], strict=True):
            told.append(right.push(theta=float(theta), torque=float(u), acceleration=float(a)))
        # Beside one that starts right, so that what lies between the samples cancels.
        errors.append(np.array(told) - Observer(DESIGN).watch(motion)[1:])
    # Rounding: 1e-16 of theta, times k T^2 and a few powers of a T, over 300 samples.
    scale = np.abs(errors[0]).max(axis=0)
    close(errors[0], errors[1], 1e-10)
    assert np.all(np.abs(errors[0][-1]) < 1e-6 * scale)  # 0.3 s: exp(-108 * 0.3) = 1e-14


def test_coulomb_friction_told_is_friction_compensated():
    friction, start = 42.0, np.array([0.0, -0.002, 1.0, 1.0])
    motion = moved(DESIGN, LIGHT, np.full(400, 300.0), start)
    assert motion.x[:, 2].min() > 0.3  # it turns one way: the friction is a constant torque
    given = {"torque": motion.torque + friction}
    bound = hold_bound(DESIGN, motion)
    told = Observer(DESIGN, coulomb=friction, width=0.01).watch(motion, **given)
    untold = Observer(DESIGN).watch(motion, **given)
    # 0.2 s after its start at rest: exp(-108 * 0.2) of it is left, 1e-9.
    assert np.all(np.abs(told - motion.x)[200:] <= bound + 1e-8)
    # Told nothing, the link seems to be further back by what would bear the friction.
    lag = (untold - motion.x)[200:, 1] + friction / AXIS.stiffness
    assert np.all(np.abs(lag) <= bound[1] + 1e-8)


def test_coupling_is_a_torque_that_follows_the_acceleration():
    given, nothing = signals(), np.zeros(300)
    pull = 0.078 * given["acceleration"]
    sampled = DESIGN._replace(held=False)
    together = run(Observer(sampled), {**given, "coupling": pull})
    taken = run(Observer(sampled), {**given, "torque": given["torque"] - pull})
    # The same sums in another order: rounding, over 300 samples.
    close(together, taken, 1e-11)
    # With a held torque the coupling is still a straight line: by superposition.
    whole = run(Observer(DESIGN), {**given, "coupling": pull})
    alone = run(Observer(DESIGN), given)
    rest = run(Observer(sampled), {"theta": nothing, "torque": -pull, "acceleration": nothing})
    close(whole, alone + rest, 1e-11)


def driven(design, tau, mass, elastic, friction, see):
    """Move a joint with any spring and motor friction by the midpoint rule; show it to ``see``.

    ``see(state, torque, q'')`` is called at every sample. Ten steps a sample: (h w)^2 = 1e-4, w of
    the joint's mode, is the error of a turn of it.
    """
    B, _, D, C, _ = design.drivetrain
    h, x = T / 10, np.zeros(4)

    def rates(x, u):
        spring = elastic(x[1] - x[0]) + D * (x[3] - x[2])
        motor = (u - C * x[2] - friction(x[2]) + spring) / B
        return np.array([x[2], x[3], motor, -spring / mass])

    for u in tau:
        see(x, float(u), float(rates(x, u)[3]))
        for _ in range(10):
            x = x + h * rates(x + 0.5 * h * rates(x, u), u)


def test_a_law_that_is_no_straight_line_enters_by_its_tangent():
    k1, k3 = 2000.0, 4e6
    design = Design(Drivetrain(0.25, k1, 0.5, 0.3), T, PAIRS, held=True)
    tangent, straight = Observer(design), Observer(design)
    errors, deflections = [], []

    def see(x, u, acceleration):
        phi = tangent.out.deflection
        sigma = k1 + 3.0 * k3 * phi**2
        bias = k1 * phi + k3 * phi**3 - sigma * phi
        given = {"theta": float(x[0]), "torque": u, "acceleration": acceleration}
        found = tangent.push(**given, stiffness=sigma, bias=bias)
        errors.append([found - x, straight.push(**given) - x])
        deflections.append(x[1] - x[0])

    tau = 40.0 * np.sin(12.0 * T * np.arange(800)) + 30.0
    driven(design, tau, 0.8, lambda phi: k1 * phi + k3 * phi**3, lambda v: 0.0, see)
    size = np.abs(errors)[300:].max(axis=0)
    largest = np.abs(deflections).max()
    assert 3.0 * k3 * largest**2 > k1  # the stiffness more than doubles
    assert size[0, 1] < 2e-3 * largest  # a sample's delay of the tangent, and the midpoint rule
    assert size[1, 1] > 0.2 * largest  # without it the link is somewhere else


def test_friction_that_reverses_is_compensated_but_for_the_moment_of_it():
    friction, width, stiffness = 3.0, 0.05, 2000.0
    design = Design(Drivetrain(0.25, stiffness, 0.5, 0.3), T, PAIRS, held=True)
    told, untold = Observer(design, coulomb=friction, width=width), Observer(design)
    errors = []

    def see(x, u, acceleration):
        given = {"theta": float(x[0]), "torque": u, "acceleration": acceleration}
        errors.append([told.push(**given) - x, untold.push(**given) - x, [x[2]] * 4])

    tau = 20.0 * np.sin(20.0 * T * np.arange(900))
    driven(
        design,
        tau,
        0.8,
        lambda phi: stiffness * phi,
        lambda v: friction * max(-1.0, min(1.0, v / width)),
        see,
    )
    q, missed, speed = np.abs(np.array(errors)[300:, :, 1]).T
    assert speed.min() < width < speed.max()  # it does reverse
    # Friction is that of a sample ago: wrong by twice itself at most, for one sample of the some
    # 1 / (0.6 * 180 rad/s) = 9 over which the observer averages. Untold it is wrong for ever.
    assert q.max() < 2.0 / 9.0 * friction / stiffness
    assert missed.max() > 0.9 * friction / stiffness


@pytest.mark.parametrize("name", ["time", "theta", "torque", "acceleration", "coupling"])
def test_a_sample_that_is_not_finite_leaves_the_state(name):
    observer, given = Observer(DESIGN), signals(40)
    before = run(observer, given)[-1]
    kept = vars(observer.state).copy(), list(observer.state.w)
    for bad in (math.nan, math.inf, 1e13):
        values = {"theta": 0.1, "torque": 1.0, "acceleration": 0.0} | {name: bad}
        found = observer.push(**values)
        np.testing.assert_array_equal(found, before)
        assert observer.out.status == NOT_FINITE | SETTLING
    assert (vars(observer.state), list(observer.state.w)) == kept


def test_a_gyroscope_that_is_not_there_may_say_anything():
    observer = Observer(DESIGN)
    observer.push(theta=0.1, rate=math.nan)
    assert observer.out.status == RESTARTED | SETTLING
    with_one = Observer(DESIGN._replace(gyro=50.0))
    with_one.push(theta=0.1, rate=math.nan)
    assert with_one.out.status & NOT_FINITE


def test_a_held_sample_repeats_the_estimate_and_says_why():
    observer = Observer(DESIGN)
    before = run(observer, signals(40))[-1]
    found = observer.push(theta=9.0, hold=1, status=64)
    np.testing.assert_array_equal(found, before)
    assert observer.out.status == 64 | SETTLING


def test_stiffness_bias_and_rest_that_are_not_finite_cost_only_themselves():
    observer = Observer(DESIGN)
    observer.push(theta=0.1, stiffness=3e5, bias=5.0, rest=math.nan)
    assert abs(observer.out.deflection) < 1e-16  # a bit of theta
    assert observer.out.status & NOT_FINITE
    observer.push(theta=0.1, stiffness=math.nan, bias=math.inf)
    assert (observer.state.stiffness, observer.state.bias) == (3e5, 5.0)
    assert observer.out.status & NOT_FINITE
    observer.push(theta=0.1)
    assert observer.state.stiffness == AXIS.stiffness  # 0: the params' own


def test_starts_at_rest_where_it_is_told_and_again_when_fresh():
    observer = Observer(DESIGN)
    found = observer.push(theta=0.4, rest=-0.001, torque=474.0)
    np.testing.assert_allclose(found, [0.4, 0.399, 0.0, 0.0], rtol=0.0, atol=1e-15)  # rounding
    assert observer.out.torque == pytest.approx(-474.0, rel=1e-9)
    for _ in range(50):  # a joint at rest under gravity: nothing moves
        found = observer.push(theta=0.4, torque=474.0)
    np.testing.assert_allclose(found, [0.4, 0.399, 0.0, 0.0], rtol=0.0, atol=1e-11)  # rounding
    run(observer, signals(40))
    found = observer.push(theta=0.7, rest=0.002, fresh=1)
    np.testing.assert_allclose(found, [0.7, 0.702, 0.0, 0.0], rtol=0.0, atol=1e-15)
    assert observer.out.status == RESTARTED | SETTLING


def test_says_when_a_start_is_forgotten():
    observer, seen = Observer(DESIGN, settle=3), []
    for _ in range(5):
        observer.push(theta=0.1)
        seen.append(observer.out.status)
    assert seen == [RESTARTED | SETTLING, SETTLING, SETTLING, 0, 0]


def test_an_acceleration_nobody_sees_is_none_and_flagged():
    unseen, still = Observer(DESIGN), Observer(DESIGN)
    given = signals(60)
    found = run(unseen, {**given, "acceleration": np.full(60, math.nan), "seen": np.zeros(60)})
    assert unseen.out.status & UNSEEN
    np.testing.assert_array_equal(found, run(still, {**given, "acceleration": np.zeros(60)}))


def test_a_stiffness_stays_within_its_bounds_and_its_rate():
    observer = Observer(DESIGN, softest=1e5, stiffest=1e6, change=0.25)
    observer.push(theta=0.1, stiffness=4e5)
    used = []
    for asked in (8e5, 8e5, 8e5, 8e5, 5e6, 5e6, 1.0):
        observer.push(theta=0.1, stiffness=asked)
        used.append(observer.out.stiffness)
    assert used == [5e5, 6.25e5, 7.8125e5, 8e5, 1e6, 1e6, 8e5]


def test_a_new_stiffness_moves_neither_position_nor_velocity():
    observer = Observer(DESIGN)
    before = run(observer, signals(80))[-1]
    luenberger._reschedule(observer.params, observer.state, 1.7 * AXIS.stiffness)
    luenberger.hold(observer.params, observer.state, observer.out)
    after = [getattr(observer.out, name) for name in STATES]
    np.testing.assert_allclose(after, before, rtol=1e-13)  # rounding of a division and a product
    assert observer.out.stiffness == 1.7 * AXIS.stiffness
