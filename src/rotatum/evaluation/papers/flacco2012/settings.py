"""The paper's own settings, written over the parameter records of its own method.

Unlike ours, they mean what they say in the paper's units only: the VSA-II's in rad and N mm, the
AwAS's in rad, mm of lever arm and N m.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.kernels.kinematic import MODIFIED
from rotatum.models import Device, Joint

__all__ = ["AWAS", "BOUNDS", "VSA2", "WIDE_BOUNDS", "Bounds", "PaperSettings", "as_printed"]

GAIN = 300.0  # K_I, rad/s
ACCELERATION = 1e10  # V_a, section 7
STEEPNESS = 6.0  # alpha of eq. 20


class Bounds(NamedTuple):
    """Variances the kinematic filter ascribes to an encoder, at rest and at speed (eq. 20).

    Only their ratio to V_a counts, so their unit does not matter.
    """

    largest: float
    smallest: float


BOUNDS = Bounds(10.0, 0.1)
WIDE_BOUNDS = Bounds(1e5, 1e4)


class PaperSettings(NamedTuple):
    """How the paper starts its recursion.

    Args:
        spread: P(0), times the identity, in squares of ``torque`` over powers of rad and
            ``setpoint``.
        c: of eq. 41.
        torque: N m in the paper's unit of torque.
        setpoint: m in the paper's unit of the lever arm.
        gain: K_I of the residual, rad/s.
    """

    spread: float
    c: float
    torque: float = 1.0
    setpoint: float = 1.0
    gain: float = GAIN


VSA2 = PaperSettings(spread=1e6, c=1e-5, torque=1e-3)
AWAS = PaperSettings(spread=1e20, c=1e-20, setpoint=1e-3)


def as_printed(
    device: Device,
    settings: PaperSettings,
    *,
    period: float,
    torque: str = "estimated",
    bounds: Bounds = BOUNDS,
) -> Prepared:
    """Make the paper's estimator of a device with one joint.

    Residual (eq. 17, torques by the trapezoid rule), modified kinematic filter (eqs 18-20),
    recursion of eqs 23 and 39-41 on powers of rad and of the set-point in the paper's units, the
    deflection's zero at 0.

    Departures: eq. 20 with ``|xdot| / w_s``; the factor a(k) of eq. 41 as the measurement variance
    1 / c that it is; one triangle of P updated; the residual starts from 0. What the stage says of
    its own accuracy has no meaning here and is not used.

    Args:
        device: whose constants and basis.
        settings: in the paper's units.
        period: s.
        torque: ``"estimated"`` (RESIDUAL) or ``"sensor"`` (MODEL and SENSOR).
        bounds: of eq. 20.
    """
    (joint,) = device.joints
    asked = Request(
        method="residual",
        torque=torque,
        cutoff=settings.gain,
        fit=(),
        forgetting=1.0,
        solver="covariance",
        shrinkage=False,
    )
    zeros = [0.0] * len(joint.transmissions)
    prepared = prepare(
        joint, settle(joint, device, period, asked), period=period, holds={}, zeros=zeros
    )
    for part in prepared.parts:
        _filters(part["rows"], joint, period, bounds)
        _basis(part["rows"]["basis"], joint, settings)
        part["solver"]["spread"][:] = settings.spread * settings.torque**2
        part["solver"]["variance"] = settings.torque**2 / settings.c
    return prepared


def _filters(rows: Any, joint: Joint, period: float, bounds: Bounds) -> None:
    ends = {"kinematic": joint.encoders.motor, "setpoint": joint.encoders.setpoint}
    for name, counts in ends.items():
        record = rows[name]
        record["mode"] = MODIFIED
        record["acceleration"] = ACCELERATION
        record["largest"], record["smallest"] = bounds
        record["steepness"] = STEEPNESS
        record["count_speed"] = 2.0 * math.pi / (counts or 1.0) / period
    rows["residual"]["held"] = 0
    rows["residual"]["settle"] = 0


def _basis(record: Any, joint: Joint, settings: PaperSettings) -> None:
    """Powers of rad, and of the set-point in the paper's unit, from what is logged."""
    record["scale"] = 1.0
    if joint.setpoint is not None:
        record["middle"] = -joint.setpoint.value(0.0) / joint.setpoint.slope
        record["half"] = settings.setpoint / joint.setpoint.slope
