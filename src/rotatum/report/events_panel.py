"""When samples were skipped, bridged or restarted at, and which doubts were raised."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotatum.kernels.status import TABLE
from rotatum.report.palette import ESTIMATE
from rotatum.report.panel import Panel, Row, Trace
from rotatum.report.thin import buckets
from rotatum.report.view import View

__all__ = ["events_panel", "status_panel"]

_CELLS = 400  # along time


def events_panel(shown: View) -> Panel:
    """Return which status bits were set when.

    Parameters
    ----------
    shown : the joint.
    """
    return status_panel(shown.time, shown.status, shown.estimate.samples)


def status_panel(
    time: NDArray[np.float64], status: NDArray[np.int64], samples: Mapping[str, int]
) -> Panel:
    """Return which status bits were set when.

    Parameters
    ----------
    time : (N,) s, increasing.
    status : (N,) bits.
    samples : name of a bit to how many samples had it; one that none had is not shown.
    """
    seen = [bit for bit in TABLE if samples.get(bit.name)]
    traces: list[Trace] = []
    if seen and len(time) > 1:
        edges = buckets(len(time), _CELLS)
        starts = [first for first, _ in edges]
        share = [
            np.add.reduceat((status & bit.bit) != 0, starts, dtype=np.float64)
            / np.diff([*starts, len(time)])
            for bit in seen
        ]
        # A single sample out of thousands has to be seen.
        shade = np.array([np.where(row > 0.0, 0.35 + 0.65 * row, 0.0) for row in share])
        traces.append(
            {
                "type": "heatmap",
                "x": np.append(time[starts], time[-1]),
                "y": [bit.name for bit in seen],
                "z": shade.astype(np.float32),
                "customdata": 100.0 * np.array(share, np.float32),
                "zmin": 0.0,
                "zmax": 1.0,
                "colorscale": [[0.0, "rgba(0, 0, 0, 0)"], [1.0, ESTIMATE]],
                "showscale": False,
                "ygap": 3,
                "hovertemplate": "%{y}: %{customdata:.2g} % of samples<extra></extra>",
            }
        )
    y = {"autorange": "reversed", "automargin": True, "showgrid": False}
    return Panel(
        "events",
        "Status",
        "Which status bits were set when; darker where more samples had them.",
        [Row("status bit", traces, y, 40 + 22 * max(1, len(seen)))],
    )
