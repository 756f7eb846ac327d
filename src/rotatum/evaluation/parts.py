"""What a run says of each transmission of a joint, and the stiffness seen from outside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.estimators.tuning import Prepared
from rotatum.evaluation.fitted import fitted_quantities
from rotatum.evaluation.summary import Summary
from rotatum.kernels.status import VERDICTS
from rotatum.models import Joint
from rotatum.record import Records


@dataclass(frozen=True)
class PartEstimate:
    """One transmission's result; a series or serial joint has one.

    Args:
        label: the joint's name, with the transmission's number where there are two.
        end: that number, or nothing.
        stiffness: at the last sample, N m/rad.
        stiffness_std: its standard deviation.
        verdict: at the last sample.
        coefficients, coefficients_std: (p,) final values in SI at the joint, fitted columns first.
        fitted: quantity to (value, standard deviation), in the device file's side and units.
        truth: as in ``JointEstimate``, of this transmission.
    """

    label: str
    end: str
    stiffness: float
    stiffness_std: float
    verdict: str
    coefficients: NDArray[np.float64]
    coefficients_std: NDArray[np.float64]
    fitted: Mapping[str, tuple[float, float]]
    truth: Mapping[str, float] | None

    def to_json(self) -> dict[str, Any]:
        """The transmission's entry in ``--json``."""
        return {
            "stiffness": self.stiffness,
            "stiffness_std": self.stiffness_std,
            "verdict": self.verdict,
            "truth": None if self.truth is None else dict(self.truth),
        }


def part_estimates(
    prepared: Prepared,
    last: Records,
    summary: Summary,
    unknown: Sequence[Sequence[tuple[str, ...]]],
) -> tuple[PartEstimate, ...]:
    """Take the last reading apart.

    Args:
        prepared: the joint's constants and columns.
        last: its last reading.
        summary: scores against truth.
        unknown: of each part with rows of its own, names that its data do not tell apart.
    """
    scales = np.array(prepared.scales)
    pair = prepared.joint.actuation == "antagonistic"
    found = []
    for i, end in enumerate(("1", "2") if pair else ("",)):
        p = len(scales)
        own = slice(i * p, (i + 1) * p)
        sigma = last["part_stiffness"][i] if pair else last["stiffness"]
        std = last["part_stiffness_std"][i] if pair else last["stiffness_std"]
        verdict = last["part_verdict"][i] if pair else last["verdict"]
        values, spread = last["coefficients"][own], last["coefficients_std"][own]
        groups = unknown[i if prepared.apart else 0]
        mixed = frozenset(name for group in groups for name in group)
        scored = summary.part_scores[i] if pair else summary.score
        found.append(
            PartEstimate(
                label=f"{prepared.joint.name}{f', transmission {end}' if pair else ''}",
                end=end,
                stiffness=float(sigma),
                stiffness_std=float(std),
                verdict=VERDICTS[int(verdict)],
                coefficients=values / scales,
                coefficients_std=spread / scales,
                fitted=fitted_quantities(
                    prepared, i, values, spread, float(sigma), float(std), mixed
                ),
                truth=scored.result() if scored.samples else None,
            )
        )
    return tuple(found)


def external_stiffness(joint: Joint, stiffness: ArrayLike, q: ArrayLike) -> NDArray[np.float64]:
    """Return the stiffness seen from the link with the motors held (flacco2012 eq. 6).

    In statics ``tau_ext = g(q) + tau_e(q - theta)``, so ``sigma_ext = sigma + G cos q`` with
    gravity ``g = G sin q``; without gravity it is the passive stiffness.

    Args:
        joint: with a link.
        stiffness: (N,) passive stiffness, N m/rad.
        q: (N,) link position, rad, 0 hanging down.
    """
    gravity = joint.link.gravity_torque if joint.link is not None else 0.0
    return np.asarray(np.asarray(stiffness) + gravity * np.cos(q))


def has_external(joint: Joint, torque: str) -> bool:
    """Whether gravity can be added: the link is described, and torques are in N m.

    Args:
        joint: as described.
        torque: their source.
    """
    return joint.link is not None and joint.torque_unit(torque) == "N m"


def final_external(prepared: Prepared, last: Records, q: NDArray[np.float64]) -> float | None:
    """Return it at the last sample whose link position is known; None where there is none.

    Args:
        prepared: the joint.
        last: the last reading.
        q: kept link positions.
    """
    known = q[np.isfinite(q)]
    if not known.size or not has_external(prepared.joint, prepared.settings.torque):
        return None
    return float(external_stiffness(prepared.joint, last["stiffness"], known[-1]))
