"""Energy, momentum and work: kept where nothing acts, accounted for where everything does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from rotatum.errors import RotatumError
from rotatum.simulation import Body, plant_of
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.plant.effects import Effects, StiffnessDrift
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.plant.steps import MOST_SUBSTEPS, choose_substeps
from tests.simulation.joints import AWAS, VSA, joint_of
from tests.simulation.plants import FREE, JOINT, LINEAR, PERIOD, drive, spring, without_losses

VSA_II = without_losses(plant_of(joint_of(VSA)))
LEVER = replace(without_losses(plant_of(joint_of(AWAS))), setpoint_motor=None)
STIFF = replace(LINEAR, transmissions=(spring("linear", stiffness=2.1e5),))
HARD = replace(FREE, transmissions=(spring("cubic", stiffness=200.0, cubic=2e6),))
STEEP = replace(FREE, link=Body(0.1), transmissions=(spring("sinh", k=0.5, a=40.0),))
TORN = {"q": 0.05, "dq": 2.0, "theta": -0.1, "dtheta": -1.0}


@pytest.mark.parametrize(
    ("plant", "start"),
    [
        (LINEAR, TORN),
        (STIFF, {"q": 0.01}),
        (FREE, {"q": 1.2, "dq": 0.5, "theta": 1.05, "dtheta": -1.0}),
        (HARD, TORN),
        (STEEP, {"dq": 3.0}),
        (VSA_II, {"q": 0.3, "dq": 1.0, "theta1": 0.6}),
        (LEVER, TORN),
    ],
    ids=["linear", "stiff", "cubic", "hard", "sinh", "vsa-ii", "awas"],
)
def test_energy_is_kept_to_a_millionth_in_ten_seconds(plant, start):
    energy = plant.energy(drive(plant, 10.0, start=start))
    assert np.max(np.abs(energy / energy[0] - 1.0)) < 1e-6


def test_the_elastic_mode_chooses_the_steps_it_was_promised():
    for stiffness in (2.1e5, 8e5, 3.2e6):
        stiff = replace(LINEAR, transmissions=(spring("linear", stiffness=stiffness),))
        count = choose_substeps(stiff, PERIOD, (stiffness,))
        swing = stiff.oscillation_rate((stiffness,))
        h = PERIOD / count
        assert 10.0 * swing * (h * swing) ** 5 / 72.0 < 2e-7  # what RK4 loses in 10 s
        assert 10.0 * swing * (h * swing * count / (count - 1)) ** 5 / 72.0 > 2e-7


def _seconds(seconds, period=1e-4):
    return np.arange(round(seconds / period) + 1) * period


def _held_twice(x):
    """Hold every other value for two samples: nothing jumps inside a panel of Simpson's rule."""
    return np.repeat(x[::2], 2)[: x.size]


EFFECTS = Effects(
    motor_stiction=1.1,
    link_stiction=0.15,
    load_friction=0.05,
    hysteresis_torque=0.5,
    hysteresis_deflection=0.02,
    drift=StiffnessDrift(rate=-0.05),
)


@pytest.mark.parametrize(
    ("effects", "damping", "share"),
    [
        # powers are smooth but for the turns of the hysteresis
        (EFFECTS, 0.05, 1e-6),
        # the edges of the play are kinks in every power: Simpson's rule is of second order there
        (replace(EFFECTS, backlash=2e-3), 0.0, 1e-6),
    ],
    ids=["without play", "with play"],
)
def test_work_losses_and_drift_account_for_the_energy(effects, damping, share):
    t = _seconds(2.0)
    tau = _held_twice(12.0 * np.sin(9 * t) + 4.0 * np.sin(31 * t))
    push = _held_twice(3.0 * np.cos(7 * t))
    springs = (spring("cubic", stiffness=200.0, cubic=600.0, damping=damping),)
    plant = replace(JOINT, transmissions=springs, effects=effects, smoothing=0.05)
    zero = np.zeros_like(t)
    inputs = Inputs(t, tau[:, None], push, zero, zero)
    at = run_plant(plant, inputs).at
    dq, dtheta, rate = at["dq"], at["dtheta"][:, 0], at["dq"] - at["dtheta"][:, 0]
    work = np.sum(tau[:-1] * np.diff(at["theta"][:, 0])) + np.sum(push[:-1] * np.diff(at["q"]))
    link = 0.1 + 0.05 * np.exp(-((dq / 0.05) ** 2))
    motor = 0.8 + 0.3 * np.exp(-((dtheta / 0.05) ** 2)) + 0.05 * np.abs(at["torque"][:, 0])
    lost = 0.3 * dq**2 + link * dq * np.tanh(dq / 0.05)
    lost += 0.35 * dtheta**2 + motor * dtheta * np.tanh(dtheta / 0.05)
    lost += damping * rate**2 + at["hysteresis"][:, 0] * rate
    play = np.clip(at["deflection"][:, 0], -effects.backlash / 2, effects.backlash / 2)
    stored = plant.transmissions[0].energy(at["deflection"][:, 0] - play)
    drifted = -0.05 * stored
    change = np.diff(plant.energy(at)[[0, -1]])[0]
    losses = simpson(lost, x=t)
    assert losses > 0.3 * work > 0.1  # the balance is about something
    assert simpson(at["hysteresis"][:, 0] * rate, x=t) > 0.01 * work
    assert change == pytest.approx(work - losses + simpson(drifted, x=t), abs=share * losses)


def test_momentum_changes_by_the_torques_from_outside_whatever_lies_between():
    t = _seconds(1.0, PERIOD)
    tau, push = 12.0 * np.sin(9 * t), 3.0 * np.cos(7 * t)
    between = replace(
        EFFECTS, motor_stiction=None, link_stiction=None, load_friction=0.0, backlash=2e-3
    )
    plant = replace(FREE, gravity_torque=0.0, effects=between)
    zero = np.zeros_like(t)
    at = run_plant(plant, Inputs(t, tau[:, None], push, zero, zero)).at
    momentum = 0.8 * at["dq"] + 0.256 * at["dtheta"][:, 0]
    impulse = np.concatenate([[0.0], np.cumsum((tau + push)[:-1]) * PERIOD])
    # springs, play and hysteresis pull both ways alike in every part of a step: rounding
    np.testing.assert_allclose(momentum, impulse, atol=1e-12)


@pytest.mark.parametrize(
    ("plant", "message"),
    [
        (replace(LINEAR, transmissions=(spring("linear", stiffness=1e9),)), "the elastic mode"),
        (replace(LINEAR, link=Body(0.8, 0.0, 5e3)), "friction .*or a smoothing of"),
        (
            replace(LINEAR, effects=Effects(hysteresis_torque=1e3, hysteresis_deflection=1e-7)),
            "hysteresis .*larger hysteresis_deflection",
        ),
    ],
    ids=["elastic", "friction", "hysteresis"],
)
def test_a_period_too_long_says_what_asks_for_how_many_steps(plant, message):
    with pytest.raises(
        RotatumError, match=rf"^elbow: {message.split(' ')[0]}.*got 0\.001; allowed: periods up to"
    ) as caught:
        drive(plant, 0.1)
    assert f"of {MOST_SUBSTEPS} at the most" in str(caught.value)
    for part in message.split(".*"):
        assert part in str(caught.value)


@pytest.mark.parametrize("coulomb", [5e3, 2e5])
def test_the_period_and_smoothing_it_names_are_enough(coulomb):
    rubbing = replace(LINEAR, link=Body(0.8, 0.0, coulomb))
    with pytest.raises(RotatumError) as caught:
        choose_substeps(rubbing, PERIOD, (200.0,))
    words = str(caught.value.allowed).split()
    period, smoothing = (float(words[words.index(unit) - 1]) for unit in ("s,", "rad/s"))
    # given with two digits
    assert choose_substeps(rubbing, 0.95 * period, (200.0,)) <= MOST_SUBSTEPS
    smoother = replace(rubbing, smoothing=1.05 * smoothing)
    assert choose_substeps(smoother, PERIOD, (200.0,)) <= MOST_SUBSTEPS
