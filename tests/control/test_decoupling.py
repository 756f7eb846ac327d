"""Position and stiffness decoupled: the law on known truth, and what stands in when it must not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState
from rotatum.control.decoupling import DecouplingGains, DecouplingLaw, Target, steerability
from rotatum.control.motor_position import MotorMotion, MotorPosition
from rotatum.control.pole_placement import PolePair
from rotatum.control.preset import preset
from rotatum.control.stiffness_control import Command, StiffnessControl
from rotatum.control.switching import ASTRAY, BLIND, LIMITED, SINGULAR, UNTRUSTED, Switching
from rotatum.errors import DeviceError, RotatumError
from rotatum.models.device import load_device
from rotatum.models.elastic import Elastic, KnownLaw

Array = NDArray[np.float64]
Laws = tuple[KnownLaw, KnownLaw]
PERIOD = 1e-3
GAINS = DecouplingGains.of_poles((PolePair(12.0), PolePair(15.0, 0.8)), PolePair(20.0, 0.7))
REACH = 0.3


@cache
def known(name: str = "vsa-ii") -> tuple[AntagonisticJoint, Laws]:
    joint = load_device(name).joints[0]
    first, second = joint.transmissions
    free = replace(AntagonisticJoint.of(joint), limits=(math.inf, math.inf))
    return free, (KnownLaw(first), KnownLaw(second))


def at(laws: Laws, state: JointState) -> tuple[Elastic, Elastic]:
    x, y = state.deflections
    return laws[0].evaluate(x), laws[1].evaluate(y)


def moving(
    joint: AntagonisticJoint, laws: Laws, torques: Callable[[JointState], Array]
) -> Callable[[float, Array], list[float]]:
    """Return x' of x = (q, q', theta, theta'), written out anew from the joint's two equations."""

    def rate(t: float, x: Array) -> list[float]:
        q, dq, a, b, da, db = x.tolist()
        u = torques(JointState(q, dq, (a, b), (da, db)))
        pull = [laws[0].evaluate(q - a).torque, laws[1].evaluate(q - b).torque]
        load = joint.link_damping * dq + joint.gravity_torque * math.sin(q) + sum(pull)
        turns = [
            (u[i] + pull[i] - joint.motor_damping[i] * v) / joint.motors[i]
            for i, v in enumerate((da, db))
        ]
        return [dq, -load / joint.link, da, db, *turns]

    return rate


@pytest.mark.parametrize(
    ("name", "aim", "begin"), [("vsa-ii", 0.6, 0.4), ("qbmove-maker-pro", 2.5, 0.35)]
)
def test_errors_die_away_with_the_chosen_poles_whatever_the_springs_do(
    name: str, aim: float, begin: float
) -> None:
    """q and sigma_t of the nonlinear joint are those of two linear systems, to the integrators'."""
    from scipy.integrate import solve_ivp
    from scipy.linalg import expm

    joint, laws = known(name)
    law = DecouplingLaw(joint, GAINS, REACH)
    target = Target((0.2, 0.0, 0.0, 0.0, 0.0), (aim, 0.0, 0.0))
    start = JointState(0.03, 0.1, (begin, -begin), (0.2, -0.1))
    x0 = np.array([start.q, start.dq, *start.theta, *start.dtheta])
    rate = moving(joint, laws, lambda s: law.torques(s, at(laws, s), target).torques)
    time = np.linspace(0.0, 0.8, 9)
    found = solve_ivp(rate, (0.0, 0.8), x0, "DOP853", time, rtol=1e-10, atol=1e-12).y
    first = joint.outputs(start, at(laws, start))
    motion, stiffness = np.diag(np.ones(3), 1), np.diag(np.ones(1), 1)
    motion[-1], stiffness[-1] = -np.array(GAINS.motion), -np.array(GAINS.stiffness)
    e0 = np.array(first.q) - np.array(target.q[:4])
    s0 = np.array(first.sigma) - np.array(target.sigma[:2])
    sigma = [
        sum(law.evaluate(q - angle).stiffness for law, angle in zip(laws, (a, b), strict=True))
        for q, a, b in found[[0, 2, 3]].T
    ]
    for t, q, s in zip(time, found[0], sigma, strict=True):
        # relative to the errors' own largest: rtol 1e-10 over some 1e3 steps
        assert q - 0.2 == pytest.approx((expm(motion * t) @ e0)[0], abs=1e-7)
        assert s - aim == pytest.approx((expm(stiffness * t) @ s0)[0], abs=1e-6 * aim)
    wanted = np.polymul(PolePair(12.0).polynomial, PolePair(15.0, 0.8).polynomial)
    assert np.poly(motion) == pytest.approx(wanted, rel=1e-10)


def test_the_outputs_are_the_derivatives_along_the_motion() -> None:
    """Symbolically, for laws of any shape: chain rule along the joint's equations."""
    sympy = pytest.importorskip("sympy")
    q, v, t1, t2, v1, v2, u1, u2 = x = sympy.symbols("q v t1 t2 v1 v2 u1 u2")
    M, D, G, B1, B2, D1, D2 = constants = sympy.symbols("M D G B1 B2 D1 D2", positive=True)
    powers = sympy.symbols("a1 a4 b1 b4")
    y = sympy.Symbol("y")
    tau = [sum(c * y**n for c, n in zip(own, (1, 4), strict=True))
           for own in (powers[:2], powers[2:])]  # fmt: skip
    phi = (q - t1, q - t2)
    pull = [f.subs(y, p) for f, p in zip(tau, phi, strict=True)]
    rates = {
        q: v,
        v: -(D * v + G * sympy.sin(q) + sum(pull)) / M,
        t1: v1,
        t2: v2,
        v1: (u1 + pull[0] - D1 * v1) / B1,
        v2: (u2 + pull[1] - D2 * v2) / B2,
    }

    def along(f: object) -> object:
        return sum(sympy.diff(f, s) * rate for s, rate in rates.items())

    chain = [q]
    for _ in range(4):
        chain.append(along(chain[-1]))
    sigma = sum(sympy.diff(f, y).subs(y, p) for f, p in zip(tau, phi, strict=True))
    stiff = [sigma, along(sigma), along(along(sigma))]
    s = [sympy.diff(f, y).subs(y, p) for f, p in zip(tau, phi, strict=True)]
    bend = [sympy.diff(f, y, 2).subs(y, p) for f, p in zip(tau, phi, strict=True)]
    # u enters v' alone, as u / B: one derivative later it stands beside what v does here
    assert not (chain[3].free_symbols | stiff[1].free_symbols) & {u1, u2}
    for i, v_i in enumerate((v1, v2)):
        assert sympy.expand(sympy.diff(chain[3], v_i) - s[i] / M) == 0
        assert sympy.expand(sympy.diff(stiff[1], v_i) + bend[i]) == 0
    # and the numbers the code makes of them
    values = [0.3, -0.7, 0.1, 0.5, 0.4, 1.1, 0.02, -0.03]
    sizes, law = [0.01, 0.02, 0.25, 1e-4, 2e-4, 1e-3, 2e-3], [0.2, 0.1, 0.25, 0.15]
    put = dict(zip((*x, *constants, *powers), (*values, *sizes, *law), strict=True))
    numbers = dict(zip(x, values, strict=True))
    joint = AntagonisticJoint(0.01, 0.02, 0.25, (1e-4, 2e-4), (1e-3, 2e-3))
    state = JointState(numbers[q], numbers[v], (0.1, 0.5), (0.4, 1.1))
    springs = [
        Elastic(
            *(float(sympy.diff(f, y, n).subs(put).subs(y, float(p.subs(put)))) for n in range(4))
        )
        for f, p in zip(tau, phi, strict=True)
    ]
    out = joint.outputs(state, (springs[0], springs[1]))
    top = np.array(out.drift) + out.matrix @ values[6:]
    told = sympy.lambdify(list(put), [*chain, *stiff], "math", cse=True)(*put.values())
    assert [*out.q, top[0], *out.sigma, top[1]] == pytest.approx(told, rel=1e-11)


@given(st.floats(0.05, 0.6), st.floats(-0.2, 0.2), st.floats(0.01, 0.05))
def test_steerability_is_the_share_of_stiffness_that_contraction_makes(
    contracted: float, bent: float, small: float
) -> None:
    """By the definition: phi_2 - phi_1 grows by a little and the link's torque stays."""
    _, laws = known()
    x, y = bent - contracted, bent + contracted
    a, b = laws[0].evaluate(x), laws[1].evaluate(y)
    step = 1e-6
    share = b.stiffness / (a.stiffness + b.stiffness)
    found = []
    for way in (-1.0, 1.0):
        one = laws[0].evaluate(x - way * step * share)
        two = laws[1].evaluate(y + way * step * (1.0 - share))
        found.append(one.stiffness + two.stiffness)
    slope = (found[1] - found[0]) / (2.0 * step) / (a.stiffness + b.stiffness)
    # central difference of steps 1e-6: rounding 1e-16 / 1e-6, curvature 1e-12
    assert steerability((a, b), REACH) == pytest.approx(REACH * slope, rel=1e-6, abs=1e-8)


def test_relaxed_springs_are_singular() -> None:
    joint, laws = known()
    law = DecouplingLaw(joint, GAINS, REACH)
    state = JointState(0.0, 0.0, (0.0, 0.0), (0.0, 0.0))
    says = law.torques(state, at(laws, state), Target((0.1,) + 4 * (0.0,), (0.6, 0.0, 0.0)))
    assert says.steerability == 0.0
    assert not np.any(np.isfinite(says.wanted))


@given(st.floats(-0.3, 0.3), st.floats(0.46, 0.9))
def test_a_preset_bears_the_load_with_the_stiffness(load: float, sigma: float) -> None:
    _, laws = known()
    load *= 0.2
    found = preset(laws, load, sigma, (-0.3, 0.3), REACH)
    if found is None:
        return  # a load alone may make it stiffer than that
    x, y = (law.evaluate(phi) for law, phi in zip(laws, found, strict=True))
    assert x.torque + y.torque == pytest.approx(load, abs=1e-9)
    assert x.stiffness + y.stiffness == pytest.approx(sigma, rel=1e-8)


def test_most_presets_are_found_and_one_too_soft_is_not() -> None:
    _, laws = known()
    found = [
        preset(laws, load, sigma, (-0.3, 0.3), REACH)
        for load in np.linspace(-0.05, 0.05, 5)
        for sigma in np.linspace(0.5, 0.9, 9)
    ]
    assert None not in found
    assert all(x < y for x, y in filter(None, found))  # the side of the guess
    assert preset(laws, 0.0, 0.4, (-0.3, 0.3), REACH) is None  # 0.43 N m/rad relaxed
    assert preset(laws, 0.0, 0.6, (0.0, 0.0), REACH) is None  # no way to go: singular


def controller(limit: float = math.inf, **switching: float) -> StiffnessControl:
    joint, _ = known()
    held = replace(joint, limits=(limit, limit)).held(PERIOD)
    law = DecouplingLaw(held, GAINS, REACH)
    return StiffnessControl(law, MotorPosition(held, 60.0), PERIOD, Switching(**switching))


AIM = Target((0.1, 0.0, 0.0, 0.0, 0.0), (0.56, 0.0, 0.0))
HOME = MotorMotion((0.4, -0.4))


def play(
    control: StiffnessControl,
    trusted: Callable[[float], bool],
    seconds: float,
    target: Callable[[float], Target] = lambda t: AIM,
) -> tuple[Array, list[Command], Array]:
    """Return time, commands and states (N, 6) of the joint under held torques from its home."""
    joint, laws = known()
    x = np.array([0.0, 0.0, 0.4, -0.4, 0.0, 0.0])
    commands, states = [], []
    time = PERIOD * np.arange(round(seconds / PERIOD))
    for t in time.tolist():
        state = JointState(x[0], x[1], (x[2], x[3]), (x[4], x[5]))
        said = control.step(state, laws, target(t), trusted=trusted(t), search=HOME)
        commands.append(said)
        states.append(x)
        rate = moving(joint, laws, lambda s, u=said.torques: u)
        # classical Runge-Kutta: the rotor's fastest rate, 50 1/s, times 1 ms is small
        k1 = np.array(rate(t, x))
        k2 = np.array(rate(t, x + 0.5 * PERIOD * k1))
        k3 = np.array(rate(t, x + 0.5 * PERIOD * k2))
        k4 = np.array(rate(t, x + PERIOD * k3))
        x = x + PERIOD / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return time, commands, np.array(states)


def stiffness_of(states: Array) -> Array:
    _, laws = known()
    return np.array(
        [laws[0].evaluate(q - a).stiffness + laws[1].evaluate(q - b).stiffness
         for q, a, b in states[:, [0, 2, 3]]]
    )  # fmt: skip


def test_switches_do_not_jump_and_both_laws_hold_the_same_place() -> None:
    """The estimate is lost for 0.3 s, then for good; link and stiffness stay."""
    control = controller()
    time, commands, states = play(control, lambda t: not 1.2 <= t < 1.5 and t < 2.1, 2.6)
    decoupled = np.array([c.decoupled for c in commands])
    turns = time[1:][np.diff(decoupled.astype(int)) != 0]
    # the wait of 0.2 s before it comes, and none before it goes
    assert turns == pytest.approx([0.2, 1.2, 1.7, 2.1], abs=1.5 * PERIOD)
    torques = np.array([c.torques for c in commands])
    steps = np.max(np.abs(np.diff(torques, axis=0)), axis=1)
    at_turns = steps[np.flatnonzero(np.diff(decoupled.astype(int)))]
    # what fades fades by PERIOD / fade a period; a jump would be of the order of the torques
    assert np.max(at_turns) < 0.05 * np.max(np.abs(torques))
    rest = time > 1.1
    assert states[rest, 0] == pytest.approx(0.1, abs=2e-3)
    assert stiffness_of(states[rest]) == pytest.approx(0.56, rel=5e-3)
    lost = {c.flags for t, c in zip(time.tolist(), commands, strict=True) if 1.3 <= t < 1.49}
    assert lost == {UNTRUSTED}


def test_it_leaves_before_the_springs_are_relaxed() -> None:
    """Told to be softer than relaxed, the law would go to the singularity and stay lost there.

    The motors' momentum may carry them across; position control brings them back to their side.
    """
    softer = Target(AIM.q, (0.4, 0.0, 0.0))
    _, commands, states = play(controller(), lambda t: True, 1.0, lambda t: softer)
    flags = np.array([c.flags for c in commands])
    decoupled = np.array([c.decoupled for c in commands])
    assert decoupled[250]
    assert np.any(flags[250:] & SINGULAR)
    assert not np.any(decoupled & (flags & SINGULAR > 0))
    assert np.all(np.isfinite([c.torques for c in commands]))
    phi = states[:, [0]] - states[:, 2:4]
    assert np.max(np.abs(phi)) < 0.8  # 1.2 rad is what the transmissions bear
    assert np.all(phi[-100:, 1] - phi[-100:, 0] > 0.0)
    # both motors stand still again, the link about to
    assert np.max(np.abs(states[-100:, 4:])) < 0.1


def test_torques_stay_within_the_limits_and_a_limit_for_long_ends_the_law() -> None:
    far = Target((2.5, 0.0, 0.0, 0.0, 0.0), (0.56, 0.0, 0.0))
    control = controller(limit=0.12, astray=10.0)
    _, commands, _ = play(control, lambda t: True, 0.5, lambda t: AIM if t < 0.25 else far)
    assert np.max(np.abs([c.torques for c in commands])) <= 0.12
    law = np.array([c.decoupled for c in commands])
    assert law[249]
    limited = np.array([c.flags & LIMITED > 0 for c in commands])
    assert np.all(limited[260:300])
    # patience is 50 ms, of the last unbroken stretch
    assert not np.any(law[310:])


def test_a_link_that_goes_astray_is_left_to_the_motors() -> None:
    far = Target((0.5, 0.0, 0.0, 0.0, 0.0), (0.56, 0.0, 0.0))
    _, commands, _ = play(controller(), lambda t: True, 0.3, lambda t: AIM if t < 0.25 else far)
    assert commands[249].decoupled
    assert not any(c.decoupled for c in commands[250:])
    assert all(c.flags & ASTRAY for c in commands[250:])


def test_a_state_that_is_no_number_keeps_the_torques_and_changes_nothing() -> None:
    _, laws = known()
    control = controller()
    state = JointState(0.0, 0.0, (0.4, -0.4), (0.1, 0.0))
    first = control.step(state, laws, AIM, trusted=True, search=HOME)
    lost = control.step(state._replace(dq=math.nan), laws, AIM, trusted=True, search=HOME)
    assert lost.flags == BLIND
    assert lost.torques.tolist() == first.torques.tolist()
    again = control.step(state, laws, AIM, trusted=True, search=HOME)
    assert np.all(np.isfinite(again.torques))


def test_a_law_that_is_no_number_is_not_kept() -> None:
    class Lost:
        def evaluate(self, phi: float) -> Elastic:
            return Elastic(math.nan, math.nan, math.nan, math.nan)

    _, laws = known()
    control = controller()
    state = JointState(0.0, 0.0, (0.4, -0.4), (0.0, 0.0))
    for _ in range(300):
        good = control.step(state, laws, AIM, trusted=True)
    assert good.decoupled
    lost = control.step(state, (Lost(), Lost()), AIM, trusted=True)
    assert not lost.decoupled
    assert lost.flags & BLIND
    assert lost.torques == pytest.approx(good.torques, abs=1e-12)


def test_a_held_torque_finds_a_damped_motor_heavier() -> None:
    """The velocity after a period, against the exponential, at the qbmove's D T / B = 0.46."""
    joint, _ = known("qbmove-maker-pro")
    B, D = joint.motors[0], joint.motor_damping[0]
    u, v = 0.3, 2.0
    after = math.exp(-D * PERIOD / B) * v - math.expm1(-D * PERIOD / B) * u / D
    assert v + PERIOD * (u - D * v) / joint.held(PERIOD).motors[0] == pytest.approx(
        after, rel=1e-12
    )
    still = replace(joint, motor_damping=(0.0, 0.0))
    assert still.held(PERIOD).motors == joint.motors


def test_joints_that_this_is_not_for_are_refused() -> None:
    with pytest.raises(DeviceError, match="two motors"):
        AntagonisticJoint.of(load_device("series-demo").joints[0])
    joint = load_device("vsa-ii").joints[0]
    damped = tuple(t.model_copy(update={"damping": 0.1}) for t in joint.transmissions)
    with pytest.raises(DeviceError, match="damper"):
        AntagonisticJoint.of(joint.model_copy(update={"transmissions": damped}))
    with pytest.raises(DeviceError, match="inertias"):
        AntagonisticJoint.of(joint.model_copy(update={"link": None}))


def test_gains_and_thresholds_that_cannot_be_are_refused() -> None:
    with pytest.raises(RotatumError, match="die away"):
        DecouplingGains((1.0, 1.0, 1.0, -1.0), (1.0, 1.0))
    with pytest.raises(RotatumError, match=r"gains\.stiffness"):
        DecouplingGains(GAINS.motion, (math.nan, 1.0))
    with pytest.raises(RotatumError, match="coming back"):
        Switching(low=0.1, high=0.1)
    with pytest.raises(RotatumError, match=r"switching\.fade"):
        Switching(fade=0.0)
