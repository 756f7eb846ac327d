"""`rotatum devices`: the catalogue, or one device with every value, its unit and its source."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rotatum.cli.failures import DONE

if TYPE_CHECKING:
    from rotatum.models import Device

__all__ = ["devices"]


def devices(
    name: Annotated[
        str | None,
        typer.Argument(help="A name of the catalogue, or a device file.", show_default=False),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON instead.")] = False,
) -> int:
    """List the catalogue of devices, or show one with its values, units and sources."""
    from rotatum.cli.printing import print_json
    from rotatum.models import device_names, load_device

    if name is not None:
        device = load_device(name)
        if json:
            print_json(_plain(device))
        else:
            _print_one(device)
        return DONE
    catalogue = [load_device(each) for each in device_names()]
    if json:
        print_json([_plain(device) for device in catalogue])
    else:
        _print_all(catalogue)
    return DONE


def _plain(device: Device) -> dict[str, Any]:
    """Return a device as JSON has it; all values in SI units."""
    return {
        "name": device.name,
        "source": device.source,
        "about": _about(_text(device)),
        "joints": [joint.model_dump(mode="json", exclude_none=True) for joint in device.joints],
    }


def _print_all(catalogue: list[Device]) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of

    table = table_of("name", "actuation", "law", "joints", numbers=(3,))
    for device in catalogue:
        kinds = ", ".join(dict.fromkeys(joint.actuation for joint in device.joints))
        springs = [spring for joint in device.joints for spring in joint.transmissions]
        laws = ", ".join(dict.fromkeys(spring.law or "-" for spring in springs))
        table.add_row(device.name, kinds, laws, str(len(device.joints)))
    console = stdout()
    console.print(table)
    console.print("rotatum devices NAME shows one; a copy of its text makes a device file.")


def _print_one(device: Device) -> None:
    from rotatum.cli.device_values import values
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of

    console = stdout()
    for joint in device.joints:
        table = table_of("value of " + joint.name, "", "unit", "source", numbers=(1,))
        for value in values(joint):
            table.add_row(value.key, value.text, value.unit, value.source.partition(":")[0])
        console.print(table)
    print(f"# {device.source}\n{_text(device)}", end="")


def _text(device: Device) -> str:
    kind, _, name = device.source.partition("catalogue:")
    if not kind and name:
        return (files("rotatum.models") / "catalogue" / f"{name}.toml").read_text("utf-8")
    return Path(device.source).read_text("utf-8")


def _about(text: str) -> str:
    """Return the comment a device file begins with."""
    words: list[str] = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        words.append(line.lstrip("#").strip())
    return " ".join(words)
