"""A verdict in a sentence, with the numbers it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rotatum.estimators.tuning import Prepared
from rotatum.kernels.status import INFORMATIVE, STARVED, TABLE, VERDICTS, WRONG
from rotatum.record import Records


def reason(reading: Records, prepared: Prepared, confounded: Sequence[tuple[str, ...]] = ()) -> str:
    """Say why the last verdict is what it is.

    Args:
        reading: the last ``Reading``.
        prepared: the joint's constants and settings.
        confounded: names that the data do not tell apart.
    """
    verdict, status = int(reading["verdict"]), int(reading["status"])
    sigma, half = float(reading["stiffness"]), 1.96 * float(reading["stiffness_std"])
    unit = prepared.joint.torque_unit(prepared.settings.torque)
    interval = f"{sigma:.4g} +- {half:.2g} {unit}/rad"
    relative = f", {100.0 * half / abs(sigma):.1f} %" if sigma else ""
    if verdict == INFORMATIVE:
        return f"informative: {interval}{relative}, narrow for at least a second"
    told = [
        _sentence(bit.name, bit.sentence, reading, prepared)
        for bit in TABLE
        if status & bit.bit and (bit.bit & WRONG or verdict == STARVED) and bit.bit >= 1024
    ]
    if verdict != INFORMATIVE:
        told = [_apart(group) for group in confounded] + told
    if verdict == STARVED and sigma < 0.0:
        told.insert(0, "the best fit is negative, which no spring is")
    if told:
        return f"{VERDICTS[verdict]}: {interval}{relative}; " + "; ".join(told)
    return f"{VERDICTS[verdict]}: {interval}{relative}, not narrower than 10 % for a second"


def _apart(group: tuple[str, ...]) -> str:
    """Say what the data do not tell."""
    if len(group) == 1:
        return f"{group[0]} drowns in the noise of the positions and is not told by these data"
    names = f"{', '.join(group[:-1])} and {group[-1]}"
    return (
        f"this motion does not tell {names} apart (they are confounded): fit fewer of them, or "
        "move faster or with more frequencies"
    )


def _sentence(name: str, sentence: str, reading: Records, prepared: Prepared) -> str:
    if name == "deflection":
        moved = 1e3 * float(reading["informative_deflection"])
        accuracy = 1e3 * (prepared.joint.encoders.accuracy or 0.0)
        return (
            f"{sentence} (q - theta varies by {moved:.2g} mrad rms, the encoders agree to "
            f"{accuracy:.2g} mrad: encoders.accuracy of the device file)"
        )
    return sentence


def sample_warnings(name: str, counts: Mapping[str, int], samples: int) -> list[str]:
    """Sentences on samples that were skipped, bridged or restarted at."""
    said = []
    for bit in TABLE:
        count = counts[bit.name]
        told = ("not_finite", "repeated", "backwards", "bridged", "gap", "jump", "saturated")
        if bit.name in told and count:
            share = 100.0 * count / samples
            said.append(f"joint {name}: {count} samples ({share:.2g} %): {bit.sentence}")
    return said


def zero_warning(
    name: str,
    prepared: Prepared,
    fitted: Mapping[str, tuple[float, float]],
    sigma: float,
) -> list[str]:
    """An odd law about a wrong zero is the wrong law: a fitted offset takes only the constant."""
    basis = prepared.joint.basis
    if "offset" not in fitted or basis.orders < 2 or basis.full or sigma <= 0.0:
        return []
    offset, std = fitted["offset"]
    unit = prepared.joint.torque_unit(prepared.settings.torque)
    shift, limit = offset / sigma, 0.01 * (basis.deflection_range or 0.01)
    # Confounded with something else it has no value.
    if not abs(offset) >= 3.0 * std or abs(shift) < limit:
        return []
    return [
        f"joint {name}: the fitted offset of {offset:.3g} {unit} may be a zero of the deflection "
        f"that is off by {1e3 * shift:.2g} mrad; odd powers about a wrong zero bend the wrong "
        "way: give [transmission] zero, start the log at rest, or use full = true"
    ]


def skew_warning(
    name: str,
    prepared: Prepared,
    part: int,
    fitted: Mapping[str, tuple[float, float]],
    sigma: float,
) -> list[str]:
    """From the motor side a skew of the encoders and viscous friction are one column: say both."""
    motor = prepared.joint.motors[part] if prepared.joint.motors else None
    settings = prepared.settings
    if motor is None or settings.torque != "estimated" or settings.side != "motor":
        return []
    gear_ratio = motor.gear_ratio
    if "skew" in fitted:
        skew, std = fitted["skew"]
        damping = -skew * sigma / gear_ratio**2
        return [
            f"joint {name}: the velocity-proportional part of the deflection is reported as a skew "
            f"of {1e3 * skew:.3g} +- {1.96e3 * std:.2g} ms between the encoder channels; from the "
            "motor side viscous friction is the same column: it could as well be "
            f"{damping:.3g} N m s/rad of motor damping beyond the device file's"
        ]
    if "damping" in fitted and sigma > 0.0:
        damping, std = fitted["damping"]
        skew = -damping * gear_ratio**2 / sigma
        if abs(damping) > 1.96 * std:
            return [
                f"joint {name}: from the motor side damping and a skew between the encoder "
                f"channels are the same column: the damping of {damping:.3g} +- {1.96 * std:.2g} "
                f"N m s/rad could as well be a skew of {1e3 * skew:.3g} ms"
            ]
    return []
