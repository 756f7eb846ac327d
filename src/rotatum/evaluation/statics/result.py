"""What a static characterisation gives back, joint by joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.estimate import finite
from rotatum.evaluation.statics.filing import described
from rotatum.evaluation.statics.scores import Preset
from rotatum.models import Device

__all__ = ["Characterisation", "Fitted", "JointCharacteristic", "Points"]

Array = NDArray[np.float64]


class Fitted(NamedTuple):
    """A fitted number, with the name a device file has for it.

    Parameters
    ----------
    name : with the transmission's number where each has its own; of a product "k a".
    value, std : SI; NaN where the data do not tell it.
    unit : SI.
    """

    name: str
    value: float
    std: float
    unit: str

    @property
    def told(self) -> bool:
        """Whether the data tell it."""
        return bool(np.isfinite(self.value))


class Points(NamedTuple):
    """The samples as a picture needs them, (N,) each but where said.

    Parameters
    ----------
    time : number of the sample among those used.
    deflection : of the joint: the mean of its transmissions' [rad].
    torque, fit : (signals, N) [N m], without offsets.
    preset : number of the sample's preset.
    """

    time: Array
    deflection: Array
    torque: Array
    fit: Array
    preset: NDArray[np.int64]


@dataclass(frozen=True)
class JointCharacteristic:
    """One joint's elastic law, fitted.

    Parameters
    ----------
    name, actuation : of the joint.
    constants : fitted, in the law's order, the agonist's first.
    fixed : constants that were given.
    springs : the constants of each transmission as a device file has them; None where the data do
        not tell all.
    together : products and quotients of constants that the data tell where they do not tell each.
    nuisances : offsets of sensors [N m] and zeros of deflections [rad].
    zeros : the fitted zeros, by transmission; empty where they were not fitted or not told.
    relative_percent : c of trumic2022 section V-A.
    floors : torque of each sensor below which a sample is left out of c [N m].
    below_floor : how many are.
    rms : of the residuals [N m].
    explained_percent : share of the torque's variance that the law explains.
    samples : used.
    left_out : why -> how many samples were not used.
    speed_limit : above which a sample was too fast [rad/s].
    correlation : samples over which residuals stay alike.
    presets : scored one by one.
    points : for a picture.
    """

    name: str
    actuation: str
    constants: tuple[Fitted, ...]
    fixed: Mapping[str, float]
    springs: tuple[Mapping[str, tuple[float, ...]], ...] | None
    together: tuple[Fitted, ...]
    nuisances: tuple[Fitted, ...]
    zeros: tuple[float, ...]
    relative_percent: float
    floors: tuple[float, ...]
    below_floor: int
    rms: float
    explained_percent: float
    samples: int
    left_out: Mapping[str, int]
    speed_limit: float
    correlation: float
    presets: tuple[Preset, ...]
    points: Points

    @property
    def answered(self) -> bool:
        """Whether the data tell every constant."""
        return self.springs is not None

    @property
    def confounded(self) -> tuple[str, ...]:
        """Names of the constants that the data do not tell."""
        return tuple(each.name for each in self.constants if not each.told)

    def to_json(self) -> dict[str, Any]:
        """The joint's entry in ``--json``."""
        return {
            "actuation": self.actuation,
            "answered": self.answered,
            "constants": _named(self.constants),
            "fixed": dict(self.fixed),
            "confounded": list(self.confounded),
            "together": _named(self.together),
            "nuisances": _named(self.nuisances),
            "relative_percent": self.relative_percent,
            "floor": list(self.floors),
            "below_floor": self.below_floor,
            "rms": self.rms,
            "explained_percent": self.explained_percent,
            "samples": self.samples,
            "left_out": dict(self.left_out),
            "speed_limit": self.speed_limit,
            "correlation": self.correlation,
            "presets": [preset._asdict() for preset in self.presets],
        }


@dataclass(frozen=True)
class Characterisation:
    """Result of ``rotatum.characterise``: an elastic law fitted to a torque sensor.

    Parameters
    ----------
    source : the log.
    device : what was characterised, as its file describes it.
    law : name of the fitted law.
    tied : whether two transmissions share their constants.
    period : s.
    joints : by name.
    warnings : sentences about the log, the motion and the fit.
    """

    source: str
    device: Device
    law: str
    tied: bool
    period: float
    joints: Mapping[str, JointCharacteristic]
    warnings: tuple[str, ...]

    @property
    def answered(self) -> bool:
        """Whether the data tell every constant of every joint."""
        return all(found.answered for found in self.joints.values())

    def to_json(self) -> dict[str, Any]:
        """Return the object ``--json`` prints: finite numbers, strings and null only."""
        found: dict[str, Any] = finite(
            {
                "log": self.source,
                "device": self.device.name,
                "law": self.law,
                "tied": self.tied,
                "period": self.period,
                "joints": {name: joint.to_json() for name, joint in self.joints.items()},
                "warnings": list(self.warnings),
            }
        )
        return found

    def fitted_device(self) -> Device:
        """Return the device with the fitted constants in its transmissions.

        Raises
        ------
        MethodError if the data do not tell them.
        """
        return described(self)[0]

    def write(self, path: str | Path) -> None:
        """Write the device file with the fitted constants; other verbs read it as it is.

        Parameters
        ----------
        path : of the TOML file.

        Raises
        ------
        MethodError if the data do not tell the constants; OutputError if it cannot be written.
        """
        from rotatum.logs import beside

        text = described(self)[1]
        with beside(path) as new:
            new.write_text(text, encoding="utf-8")


def _named(each: tuple[Fitted, ...]) -> dict[str, Any]:
    return {f.name: {"value": f.value, "std": f.std, "unit": f.unit} for f in each}
