"""What speaks against a characteristic: speed in the torque, a range that is left, a poor fit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError
from rotatum.evaluation.metrics import Z95
from rotatum.evaluation.statics.joint import Run, residual_of
from rotatum.evaluation.statics.result import JointCharacteristic
from rotatum.evaluation.statics.spread import correlation
from rotatum.models import Transmission

__all__ = ["warnings_of"]

Array = NDArray[np.float64]

_SHARE = 0.01  # of the torque that may follow the speed in a static characterisation
_POOR = 90.0  # per cent of the torque's variance that a law should explain at least
_LOST = 0.05  # of the samples


def warnings_of(run: Run, found: JointCharacteristic) -> list[str]:
    """Return sentences about the motion and the fit of a joint.

    Parameters
    ----------
    run : the fit.
    found : what is told of it.
    """
    own = [_poor(found), _wide(found), _lost(found)]
    told = [_speed(run), _inertia(run), *own, _range(run), _ended(run)]
    return [f"{run.joint.name}: {sentence}" for sentence in told if sentence]


def _speed(run: Run) -> str:
    """Say when the residual follows the speed of the deflection: friction, hysteresis, damping."""
    torque, _, off = residual_of(run)
    for signal, tau, left in zip(run.model.signals, torque, off, strict=True):
        rate = run.samples.rate[list(signal.parts)].sum(axis=0)
        rate = rate - rate.mean()
        power = float(rate @ rate)
        if power == 0.0:
            continue
        slope = float(rate @ left) / power
        rest = left - slope * rate
        samples = len(left)
        std = math.sqrt(float(rest @ rest) / samples * correlation(rest) / power)
        share = abs(slope) * math.sqrt(power / samples) / float(np.sqrt(np.mean(tau**2)))
        if abs(slope) > Z95 * std and share > _SHARE:
            return (
                f"{100.0 * share:.2g} % of {signal.role} follows the speed of the deflection "
                f"({slope:.3g} +- {Z95 * std:.2g} N m s/rad): the joint moved too fast for a "
                "static characterisation, or friction or hysteresis is in it; move slower, or see "
                "--max-speed"
            )
    return ""


def _inertia(run: Run) -> str:
    link = run.joint.link
    if link is None or link.inertia is None:
        return ""
    size = float(np.sqrt(np.mean(run.samples.torque**2)))
    inertial = link.inertia.value * float(np.sqrt(np.mean(run.samples.acceleration**2)))
    if inertial <= _SHARE * size:
        return ""
    return (
        f"the joint moved too fast: the link's inertia times its acceleration is "
        f"{100.0 * inertial / size:.2g} % of the torque, and a sensor beyond the link's inertia "
        "does not see it"
    )


def _poor(found: JointCharacteristic) -> str:
    if found.explained_percent >= _POOR:
        return ""
    return (
        f"the law explains {found.explained_percent:.3g} % of the torque's variance: another law, "
        "channel, unit or zero would fit better"
    )


def _wide(found: JointCharacteristic) -> str:
    """Say which constants are told by the data, but not by a law that does not fit them."""
    wide = [c.name for c in found.constants if c.told and Z95 * c.std > 0.5 * abs(c.value)]
    if not wide or not found.answered:
        return ""
    return (
        f"the interval of {', '.join(wide)} is wider than half of the value: what the law leaves "
        "over is not noise, and other presets or deflections would give other constants"
    )


def _lost(found: JointCharacteristic) -> str:
    total = found.samples + sum(found.left_out.values())
    if found.samples >= (1.0 - _LOST) * total:
        return ""
    told = ", ".join(f"{n} {why}" for why, n in found.left_out.items() if n)
    return f"{total - found.samples} of {total} samples are left out: {told}"


def _range(run: Run) -> str:
    """Say where the data leave the range of the fitted law or the maker's limit."""
    u, model, phi = run.found.u, run.model, run.samples.phi
    for part, filed in enumerate(run.joint.transmissions):
        values = {n: v if _many(run, n) else v[0] for n, v in model.values(u, part).items()}
        try:
            spring = Transmission.model_validate(
                {"law": model.law.name, "limit": filed.limit, **values}
            )
            spring.check(phi[part] - model.zero(u, part, len(phi)), run.samples.setpoint)
        except DeviceError as error:
            return f"{error.what}, at {error.value:.4g} of {error.allowed}"
        except ValueError:
            return "the fitted constants are none a device file could have"
    return ""


def _many(run: Run, name: str) -> bool:
    return any(each.name == name and each.many for each in run.model.law.constants)


def _ended(run: Run) -> str:
    return "" if run.found.converged else "the fit stopped before it had converged"
