"""Results as columns of a table."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.kernels.status import VERDICTS
from rotatum.record import Records

FIELDS = ("stiffness", "stiffness_std", "torque", "torque_std", "dstiffness", "deflection")


def reading_columns(joint: str, records: Records) -> dict[str, NDArray[Any]]:
    """Canonical result columns of one joint: ``<joint>.stiffness`` and so on, all SI.

    Args:
        joint: its name.
        records: (N,) records of ``Reading``.
    """
    columns: dict[str, NDArray[Any]] = {f"{joint}.{f}": records[f] for f in FIELDS}
    columns[f"{joint}.verdict"] = np.array(VERDICTS)[records["verdict"]]
    columns[f"{joint}.status"] = records["status"]
    return columns
