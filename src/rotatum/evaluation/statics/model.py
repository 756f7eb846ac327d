"""What is fitted: constants of a law, sensor offsets and zeros as one vector, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.models.laws import Law
from rotatum.models.laws.law import Values

__all__ = ["LENGTH", "Cells", "Model", "Parameter", "Scales", "Signal", "law_values"]

Array = NDArray[np.float64]

LENGTH = 0.05
"""Where a law has lengths and the log none: m, of a lever in a joint."""
_FARTHEST = 14.0  # of a positive constant's logarithm from where it is looked for: a factor 1e6
_LARGEST = 1e4  # of a constant of either sign, in its scale
_WALL = 1e3  # times the torque: a residual where the constants describe no law


class Signal(NamedTuple):
    """A torque channel and the transmissions whose torques it sums.

    Parameters
    ----------
    role : of the channel.
    parts : numbers of the transmissions.
    """

    role: str
    parts: tuple[int, ...]


class Cells(NamedTuple):
    """Samples, or means of samples that lie next to each other.

    Parameters
    ----------
    phi : (parts, C) deflections with preload [rad].
    setpoint : (C,), 0 where there is none.
    torque : (signals, C) [N m].
    samples : (C,) how many are in each.
    """

    phi: Array
    setpoint: Array
    torque: Array
    samples: Array

    def some(self, number: int) -> Cells:
        """Return at most so many, evenly over time."""
        pick = np.unique(np.linspace(0, len(self.samples) - 1, number).astype(int))
        own = self.setpoint[pick], self.torque[:, pick], self.samples[pick]
        return Cells(self.phi[:, pick], *own)


class Scales(NamedTuple):
    """Sizes that make numbers of any unit comparable.

    Parameters
    ----------
    torque : rms [N m].
    deflection : half of its range [rad].
    length : of a lever [m].
    """

    torque: float
    deflection: float
    length: float

    def of(self, unit: str) -> float:
        """Return the size a quantity of that unit has, 1 where nothing tells."""
        t, phi, length = self
        power = int(unit.rpartition("^")[2]) if "rad^" in unit else 1
        known = {"N m": t, "1/rad": 1.0 / phi, "rad": phi, "m": length}
        known["N/m"] = t / (length * length * phi)
        return t / phi**power if unit.startswith("N m/rad") else known.get(unit, 1.0)


class Parameter(NamedTuple):
    """One number that is fitted.

    Parameters
    ----------
    name : of the constant or nuisance.
    end : "1" or "2" of a transmission's or sensor's own, "" otherwise.
    unit : SI.
    scale : what the vector's entry is multiplied by.
    positive : whether the entry is the logarithm of value / scale.
    place : in a list of coefficients; None: not in a list.
    """

    name: str
    end: str
    unit: str
    scale: float
    positive: bool
    place: int | None = None

    @property
    def label(self) -> str:
        """Name with the transmission's number."""
        at = "" if self.place is None else f"[{self.place}]"
        return f"{self.name}{self.end}{at}"

    def value(self, entry: float) -> float:
        """Return the SI value of an entry."""
        return self.scale * (math.exp(entry) if self.positive else entry)

    def entry(self, value: float) -> float:
        """Return the entry of an SI value."""
        return math.log(value / self.scale) if self.positive else value / self.scale

    @property
    def bound(self) -> float:
        """Return how far the entry may be from where it starts."""
        if self.name == "zero":
            return 1.0
        return _FARTHEST if self.positive else _LARGEST


@dataclass(frozen=True)
class Model:
    """Torques of the sensors as a function of the fitted vector.

    Parameters
    ----------
    law : of every transmission.
    constants : fitted, transmission by transmission; of one where they are tied.
    nuisances : offsets of the sensors and zeros of the deflections.
    fixed : constants that are given, by name.
    signals : torque channels.
    scales : sizes.
    """

    law: Law
    constants: tuple[Parameter, ...]
    nuisances: tuple[Parameter, ...]
    fixed: Mapping[str, float]
    signals: tuple[Signal, ...]
    scales: Scales

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Constants, then nuisances."""
        return self.constants + self.nuisances

    @cached_property
    def _offsets(self) -> list[int | None]:
        count = len(self.signals)
        ends = [""] if count == 1 else ["1", "2"]
        return [self._place("offset", end) for end in ends]

    def _place(self, name: str, end: str) -> int | None:
        for k, each in enumerate(self.nuisances, len(self.constants)):
            if each.name == name and each.end == end:
                return k
        return None

    def values(self, u: Sequence[float] | Array, part: int) -> Values:
        """Return the law's constants of a transmission, as a device file gives them."""
        end = str(part + 1)
        found: dict[str, list[float]] = {n: [v] for n, v in self.fixed.items()}
        for parameter, entry in zip(self.constants, u, strict=False):
            if parameter.end in ("", end):
                found.setdefault(parameter.name, []).append(parameter.value(float(entry)))
        return {each.name: tuple(found[each.name]) for each in self.law.constants}

    def zero(self, u: Sequence[float] | Array, part: int, parts: int) -> float:
        """Return the fitted zero of a transmission's deflection [rad], 0 if it is not fitted."""
        place = self._place("zero", "" if parts == 1 else str(part + 1))
        return 0.0 if place is None else self.parameters[place].value(float(u[place]))

    def offset(self, u: Sequence[float] | Array, signal: int) -> float:
        """Return the fitted offset of a sensor [N m], 0 if it is not fitted."""
        place = self._offsets[signal]
        return 0.0 if place is None else self.parameters[place].value(float(u[place]))

    def elastic(self, u: Array, cells: Cells) -> Array:
        """Return what the sensors would read without their offsets, (signals, C) [N m]."""
        count = len(cells.phi)
        torques = [
            law_values(self.law, "torque", self.values(u, k), phi - self.zero(u, k, count), s)
            for k, (phi, s) in enumerate((phi, cells.setpoint) for phi in cells.phi)
        ]
        return np.array([sum(torques[k] for k in signal.parts) for signal in self.signals])

    def residual(self, u: Array, cells: Cells) -> Array:
        """Return sensor less law and offset in shares of the torque's rms, (signals C,), weighted.

        Weights are the roots of the cells' counts.
        """
        wall = _WALL * self.scales.torque
        if any(self.law.wrong(self.values(u, k)) for k in range(len(cells.phi))):
            off = np.full(cells.torque.shape, wall)
        else:
            offsets = [[self.offset(u, k)] for k in range(len(self.signals))]
            off = np.clip(cells.torque - self.elastic(u, cells) - offsets, -wall, wall)
        weighted: Array = (off * np.sqrt(cells.samples) / self.scales.torque).ravel()
        return weighted


def law_values(law: Law, kind: str, values: Values, phi: Array, setpoint: Array) -> Array:
    """Return a function of the law at each sample, (C,).

    Parameters
    ----------
    law : whose.
    kind : "torque" or "stiffness".
    values : constants by name.
    phi, setpoint : (C,).
    """
    kernel = getattr(law, kind)
    c = list(law.pack(values))
    pairs = zip(phi.tolist(), setpoint.tolist(), strict=True)
    return np.array([kernel(c, x, s) for x, s in pairs], dtype=np.float64)
