"""Two transmissions that share a row: the total as told, and each told apart by its columns.

Columns of a row are fitted quantities, then the basis in turns, agonist first. Coefficients of a
``PairReading`` are the fitted ones and the agonist's, then the fitted ones and the antagonist's.
"""

from __future__ import annotations

import math
from typing import Any

from rotatum.kernels.pair import read2
from rotatum.kernels.status import STARVED, WIDE


def read(reading: Any, row: Any, out: Any) -> None:
    """Hand on what is told of the total; its deflection is the mean of both."""
    out.stiffness = reading.stiffness
    out.stiffness_std = reading.stiffness_std
    out.torque = reading.torque
    out.torque_std = reading.torque_std
    out.dstiffness = reading.dstiffness
    out.deflection = 0.5 * (row.phi + row.phi2)
    out.row_torque = reading.row_torque
    out.row_fit = reading.row_fit
    out.noise = reading.noise
    out.inflation = reading.inflation
    out.informative_deflection = reading.informative_deflection
    out.converged_at = reading.converged_at
    out.converged = reading.converged
    out.verdict = reading.verdict
    out.status = reading.status
    out.rows = reading.rows


def mask(row: Any, terms: int, i: int, out: Any) -> None:
    """Keep the read-out of one transmission, 0 elsewhere."""
    first = len(out) - terms
    for h in range(len(out)):
        out[h] = 0.0
    for h in range(int(terms * 0.5)):
        out[first + 2 * h + i] = row.D[first + 2 * h + i]


def part(
    readout: Any,
    evidence: Any,
    reading: Any,
    row: Any,
    spread: float,
    bias2: float,
    terms: int,
    i: int,
    out: Any,
) -> None:
    """Tell one transmission's share, ``spread`` being ``D^T P D`` of its own read-out D.

    What is systematic may be all its. Where its own interval is wide it is starved, whatever the
    total is.
    """
    first = len(row.D) - terms
    half = int(terms * 0.5)
    own = first + half
    stiffness = 0.0
    torque = 0.0
    slope = 0.0
    for h in range(first):
        out.coefficients[i * own + h] = reading.coefficients[h]
        out.coefficients_std[i * own + h] = reading.coefficients_std[h]
    for h in range(half):
        at = first + 2 * h + i
        a = reading.coefficients[at]
        stiffness = stiffness + row.D[at] * a
        torque = torque + row.F[at] * a
        slope = slope + row.H[at] * a
        out.coefficients[i * own + first + h] = a
        out.coefficients_std[i * own + first + h] = reading.coefficients_std[at]
    variance = evidence.inflation * evidence.variance * spread + bias2
    variance = variance + stiffness * stiffness * evidence.relative2
    variance = variance + evidence.shift * evidence.shift
    variance = variance + slope * slope * (readout.link2 + readout.motor2)
    std = math.sqrt(variance)
    out.part_stiffness[i] = stiffness
    out.part_stiffness_std[i] = std
    out.part_torque[i] = torque
    out.part_dstiffness[i] = slope
    out.part_deflection[i] = row.phi
    if i == 1:
        out.part_deflection[i] = row.phi2
    out.part_row_torque[i] = reading.row_torque
    out.part_row_fit[i] = reading.row_fit
    out.part_verdict[i] = reading.verdict
    out.part_status[i] = reading.status
    if 1.96 * std > readout.starved * math.fabs(stiffness):
        out.part_verdict[i] = STARVED
        out.part_status[i] = reading.status | WIDE


def relate(readout: Any, out: Any) -> None:
    """Correct the total's deviation for two motors; tell how both errors hang together.

    The total was told with ``(sigma_1' + sigma_2')^2`` for the noise of one motor; the correlation
    is ``(V - V_1 - V_2) / (2 sqrt(V_1 V_2))`` within -1 and 1.
    """
    both = out.part_dstiffness[0] + out.part_dstiffness[1]
    told = both * both * (readout.link2 + readout.motor2)
    variance = out.stiffness_std * out.stiffness_std - told + read2(readout, out)
    if variance > 0.0:
        out.stiffness_std = math.sqrt(variance)
    V1 = out.part_stiffness_std[0] * out.part_stiffness_std[0]
    V2 = out.part_stiffness_std[1] * out.part_stiffness_std[1]
    V = out.stiffness_std * out.stiffness_std
    out.correlation = 0.0
    if V1 > 0.0 and V2 > 0.0:
        r = (V - V1 - V2) / (2.0 * math.sqrt(V1 * V2))
        if r > 1.0:
            r = 1.0
        if r < -1.0:
            r = -1.0
        out.correlation = r
