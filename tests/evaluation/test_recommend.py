"""`rotatum.recommend`: each rule on a log that calls for it, and on one that does not.

Nothing is estimated here, so that nothing is compiled but the simulator.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
import pytest

from rotatum import Log, Recommendation, load_device, load_scenario, recommend
from rotatum.evaluation import Advice
from rotatum.evaluation.motion import motion_of
from rotatum.models import Device, Uncertain


@cache
def scene(name: str) -> tuple[Log, Device]:
    """A ready scenario's log without its torque sensor, and the device that is told."""
    scenario = load_scenario(name)
    log = scenario.run()
    joints = {
        joint: {role: x for role, x in channels.items() if not role.startswith("torque_measured")}
        for joint, channels in log.joints.items()
    }
    return replace(log, joints=joints), scenario.device


def told(device: Device, part: str, values: Mapping[str, Any]) -> Device:
    """The device with other values in [motor], [link] or [estimator]."""
    joint = device.joints[0]
    if part == "motor":
        motors = tuple(motor.model_copy(update=values) for motor in joint.motors)
        changed = joint.model_copy(update={"motors": motors})
    else:
        changed = joint.model_copy(update={part: getattr(joint, part).model_copy(update=values)})
    return replace(device, joints=(changed, *device.joints[1:]))


def advice(log: Log, device: Device) -> Advice:
    found = recommend(log, device)
    assert isinstance(found, Recommendation)
    return found.joints[device.joints[0].name]


def said(found: Advice) -> str:
    return " ".join((*found.reasons, *found.cautions))


def test_a_clean_log_of_a_described_joint_needs_nothing_special() -> None:
    found = advice(*scene("trouble/clean"))
    assert found.settings() == {"method": "weak", "side": "motor", "torque": "estimated"}
    assert found.options() == "--method weak --side motor"
    assert found.reasons
    assert not found.cautions


def test_a_measured_torque_is_used() -> None:
    scenario = load_scenario("trouble/clean").with_values({"seconds": 4.0})
    found = advice(scenario.run(), scenario.device)
    assert (found.side, found.torque) == ("motor", "sensor")
    assert "--torque sensor" in found.options()


def test_without_torque_the_link_side_is_left() -> None:
    log, device = scene("trouble/clean")
    joints = {j: {r: x for r, x in c.items() if r != "tau"} for j, c in log.joints.items()}
    found = advice(replace(log, joints=joints), device)
    assert found.side == "link"
    assert "the motor side lacks the channel tau" in said(found)
    assert found.fit is None, "the link's damping is in the device file"
    none = advice(replace(log, joints=joints), told(device, "link", {"inertia": None}))
    assert none.method is None
    assert none.settings() == {}
    assert "the link side lacks the link's inertia" in said(none)


def test_without_a_position_there_is_no_method() -> None:
    log, device = scene("trouble/clean")
    joints = {j: {r: x for r, x in c.items() if r != "theta"} for j, c in log.joints.items()}
    found = advice(replace(log, joints=joints), device)
    assert found.method is None
    assert "position" in said(found)


def test_friction_behind_a_gear_that_nobody_describes() -> None:
    log, device = scene("trouble/clean")
    bare = told(device, "motor", {"damping": Uncertain(0.0), "coulomb": Uncertain(0.0)})
    found = advice(log, bare)
    assert found.side == "link", "its load is loud: 149 times its noise"
    assert "friction" in said(found)
    fitted = advice(log, told(bare, "link", {"inertia": None}))
    assert (fitted.side, fitted.fit) == ("motor", ("damping", "coulomb", "offset"))


def test_a_faint_link_gets_a_window() -> None:
    log, device = scene("trouble/coarse-encoder")
    joints = {j: {r: x for r, x in c.items() if r != "tau"} for j, c in log.joints.items()}
    found = advice(replace(log, joints=joints), device)
    # behind the low-pass its load is 2.4 times its noise, in the clean log 149 times
    assert (found.side, found.window) == ("link", 0.2)
    assert "--window 0.2" in found.options()


def test_an_unknown_inertia_is_fitted_and_a_doubtful_one_too() -> None:
    log, device = scene("trouble/clean")
    unknown = advice(log, told(told(device, "motor", {"inertia": None}), "link", {"inertia": None}))
    assert unknown.fit == ("inertia", "offset")
    inertia = device.joints[0].motors[0].inertia
    assert inertia is not None
    doubtful = Uncertain(inertia.value, 0.1 * inertia.value)
    found = advice(log, told(device, "motor", {"inertia": doubtful}))
    assert found.fit == ("inertia", "offset")
    sure = Uncertain(inertia.value, 0.001 * inertia.value)
    assert advice(log, told(device, "motor", {"inertia": sure})).fit is None


@lru_cache(maxsize=1)
def one_sine() -> tuple[Log, Device]:
    """A free link under one slow sine, whose start fades in the link's damping."""
    scenario = load_scenario("trouble/clean").with_values(
        {
            "seconds": 8.0,
            "drives.tau": {"kind": "sine", "amplitude": 4.5, "frequency": 0.8},
            "truth": {"link.gravity_torque": 0.0, "motor.coulomb": 0.0},
            "told": {"link.gravity_torque": 0.0, "motor.coulomb": 0.0},
        }
    )
    log = scenario.run()
    joints = {
        joint: {role: x for role, x in channels.items() if not role.startswith("torque_measured")}
        for joint, channels in log.joints.items()
    }
    return replace(log, joints=joints), scenario.device


def test_under_one_sine_damping_is_not_fitted_beside_inertia() -> None:
    log, device = one_sine()
    bare = {"inertia": None, "damping": Uncertain(0.0), "coulomb": Uncertain(0.0)}
    device = told(told(device, "motor", bare), "link", {"inertia": None})
    found = advice(log, device)
    assert found.fit == ("inertia", "coulomb", "offset")
    assert "more than one frequency" in said(found)
    rich, other = scene("trouble/clean")
    other = told(told(other, "motor", bare), "link", {"inertia": None})
    assert advice(rich, other).fit == ("inertia", "damping", "coulomb", "offset")


def test_what_the_device_file_fits_is_kept() -> None:
    log, device = scene("trouble/clean")
    found = advice(log, told(device, "estimator", {"fit": ("coulomb",)}))
    assert found.fit == ("coulomb",)
    assert "device file" in said(found)


def test_ranges_and_encoders_are_judged() -> None:
    log, device = scene("trouble/clean")
    narrow = advice(log, told(device, "basis", {"deflection_range": 0.03}))
    assert "beyond [basis] deflection_range" in said(narrow)
    wide = advice(log, told(device, "basis", {"deflection_range": 0.5}))
    assert "extrapolated" in said(wide)
    coarse = advice(log, told(device, "encoders", {"link": 1000.0}))
    assert "finer encoders" in said(coarse)


def test_a_joint_that_does_not_move_is_said() -> None:
    log, device = scene("trouble/clean")
    joints = {
        j: {r: np.zeros_like(x) for r, x in c.items() if not r.endswith("_true")}
        for j, c in log.joints.items()
    }
    found = advice(replace(log, joints=joints), device)
    assert "does not change" in said(found)


def test_a_torque_whose_hold_nobody_says() -> None:
    log, device = scene("trumic2022/simulation-avsa")
    assert "held" in said(advice(log, device))
    assert "held" not in said(advice(*scene("trouble/clean"))), "its device file says it"


def test_two_transmissions_and_set_points() -> None:
    for name in ("flacco2012/table1", "flacco2012/table2"):
        found = advice(*scene(name))
        assert found.method == "weak"
        assert found.side in ("motor", "link")


def test_an_arm_gets_one_side_for_all() -> None:
    log, _ = scene("trouble/clean")
    device = load_device("planar-vsa-ii")
    wave = 0.1 * np.sin(2.0 * np.pi * log.time)
    logged = {"q": wave, "theta1": 0.5 * wave, "theta2": 0.4 * wave}
    first, second = (joint.name for joint in device.joints)
    joints = {first: logged, second: {**logged, "tau1": wave, "tau2": wave}}
    found = recommend(replace(log, joints=joints), device)
    assert {a.side for a in found.joints.values()} == {"link"}
    assert "one side" in str(found)


def test_the_motions_numbers_are_those_of_a_sine() -> None:
    """Closed form: q = a sin(w t), theta = 0, M = 2: the link's load is M a w^2, its noise 0."""
    log, device = scene("trouble/clean")
    time = log.period * np.arange(8000)
    wave = 0.01 * np.sin(2.0 * np.pi * time)
    link = {"inertia": Uncertain(2.0), "damping": Uncertain(0.0), "gravity_torque": 0.0}
    device = told(told(device, "link", link), "encoders", {"link": None, "motor": None})
    logged = {"q": wave, "theta": np.zeros_like(wave)}
    found = motion_of(logged, device.joints[0], device, log.period)
    assert found is not None
    assert found.link is not None
    assert found.motor is None, "no tau"
    # hats and two poles at 300 rad/s lose (2 pi / 300)^2 = 4e-4 of an amplitude at 1 Hz, and the
    # 8 s are cut at no whole period behind the low-pass: a per cent in all
    load = 2.0 * 0.01 * (2.0 * np.pi) ** 2 / np.sqrt(2.0)
    assert found.link.load == pytest.approx(load, rel=0.01)
    assert found.link.share == pytest.approx(1.0, rel=0.01)
    assert found.deflection == pytest.approx(0.01 / np.sqrt(2.0), rel=1e-3)
    # the zero is the mean of the first 50 ms, 1.6e-3 rad
    assert found.reach == pytest.approx(0.01 + np.mean(wave[:50]), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "one"), [("flacco2012/table2", True), ("trumic2022/simulation-avsa", False)]
)
def test_one_sine_is_told_from_two(name: str, one: bool) -> None:
    """AwAS under 0.1 Hz; a link's sine while the preset swings."""
    log, device = scene(name)
    joint = device.joints[0]
    found = motion_of(log.joints[joint.name], joint, device, log.period)
    assert found is not None
    assert (found.line > 0.95) is one


@pytest.mark.parametrize(("hertz", "window"), [(0.5, 0.2), (10.0, 0.1), (60.0, 0.02)])
def test_a_window_lets_the_motion_pass(hertz: float, window: float) -> None:
    """(u (1 - u))^3 over T passes about exp(-(w T)^2 / 72) of a sine.

    Half at w T = 7.1: of 10 Hz 0.11 s, of 60 Hz 0.019 s, where 20 samples are the shortest.
    """
    _, device = scene("trouble/clean")
    time = 1e-3 * np.arange(8000)
    wave = 0.01 * np.sin(2.0 * np.pi * hertz * time)
    logged = {"q": wave, "theta": np.zeros_like(wave)}
    found = motion_of(logged, device.joints[0], device, 1e-3)
    assert found is not None
    assert found.window == pytest.approx(window)
