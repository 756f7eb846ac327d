"""Effects beyond the device file against closed forms, and all at once against scipy."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rotatum.errors import RotatumError
from rotatum.simulation import Body, plant_of, simulate_joint, sine
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.payload import GRAVITY, Payload
from rotatum.simulation.plant.effects import Effects, StiffnessDrift
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.plant.springs import dahl
from tests.simulation.joints import series_joint
from tests.simulation.plants import JOINT, LINEAR, PERIOD, clock, drive, spring

LOCKED = replace(LINEAR, motors=(Body(1e12),))  # takes 1e-12 of the motion
OMEGA = math.sqrt(200.0 / 0.8)


def _tanh(v, smoothing=5e-3):
    return math.tanh(v / smoothing)


@pytest.mark.parametrize("body", ["motor", "link"])
@pytest.mark.parametrize("v", [-0.2, 0.006, 0.03, 0.06, 0.5])
def test_a_body_settles_where_stribeck_s_curve_meets_the_torque(body, v):
    # damped steeply enough that the curve rises everywhere: its fall is 0.4 / 0.05 x 0.86
    rubbing, free = Body(0.3, 10.0, 0.8), Body(0.3)
    effects = Effects(**{f"{body}_stiction": 1.2, f"{body}_stribeck": 0.05})
    bodies = (free, (rubbing,)) if body == "motor" else (rubbing, (free,))
    plant = replace(LINEAR, link=bodies[0], motors=bodies[1], effects=effects)
    damped = (spring("linear", stiffness=200.0, damping=5.0),)
    torque = 10.0 * v + (0.8 + 0.4 * math.exp(-((v / 0.05) ** 2))) * _tanh(v)
    run = drive(replace(plant, transmissions=damped), 4.0, tau=torque)
    # the slowest decays, 3.1 N m s/rad over both inertias and 5 over twice one, leave e^-20
    np.testing.assert_allclose(run["dtheta"][-1, 0], v, atol=1e-9)
    np.testing.assert_allclose(run["dq"][-1], v, atol=1e-9)


@pytest.mark.parametrize(("tau", "push"), [(6.0, -3.0), (-6.0, 3.0), (1.0, 4.0), (5.0, 4.0)])
def test_gears_rub_away_a_share_of_what_they_carry(tau, push):
    damped = (spring("linear", stiffness=200.0, damping=1.0),)
    motors = (Body(0.256, 2.0, 0.8),)
    plant = replace(LINEAR, motors=motors, transmissions=damped)
    run = drive(replace(plant, effects=Effects(load_friction=0.1)), 6.0, tau=tau, tau_ext=push)
    left = tau + push
    speed = math.copysign(abs(left) - 0.8 - 0.1 * abs(push), left) / 2.0
    # D over all inertia is 1.9 1/s: e^-11 of the speed is missing, and tanh is 1 to e^-400
    np.testing.assert_allclose(run["dtheta"][-1, 0], speed, rtol=3e-5)
    np.testing.assert_allclose(run["torque"][-1, 0], push, rtol=3e-5)


def test_a_link_flies_freely_through_the_play_and_bounces():
    b, v = 0.02, 0.5
    run = drive(replace(LOCKED, effects=Effects(backlash=b)), 3.0, start={"dq": v})
    t = clock(3.0)
    half, flight = math.pi / OMEGA, b / v
    # from the middle: half a flight, half a period in the spring, a flight back, the other side
    part = np.mod(t + 0.5 * flight, half + flight)
    side = np.where(np.floor((t + 0.5 * flight) / (half + flight)) % 2 == 0, 1.0, -1.0)
    inside = part < flight
    free = v * part - 0.5 * b
    sprung = 0.5 * b + v / OMEGA * np.sin(OMEGA * (part - flight))
    expected = side * np.where(inside, free, sprung)
    # a step over an edge errs by up to (k / M) v h^2 / 8 = 2e-7 rad/s in speed; measured 2e-9 rad
    np.testing.assert_allclose(run["q"], expected, atol=1e-8)
    # what is at the edge to rounding may be on either side
    clear = np.abs(np.abs(expected) - 0.5 * b) > 1e-7
    firm = np.where(np.abs(expected) > 0.5 * b, 200.0, 0.0)
    np.testing.assert_array_equal(run["stiffness"][clear, 0], firm[clear])
    assert np.all(run["torque"][clear & (firm == 0.0), 0] == 0.0)


def test_play_widens_a_preloaded_spring_around_its_own_rest():
    preloaded = (spring("linear", stiffness=200.0, preload=0.05),)
    plant = replace(LOCKED, transmissions=preloaded, effects=Effects(backlash=0.02))
    for q in (-0.2, -0.055, -0.05, -0.045, 0.0, 0.1):
        at = drive(plant, PERIOD, start={"q": q})[:1]
        x = q + 0.05
        assert at["torque"][0, 0] == pytest.approx(200.0 * (x - np.clip(x, -0.01, 0.01)), abs=1e-12)


def test_spring_damping_does_not_act_in_the_play():
    damped = (spring("linear", stiffness=200.0, damping=3.0),)
    plant = replace(LOCKED, transmissions=damped, effects=Effects(backlash=0.2))
    run = drive(plant, 1.0, start={"dq": 0.5})
    inside = np.abs(run["deflection"][:, 0]) < 0.1
    np.testing.assert_allclose(run["dq"][: np.argmin(inside)], 0.5, rtol=1e-9)
    assert np.all(run["transmitted"][inside, 0] == 0.0)
    pulled = 200.0 * (run["q"] - 0.1) + 3.0 * run["dq"]
    first = slice(np.argmin(inside), np.argmin(inside) + 20)
    np.testing.assert_allclose(run["transmitted"][first, 0], pulled[first], rtol=1e-9)


def test_a_limit_counts_what_the_spring_feels():
    limited = (spring("linear", stiffness=200.0, limit=0.02),)
    plant = replace(LINEAR, transmissions=limited, effects=Effects(backlash=0.1))
    inputs = _inputs(0.5, tau_ext=np.full(clock(0.5).size, 20.0))
    course = run_plant(plant, inputs)
    assert course.stopped is not None
    assert "allowed: -0.07 to 0.07 rad" in str(course.stopped)
    assert np.max(np.abs(course.at["deflection"])) <= 0.07 + 1e-12


@pytest.mark.parametrize(("h", "d", "push"), [(2.0, 0.01, 6.0), (1.0, 0.05, 10.0)])
def test_a_turn_of_the_hysteresis_loop_costs_what_dahl_s_model_says(h, d, push):
    damped = (spring("linear", stiffness=200.0, damping=2.0),)
    effects = Effects(hysteresis_torque=h, hysteresis_deflection=d)
    plant = replace(LOCKED, transmissions=damped, effects=effects)
    t = clock(12.0)
    run = drive(plant, 12.0, tau_ext=push * np.sin(2 * np.pi * t))
    last = slice(t.size - 1001, t.size)
    phi, torque = run["deflection"][last, 0], run["hysteresis"][last, 0]
    swing = 0.5 * np.ptp(phi)
    assert swing > d
    area = np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(phi))
    # trapezoidal rule: h d (step / d)^2 / 12 with steps of 2e-4 rad: 1e-4 of the area at the most
    assert area == pytest.approx(4.0 * h * (swing - d * math.tanh(swing / d)), rel=3e-4)
    assert np.max(torque) == pytest.approx(h * math.tanh(swing / d), rel=1e-4)


def test_hysteresis_that_builds_up_at_once_is_dry_friction_and_stays_stable():
    effects = Effects(hysteresis_torque=1.0, hysteresis_deflection=1e-5)
    run = drive(replace(LOCKED, effects=effects), 4.0, start={"q": 0.1})
    assert np.max(np.abs(run["hysteresis"])) <= 1.0
    # the amplitude falls by 2 h / k each half swing: Coulomb friction in a spring
    turns = np.abs(run["q"][1:-1][np.diff(np.sign(run["dq"][1:])) != 0])
    falls = np.diff(turns[:8])
    # turning points are read at samples: a (omega T)^2 / 8 = 3e-6 rad; building up takes d
    np.testing.assert_allclose(falls, -2.0 * 1.0 / 200.0, atol=5e-5)
    # stuck where the spring is weaker than the hysteresis
    assert np.ptp(run["q"][-100:]) < 1e-5
    assert abs(run["q"][-1]) <= 1.0 / 200.0


@given(
    z=st.floats(-1.0, 1.0), way=st.floats(-0.2, 0.2), d=st.floats(1e-3, 0.1), part=st.floats(0, 1)
)
def test_dahl_s_model_is_solved_along_the_way(z, way, d, part):
    params = SimpleNamespace(hysteresis_deflection=d)
    there = dahl(params, z, way)
    assert abs(there) <= 1.0
    halted = dahl(params, dahl(params, z, part * way), (1.0 - part) * way)
    assert there == pytest.approx(halted, abs=1e-14)  # rounding
    step = 1e-4 * d
    slope = (dahl(params, z, step) - dahl(params, z, 0.0)) / step
    # dz / dphi = (1 - z) / d, and half a step of its own slope
    assert slope * d == pytest.approx(1.0 - z, abs=2e-4)


def test_the_springs_drift_and_jump_as_told():
    drift = StiffnessDrift(rate=-0.05, step=0.3, at=1.2345)
    plant = replace(LOCKED, effects=Effects(drift=drift))
    run, t = drive(plant, 3.0, start={"q": 0.1}), clock(3.0)
    factor = 1.0 - 0.05 * t + np.where(t >= 1.2345, 0.3, 0.0)
    np.testing.assert_allclose(run["scale"], factor, rtol=1e-15)
    np.testing.assert_allclose(run["stiffness"][:, 0], 200.0 * factor, rtol=1e-14)
    phi = run["deflection"][:, 0]
    np.testing.assert_allclose(run["torque"][:, 0], 200.0 * factor * phi, rtol=1e-13, atol=1e-15)

    def rates(step):
        return lambda t, y: [y[1], -200.0 / 0.8 * (1.0 - 0.05 * t + step) * y[0]]

    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "dense_output": True}
    before = solve_ivp(rates(0.0), (0.0, 1.235), [0.1, 0.0], **options)
    after = solve_ivp(rates(0.3), (1.235, 3.0), before.y[:, -1], **options)
    expected = np.where(t < 1.235, before.sol(t)[0], after.sol(t)[0])
    # RK4's phase error, (omega h)^4 / 120 per radian of 50, and the reference's own
    np.testing.assert_allclose(run["q"], expected, atol=1e-10)


def test_a_drift_to_no_stiffness_is_refused_with_its_time():
    plant = replace(LOCKED, effects=Effects(drift=StiffnessDrift(rate=-0.5)))
    with pytest.raises(RotatumError, match=r"effects\.drift, t = 1\.999 s.*drifts to zero"):
        drive(plant, 3.0)


@pytest.mark.parametrize(
    ("given", "where"),
    [
        ({"motor_stiction": -0.1}, "motor_stiction"),
        ({"link_stiction": math.nan}, "link_stiction"),
        ({"motor_stribeck": 0.0}, "motor_stribeck"),
        ({"link_stribeck": -1.0}, "link_stribeck"),
        ({"load_friction": 1.0}, "load_friction"),
        ({"load_friction": -0.1}, "load_friction"),
        ({"backlash": -1e-3}, "backlash"),
        ({"backlash": math.inf}, "backlash"),
        ({"hysteresis_torque": -1.0}, "hysteresis_torque"),
        ({"hysteresis_deflection": 0.0}, "hysteresis_deflection"),
    ],
)
def test_impossible_effects_are_refused_by_name(given, where):
    with pytest.raises(RotatumError, match=rf"^effects\.{where}: .*allowed: "):
        Effects(**given)


def test_other_refusals_name_their_place():
    with pytest.raises(RotatumError, match=r"effects\.drift\.rate"):
        StiffnessDrift(rate=math.nan)
    with pytest.raises(RotatumError, match=r"effects\.motor_stiction: .*0\.8 N m or more"):
        plant_of(series_joint(), effects=Effects(motor_stiction=0.5))
    with pytest.raises(RotatumError, match=r"smoothing.*above 0 rad/s"):
        plant_of(series_joint(), smoothing=0.0)


ALL = Effects(
    motor_stiction=1.1,
    link_stiction=0.15,
    motor_stribeck=0.05,
    link_stribeck=0.08,
    load_friction=0.05,
    backlash=2e-3,
    hysteresis_torque=0.5,
    hysteresis_deflection=0.01,
    drift=StiffnessDrift(rate=-0.02, step=0.1, at=0.5),
)


def _rates(t, y, tau, tau_ext, at, load):
    """The elbow of `tests.simulation.plants` with all of ALL, written out."""
    q, dq, th, dth, z = y
    phi, rate = q - th, dq - dth
    stretch = phi - min(max(phi, -1e-3), 1e-3)
    factor = 1.0 - 0.02 * t + (0.1 if at >= 0.5 else 0.0)
    elastic = factor * (200.0 * stretch + 600.0 * stretch**3)
    pull = elastic + (0.05 * rate if stretch != 0.0 else 0.0) + 0.5 * z
    motor = 0.8 + 0.3 * math.exp(-((dth / 0.05) ** 2)) + 0.05 * abs(elastic)
    link = 0.1 + 0.05 * math.exp(-((dq / 0.08) ** 2))
    gravity = (15.0 + load[1]) * math.sin(q)
    return [
        dq,
        (tau_ext - pull - gravity - 0.3 * dq - link * _tanh(dq, 0.02)) / (0.8 + load[0]),
        dth,
        (tau + pull - 0.35 * dth - motor * _tanh(dth, 0.02)) / 0.256,
        (rate - abs(rate) * z) / 0.01,
    ]


def _inputs(seconds, *, tau=0.0, tau_ext=0.0):
    t = clock(seconds)
    zero = np.zeros_like(t)
    torques = (zero + tau)[:, None]
    return Inputs(time=t, tau=torques, tau_ext=zero + tau_ext, angle=zero, tau_setpoint=zero)


def test_all_effects_at_once_agree_with_radau():
    t = clock(1.0)
    tau, tau_ext = 12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t), 3.0 * np.cos(7 * t)
    inertia, gravity = np.where(t >= 0.3, 0.2, 0.0), np.where(t >= 0.3, 2.0, 0.0)
    plant = replace(JOINT, effects=ALL, smoothing=0.02)
    inputs = _inputs(1.0, tau=tau, tau_ext=tau_ext)
    found = run_plant(plant, inputs, added=(inertia, gravity), start={"q": 0.3, "theta": 0.3}).at
    states = [np.array([0.3, 0.0, 0.3, 0.0, 0.0])]
    for k in range(t.size - 1):
        held = (tau[k], tau_ext[k], t[k], (inertia[k], gravity[k]))
        found_k = solve_ivp(
            _rates, (t[k], t[k + 1]), states[-1], args=held, method="Radau", rtol=1e-8, atol=1e-11
        )
        states.append(found_k.y[:, -1])
    expected = np.array(states)
    assert np.max(np.abs(expected[:, 0] - expected[:, 2])) > 0.02
    turns = np.sum(np.diff(np.sign(expected[:, 1] - expected[:, 3])) != 0)
    assert turns > 8  # the hysteresis has something to remember
    # spring damping jumps at the edges of the play: first order there. Measured 1.1e-6 rad, and
    # 1.3e-8 rad without that damping
    np.testing.assert_allclose(found["q"], expected[:, 0], atol=2e-6)
    np.testing.assert_allclose(found["theta"][:, 0], expected[:, 2], atol=2e-6)
    np.testing.assert_allclose(found["hysteresis"][:, 0], 0.5 * expected[:, 4], atol=1e-4)


def test_a_payload_makes_the_pendulum_heavier_from_its_time_on():
    joint = series_joint(
        motor={"inertia": 1e6},
        link={"inertia": 0.8, "gravity_torque": 15.0},
        transmission={"law": "linear", "stiffness": 1e4},
    )
    payload = Payload(mass=2.0, distance=0.3, begin=1.0)
    log = simulate_joint(
        joint,
        seconds=2.0,
        period=1e-3,
        drives={"tau": sine(0.0, 1.0)},
        payloads=(payload,),
        start={"q": 0.01},
    )
    q = log.joints[joint.name]["torque_true"] / 1e4
    before = math.sqrt((1e4 + 15.0) / 0.8)
    after = math.sqrt((1e4 + 15.0 + 2.0 * GRAVITY * 0.3) / (0.8 + 2.0 * 0.09))
    t = 1e-3 * np.arange(2000)
    np.testing.assert_allclose(q[:1000], 0.01 * np.cos(before * t[:1000]), atol=1e-6)
    position, velocity = 0.01 * math.cos(before), -0.01 * before * math.sin(before)
    swing = position * np.cos(after * (t - 1.0)) + velocity / after * np.sin(after * (t - 1.0))
    # sin q is q to 2e-5, of 15 in 1e4; the velocity goes on, whatever is taken up
    np.testing.assert_allclose(q[1000:], swing[1000:], atol=1e-6)
