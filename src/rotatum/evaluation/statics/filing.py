"""The device file with the fitted constants in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rotatum.errors import MethodError
from rotatum.models import Device, Joint
from rotatum.models.device import device_from_tables
from rotatum.models.laws import LAWS
from rotatum.simulation.scenario.device_tables import device_toml, tables_of

if TYPE_CHECKING:
    from rotatum.evaluation.statics.result import Characterisation, JointCharacteristic

__all__ = ["described"]


def described(found: Characterisation) -> tuple[Device, str]:
    """Return the device with the fitted constants, and the text of its file.

    What the file says of damping, preload, limit and the zero stays; a zero that is a number and
    was fitted is the fitted one. Comments of the old file are lost, its [sources] are kept but for
    the constants', which name the log.

    Parameters
    ----------
    found : with every constant told.

    Raises
    ------
    MethodError if the data do not tell every constant.
    """
    tables = tables_of(found.device)
    joints = tables.get("joint", [tables])
    remarks = [f"rotatum characterise {found.source} --law {found.law}"]
    for joint, table in zip(found.device.joints, joints, strict=True):
        if joint.name not in found.joints:
            continue
        one = found.joints[joint.name]
        if one.springs is None:
            raise MethodError(
                f"no constants to write: the data do not tell {', '.join(one.confounded)} of "
                f"joint {joint.name}",
                where=found.source,
            )
        springs = [_spring(found.law, joint, one, part) for part in range(len(one.springs))]
        same = all(each == springs[0] for each in springs)
        table["transmission"] = springs[0] if same else springs
        table["sources"] = _sources(found, joint, one)
        told = [f"{c.name} = {c.value:.5g} +- {1.96 * c.std:.2g} {c.unit}" for c in one.constants]
        remarks.append(f"{joint.name}: {', '.join(told)}; c = {one.relative_percent:.4g} %")
    device = device_from_tables(tables, found.device.source)
    return device, device_toml(device, tuple(remarks))


def _spring(law: str, joint: Joint, one: JointCharacteristic, part: int) -> dict[str, Any]:
    filed = joint.transmissions[part]
    kept = filed.model_dump(exclude_defaults=True, exclude_none=True)
    kept = {name: kept[name] for name in ("damping", "zero", "preload", "limit") if name in kept}
    if one.zeros and not isinstance(filed.zero, str):
        kept["zero"] = one.zeros[part]
    assert one.springs is not None
    many = {each.name for each in LAWS[law].constants if each.many}
    constants = {n: list(v) if n in many else v[0] for n, v in one.springs[part].items()}
    return {"law": law, **constants, **kept}


def _sources(found: Characterisation, joint: Joint, one: JointCharacteristic) -> dict[str, str]:
    constants = {each.name for spring in joint.transmissions for each in _constants(spring.law)}
    gone = {"law", *constants}
    kept = {}
    for key, text in joint.sources.items():
        table, _, name = key.partition(".")
        if not table.startswith("transmission") or (name and name not in gone):
            kept[key] = text
    told = f"computed: fit to {found.source}, relative rms {one.relative_percent:.4g} %"
    return kept | {"transmission": told}


def _constants(law: str | None) -> tuple[Any, ...]:
    return () if law is None else LAWS[law].constants
