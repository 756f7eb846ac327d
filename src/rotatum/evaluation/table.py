"""Results as columns of a table."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.parts import external_stiffness, has_external
from rotatum.kernels.status import VERDICTS
from rotatum.models import Joint
from rotatum.record import Records

FIELDS = ("stiffness", "stiffness_std", "torque", "torque_std", "dstiffness", "deflection")
PARTS = ("stiffness", "stiffness_std", "torque", "dstiffness", "deflection")


def reading_columns(
    joint: Joint, torque: str, records: Records, q: NDArray[np.float64]
) -> dict[str, NDArray[Any]]:
    """Canonical result columns of one joint: ``<joint>.stiffness`` and so on, all SI.

    Antagonistic joints have ``stiffness1``, ``stiffness2`` and so on beside the total, joints
    with a described link the ``external_stiffness`` (flacco2012 eq. 6).

    Args:
        joint: as described.
        torque: source of its torques.
        records: (N,) records of ``Reading`` or ``PairReading``.
        q: (N,) link positions, rad.
    """
    name = joint.name
    columns: dict[str, NDArray[Any]] = {f"{name}.{f}": records[f] for f in FIELDS}
    if has_external(joint, torque):
        columns[f"{name}.external_stiffness"] = external_stiffness(joint, records["stiffness"], q)
    if joint.actuation == "antagonistic":
        for field in PARTS:
            word, _, rest = field.partition("_")
            for i in (0, 1):
                end = f"{word}{i + 1}{f'_{rest}' if rest else ''}"
                columns[f"{name}.{end}"] = records[f"part_{field}"][:, i]
    columns[f"{name}.verdict"] = np.array(VERDICTS)[records["verdict"]]
    columns[f"{name}.status"] = records["status"]
    return columns
