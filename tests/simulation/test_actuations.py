"""Antagonistic and serial joints against closed forms, balances and the published tables."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rotatum.errors import RotatumError
from rotatum.simulation import Body, Plant, Sensors, hold, plant_of, simulate_joint, sine
from tests.simulation.joints import AWAS, B_LEVER, VSA, four_bar, joint_of
from tests.simulation.plants import LINEAR, clock, drive, spring, without_losses

PAIR = Plant("pair", "antagonistic", Body(0.8), (Body(0.1), Body(0.1)), ())
LEVER = replace(without_losses(plant_of(joint_of(AWAS))), setpoint_motor=None)


def test_two_linear_springs_are_one_of_their_sum():
    # motors in proportion to their springs, so that both turn alike
    springs = (spring("linear", stiffness=120.0), spring("linear", stiffness=80.0))
    motors = (Body(0.6 * 0.256, 0.6 * 0.35), Body(0.4 * 0.256, 0.4 * 0.35))
    pair = replace(PAIR, motors=motors, transmissions=springs, gravity_torque=15.0)
    one = replace(LINEAR, motors=(Body(0.256, 0.35),), gravity_torque=15.0)
    tau = 12.0 * np.sin(9 * clock(2.0))
    both = drive(pair, 2.0, tau=np.column_stack([0.6 * tau, 0.4 * tau]))
    alone = drive(one, 2.0, tau=tau)
    for found in (both["theta"][:, 0], both["theta"][:, 1]):
        np.testing.assert_allclose(found, alone["theta"][:, 0], atol=1e-12)  # rounding
    np.testing.assert_allclose(both["q"], alone["q"], atol=1e-12)
    np.testing.assert_allclose(both["torque_total"], alone["torque_total"], atol=1e-10)
    np.testing.assert_allclose(both["stiffness_total"], 200.0, rtol=1e-15)


@pytest.mark.parametrize("preload", [0.0, 0.1, 0.2])
def test_a_pair_pulled_against_itself_is_stiffer_by_its_cubic_part(preload):
    # k phi + c phi^3 at phi + p and phi - p: 2 k phi + 2 c (phi^3 + 3 p^2 phi)
    k, c = 50.0, 1000.0
    springs = tuple(spring("cubic", stiffness=k, cubic=c, preload=p) for p in (preload, -preload))
    # rotors of 1e12 kg m^2 are held
    locked = replace(PAIR, motors=(Body(1e12), Body(1e12)), transmissions=springs)
    run = drive(locked, 3.0, start={"q": 1e-4})
    omega = math.sqrt((2 * k + 6 * c * preload**2) / 0.8)
    # the cubic part of the pair shifts the phase by 3 c phi^2 / (4 (k + 3 c p^2)): 1e-7, of 40 rad
    np.testing.assert_allclose(run["q"], 1e-4 * np.cos(omega * clock(3.0)), atol=1e-4 * 1e-5)
    phi = run["q"]
    expected = 2 * k + 6 * c * (phi**2 + preload**2)
    # the held rotors give way by 3e-11 rad: 12 c p of it
    np.testing.assert_allclose(run["stiffness_total"], expected, rtol=1e-9)


def test_antagonistic_torques_have_the_sign_of_their_own_deflection():
    joint = joint_of(VSA)
    drives = {"tau1": hold(0.02), "tau2": hold(-0.02)}
    ideal = Sensors(counts={})
    seen = simulate_joint(joint, seconds=5.0, period=1e-3, drives=drives, sensors=ideal).joints[
        "vsa"
    ]
    # pulling apart moves no link, and each spring ends up with its motor's torque against it
    np.testing.assert_allclose(seen["q"], 0.0, atol=1e-15)
    for m, tau in ((1, 0.02), (2, -0.02)):
        # the motors swing at 47 rad/s and lose 6 in a second's exponent: e^-31 after 5 s
        assert seen[f"torque{m}_true"][-1] == pytest.approx(-tau, abs=1e-10)
        phi = seen["q"][-1] - seen[f"theta{m}"][-1]
        assert four_bar(phi) == pytest.approx(-tau, abs=1e-10)


def test_a_lever_that_stands_is_a_series_spring():
    # 1e-6 rad: sin(2 phi) is 2 phi to 1e-12
    stiffness = 2 * 14220.0 * 0.08**2
    one = replace(LEVER, actuation="series", transmissions=(spring("linear", stiffness=stiffness),))
    tau = 1e-4 * np.sin(30 * clock(2.0))
    lever = drive(LEVER, 2.0, tau=tau, angle=(0.1 - 0.08) / B_LEVER)
    linear = drive(one, 2.0, tau=tau)
    for name in ("q", "theta", "torque_total"):
        scale = np.max(np.abs(linear[name]))
        # phases of 100 rad differ by 1e-12 of themselves
        np.testing.assert_allclose(lever[name], linear[name], atol=1e-9 * scale)


def test_a_prescribed_arm_goes_straight_between_the_samples():
    t = clock(0.5)
    angle = 50.0 * np.sin(3 * t)
    run = drive(LEVER, 0.5, angle=angle)
    np.testing.assert_allclose(run["angle"], angle, rtol=0, atol=0)
    np.testing.assert_allclose(run["setpoint"], 0.1 - B_LEVER * angle, rtol=1e-15)
    np.testing.assert_allclose(run["dangle"][:-1], np.diff(angle) / 1e-3, rtol=1e-12, atol=1e-10)
    assert run["dangle"][-1] == 0.0  # held at its last value


START = {"q": 0.05, "dq": 2.0, "theta": -0.1, "dtheta": -1.0}


@pytest.mark.parametrize(
    ("plant", "start"),
    [
        (without_losses(plant_of(joint_of(VSA))), {"q": 0.3, "dq": 1.0, "theta1": 0.6}),
        (LEVER, START),
    ],
    ids=["antagonistic", "serial"],
)
def test_energy_is_kept_without_damping(plant, start):
    energy = plant.energy(drive(plant, 10.0, start=start))
    # asked for: 1e-6. RK4 loses (omega h)^6 / 72 in each of 1e5 steps: 5e-10 at 88 rad/s
    assert np.max(np.abs(energy / energy[0] - 1.0)) < 1e-8


def test_the_work_of_a_prescribed_arm_is_what_the_spring_gains():
    t = clock(4.0)
    angle = 20.0 * np.sin(7 * t)
    run = drive(LEVER, 4.0, angle=angle, start=START)
    energy = LEVER.energy(run)
    r, phi = run["setpoint"], run["deflection"][:, 0]
    reaction = -2 * 14220.0 * B_LEVER * r * np.sin(phi) ** 2  # flacco2012 eq. 52
    work = np.sum((reaction[1:] + reaction[:-1]) / 2 * np.diff(angle))
    assert np.ptp(energy) > 0.1 * energy[0]
    # trapezoidal rule: (2 omega T)^2 / 12 at 88 rad/s, 2.6e-3 of a work that swings by 0.5 J
    assert energy[-1] - energy[0] == pytest.approx(work, abs=2e-3 * np.ptp(energy))


def test_the_work_on_the_set_point_s_motor_goes_into_energy_or_friction():
    # a heavy secondary motor, so that its inertia is seen; 3 N m constant: work is 3 theta_c
    heavy = replace(LEVER, setpoint_motor=Body(0.2))
    run = drive(heavy, 2.0, angle=None, tau_setpoint=3.0, start=START)
    energy = heavy.energy(run) - 3.0 * run["angle"]
    assert np.ptp(run["angle"]) > 10.0
    # RK4 at 100 rad/s, 2e4 steps
    np.testing.assert_allclose(energy, energy[0], atol=1e-8 * np.ptp(run["angle"]))


def test_the_spring_pushes_the_arm_inwards():
    # psi_e is negative: left alone, the motor turns forwards and the arm gets shorter
    light = replace(LEVER, setpoint_motor=Body(0.2, 0.1))
    run = drive(light, 0.5, angle=None, start={"q": 0.2, "theta": -0.1})
    assert np.all(np.diff(run["angle"][1:]) > 0.0)
    assert run["setpoint"][-1] < 0.1


def test_a_motor_without_inertia_creeps_at_the_speed_friction_allows():
    plant = plant_of(joint_of(AWAS))
    for coulomb in (0.0, 2.0):
        moved = Body(plant.setpoint_motor.inertia, plant.setpoint_motor.damping, coulomb)
        slow = replace(plant, setpoint_motor=moved)
        # unloaded: the whole torque turns against friction
        run = drive(slow, 1.0, angle=None, tau_setpoint=30.0)
        speed = (30.0 - coulomb) / plant.setpoint_motor.damping
        np.testing.assert_allclose(run["angle"], speed * clock(1.0), rtol=1e-12, atol=1e-14)


def test_a_set_point_motor_with_dry_friction_only_keeps_its_inertia():
    plant = plant_of(joint_of(AWAS))
    dry = replace(plant, setpoint_motor=Body(6.8e-3, 0.0, 2.0))
    run = drive(dry, 1.0, angle=None, tau_setpoint=2.5)
    # full friction from 2e-2 rad/s on, reached in a millisecond: 1e-2 rad/s at the most
    np.testing.assert_allclose(run["dangle"][-1], 0.5 / 6.8e-3, atol=1e-2)


def test_a_motor_taken_without_inertia_is_said_in_the_log():
    drives = {"tau": sine(15.0, 0.5), "tau_setpoint": sine(60.0, 0.5)}
    settings = {"seconds": 0.5, "period": 1e-3, "drives": drives}
    quick = simulate_joint(joint_of(AWAS), **settings)
    assert len(quick.warnings) == 1
    assert "awas: friction stops the set-point motor" in quick.warnings[0]
    assert simulate_joint(joint_of(AWAS), substeps=300, **settings).warnings == ()


def test_leaving_the_range_names_the_transmission():
    limited = {"law": "fourbar", "spring": 2.5, "ratio": math.sqrt(2), "limit": 0.5}
    joint = joint_of(VSA, transmission=limited)
    drives = {"tau1": hold(0.0), "tau2": hold(0.3)}
    message = r"^vsa, t = 0\.\d+ s: the deflection of transmission 2, law \"fourbar\", leaves its "
    message += r"range, got -0\.5\d+; allowed: -0\.5 to 0\.5 rad"
    with pytest.raises(RotatumError, match=message):
        simulate_joint(joint, seconds=5.0, period=1e-3, drives=drives)


def test_an_arm_without_length_is_refused_with_its_time():
    drives = {"tau": hold(0.0), "setpoint": lambda t: 0.1 - 0.2 * t}
    with pytest.raises(RotatumError, match=r"^awas, t = 0\.501 s: the set-point .*0 to inf m"):
        simulate_joint(joint_of(AWAS), seconds=1.0, period=1e-3, drives=drives)


@pytest.mark.parametrize(
    ("ratio", "k", "damping", "rms", "total", "deflection", "turn"),
    [
        (math.sqrt(2), 2.5, 1.27e-3, (224, 224, 448), (429, 468), (0.24, 0.23), 0.58),
        (math.sqrt(2), 2.5, 1.27e-2, (225, 219, 445), (429, 470), (0.29, 0.19), 0.41),
        (2.0, 0.41, 1.27e-2, (225, 214, 439), (410, 484), (0.29, 0.20), 0.41),
        (2.0, 0.41, 1.27e-3, (223, 222, 445), (410, 482), (0.24, 0.24), 0.58),
    ],
)
def test_vsa_ii_moves_as_tabulated(ratio, k, damping, rms, total, deflection, turn):
    """The paper's torques for 20 s; a table made with another integrator at 0.2 ms."""
    law = {"law": "fourbar", "spring": k, "ratio": ratio}
    joint = joint_of(VSA, transmission=law, motor=[{"inertia": 1e-4, "damping": damping}] * 2)
    drives = {"tau1": sine(0.05, 0.05), "tau2": sine(0.05, 1.0)}
    ideal = Sensors(counts={})
    seen = simulate_joint(joint, seconds=20.0, period=1e-3, drives=drives, sensors=ideal).joints[
        "vsa"
    ]
    # one unit of the last printed digit
    for role, expected in zip(("stiffness1", "stiffness2", "stiffness"), rms, strict=True):
        found = 1e3 * np.sqrt(np.mean(seen[f"{role}_true"] ** 2))
        assert found == pytest.approx(expected, abs=1.0)
    assert 1e3 * np.min(seen["stiffness_true"]) == pytest.approx(total[0], abs=1.0)
    assert 1e3 * np.max(seen["stiffness_true"]) == pytest.approx(total[1], abs=1.0)
    for m, expected in zip((1, 2), deflection, strict=True):
        phi = np.max(np.abs(seen["q"] - seen[f"theta{m}"]))
        assert phi == pytest.approx(expected, abs=0.01)
    assert np.max(np.abs(seen["q"])) == pytest.approx(turn, abs=0.01)


@pytest.mark.parametrize(("arm", "largest"), [(0.083, 47e-4), (0.1, 32e-4), (0.117, 24e-4)])
def test_awas_deflects_as_tabulated(arm, largest):
    """0.3 sin(0.2 pi t) N m at the motor, 15 N m at the joint."""
    drives = {"tau": sine(15.0, 0.1), "setpoint": hold(arm)}
    ideal = Sensors(counts={})
    seen = simulate_joint(joint_of(AWAS), seconds=20.0, period=1e-3, drives=drives, sensors=ideal)
    phi = seen.joints["awas"]["q"] - seen.joints["awas"]["theta"]
    # the last printed digit
    assert np.max(np.abs(phi)) == pytest.approx(largest, abs=1e-4)


def test_awas_with_a_swept_arm_deflects_by_the_paper_s_0_005_rad():
    drives = {"tau": sine(15.0, 0.1), "setpoint": lambda t: 0.1 - 0.02 * np.sin(0.1 * np.pi * t)}
    ideal = Sensors(counts={})
    seen = simulate_joint(joint_of(AWAS), seconds=20.0, period=1e-3, drives=drives, sensors=ideal)
    phi = seen.joints["awas"]["q"] - seen.joints["awas"]["theta"]
    assert np.max(np.abs(phi)) == pytest.approx(47e-4, abs=1e-4)
