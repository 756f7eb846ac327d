"""What the answer rests on: how far the joint was deflected, and how narrow that made it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rotatum.report.palette import DATA, ESTIMATE, MEASURED, PARTS, THRESHOLD
from rotatum.report.panel import Panel, Row, Trace, level, line, robust_range
from rotatum.report.part import parts
from rotatum.report.setpoints import setpoint_axis
from rotatum.report.view import View

__all__ = ["excitation_panel", "interval_row"]

Array = NDArray[np.float64]
_NARROW, _WIDE = 10.0, 50.0  # per cent; the verdict's thresholds


def excitation_panel(shown: View) -> Panel:
    """Return deflection, interval, noise and inflation over time.

    Parameters
    ----------
    shown : the joint.
    """
    rows = [
        _deflection_row(shown),
        _informative_row(shown),
        interval_row(shown),
        _scatter_row(shown),
        _inflation_row(shown),
    ]
    note = (
        "A stiffness can only be told where the spring moves: the deflection that nothing else in "
        "the model explains has to be large against the error of the encoders. Inflation above 1 "
        "says that the residuals are coloured, and by how much variances were raised for it."
    )
    if shown.setpoint is not None:
        rows.insert(1, _setpoint_row(shown, shown.setpoint))
        note += " How the stiffness hangs on the set-point can only be told where that moves too."
    if len(shown.estimate.parts) > 1:
        rows.append(_correlation_row(shown))
        note += (
            " Both transmissions are deflected against one link, whose encoder's errors enter "
            "both: a correlation below 0 makes the total surer than two independent ones."
        )
    return Panel("excitation", "Excitation", note, rows)


def interval_row(shown: View) -> Row:
    """Return half the interval over the stiffness on a logarithmic axis, with the thresholds.

    Parameters
    ----------
    shown : the joint.
    """
    time, relative = shown.time, shown.relative
    traces: list[Trace] = [line("half interval", time, relative, ESTIMATE, legend=False)]
    if len(time):
        traces.append(level("10 %: informative below", time, _NARROW, THRESHOLD))
        traces.append(level("50 %: starved above", time, _WIDE, DATA))
    finite = relative[np.isfinite(relative) & (relative > 0.0)]
    low = min(float(np.percentile(finite, 0.5)) if finite.size else _NARROW, _NARROW)
    return Row(
        "half interval over stiffness, % (log)",
        traces,
        _logarithmic(0.7 * low, 300.0),
        150,
    )


def _deflection_row(shown: View) -> Row:
    own = parts(shown)
    curves = [1e3 * part.row("deflection") for part in own]
    if len(own) == 1:
        traces = [line("deflection", shown.time, curves[0], DATA, width=1.0, legend=False)]
    else:
        traces = [
            line(part.name, shown.time, phi, colour, width=1.0)
            for part, phi, colour in zip(own, curves, PARTS, strict=True)
        ]
    return Row("deflection, mrad", traces, _linear(robust_range(*curves, keep=0.9999)), 130)


def _setpoint_row(shown: View, setpoint: Array) -> Row:
    axis = setpoint_axis(shown)
    s = axis.factor * setpoint
    traces = [line("set-point", shown.time, s, DATA, width=1.2, legend=False)]
    limits = shown.joint.basis.setpoint_range
    if len(shown.time) and limits and shown.joint.basis.setpoint_orders:
        for end in limits:
            name = "ends of its declared range"
            traces.append(level(name, shown.time, axis.factor * end, DATA, "dot"))
    return Row(axis.title, traces, {"nticks": 5}, 130)


def _correlation_row(shown: View) -> Row:
    r = shown.learned("correlation")
    traces = [line("correlation", shown.time, r, DATA, width=1.2, legend=False)]
    y = {"range": [-1.08, 1.08], "tickvals": [-1, 0, 1]}
    return Row("correlation of the two stiffnesses' errors", traces, y, 105)


def _informative_row(shown: View) -> Row:
    time = shown.time
    moved = 1e3 * shown.learned("informative_deflection")
    moved = np.where(moved > 0.0, moved, np.nan)
    traces: list[Trace] = [line("informative deflection", time, moved, ESTIMATE, legend=False)]
    values = list(moved[np.isfinite(moved)][-1:])
    encoders = shown.joint.encoders
    steps = [s for s in (encoders.resolution("link"), encoders.resolution("motor")) if s]
    if len(time) and steps:
        values.append(1e3 * max(steps))
        traces.append(level("coarser encoder's step", time, 1e3 * max(steps), DATA, "dot"))
    if len(time) and encoders.accuracy:
        values.append(1e3 * encoders.accuracy)
        traces.append(level("encoders' accuracy", time, 1e3 * encoders.accuracy, MEASURED))
    y = _logarithmic(0.4 * min(values), 2.5 * max(values)) if values else {"type": "log"}
    return Row("informative deflection, mrad rms (log)", traces, y, 130)


def _scatter_row(shown: View) -> Row:
    noise = shown.learned("noise")
    y = _linear(robust_range(noise, np.zeros(1)))
    traces = [line("noise", shown.time, noise, DATA, legend=False)]
    return Row(f"noise of a row, {shown.unit}", traces, y, 105)


def _inflation_row(shown: View) -> Row:
    inflation = shown.learned("inflation")
    y = _linear(robust_range(inflation, np.ones(1)))
    traces = [line("inflation", shown.time, inflation, DATA, legend=False)]
    return Row("inflation of variances", traces, y, 105)


def _linear(limits: list[float] | None) -> dict[str, object]:
    return {"range": limits, "nticks": 5} if limits else {"nticks": 5}


def _logarithmic(low: float, high: float) -> dict[str, object]:
    bottom, top = math.log10(low), math.log10(high)
    y: dict[str, object] = {"type": "log", "range": [bottom, top], "tickformat": "~g"}
    return {**y, "dtick": 1 if top - bottom > 1.5 else "D2"}
