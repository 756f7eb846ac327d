"""`rotatum.characterise` against constants that are known, and what it refuses to tell."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from rotatum import Device, RotatumError, characterise, load_device
from rotatum.evaluation.statics.result import Characterisation, JointCharacteristic
from rotatum.models import device_from_tables
from tests.evaluation.torque_sweeps import MAKER_PRO, NAME, log_of, qbmove, series

Array = NDArray[np.float64]

TRUTH = dict(zip(("k1", "a1", "k2", "a2"), np.ravel(MAKER_PRO), strict=True))
PHI = 0.2 * np.sin(np.linspace(0.0, 12.0, 800))


def qb(columns: dict[str, Array]) -> JointCharacteristic:
    result: Characterisation = characterise(log_of(columns), load_device(NAME))
    return result.joints[NAME]


def spring(text: str = "") -> Device:
    return device_from_tables(tomllib.loads(f'name = "sea"\n{text}'), "sea.toml")


@lru_cache(maxsize=1)
def found() -> Characterisation:
    result: Characterisation = characterise(log_of(qbmove()), load_device(NAME))
    return result


@pytest.mark.parametrize("colour", [0.0, 0.9])
def test_intervals_hold_the_truth(colour: float) -> None:
    """Eight seeds of four constants and an offset: at 95 % fewer than 5 of 40 miss (99 %).

    The constants of one seed move together, so the binomial's 5 becomes 8.
    """
    missed = 0
    for seed in range(8):
        joint = qb(qbmove(seed, colour=colour, samples=120))
        for one in (*joint.constants, *joint.nuisances):
            truth = TRUTH.get(one.name, 0.05)
            missed += abs(one.value - truth) > 1.96 * one.std
            assert abs(one.value - truth) < 5.0 * one.std  # not even once in a million
    assert missed <= 8


def test_c_is_the_papers_formula() -> None:
    joint = found().joints[NAME]
    logged = qbmove()
    constants = {one.name: one.value for one in joint.constants}
    offset = joint.nuisances[0].value
    (k1, a1), (k2, a2) = ((constants[f"k{i}"], constants[f"a{i}"]) for i in (1, 2))
    fit = k1 * np.sinh(a1 * (logged["q"] - logged["theta1"]))
    fit += k2 * np.sinh(a2 * (logged["q"] - logged["theta2"]))
    torque = logged["torque_measured"] - offset
    # Between presets the motors jump: those samples were too fast and are not in c.
    jump = np.abs(np.convolve(np.gradient(logged["theta1"]), np.ones(5), "same")) > 0.01
    kept = (np.abs(torque) > joint.floors[0]) & ~jump
    by_hand = 100.0 * np.sqrt(np.mean(((torque - fit) / torque)[kept] ** 2))
    # A few samples beside each jump are cut differently here than there.
    assert joint.relative_percent == pytest.approx(by_hand, rel=0.02)
    # The sensor's noise is 0.01 N m; its own estimate from differences is within 10 %.
    assert joint.floors[0] == pytest.approx(0.03, rel=0.1)
    assert joint.rms == pytest.approx(0.01, rel=0.05)
    assert [round(p.value, 2) for p in joint.presets] == [0.0, 0.15, 0.3, 0.45, 0.6]
    assert sum(p.samples for p in joint.presets) == joint.samples


def test_the_written_device_is_the_old_one_with_other_constants(tmp_path: Path) -> None:
    path = tmp_path / "fitted.toml"
    found().write(path)
    old, new = load_device(NAME).joints[0], load_device(path).joints[0]
    assert new == old.model_copy(
        update={"transmissions": new.transmissions, "sources": new.sources}
    )
    assert new.transmission.limit == old.transmission.limit
    stiffness = [sum(t.stiffness(0.1) for t in joint.transmissions) for joint in (new, old)]
    # Constants are told to 1 %, and k and a make up for one another.
    assert stiffness[0] == pytest.approx(stiffness[1], rel=0.01)


def test_a_slope_that_sinh_does_not_have_makes_c_grow_and_the_interval_wide() -> None:
    """The data sheet's `+ m (q - x)`, m = 0.5 N m/rad: a law that is wrong by it."""
    wrong, right = qb(qbmove(slope=0.5)), found().joints[NAME]
    # Most of it where the joint is soft: at preset 0 the slope is more than the springs are.
    assert wrong.presets[0].relative_percent > 1.5 * right.presets[0].relative_percent
    assert wrong.rms > 2.0 * right.rms
    assert wrong.correlation > 20.0
    assert wrong.constants[0].std > 10.0 * right.constants[0].std


def test_small_deflections_tell_products_and_no_constant() -> None:
    small = qbmove(presets=(0.0, 0.02), reach=0.05)
    joint = qb(small)
    assert not joint.answered
    assert joint.confounded == ("k1", "a1", "k2", "a2")
    assert all(np.isnan(one.value) for one in joint.constants)
    for one, (k, a) in zip(joint.together, MAKER_PRO, strict=True):
        assert abs(one.value - k * a) < 3.0 * one.std
    assert [one.name for one in joint.together] == ["k1 a1", "k2 a2"]
    result = characterise(log_of(small), load_device(NAME))
    with pytest.raises(RotatumError, match="do not tell k1"):
        result.fitted_device()


def test_one_preset_does_not_tell_two_springs_and_tied_it_does() -> None:
    log = log_of(qbmove(presets=(0.0,), samples=1000))
    own = characterise(log, load_device(NAME)).joints[NAME]
    assert not own.answered
    tied = characterise(log, load_device(NAME), tied=True).joints[NAME]
    assert [one.name for one in tied.constants] == ["k", "a"]
    k, a = tied.constants
    # The two real springs differ by 5 %, one between them is the best there is.
    assert abs(k.value - 0.0222) < 3.0 * k.std
    assert abs(a.value - 6.85) < 3.0 * a.std


def test_a_constant_that_is_known_makes_the_other_told() -> None:
    log = log_of(qbmove(presets=(0.0, 0.02), reach=0.05))
    given_a = characterise(log, load_device(NAME), fixed={"a": 6.85}).joints[NAME]
    assert given_a.answered
    assert [one.name for one in given_a.constants] == ["k1", "k2"]


@pytest.mark.parametrize(
    ("law", "torque", "truth"),
    [
        ("linear", 50.0 * PHI, {"stiffness": 50.0}),
        ("cubic", 20.0 * PHI + 300.0 * PHI**3, {"stiffness": 20.0, "cubic": 300.0}),
        ("sinh", 0.5 * np.sinh(9.0 * PHI), {"k": 0.5, "a": 9.0}),
        (
            "odd_polynomial",
            20.0 * PHI + 300.0 * PHI**3,
            {"coefficients[0]": 20.0, "coefficients[1]": 300.0},
        ),
    ],
)
def test_other_laws(law: str, torque: np.ndarray, truth: dict[str, float]) -> None:
    joint = characterise(log_of(series(torque, PHI), "sea"), spring(), law=law, terms=2)
    constants = joint.joints["sea"].constants
    assert {one.name for one in constants} == set(truth)
    for one in constants:
        assert abs(one.value - truth[one.name]) < 4.0 * one.std
        assert one.std < 0.05 * abs(one.value) + 1e-12


def test_a_lever_with_its_set_point() -> None:
    arm = np.repeat([0.06, 0.08, 0.1], 300)
    phi = np.tile(0.1 * np.sin(np.linspace(0.0, 6.28, 300)), 3)
    columns = series(14220.0 * arm**2 * np.sin(2.0 * phi), phi) | {"setpoint": arm}
    device = spring('actuation = "serial"\n[transmission]\nzero = 0.0')
    joint = characterise(log_of(columns, "sea"), device, law="lever").joints["sea"]
    (one,) = joint.constants
    assert abs(one.value - 14220.0) < 4.0 * one.std
    assert one.std < 30.0
    assert [round(preset.value, 2) for preset in joint.presets] == [0.06, 0.08, 0.1]
    del columns["setpoint"]
    with pytest.raises(RotatumError, match="lacks the channel setpoint"):
        characterise(log_of(columns, "sea"), device, law="lever")


def test_each_transmissions_own_sensor_and_a_zero() -> None:
    columns = qbmove(noise=0.0, offset=0.0)
    for end, (k, a) in zip(("1", "2"), MAKER_PRO, strict=True):
        phi = columns["q"] - columns[f"theta{end}"] - 0.01
        columns[f"torque_measured{end}"] = k * np.sinh(a * phi) + 0.02
    # Noise-free, so that what is left is the fit's own tolerance.
    result = characterise(log_of(columns), load_device(NAME), fit=("offset", "zero"))
    joint = result.joints[NAME]
    for one in joint.constants:
        assert one.value == pytest.approx(TRUTH[one.name], rel=1e-3)
    assert joint.zeros == pytest.approx((0.01, 0.01), abs=1e-4)


def test_an_encoder_that_starts_anywhere() -> None:
    columns = series(0.5 * np.sinh(9.0 * PHI), PHI)
    columns["q"] = columns["q"] + 2.0
    joint = characterise(log_of(columns, "sea"), spring()).joints["sea"]
    assert joint.zeros[0] == pytest.approx(2.0, abs=2e-3)  # 1 % of the swing
    assert abs(joint.constants[1].value - 9.0) < 4.0 * joint.constants[1].std


def test_gaps_dropouts_and_fast_samples_are_left_out() -> None:
    columns = qbmove()
    columns["torque_measured"][100:130] = np.nan
    columns["torque_measured"][[300, 301, 900]] = -40.0
    columns["q"][1500:1502] = 9.0
    joint = characterise(log_of(columns), load_device(NAME)).joints[NAME]
    assert joint.left_out["not finite"] == 30
    assert joint.left_out["dropouts"] == 5
    assert joint.left_out["too fast"] > 0
    for one in joint.constants:
        assert abs(one.value - TRUTH[one.name]) < 4.0 * one.std


def test_friction_in_the_sensor_is_told() -> None:
    rate = np.gradient(PHI, 0.02)
    columns = series(50.0 * PHI + 20.0 * rate, PHI)
    result = characterise(log_of(columns, "sea"), spring(), law="linear", max_speed=np.inf)
    assert any("moved too fast" in sentence for sentence in result.warnings)


def test_what_cannot_be_characterised_is_said() -> None:
    device, log = load_device(NAME), qbmove()
    with pytest.raises(RotatumError, match="Did you mean 'sinh'"):
        characterise(log_of(log), device, law="sin")
    with pytest.raises(RotatumError, match="a table has no constants"):
        characterise(log_of(log), device, law="table")
    with pytest.raises(RotatumError, match="depends on a set-point"):
        characterise(log_of(log), device, law="lever")
    with pytest.raises(RotatumError, match="Did you mean 'offset'"):
        characterise(log_of(log), device, fit=["ofset"])
    with pytest.raises(RotatumError, match="no such constant to fix"):
        characterise(log_of(log), device, fixed={"b": 1.0})
    lacking = {role: values for role, values in log.items() if role != "torque_measured"}
    with pytest.raises(RotatumError, match="lacks the channel torque_measured"):
        characterise(log_of(lacking), device)
    degrees = {r: v * (1.0 if "torque" in r else 180.0 / np.pi) for r, v in log.items()}
    with pytest.raises(RotatumError, match='unit = "deg"'):
        characterise(log_of(degrees), device)
    turned = log | {"torque_measured": -log["torque_measured"]}
    with pytest.raises(RotatumError, match="sign = -1"):
        characterise(log_of(turned), device)
