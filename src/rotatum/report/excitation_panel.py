"""What the answer rests on: how far the joint was deflected, and how narrow that made it."""

from __future__ import annotations

import math

import numpy as np

from rotatum.report.palette import DATA, ESTIMATE, MEASURED, THRESHOLD
from rotatum.report.panel import Panel, Row, Trace, level, line, robust_range
from rotatum.report.view import View

__all__ = ["excitation_panel", "interval_row"]

_NARROW, _WIDE = 10.0, 50.0  # per cent; the verdict's thresholds


def excitation_panel(shown: View) -> Panel:
    """Return deflection, interval, noise and inflation over time.

    Parameters
    ----------
    shown : the joint.
    """
    return Panel(
        "excitation",
        "Excitation",
        "A stiffness can only be told where the spring moves: the deflection that nothing else in "
        "the model explains has to be large against the error of the encoders. Inflation above 1 "
        "says that the residuals are coloured, and by how much variances were raised for it.",
        [
            _deflection_row(shown),
            _informative_row(shown),
            interval_row(shown),
            _scatter_row(shown),
            _inflation_row(shown),
        ],
    )


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
    low = min(float(finite.min()) if finite.size else _NARROW, _NARROW)
    return Row(
        "half interval over stiffness, % (log)",
        traces,
        _logarithmic(0.7 * low, 300.0),
        150,
    )


def _deflection_row(shown: View) -> Row:
    phi = 1e3 * shown.row("deflection")
    limits = robust_range(phi, keep=0.9999)
    y = {"range": limits, "nticks": 5} if limits else {"nticks": 5}
    traces = [line("deflection", shown.time, phi, DATA, width=1.0, legend=False)]
    return Row("deflection, mrad", traces, y, 130)


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
    limits = robust_range(noise, np.zeros(1))
    y = {"range": limits, "nticks": 5} if limits else {"nticks": 5}
    traces = [line("noise", shown.time, noise, DATA, legend=False)]
    return Row(f"noise of a row, {shown.unit}", traces, y, 105)


def _inflation_row(shown: View) -> Row:
    inflation = shown.learned("inflation")
    limits = robust_range(inflation, np.ones(1))
    y = {"range": limits, "nticks": 5} if limits else {"nticks": 5}
    traces = [line("inflation", shown.time, inflation, DATA, legend=False)]
    return Row("inflation of variances", traces, y, 105)


def _logarithmic(low: float, high: float) -> dict[str, object]:
    bottom, top = math.log10(low), math.log10(high)
    y: dict[str, object] = {"type": "log", "range": [bottom, top], "tickformat": "~g"}
    return {**y, "dtick": 1 if top - bottom > 1.5 else "D2"}
