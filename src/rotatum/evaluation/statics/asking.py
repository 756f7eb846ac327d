"""What a characterisation is asked for, checked against the joint and its log."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from rotatum.errors import LogError, MethodError, check_names, nearest
from rotatum.estimators.shapes import ends_of
from rotatum.evaluation.statics.model import Model, Parameter, Scales, Signal
from rotatum.models import Joint
from rotatum.models.laws import LAWS, Law

__all__ = ["NUISANCES", "Asked", "asked", "known_constants", "model_of", "signals_of"]

NUISANCES = ("offset", "zero")


class Asked(NamedTuple):
    """What is fitted.

    Parameters
    ----------
    law : of every transmission.
    tied : whether two transmissions share their constants.
    fit : nuisances to fit; None: those that suit the law and the joint.
    fixed : constants that are given, by name.
    terms : coefficients of a polynomial.
    """

    law: Law
    tied: bool
    fit: tuple[str, ...] | None
    fixed: Mapping[str, float]
    terms: int

    def nuisances(self, joint: Joint) -> tuple[str, ...]:
        """Return what is fitted beside the constants of a joint.

        By default the sensor's offset, and the zero of a single deflection that the file leaves to
        the log, unless the law has a rest of its own. The zeros of two transmissions against each
        other would take on what is wrong with the law: they are fitted when asked for.
        """
        if self.fit is not None:
            return self.fit
        springs = joint.transmissions
        left = len(springs) == 1 and isinstance(springs[0].zero, str) and self.law.odd
        return NUISANCES if left else ("offset",)


def asked(
    law: str,
    tied: bool,
    fit: Sequence[str] | None,
    fixed: Mapping[str, float] | None,
    terms: int,
    source: str,
) -> Asked:
    """Check what is asked for.

    Raises
    ------
    RotatumError or MethodError naming the value, what is allowed and the nearest.
    """
    fittable = tuple(name for name in LAWS if name != "table")
    if law == "table":
        what = "a table has no constants to fit; its points are the measurements themselves"
        raise MethodError(what, where="--law", value=law, allowed=fittable)
    check_names([law], fittable, what="no such law", where="--law")
    check_names(fit or (), NUISANCES, what="no such quantity to fit", where="--fit")
    found = LAWS[law]
    names = tuple(each.name for each in found.constants if not each.many)
    for name, value in (fixed or {}).items():
        if name not in names:
            close = nearest(name, names)
            hint = f"Did you mean {close!r}?" if close else None
            what = f'law "{law}" has no such constant to fix'
            raise MethodError(what, where="--fix", value=name, allowed=names, hint=hint)
        if not math.isfinite(value):
            raise MethodError(f"{name} must be a finite number", where="--fix", value=value)
        if any(each.name == name and each.positive and value <= 0.0 for each in found.constants):
            raise MethodError(f"{name} must be greater than 0", where="--fix", value=value)
    if fixed and set(fixed) == {each.name for each in found.constants}:
        raise MethodError("nothing is left to fit: every constant is fixed", where="--fix")
    if not 1 <= terms <= 8:
        raise MethodError("not so many coefficients", where=source, value=terms, allowed="1 to 8")
    return Asked(found, tied, None if fit is None else tuple(fit), dict(fixed or {}), terms)


def signals_of(
    joint: Joint, roles: Sequence[str], wanted: Asked, source: str
) -> tuple[Signal, ...]:
    """Return the torque channels of a joint: of two transmissions their own, else their total.

    Raises
    ------
    LogError or MethodError for a log or device that cannot be characterised with this law.
    """
    ends = ends_of(joint.actuation)
    if wanted.law.uses_setpoint and joint.actuation != "serial":
        raise MethodError(
            f'law "{wanted.law.name}" depends on a set-point, which joint {joint.name} of '
            f'actuation "{joint.actuation}" has not',
            where="--law",
            allowed=tuple(n for n, law in LAWS.items() if not law.uses_setpoint and n != "table"),
        )
    if joint.torque_unit("sensor") != "N m":
        what = f"the torque sensor of joint {joint.name} is a current; constants need N m"
        raise MethodError(what, where="channels.torque_measured", value="A")
    needed = ["q", *(f"theta{end}" for end in ends)]
    needed += ["setpoint"] if wanted.law.uses_setpoint else []
    missing = [role for role in needed if role not in roles]
    each = tuple(Signal(f"torque_measured{end}", (k,)) for k, end in enumerate(ends))
    own = all(signal.role in roles for signal in each)
    if not own and "torque_measured" not in roles:
        missing.append("torque_measured")
    if missing:
        hint = None
        if any(role.startswith("tau") for role in roles) and "torque_measured" in missing:
            hint = "tau is the motor's torque, not that of a sensor behind the spring."
        raise LogError(
            f"a characterisation lacks the channel {', '.join(missing)} of joint {joint.name}",
            where=source,
            allowed=f"needs {', '.join([*needed, 'torque_measured'])}; has {', '.join(roles)}",
            hint=hint,
        )
    return each if own else (Signal("torque_measured", tuple(range(len(ends)))),)


def model_of(joint: Joint, wanted: Asked, signals: tuple[Signal, ...], scales: Scales) -> Model:
    """Return what is fitted to a joint.

    Parameters
    ----------
    joint : as described.
    wanted : law and options.
    signals : from `signals_of`.
    scales : from the data.
    """
    two = joint.actuation == "antagonistic"
    ends = ("1", "2") if two else ("",)
    own = ("",) if wanted.tied else ends
    constants = tuple(each for end in own for each in _constants(wanted, end, scales))
    nuisances = []
    for name in wanted.nuisances(joint):
        many = ends if name == "zero" or len(signals) > 1 else ("",)
        unit = "rad" if name == "zero" else "N m"
        size = scales.deflection if name == "zero" else scales.torque
        nuisances += [Parameter(name, end, unit, size, False) for end in many]
    return Model(wanted.law, constants, tuple(nuisances), wanted.fixed, signals, scales)


def known_constants(model: Model, joint: Joint) -> list[dict[str, float]]:
    """Return the file's own constants of the agonist to start from, if its law is the fitted one.

    Parameters
    ----------
    model : what is fitted.
    joint : as described.
    """
    spring = joint.transmission
    if spring.law != model.law.name:
        return []
    own = [each for each in model.constants if each.end in ("", "1")]
    if any((each.place or 0) >= len(spring.given[each.name]) for each in own):
        return []
    return [{each._replace(end="").label: spring.given[each.name][each.place or 0] for each in own}]


def _constants(wanted: Asked, end: str, scales: Scales) -> list[Parameter]:
    found = []
    for each in wanted.law.constants:
        if each.name in wanted.fixed:
            continue
        if not each.many:
            size = scales.of(each.unit)
            found.append(Parameter(each.name, end, each.unit, size, each.positive))
            continue
        for k in range(wanted.terms):
            power = 2 * k + 1 if wanted.law.odd else k + 1
            unit = f"N m/rad^{power}" if power > 1 else "N m/rad"
            found.append(Parameter(each.name, end, unit, scales.of(unit), False, k))
    return found
