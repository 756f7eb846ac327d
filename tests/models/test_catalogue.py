"""The catalogue: every number says where it is from, and agrees with numbers worked out apart."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from importlib.resources import files
from math import pi
from typing import Any

import numpy as np
import pytest

from rotatum.models import Joint, device_names, load_device

NAMES = (
    "alterego-cube",
    "awas",
    "awas-ii",
    "bavs",
    "cjt-avocado-100-21000",
    "cjt-lemon-50-6000",
    "cjt-lime-50-21000",
    "cjt-orange-100-6000",
    "cjt-orange-80-6000",
    "cjt-pomegranate-160-9000",
    "compact-sea",
    "cubic-spring-pair",
    "franka-fr3",
    "kr15-like",
    "maccepa",
    "maccepa-two-link",
    "maccepa-vd",
    "manutec-r3",
    "planar-qbmove",
    "planar-vsa-ii",
    "qbmove-advanced",
    "qbmove-maker-pro",
    "qbmove-maker-pro-symmetric",
    "sea-10",
    "series-demo",
    "seven-axis",
    "vsa-ii",
    "vsa-ii-alt",
)


def _raw(name: str) -> dict[str, Any]:
    entry = files("rotatum.models") / "catalogue" / f"{name}.toml"
    return tomllib.loads(entry.read_text("utf-8"))


def _numbers(table: Any, place: str) -> Iterator[str]:
    """Yield the dotted key of every number of a joint's tables."""
    if isinstance(table, dict):
        for key, value in table.items():
            if key not in ("sources", "joint"):
                yield from _numbers(value, f"{place}.{key}" if place else key)
    elif isinstance(table, list):
        for i, value in enumerate(table):
            yield from _numbers(value, f"{place}[{i}]" if isinstance(value, dict) else place)
    elif isinstance(table, int | float) and not isinstance(table, bool):
        yield place


def _joint(name: str, number: int = 0) -> Joint:
    return load_device(name).joints[number]


def test_the_catalogue_is_complete() -> None:
    assert device_names() == NAMES
    for name in NAMES:
        device = load_device(name)
        assert (device.name, device.source) == (name, f"catalogue:{name}")


@pytest.mark.parametrize("name", NAMES)
def test_every_number_has_a_source(name: str) -> None:
    raw = _raw(name)
    tables = raw.get("joint", [raw])
    joints = load_device(name).joints
    for table, joint in zip(tables, joints, strict=True):
        keys = list(_numbers(table, ""))
        assert keys
        assert [key for key in keys if joint.source_of(key) is None] == []
        stale = [key for key in joint.sources if key.split(".")[0] not in table]
        assert stale == []


@pytest.mark.parametrize("name", NAMES)
def test_the_basis_lies_in_the_range_of_the_law(name: str) -> None:
    for joint in load_device(name).joints:
        reach = joint.basis.deflection_range
        nonlinear = [t for t in joint.transmissions if t.law not in (None, "linear")]
        assert reach is not None or not nonlinear
        for spring in nonlinear:
            assert reach is not None
            setpoints = joint.basis.setpoint_range or (0.0, 0.0)
            assert spring.model.uses_setpoint == (joint.basis.setpoint_range is not None)
            spring.check([[-reach], [reach]], setpoints)


@pytest.mark.parametrize("name", NAMES)
def test_the_basis_can_follow_the_law(name: str) -> None:
    for joint in load_device(name).joints:
        basis = joint.basis
        for spring in joint.transmissions:
            if spring.law is None or basis.deflection_range is None:
                continue
            x = np.linspace(-1.0, 1.0, 41)
            low, high = basis.setpoint_range or (0.0, 0.0)
            s = np.linspace(low, high, 9) if high > low else np.zeros(1)
            phi, setpoint = np.meshgrid(x * basis.deflection_range, s)
            scaled = (setpoint - 0.5 * (low + high)) / (0.5 * (high - low) or 1.0)
            powers = range(basis.orders) if basis.full else range(1, 2 * basis.orders, 2)
            columns = [
                (phi / basis.deflection_range) ** i * scaled**j
                for i in powers
                for j in range(basis.setpoint_orders + 1)
            ]
            F = np.stack([column.ravel() for column in columns], axis=1)
            tau = spring.torque(phi, setpoint).ravel()
            alpha, *_ = np.linalg.lstsq(F, tau, rcond=None)
            # A basis a user would want: over the whole range at most half a per cent of the
            # largest torque is left over.
            assert np.abs(F @ alpha - tau).max() < 5e-3 * np.abs(tau).max(), spring.law


@pytest.mark.parametrize("name", ["vsa-ii", "vsa-ii-alt"])
def test_both_vsa_ii_have_the_stiffness_of_the_papers_table(name: str) -> None:
    joint = _joint(name)
    t = np.linspace(0.0, 20.0, 2001)
    # Deflections of the size its simulation shows, 0.24 rad, at the inputs' frequencies.
    phi1, phi2 = 0.24 * np.sin(0.1 * pi * t), 0.24 * np.sin(2 * pi * t)
    total = joint.transmissions[0].stiffness(phi1) + joint.transmissions[1].stiffness(phi2)
    # Table 1 implies 0.439 to 0.452 N m/rad, known to about 10 %.
    assert np.sqrt(np.mean(total**2)) == pytest.approx(0.445, rel=0.05)
    assert joint.encoders.resolution("link") == 2 * pi / 4059


def test_the_qbmoves_at_their_presets() -> None:
    # Stiffness at zero deflection over the preset, N m/rad, tabulated apart from this code.
    tabulated = {
        "qbmove-maker-pro": {0.0: 0.30, 0.3: 1.2, 0.5: 4.7, 0.64: 12.2, 0.7: 18.3},
        "qbmove-maker-pro-symmetric": {0.0: 0.30, 0.3: 1.15, 0.5: 4.34, 0.64: 11.1, 0.7: 16.7},
    }
    for name, table in tabulated.items():
        one, other = _joint(name).transmissions
        for preset, told in table.items():
            sigma = float(one.stiffness(-preset) + other.stiffness(preset))
            assert sigma == pytest.approx(told, rel=0.02), (name, preset)  # two or three digits


def test_the_awas_is_stiff_as_its_lever_is_long() -> None:
    joint = _joint("awas")
    assert joint.setpoint is not None
    assert joint.setpoint.motor is not None
    # 20 mm of lever are 50 rad of the secondary motor behind its gear.
    arm = joint.setpoint.value(20.0 / 1000.0 / joint.setpoint.b)
    assert arm == pytest.approx(0.08, rel=1e-12)
    assert joint.transmission.stiffness(0.0, joint.setpoint.r0) == pytest.approx(284.4, rel=1e-4)
    assert joint.setpoint.motor.reflected_damping.value == pytest.approx(7.46, rel=1e-3)
    assert joint.setpoint.motor.reflected_inertia is not None
    assert joint.setpoint.motor.reflected_inertia.value == pytest.approx(6.8e-5, rel=5e-3)


CJT = {
    "cjt-avocado-100-21000": (0.0941 + 0.0540, 0.0022 + 3.4375, 1.50, 21000.0),
    "cjt-lemon-50-6000": (0.0472 + 0.0280, 0.0005 + 0.8594, 1.05, 6000.0),
    "cjt-lime-50-21000": (0.0160 + 0.0135, 0.0002 + 0.8594, 0.60, 21000.0),
    "cjt-orange-100-6000": (0.3594 + 0.1120, 0.0056 + 3.4375, 3.30, 6000.0),
    "cjt-orange-80-6000": (0.2300 + 0.0717, 0.0036 + 2.2000, 2.64, 6000.0),
    "cjt-pomegranate-160-9000": (1.5351 + 0.6733, 0.0233 + 8.8000, 6.00, 9000.0),
}


@pytest.mark.parametrize("name", CJT)
def test_the_toolboxs_joints_reflect_to_what_it_has(name: str) -> None:
    inertia, damping, coulomb, stiffness = CJT[name]
    joint = _joint(name)
    (motor,) = joint.motors
    assert motor.reflected_inertia is not None
    # Four digits are given in the file.
    assert motor.reflected_inertia.value == pytest.approx(inertia, rel=5e-4)
    assert motor.reflected_damping.value == pytest.approx(damping, rel=5e-4)
    assert motor.reflected_coulomb.value == pytest.approx(coulomb, rel=5e-4)
    assert joint.transmission.stiffness(0.01) == stiffness


def test_the_industrial_arms() -> None:
    r3, like = load_device("manutec-r3").joints, load_device("kr15-like").joints
    inertias = [j.motors[0].reflected_inertia for j in r3]
    assert [round(i.value, 2) for i in inertias if i is not None] == [14.33, 57.33, 4.68]
    stiffness = [float(j.transmission.stiffness(0.0)) for j in r3]
    assert stiffness == [474075.0, 352800.0, 208800.0]
    dampings = [j.transmission.damping for j in r3]
    assert dampings == pytest.approx([55.1, 441.0, 144.0], rel=1e-3)
    for one, other in zip(r3, like, strict=True):
        # 0.35, given to two digits, of values given to two or three.
        ratio = float(other.transmission.stiffness(0.0) / one.transmission.stiffness(0.0))
        assert ratio == pytest.approx(0.35, rel=0.02)
        ratio = other.transmission.damping / one.transmission.damping
        assert ratio == pytest.approx(0.35, rel=0.02)


def test_rotors_alone() -> None:
    joints = load_device("franka-fr3").joints
    found = [j.motors[0].reflected_inertia for j in joints]
    told = [0.6057, 0.6057, 0.4625, 0.4625, 0.2055, 0.2055, 0.2055]
    assert [i.value for i in found if i is not None] == told
    assert all(joint.transmission.law is None for joint in joints)
