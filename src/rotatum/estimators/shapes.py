"""Everything about a joint that decides the code and layouts of its estimator."""

from __future__ import annotations

from typing import NamedTuple

from rotatum.estimators.operators import EXPONENTIAL, OBSERVER, WINDOW
from rotatum.record import Layout, integer, number

ROOMY = (WINDOW, OBSERVER)
"""Operators that look back over a number of samples."""


class Shape(NamedTuple):
    """All that decides a stage's code and layouts; joints that share it share a bank.

    Args:
        method: ``"weak"``, ``"algebraic"``, ``"rotatum"`` or ``"residual"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
        terms: terms of the basis; of both transmissions where they share a row.
        columns: all regressors of a row.
        powers: highest power of the deflection or of the set-point.
        solver: ``"ud"`` or ``"covariance"``.
        actuation: ``"series"``, ``"antagonistic"`` or ``"serial"``.
        shrunk: whether high orders are shrunk.
        law: of the device, where it stands in for a torque; else ``""``.
        constants: how many it has.
        side: ``"motor"`` or ``"link"``.
        arm: whether the link belongs to an arm.
        operator: ``"exponential"``, ``"window"`` or ``"observer"``.
        size: samples a window's ring, or an observer's window, can hold; 0 without one.
        selective: whether nothing is learnt near a standstill of the link.
    """

    method: str
    torque: str
    terms: int
    columns: int
    powers: int
    solver: str = "ud"
    actuation: str = "series"
    shrunk: bool = False
    law: str = ""
    constants: int = 0
    side: str = "motor"
    arm: bool = False
    operator: str = EXPONENTIAL
    size: int = 0
    selective: bool = False

    @property
    def rows_name(self) -> str:
        """Name of the rows' stage."""
        source = "link" if self.side == "link" else self.torque
        name = f"{self.method}_{source}_{self.terms}of{self.columns}"
        if self.law:
            name = f"{name}_{self.law}"
        return f"{name}_{self.operator}{self.size}" if self.operator in ROOMY else name

    @property
    def together(self) -> bool:
        """Whether two transmissions share a row: their torques add up on the link."""
        return self.side == "link" and self.actuation == "antagonistic"


def ring_size(length: int, least: int = 64) -> int:
    """Room for a window: the next power of two, so that windows of like length share their code."""
    size = least
    while size < length:
        size *= 2
    return size


_TORQUES = {"estimated": "tau", "sensor": "torque_measured"}
_DOCS = {
    "q": ("link position", "rad"),
    "theta": ("motor position, joint side", "rad"),
    "setpoint": ("set-point as logged", "unit of the set-point"),
    "tau": ("motor torque, joint side", "N m"),
    "torque_measured": ("measured elastic torque", "N m"),
}


def ends_of(actuation: str) -> tuple[str, ...]:
    """Return what the names of a joint's transmissions end in."""
    return ("1", "2") if actuation == "antagonistic" else ("",)


def roles(actuation: str, torque: str, side: str = "motor") -> tuple[str, ...]:
    """Channels an estimator of this actuation reads, under the names of the log.

    Args:
        actuation: ``"series"``, ``"antagonistic"`` or ``"serial"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
        side: ``"motor"`` or ``"link"``; the latter reads no torque.
    """
    ends = ends_of(actuation)
    found = ["q", *(f"theta{end}" for end in ends)]
    if actuation == "serial":
        found.append("setpoint")
    if side == "motor" and torque in _TORQUES:
        found += [f"{_TORQUES[torque]}{end}" for end in ends]
    return tuple(found)


def sample_layout(actuation: str, torque: str, side: str = "motor") -> Layout:
    """What an estimator reads: time, its channels, and whether to learn."""
    fields = {"time": number("of the sample", unit="s", symbol="t")}
    for role in roles(actuation, torque, side):
        doc, unit = _DOCS[role.rstrip("12")]
        which = {"1": ", agonist", "2": ", antagonist"}.get(role[-1], "")
        fields[role] = number(f"{doc}{which}", unit=unit, symbol=role)
    fields["enable"] = integer("0: do not learn from this sample")
    doc = f"One sample of a joint with {actuation} actuation."
    return Layout(f"{actuation}_{'link' if side == 'link' else torque}_sample", doc, fields)


def wires_of(actuation: str, torque: str, side: str) -> dict[str, str]:
    """Field of a stage's input, dotted where it is nested, to the channel it is fed from."""
    common = {"time": "time", "q": "q", "enable": "enable"}
    if side == "link":
        wires = {**common, "theta": f"theta{ends_of(actuation)[0]}"}
        if actuation == "antagonistic":
            wires["theta2"] = "theta2"
        return wires | ({"setpoint": "setpoint"} if actuation == "serial" else {})
    found = {}
    for end in ends_of(actuation):
        wires = {**common, "theta": f"theta{end}"}
        if torque in _TORQUES:
            wires["torque"] = f"{_TORQUES[torque]}{end}"
        found[end] = wires
    if actuation == "antagonistic":
        parts = {"first": found["1"], "second": found["2"]}
        inner = {f"{k}.{f}": v for k, wires in parts.items() for f, v in wires.items()}
        return {"time": "time", **inner}
    return found[""] | ({"setpoint": "setpoint"} if actuation == "serial" else {})
