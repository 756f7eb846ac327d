"""The integrator against scipy's, for each actuation, and what it is made of."""

import numpy as np
import pytest

from rotatum.export.checker import in_stage
from rotatum.models.laws import LAWS
from rotatum.runtime.bank import Bank
from rotatum.simulation import Sines, plant_of, sine
from rotatum.simulation.drivers.drives import sample_drives
from rotatum.simulation.plant.effects import Effects, StiffnessDrift
from rotatum.simulation.plant.march import March
from rotatum.simulation.plant.params import drive_of, plant_params
from rotatum.simulation.plant.run import course_of, run_plant, write_inputs
from rotatum.simulation.plant.stage import plant_stage, train_stage
from tests.simulation.joints import (
    AWAS,
    VSA,
    awas_creep_rates,
    awas_motor_rates,
    awas_rates,
    joint_of,
    reference,
    series_joint,
    series_rates,
    vsa_rates,
)

TIME = np.arange(401) * 1e-3
# no Coulomb friction: the reference's own step control stumbles over it
ELBOW = series_joint(
    motor={"inertia": 4e-5, "damping": 5e-5, "gear_ratio": 80.0},
    link={"inertia": 0.8, "damping": 1.0, "gravity_torque": 15.0},
)
PUSH = sine(12.0, 1.5) + sine(4.0, 5.0)


def _swept(time):
    return 0.1 - 0.01 * (1 - np.cos(2 * np.pi * 0.5 * time))


CASES = {
    "series": (ELBOW, {"tau": PUSH}, series_rates, 4),
    "antagonistic": (
        joint_of(VSA),
        {"tau1": sine(0.05, 0.5), "tau2": sine(0.05, 3.0)},
        vsa_rates,
        6,
    ),
    "serial, prescribed": (
        joint_of(AWAS),
        {"tau": sine(15.0, 0.5), "setpoint": _swept},
        awas_rates,
        4,
    ),
    "serial, quasi-static": (
        joint_of(AWAS),
        {"tau": sine(15.0, 0.5), "tau_setpoint": Sines((60.0,), (2.0,), (0.0,))},
        awas_creep_rates,
        5,
    ),
}


def _motion(joint, drives, **settings):
    plant = plant_of(joint)
    return run_plant(plant, sample_drives(joint, plant, TIME, drives), **settings)


def _states(at, columns):
    motors = [
        x for m in range(at["theta"].shape[1]) for x in (at["theta"][:, m], at["dtheta"][:, m])
    ]
    return np.column_stack([at["q"], at["dq"], *motors, at["angle"], at["dangle"]])[:, :columns]


@pytest.mark.parametrize("case", CASES)
def test_motion_agrees_with_radau(case):
    joint, drives, rates, states = CASES[case]
    course = _motion(joint, drives)
    inputs = tuple(drive(TIME) for drive in drives.values())
    found = reference(rates, [0.0] * states, TIME.size, inputs, method="Radau")
    assert course.substeps == 10
    # Measured at most 1.7e-12 rad and 9.4e-11 rad/s (2.0e-12 rad over 2 s), much of which is the
    # reference's own error
    np.testing.assert_allclose(_states(course.at, states), found, atol=1e-10)


def test_leaving_out_the_set_point_motor_s_inertia_costs_next_to_nothing():
    joint, drives, *_ = CASES["serial, quasi-static"]
    creeping = _motion(joint, drives)
    whole = _motion(joint, drives, substeps=300)
    assert creeping.quasi_static
    assert not whole.quasi_static
    # the inertia delays the angle by Bc / Dc = 9.15 us: at 8 rad/s 7.4e-5 rad, 3e-8 m of the arm
    np.testing.assert_allclose(creeping.at["angle"], whole.at["angle"], atol=8e-5)
    for name in ("stiffness_total", "torque_total"):
        scale = np.max(np.abs(whole.at[name]))
        # twice the arm's relative error of 3e-7
        np.testing.assert_allclose(creeping.at[name], whole.at[name], atol=7e-7 * scale)


def test_the_set_point_motor_followed_with_its_inertia_agrees_with_radau():
    joint, drives, *_ = CASES["serial, quasi-static"]
    course = _motion(joint, drives, substeps=300)
    few = 40  # the reference needs 35 ms a sample here
    inputs = tuple(drive(TIME) for drive in drives.values())
    found = reference(awas_motor_rates, [0.0] * 6, few, inputs, method="Radau")
    # 300 steps let its transient, e^-109 of what it was, end; the rest is rounding
    np.testing.assert_allclose(_states(course.at, 6)[:few], found, atol=1e-12)


@pytest.mark.parametrize("case", CASES)
def test_interpreted_and_compiled_are_the_same_bits(case, monkeypatch):
    joint, drives, *_ = CASES[case]
    plant = plant_of(joint)
    inputs = sample_drives(joint, plant, TIME[:40], drives)
    compiled = run_plant(plant, inputs).at
    monkeypatch.setenv("ROTATUM_JIT", "0")
    interpreted = run_plant(plant, inputs).at
    for name in compiled.dtype.names:
        np.testing.assert_array_equal(interpreted[name], compiled[name])


@pytest.mark.parametrize("law", LAWS)
def test_every_law_s_plant_is_in_the_exportable_subset(law):
    assert in_stage(plant_stage(((law, 13),))) == []
    assert in_stage(plant_stage(((law, 13), ("cubic", 2)))) == []
    assert in_stage(train_stage(((law, 13),))) == []


RUBBING = Effects(
    motor_stiction=0.01,
    load_friction=0.05,
    backlash=1e-3,
    hysteresis_torque=0.01,
    drift=StiffnessDrift(rate=0.1, step=-0.2, at=0.2),
)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("effects", [Effects(), RUBBING], ids=["lawful", "effects"])
def test_a_drive_train_says_what_the_plant_does(case, effects):
    joint, drives, *_ = CASES[case]
    plant = plant_of(joint, effects=effects)
    inputs = sample_drives(joint, plant, TIME, drives)
    course = run_plant(plant, inputs)
    at, n, bodies = course.at, TIME.size, len(plant.motors) + 2
    stage = train_stage(plant.springs)
    step = 1e-3 / course.substeps
    drive = drive_of(plant, step, prescribed=inputs.angle is not None)
    params = plant_params(plant, {}, step=step, substeps=course.substeps, drive=drive)
    bank = Bank(stage, np.repeat(params, n))
    u = stage.input.zeros(n)
    write_inputs(inputs, u, effects=effects)
    position = np.column_stack([at["q"], at["theta"], at["angle"]])
    velocity = np.column_stack([at["dq"], at["dtheta"], at["dangle"]])
    bank.state["trial_position"], bank.state["trial_velocity"] = position, velocity
    z = at["hysteresis"] / effects.hysteresis_torque if effects is RUBBING else at["hysteresis"]
    bank.state["trial_hysteresis"] = z
    found = bank.update(u)
    for name in found.dtype.names:
        # the same operations on the same numbers, but for z, divided and multiplied again
        np.testing.assert_allclose(found[name], at[name], rtol=1e-12, atol=1e-12, err_msg=name)
    rate = at["dq"][:, None] - at["dtheta"]
    expected = (rate - np.abs(rate) * z) / 0.01 if effects is RUBBING else 0.0 * z
    np.testing.assert_allclose(bank.state["hysteresis_rate"], expected, rtol=1e-13)
    assert bank.state["acceleration"].shape == (n, bodies)
    if effects is not RUBBING:
        motor = plant.motors[0]
        net = inputs.tau[:, 0] + at["transmitted"][:, 0] - motor.damping * at["dtheta"][:, 0]
        # the balance of the first motor, which has no Coulomb friction here; rounding
        scale = np.max(np.abs(at["transmitted"])) / motor.inertia
        theta = bank.state["acceleration"][:, 1]
        np.testing.assert_allclose(theta, net / motor.inertia, atol=1e-13 * scale)


def test_half_a_period_on_the_springs_have_drifted_half_the_way():
    joint, *_ = CASES["series"]
    plant = plant_of(joint)
    stage = train_stage(plant.springs)
    bank = Bank(stage, plant_params(plant, {}, step=1e-3, substeps=1, drive=0))
    bank.state["trial_position"][0] = [0.05, 0.0, 0.0]
    u = stage.input.zeros(1)
    u["scale"], u["next_scale"] = 1.0, 0.8
    found = []
    for share in (0.0, 0.5, 1.0):
        u["share"] = share
        found.append(float(bank.update(u)["torque"][0, 0]))
    full = 200.0 * 0.05 + 1500.0 * 0.05**3
    np.testing.assert_allclose(found, [full, 0.9 * full, 0.8 * full], rtol=1e-14)


@pytest.mark.parametrize("case", CASES)
def test_a_march_sample_by_sample_is_the_run_bit_for_bit(case):
    joint, drives, *_ = CASES[case]
    plant = plant_of(joint, effects=RUBBING)
    inputs = sample_drives(joint, plant, TIME, drives)
    course = run_plant(plant, inputs)
    begin = {} if inputs.angle is None else {"setpoint_angle": float(inputs.angle[0])}
    prescribed = inputs.angle is not None
    march = March(plant, 1e-3, start=begin, substeps=course.substeps, prescribed=prescribed)
    u, out = march.inputs(TIME.size), march.outputs(TIME.size)
    write_inputs(inputs, u, effects=plant.effects)
    for k in range(TIME.size):
        assert march.state["position"][0, 0] == course.at["q"][k]
        march.step(u[k : k + 1], out[k : k + 1])
    for name in out.dtype.names:
        np.testing.assert_array_equal(out[name], course.at[name])
    assert course_of(plant, TIME, out, march).stopped is None
