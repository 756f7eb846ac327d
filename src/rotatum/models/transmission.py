"""The elastic element of a joint: its law with numbers, over arrays of deflections."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import isfinite
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from rotatum.errors import DeviceError
from rotatum.models.constants import split_constants
from rotatum.models.laws import LAWS, Law
from rotatum.models.laws.law import Kernel
from rotatum.models.table import NonNegative, Positive, Real, Table

__all__ = ["Transmission"]

Array = NDArray[np.float64]

_KEYS = ("law", "damping", "zero", "preload", "limit")
_SETPOINTS = 64  # at which the range is evaluated when more differ; between them it is a line


def _zero(raw: object) -> object:
    """Accept the two words or a finite number."""
    number = isinstance(raw, int | float) and not isinstance(raw, bool) and isfinite(raw)
    if not number and raw not in ("first", "mean"):
        raise ValueError('must be "first", "mean" or a number of radians')
    return raw


class Transmission(Table):
    """The elastic element: its law (optional truth) and the zero of the deflection.

    law: a name of `rotatum.models.laws.LAWS`; its constants stand beside it in the file.
    damping [N m s/rad] in parallel to the spring. zero: the deflection at rest, subtracted from
    q - theta: "first" (mean of the first 50 ms), "mean" (of the log), or a number [rad].
    preload [rad]: the law is evaluated at deflection + preload (flacco2012, footnote 4). limit
    [rad]: the largest magnitude of deflection + preload the maker allows.

    The methods take deflections [rad] and set-points (unit of the law's), arrays that broadcast,
    and return arrays. They raise DeviceError where the transmission has no law.
    """

    law: str | None = None
    given: Mapping[str, tuple[float, ...]] = Field(default_factory=dict)
    damping: NonNegative = 0.0
    zero: Annotated[Literal["first", "mean"] | float, BeforeValidator(_zero)] = "first"
    preload: Real = 0.0
    limit: Positive | None = None

    @model_validator(mode="before")
    @classmethod
    def _constants_of_the_law(cls, raw: object) -> object:
        """Ask for the constants of the law, no more and no fewer."""
        if not isinstance(raw, Mapping):
            return raw
        rest, given = split_constants(raw, _KEYS)
        return {**rest, "given": given}

    @model_serializer(mode="wrap")
    def _as_in_the_file(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Write the constants beside the law."""
        written = dict(handler(self))
        written.pop("given", None)
        constants = {k: v[0] if len(v) == 1 else list(v) for k, v in self.given.items()}
        return {"law": written.pop("law", None), **constants, **written}

    @property
    def model(self) -> Law:
        """The law.

        Raises
        ------
        DeviceError if the transmission has none.
        """
        if self.law is None:
            raise DeviceError("needs a law", where="transmission", allowed=tuple(LAWS))
        return LAWS[self.law]

    @cached_property
    def constants(self) -> Array:
        """The law's packed constants, (n,) float64, not to be written to."""
        packed = np.array(self.model.pack(self.given), dtype=np.float64)
        packed.flags.writeable = False
        return packed

    def energy(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return the elastic energy [J]."""
        return self._over(self.model.energy, phi, setpoint)

    def torque(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return the elastic torque, without damping [N m]."""
        return self._over(self.model.torque, phi, setpoint)

    def stiffness(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return dtau/dphi [N m/rad]."""
        return self._over(self.model.stiffness, phi, setpoint)

    def slope(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return dsigma/dphi [N m/rad^2]."""
        return self._over(self.model.slope, phi, setpoint)

    def curvature(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return d2sigma/dphi2 [N m/rad^3]."""
        return self._over(self.model.curvature, phi, setpoint)

    def energy_setpoint(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return dU/ds; times ds/dtheta_c it is the reaction on the set-point's motor."""
        return self._over(self.model.energy_setpoint, phi, setpoint)

    def torque_setpoint(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return dtau/ds."""
        return self._over(self.model.torque_setpoint, phi, setpoint)

    def stiffness_setpoint(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> Array:
        """Return dsigma/ds."""
        return self._over(self.model.stiffness_setpoint, phi, setpoint)

    def limits(self, setpoint: float = 0.0) -> tuple[float, float]:
        """Return the (lowest, highest) deflection at which law and maker's limit hold [rad]."""
        low, high = self.model.limits(self.constants, float(setpoint))
        if self.limit is not None:
            low, high = max(low, -self.limit), min(high, self.limit)
        return low - self.preload, high - self.preload

    def check(self, phi: ArrayLike, setpoint: ArrayLike = 0.0) -> None:
        """Refuse deflections and set-points outside the range; NaN passes.

        Raises
        ------
        DeviceError naming the law, the range and the value that left it the farthest.
        """
        deflections, setpoints = np.broadcast_arrays(
            np.asarray(phi, dtype=np.float64), np.asarray(setpoint, dtype=np.float64)
        )
        if deflections.size == 0:
            return
        if self.model.uses_setpoint:
            lowest, highest = self.model.setpoint_limits(self.constants)
            bounds = np.full(setpoints.shape, lowest), np.full(setpoints.shape, highest)
            unit = self.model.setpoint_unit
            self._inside("set-point", setpoints, *bounds, unit)
        self._inside("deflection", deflections, *self._ranges(setpoints), "rad")

    def _ranges(self, setpoints: Array) -> tuple[Array, Array]:
        """Return the lowest and highest deflection at each set-point."""
        known = np.unique(setpoints[np.isfinite(setpoints)])
        if len(known) == 0:
            known = np.zeros(1)
        if len(known) > _SETPOINTS:
            known = np.linspace(known[0], known[-1], _SETPOINTS)
        ends = np.array([self.limits(each) for each in known])
        return np.interp(setpoints, known, ends[:, 0]), np.interp(setpoints, known, ends[:, 1])

    def _inside(self, what: str, values: Array, low: Array, high: Array, unit: str) -> None:
        """Refuse values outside of low to high."""
        beyond = np.maximum(low - values, values - high)
        beyond = np.where(np.isnan(beyond), -np.inf, beyond)
        worst = np.unravel_index(np.argmax(beyond), beyond.shape)
        if beyond[worst] > 0.0:
            raise DeviceError(
                f'the {what} leaves the range of law "{self.law}"',
                where="transmission",
                value=float(values[worst]),
                allowed=f"{low[worst]:.6g} to {high[worst]:.6g} {unit}",
            )

    def _over(self, kernel: Kernel, phi: ArrayLike, setpoint: ArrayLike) -> Array:
        """Call a scalar kernel at each element."""
        # Python's floats: the same bits as numpy's, no warnings, and faster one by one.
        c = self.constants.tolist()
        deflections, setpoints = np.broadcast_arrays(
            np.asarray(phi, dtype=np.float64) + self.preload,
            np.asarray(setpoint, dtype=np.float64),
        )
        pairs = zip(deflections.ravel().tolist(), setpoints.ravel().tolist(), strict=True)
        values = [kernel(c, x, s) for x, s in pairs]
        return np.array(values, dtype=np.float64).reshape(deflections.shape)
