"""An observation in words: the table's cells, the same in the terminal and in the page."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from rotatum.evaluation.observation import JointObservation, Observation
from rotatum.report.words import number

__all__ = ["NUMBERS", "observation_rows", "observation_sentences", "observation_settings", "titles"]

_COMMON = ("joint", "determined", "torsion mrad", "speed rad/s", "torque N m")
_SCORED = ("error mrad", "max mrad", "rigid mrad", "speed error mrad/s")
NUMBERS = tuple(range(2, len(_COMMON) + len(_SCORED)))
"""Columns that stand to the right."""


def titles(found: Observation) -> tuple[str, ...]:
    """Return the titles of the table; those of errors only where something is known to be true.

    Args:
        found: to be told.
    """
    return (*_COMMON, *_SCORED) if _known(found) else _COMMON


def observation_rows(found: Observation) -> list[tuple[str, ...]]:
    """Return a row per joint.

    Args:
        found: to be told.
    """
    known = _known(found)
    return [(*_peaks(joint), *(_errors(joint) if known else ())) for joint in found.joints.values()]


def observation_settings(found: Observation) -> list[str]:
    """Return what the observers were: joints that share it are told at once.

    Args:
        found: to be told.
    """
    told = [f"{', '.join(names)}: {what}" for what, names in _shared(found.joints.values(), _poles)]
    sensors = f"accelerations from {', '.join(found.sensors)}"
    speed = f"{number(found.microseconds, 3)} us a sample"
    return [*told, f"{sensors}; scored from {number(found.score_from, 3)} s on; {speed}"]


def observation_sentences(found: Observation) -> list[str]:
    """Return what the errors are against, and what is not determined.

    Args:
        found: to be told.
    """
    joints = found.joints.values()
    told = []
    for what, names in _shared(joints, _against):
        if what:
            told.append(f"{', '.join(names)}: {what}")
    blind = [joint.name for joint in joints if not joint.determined]
    if blind:
        verb = "is" if len(blind) == 1 else "are"
        told.append(
            f"{', '.join(blind)} {verb} not determined by the sensors: the acceleration of the "
            "link is taken for 0, and its state is that of a link that does not accelerate."
        )
    return told


def _known(found: Observation) -> bool:
    return any(joint.score is not None for joint in found.joints.values())


def _peaks(joint: JointObservation) -> tuple[str, ...]:
    told = "yes" if joint.told == 1.0 else f"{100.0 * joint.told:.3g} %" if joint.told else "no"
    torsion, speed, torque = (joint.peak[key] for key in ("deflection", "dq_hat", "torque"))
    return joint.name, told, number(1e3 * torsion), number(speed), number(torque)


def _errors(joint: JointObservation) -> tuple[str, ...]:
    score = joint.score
    if score is None:
        return ("-",) * len(_SCORED)
    each = (score.q_rms, score.q_max, score.rigid_rms, score.dq_rms)
    return tuple(number(1e3 * error, 3) for error in each)


def _poles(joint: JointObservation) -> str:
    pairs = [
        f"{number(p.frequency)} rad/s, damping {number(p.damping)}" for p in joint.design.pairs
    ]
    poles = f"two pairs of poles at {pairs[0]}"
    if pairs[1] != pairs[0]:
        poles = f"poles at {pairs[0]} and at {pairs[1]}"
    gyro = joint.design.gyro
    return poles + (f"; gyroscopes with {number(gyro)} 1/s" if gyro > 0.0 else "")


def _against(joint: JointObservation) -> str:
    if joint.score is None:
        return ""
    what = "the truth" if joint.score.of == "truth" else "its link encoder"
    return (
        f"rms and largest error of the link's position, rms of its speed's, against {what}; rigid: "
        "with the link taken to be where the motor is."
    )


def _shared(
    joints: Iterable[JointObservation], of: Callable[[JointObservation], str]
) -> list[tuple[str, list[str]]]:
    shared: dict[str, list[str]] = {}
    for joint in joints:
        shared.setdefault(of(joint), []).append(joint.name)
    return list(shared.items())
