"""The three modalities of eq. 44 through the paper's method, and ``weak`` on the same log."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.columns import Power
from rotatum.evaluation.estimate import JointEstimate
from rotatum.evaluation.metrics import mse, msrep_percent
from rotatum.evaluation.papers.flacco2012.settings import (
    BOUNDS,
    Bounds,
    PaperSettings,
    as_printed,
)
from rotatum.evaluation.papers.frozen import FrozenLaw, frozen
from rotatum.evaluation.run import estimate
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.record import Records
from rotatum.runtime.bank import Bank

__all__ = [
    "MODALITIES",
    "SCORED_FROM",
    "Printed",
    "channels",
    "printed",
    "score",
    "total",
    "weak",
    "weak_law",
]

Array = NDArray[np.float64]

MODALITIES = ("MODEL", "SENSOR", "RESIDUAL")
SCORED_FROM = 2.0  # s; the paper does not say from when on it scores

_TORQUES = {"MODEL": "sensor", "SENSOR": "sensor", "RESIDUAL": "estimated", "NOMINAL": "model"}


class Printed(NamedTuple):
    """A run with the paper's settings.

    Args:
        out: (N,) readings: stiffness, torque, filtered deflection, residual (``row_torque``).
        laws: final law of each transmission, SI.
    """

    out: Records
    laws: tuple[FrozenLaw, ...]


def printed(
    device: Device,
    log: Log,
    modality: str,
    settings: PaperSettings,
    bounds: Bounds = BOUNDS,
) -> Printed:
    """Run the paper's method with the paper's settings.

    MODEL feeds the recursion with the true elastic torque, SENSOR with that torque and noise,
    RESIDUAL with the residual; the deflection is always that of the encoders (eq. 44). NOMINAL,
    the MODEL of section 8, feeds it with the device's own law at the measured deflection.

    Args:
        device: of one joint.
        log: simulated, with truth.
        modality: one of ``MODALITIES``, or ``"NOMINAL"``.
        settings: in the paper's units.
        bounds: of the kinematic filter.
    """
    torque = _TORQUES[modality]
    prepared = as_printed(device, settings, period=log.period, torque=torque, bounds=bounds)
    logged = channels(device, log)
    u = prepared.stage.input.zeros(log.samples, 1)
    u["time"][:, 0], u["enable"] = log.time, 1
    for role in u.dtype.names or ():
        if role not in ("time", "enable"):
            u[role][:, 0] = logged[_source(role, modality)]
    out = Bank(prepared.stage, prepared.params).run(u)[:, 0]
    scales = [settings.setpoint**-power.setpoint for power in prepared.powers]
    each = out["coefficients"][-1].reshape(len(prepared.parts), -1)
    return Printed(out, tuple(FrozenLaw(prepared.powers, a * scales) for a in each))


def _source(role: str, modality: str) -> str:
    if modality == "MODEL" and role.startswith("torque_measured"):
        return role.replace("torque_measured", "torque") + "_true"
    return role


def weak(
    device: Device,
    log: Log,
    *,
    torque: str | None = None,
    cutoff: float | None = None,
    shrinkage: bool | None = None,
) -> JointEstimate:
    """Run ``weak``; what is None is the default.

    Args:
        device: of one joint.
        log: simulated, with truth.
        torque, cutoff, shrinkage: as in ``rotatum.estimate``.
    """
    found = estimate(
        log,
        device,
        method="weak",
        torque=torque,
        cutoff=cutoff,
        shrinkage=shrinkage,
        start=SCORED_FROM,
    )
    (joint,) = found.joints.values()
    return joint


def weak_law(device: Device, found: JointEstimate) -> tuple[FrozenLaw, ...]:
    """Return the final law of each transmission."""
    (joint,) = device.joints
    return frozen(joint, found)


def channels(device: Device, log: Log) -> dict[str, Array]:
    """Return the channels of the only joint, and ``lever``: the set-point the logged one means."""
    (joint,) = device.joints
    found = dict(log.joints[joint.name])
    if joint.setpoint is not None:
        found["lever"] = joint.setpoint.value(found["setpoint"])
    return found


def total(device: Device, log: Log, laws: tuple[FrozenLaw, ...]) -> Array:
    """Return the stiffness of frozen laws over a log, summed over the transmissions, N m/rad."""
    logged = channels(device, log)
    if len(laws) == 1:
        phi = logged["q"] - logged["theta"]
        return laws[0].stiffness(phi, logged.get("lever", 0.0))
    phis = (logged["q"] - logged[f"theta{i + 1}"] for i in range(len(laws)))
    return sum(
        (law.stiffness(phi) for law, phi in zip(laws, phis, strict=True)),
        np.zeros(log.samples),
    )


def score(log: Log, sigma: Array, truth: Array, start: float = SCORED_FROM) -> tuple[float, float]:
    """Return MSE [(N m/rad)^2] and MSREP [%] from ``start`` seconds on (eqs 45-46)."""
    seen = log.time >= log.time[0] + start
    return mse(sigma[seen], truth[seen]), msrep_percent(sigma[seen], truth[seen])


def leading(law: FrozenLaw) -> float:
    """Return eta_02, the coefficient of ``phi r^2`` (eq. 35), N/m."""
    return law.raw()[Power(1, 2)]
