"""One joint's observed state in time: deflection, link velocity, errors, status."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.observation import JointObservation
from rotatum.report.events_panel import status_panel
from rotatum.report.palette import DATA, ESTIMATE, MEASURED, TRUTH
from rotatum.report.panel import Panel, Row, line, robust_range
from rotatum.report.view import in_order

__all__ = ["observation_panels"]

Array = NDArray[np.float64]

_KEEP = 0.9999  # of a curve's values inside its plot: a start or a jump may leave it


class _Known(NamedTuple):
    """Positions that are known, or measured, of link and motor [rad]."""

    name: str
    q: Array
    theta: Array


@dataclass(frozen=True)
class _Shown:
    """A joint's series ready to be drawn, in order of time.

    Args:
        joint: as observed.
        begin: seconds after the first sample from which it is scored.
    """

    joint: JointObservation
    begin: float

    @cached_property
    def order(self) -> NDArray[np.int64]:
        return in_order(self.joint.series["time"])

    @cached_property
    def time(self) -> Array:
        time = self["time"]
        return np.asarray(time - time[:1].sum())  # the sum of one number, and 0 of none

    def __getitem__(self, key: str) -> Array:
        return np.asarray(self.joint.series[key][self.order], np.float64)

    def find(self, key: str) -> Array | None:
        """Series that not every log has."""
        return self[key] if key in self.joint.series else None

    @cached_property
    def known(self) -> _Known | None:
        """What the state is held against: the truth, else the link's encoder."""
        truth, encoder = self.find("q_true"), self.find("q")
        if truth is not None:
            theta = self.find("theta_true")
            return _Known("truth", truth, self["theta_hat"] if theta is None else theta)
        if encoder is not None and self.joint.score is not None:
            return _Known("link encoder", encoder, self["theta_hat"])
        return None

    def limits(self, *curves: Array) -> dict[str, list[float]]:
        """Vertical axis that shows what is scored; the start may leave it."""
        scored = self.time >= self.begin
        limits = robust_range(*(curve[scored] for curve in curves), keep=_KEEP)
        return {"range": limits} if limits else {}


def observation_panels(joint: JointObservation, begin: float) -> list[Panel]:
    """Return the panels of a joint, in their order.

    Args:
        joint: what was observed.
        begin: seconds after the first sample from which it is scored.
    """
    shown = _Shown(joint, begin)
    errors = [_errors(shown, shown.known)] if shown.known else []
    status = status_panel(shown.time, shown["status"].astype(np.int64), joint.status)
    return [_deflection(shown), _velocity(shown), *errors, status]


def _deflection(shown: _Shown) -> Panel:
    time, bent = shown.time, 1e3 * (shown["q_hat"] - shown["theta_hat"])
    traces, curves = [line("observed", time, bent, ESTIMATE, width=2.0)], [bent]
    if shown.known:
        name, q, theta = shown.known
        curves.append(1e3 * (q - theta))
        if name == "truth":
            traces.append(line(name, time, curves[1], TRUTH, width=1.4, dash="dash"))
        else:
            # Its steps are wider than the observed line, and would hide it.
            traces.insert(0, line(name, time, curves[1], MEASURED, width=1.0))
    return Panel(
        "deflection",
        "Deflection",
        "Link's position less the motor's, q - theta: what the spring is twisted by.",
        [Row("q - theta, mrad", traces, shown.limits(*curves), 260)],
    )


def _velocity(shown: _Shown) -> Panel:
    time, curves = shown.time, [shown["dq_hat"]]
    traces = [line("observed", time, curves[0], ESTIMATE, width=2.0)]
    truth = shown.find("dq_true")
    if truth is not None:
        curves.append(truth)
        traces.append(line("truth", time, truth, TRUTH, width=1.4, dash="dash"))
    return Panel(
        "velocity",
        "Link velocity",
        "Velocity of the link, beyond the elasticity.",
        [Row("q', rad/s", traces, shown.limits(*curves), 260)],
    )


def _errors(shown: _Shown, known: _Known) -> Panel:
    name, q, theta = known
    off, rigid = 1e3 * (shown["q_hat"] - q), 1e3 * (theta - q)
    time = shown.time
    both = [
        line("of a rigid joint", time, rigid, DATA, width=1.5),
        line("of the observer", time, off, ESTIMATE, width=1.5),
    ]
    alone = [line("of the observer", time, off, ESTIMATE, width=1.2)]
    rows = [
        Row("error of the link's position, mrad", both, shown.limits(off, rigid), 150),
        Row("that of the observer alone, mrad", alone, shown.limits(off), 130),
    ]
    against = "the truth" if name == "truth" else "the link's encoder, whose own error is in it"
    note = f"Against {against}. A rigid joint: the link is taken to be where the motor is."
    return Panel("errors", "Error of the link's position", note, rows)
