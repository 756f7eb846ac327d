"""Position and preset commands of a joint, by a position controller at each of its motors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rotatum.errors import DeviceError, RotatumError
from rotatum.simulation.drivers.compensation import GravityCompensation
from rotatum.simulation.drivers.control import Gains, PositionControl
from rotatum.simulation.drivers.paths import Path, Superposed, hold

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["co_contraction", "position_drives"]

# Agonist and antagonist go apart by the preset: phi1 = q - x + preset, phi2 = q - x - preset.
_SIGNS = (-1.0, 1.0)


def position_drives(
    joint: Joint,
    path: Path,
    *,
    bandwidth: float | Sequence[float] | None = None,
    damping: float | Sequence[float] = 1.0,
    gains: Sequence[Gains] | None = None,
    preset: Path | None = None,
    gravity: GravityCompensation | None = None,
    index: int = 0,
) -> dict[str, PositionControl]:
    """Return role -> controller of each motor of a joint: "tau", or "tau1" and "tau2".

    A series or serial joint's motor follows ``theta_d = x``; the two of an antagonistic joint
    follow ``theta1_d = x - preset`` and ``theta2_d = x + preset``, and share its gravity. The
    rotors' inertia is fed forward. The set-point of a serial joint is a drive of its own.

    Parameters
    ----------
    joint
        Of a device, its motors with inertia.
    path
        x [rad].
    bandwidth, damping
        w [rad/s] and zeta of `Gains.of_bandwidth`, one for all motors or one for each.
    gains
        In place of the bandwidth, one for each motor.
    preset
        Of an antagonistic joint [rad]; None: zero.
    gravity
        To be compensated, one object for all joints of a device; None: it is not.
    index
        The joint's place among them.

    Raises `DeviceError` for motors without inertia, `RotatumError` for a preset that makes no
    sense, gains in two ways or none, or not one for each motor.
    """
    paths = [path]
    if joint.actuation == "antagonistic":
        apart = preset if preset is not None else hold(0.0)
        paths = [Superposed((path, apart), (1.0, sign)) for sign in _SIGNS]
    elif preset is not None:
        what = f"a joint with {joint.actuation} actuation has no preset between its motors"
        raise RotatumError(what, where=f"{joint.name}, preset", hint="Leave the preset out.")
    inertias = _inertias(joint)
    chosen = _gains(joint, inertias, bandwidth, damping, gains)
    roles = ("tau",) if len(paths) == 1 else ("tau1", "tau2")
    return {
        role: PositionControl(
            joint=joint.name,
            path=paths[m],
            gains=chosen[m],
            motor=m,
            inertia=inertias[m],
            gravity=gravity,
            index=index,
            share=1.0 / len(paths),
        )
        for m, role in enumerate(roles)
    }


def co_contraction(
    joint: Joint,
    preset: Path,
    *,
    position: float = 0.0,
    bandwidth: float | Sequence[float],
    damping: float | Sequence[float] = 1.0,
    gravity: GravityCompensation | None = None,
    index: int = 0,
) -> dict[str, PositionControl]:
    """Return the controllers of an antagonistic joint that stands while its preset moves.

    `position_drives` with x = `position` [rad].
    """
    if joint.actuation != "antagonistic":
        what = f"co-contraction needs two motors; the joint has {joint.actuation} actuation"
        raise RotatumError(what, where=joint.name)
    return position_drives(
        joint,
        hold(position),
        bandwidth=bandwidth,
        damping=damping,
        preset=preset,
        gravity=gravity,
        index=index,
    )


def _inertias(joint: Joint) -> list[float]:
    """Return the rotors' inertia at the joint [kg m^2]."""
    found = [motor.reflected_inertia for motor in joint.motors]
    given = [inertia.value for inertia in found if inertia is not None]
    if not given or len(given) < len(found):
        what = "position control needs motor.inertia, which the device does not give"
        raise DeviceError(what, where=joint.name)
    return given


def _gains(
    joint: Joint,
    inertias: Sequence[float],
    bandwidth: float | Sequence[float] | None,
    damping: float | Sequence[float],
    gains: Sequence[Gains] | None,
) -> list[Gains]:
    if (bandwidth is None) == (gains is None):
        what = "a position controller needs either a bandwidth or gains"
        raise RotatumError(what, where=joint.name)
    if gains is not None:
        _check_count(joint, "gains", len(gains), len(inertias))
        return list(gains)
    rates = _each(joint, "bandwidth", bandwidth, len(inertias))
    shares = _each(joint, "damping", damping, len(inertias))
    return [Gains.of_bandwidth(*each) for each in zip(inertias, rates, shares, strict=True)]


def _each(
    joint: Joint, name: str, given: float | Sequence[float] | None, count: int
) -> list[float]:
    """Return one number for each motor."""
    if not isinstance(given, Sequence):
        return [float(given or 0.0)] * count
    _check_count(joint, name, len(given), count)
    return list(given)


def _check_count(joint: Joint, name: str, given: int, motors: int) -> None:
    if given != motors:
        what = f"needs one for each of its {motors} motor{'s' * (motors > 1)}"
        raise RotatumError(what, where=f"{joint.name}, {name}", value=given)
