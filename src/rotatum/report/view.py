"""One joint's result as plots need it: in order of time, gaps as NaN, units in words."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation import Estimate, JointEstimate
from rotatum.kernels.status import PRIOR, SETTLING
from rotatum.models import Joint
from rotatum.models.units import find_unit

__all__ = ["View", "in_order", "view"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """A joint's result ready to be drawn.

    Parameters
    ----------
    estimate : of the joint.
    joint : as the device describes it.
    unit : of torques, "N m", or "A" where the torque is a current.
    order : (K,) indices of the kept samples whose time is finite and increases.
    """

    estimate: JointEstimate
    joint: Joint
    unit: str
    order: NDArray[np.int64]

    @property
    def stiffness_unit(self) -> str:
        """Unit of the stiffness."""
        return f"{self.unit}/rad"

    @cached_property
    def time(self) -> Array:
        """Time of each sample after the first [s]."""
        time = np.asarray(self.estimate.records["time"][self.order], np.float64)
        return np.asarray(time - time[:1].sum())  # the sum of one number, and 0 of none

    @cached_property
    def status(self) -> NDArray[np.int64]:
        """Status bits of each sample."""
        return np.asarray(self.estimate.records["status"][self.order])

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Whether the data, and not the prior, say something about the stiffness."""
        return np.asarray((self.status & PRIOR) == 0)

    @cached_property
    def settled(self) -> NDArray[np.bool_]:
        """Samples since the first informative one, or where the data say something if none was."""
        since = self.estimate.converged_at
        return self.known if since is None else self.known & (self.time >= since)

    @cached_property
    def scales(self) -> Array:
        """What a record's coefficients are divided by to be in SI at the joint, (p,)."""
        found = self.estimate
        # The last kept record is the last sample, or within a 100,000th of the log's length of it.
        recorded = np.asarray(found.records["coefficients_std"][-1], np.float64)
        known = (recorded > 0.0) & (found.coefficients_std > 0.0)
        return np.divide(recorded, found.coefficients_std, out=np.ones(len(known)), where=known)

    def field(self, name: str) -> Array:
        """Return a field of the readings at each sample.

        Parameters
        ----------
        name : of a scalar field of ``Reading``.
        """
        return np.asarray(self.estimate.records[name][self.order], np.float64)

    def learned(self, name: str) -> Array:
        """Return a field; NaN while it rests on the prior.

        Parameters
        ----------
        name : of a scalar field of ``Reading``.
        """
        return np.where(self.known, self.field(name), np.nan)

    def row(self, name: str) -> Array:
        """Return a field of the rows; NaN while there was none.

        Parameters
        ----------
        name : "row_torque" or "row_fit".
        """
        return np.where(self.status & SETTLING, np.nan, self.field(name))

    def truth(self, name: str) -> Array | None:
        """Return the log's truth at each sample, None where it does not know.

        Parameters
        ----------
        name : "stiffness" or "torque".
        """
        values = self.estimate.truth_records.get(name)
        return None if values is None else np.asarray(values)[self.order]

    @cached_property
    def measured_torque(self) -> Array | None:
        """Measured elastic torque at each sample, None where there is no sensor."""
        values = self.estimate.logged.get("torque_measured")
        return None if values is None else values[self.order]

    @cached_property
    def setpoint(self) -> Array | None:
        """Set-point at each sample in the unit of the law, None where the log has none."""
        logged = self.estimate.logged.get("setpoint")
        if logged is None:
            return None
        values = np.asarray(logged[self.order], np.float64)
        return values if self.joint.setpoint is None else self.joint.setpoint.value(values)

    @property
    def setpoint_unit(self) -> str:
        """Unit of the set-point: that of the law, else what it is logged in."""
        spring, setpoint = self.joint.transmission, self.joint.setpoint
        if spring.law is not None and spring.model.setpoint_unit:
            return spring.model.setpoint_unit
        if setpoint is not None and setpoint.law == "lever":
            return "m"
        channel = self.joint.channels.get("setpoint")
        if channel is not None and channel.unit is not None:
            return "m" if find_unit(channel.unit).kind == "length" else "rad"
        return "rad"

    @cached_property
    def half(self) -> Array:
        """Half of the 95 % interval of the stiffness; NaN while it rests on the prior."""
        return 1.96 * self.learned("stiffness_std")

    @cached_property
    def relative(self) -> Array:
        """Half of the interval over the stiffness, in per cent."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(100.0 * self.half / np.abs(self.learned("stiffness")))


def view(estimate: Estimate, joint: str) -> View:
    """Return the view of one joint.

    Parameters
    ----------
    estimate : of the device.
    joint : its name.
    """
    found = estimate.joints[joint]
    described = next(j for j in estimate.device.joints if j.name == joint)
    unit = described.torque_unit(estimate.torque)
    return View(found, described, unit, in_order(found.records["time"]))


def in_order(time: Array) -> NDArray[np.int64]:
    """Return the indices of the samples whose time is finite and later than any before.

    Parameters
    ----------
    time : (N,) s.
    """
    finite = np.flatnonzero(np.isfinite(time))
    latest = np.maximum.accumulate(time[finite])
    later = np.concatenate([[True], np.diff(latest) > 0.0])
    return np.asarray(finite[later[: len(finite)]])
