"""The integrator against scipy's, for each actuation, and what it is made of."""

import numpy as np
import pytest

from rotatum.export.checker import in_stage
from rotatum.models.laws import LAWS
from rotatum.simulation import Sines, plant_of, sine
from rotatum.simulation.drivers.drives import sample_drives
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.plant.stage import plant_stage
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
