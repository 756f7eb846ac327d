"""The full state of every joint over a log: `StateObserver` run on what was recorded."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError, MethodError
from rotatum.estimators.full_state.observer import StateObserver
from rotatum.estimators.full_state.poles import DAMPING, Pair
from rotatum.evaluation.inputs import batches, log_names, log_roles
from rotatum.evaluation.observation import Observation
from rotatum.evaluation.observed import Observed
from rotatum.kernels.status import TABLE
from rotatum.logs import Log, LogReader, TableWriter
from rotatum.models import Device

__all__ = ["observe"]

Array = NDArray[np.float64]
Progress = Callable[[int, int | None], None]

BATCH = 2000  # samples between two reports of progress
OFTEN = 0.01  # of the samples: a status bit that more of them have is worth a sentence
_SILENT = ("restarted", "settling")


def observe(
    log: Log | LogReader,
    device: Device,
    *,
    frequency: float | None = None,
    damping: float = DAMPING,
    poles: Mapping[str, tuple[Pair, Pair]] | None = None,
    gyro: float | None = None,
    noise: Mapping[str, float] | None = None,
    accelerations: str | None = None,
    start: float | None = None,
    output: str | Path | None = None,
    progress: Progress | None = None,
) -> Observation:
    """Observe the full state of every joint of a device over a log (deluca2007).

    Args:
        log: from ``read_log`` or ``open_log``; with ``true_states`` what is simulated is scored.
        device: from ``load_device``; series or serial joints with motor inertia and a law, and
            accelerometers on the links of its arm, or a channel ``acc`` for every joint.
        frequency, damping, poles, gyro, noise, accelerations: of `StateObserver`.
        start: seconds after the first sample from which samples are scored; ``None``: once the
            start is forgotten.
        output: where every sample's state goes (.csv, .npz or .parquet).
        progress: called with samples done and expected.

    Raises:
        MethodError: what cannot be observed with this device or these settings.
        LogError: the log lacks a channel, or ends before the start is forgotten.
        OutputError: the output cannot be written; no partial file is left.
    """
    names = log_names(log, device)
    loop = StateObserver(
        device, period=log.period, frequency=frequency, damping=damping, poles=poles, gyro=gyro,
        noise=noise, accelerations=accelerations, holds=_holds(log, device, names),
    )  # fmt: skip
    _check(log, loop, names)
    kept = {
        joint.name: Observed(joint, design, bool(told), start, len(device.joints))
        for joint, design, told in zip(device.joints, loop.designs, loop.determined, strict=True)
    }
    seconds = _run(log, loop, names, kept, output, progress)
    first = next(iter(kept.values()))
    return Observation(
        source=log.source,
        device=device,
        sensors=(*loop.columns, *loop.gyro_columns),
        period=log.period,
        samples=first.samples,
        seconds=first.seconds,
        score_from=max(_begin(log, loop, own) for own in kept.values()),
        joints={name: own.result() for name, own in kept.items()},
        microseconds=1e6 * seconds / max(1, first.samples),
        warnings=(*log.warnings, *log.inertial_warnings, *_warnings(loop, kept)),
    )


def _run(
    log: Log | LogReader,
    loop: StateObserver,
    names: Mapping[str, str],
    kept: Mapping[str, Observed],
    output: str | Path | None,
    progress: Progress | None,
) -> float:
    spent, done = 0.0, 0
    with ExitStack() as stack:
        table = stack.enter_context(TableWriter(output)) if output is not None else None
        for piece, part in batches(log, BATCH):
            begin = clock.perf_counter()
            states = loop.run(piece.time[part], *_inputs(piece, loop, names, part))
            spent += clock.perf_counter() - begin
            columns: dict[str, NDArray[Any]] = {"time": piece.time[part]}
            for i, (joint, own) in enumerate(kept.items()):
                logged = piece.joints[names[joint]]
                found = own.add(
                    piece.time[part], states[:, i], {k: v[part] for k, v in logged.items()}
                )
                columns |= {f"{joint}.{key}": values for key, values in found.items()}
            if table is not None:
                table.write(columns)
            done += part.stop - part.start
            if progress is not None:
                progress(done, log.samples)
        for own in kept.values():
            # Before the table appears: of a log that cannot be used there is none.
            _begin(log, loop, own)
    return spent


def _begin(log: Log | LogReader, loop: StateObserver, own: Observed) -> float:
    """Return the seconds after the first sample from which a joint is scored."""
    if own.score_from is None:
        slowest = min(pair.frequency for design in loop.designs for pair in design.pairs)
        raise LogError(
            "the log ends before there is anything to score", where=log.source, value=own.samples,
            allowed=f"more samples than the observer takes to settle, {slowest:g} rad/s, and than "
            "--from leaves out",
        )  # fmt: skip
    return own.score_from


def _inputs(
    piece: Log, loop: StateObserver, names: Mapping[str, str], part: slice
) -> tuple[Array, Array, Array, Array, Array]:
    """Motor positions, torques, set-points, readings and rates, (N, ...) each."""
    joints = [piece.joints[names[joint.name]] for joint in loop.device.joints]
    none = np.zeros(part.stop - part.start)

    def inertial(columns: tuple[str, ...]) -> Array:
        found = np.empty((none.size, len(columns)))
        for i, column in enumerate(columns):
            owner, _, axis = column.rpartition(".")
            if axis == "acc":
                found[:, i] = piece.joints[names[owner]]["acc"][part]
            else:
                found[:, i] = piece.inertial[owner][axis][part]
        return found

    theta, tau = (np.column_stack([own[role][part] for own in joints]) for role in ("theta", "tau"))
    levers = np.column_stack([own["setpoint"][part] if "setpoint" in own else none
                              for own in joints])  # fmt: skip
    return theta, tau, levers, inertial(loop.columns), inertial(loop.gyro_columns)


def _holds(log: Log | LogReader, device: Device, names: Mapping[str, str]) -> dict[str, bool]:
    """Joint to whether its torque is held between samples."""
    return {
        joint.name: log.holds.get(names[joint.name], {}).get("tau") == "held"
        for joint in device.joints
    }


def _check(log: Log | LogReader, loop: StateObserver, names: Mapping[str, str]) -> None:
    """Refuse a log that lacks what the observer reads."""
    found = log_roles(log)
    for joint in loop.device.joints:
        has = found[names[joint.name]]
        needed = ["theta", "tau"]
        spring = joint.transmission
        if spring.law is not None and spring.model.uses_setpoint:
            needed.append("setpoint")
        if f"{joint.name}.acc" in loop.columns:
            needed.append("acc")
        missing = [role for role in needed if role not in has]
        if missing:
            hint = None
            if "acc" in missing:
                hint = ("Measure the links' accelerations: [[accelerometer]] in the device file, "
                        "or a channel acc for each joint.")  # fmt: skip
            raise MethodError(
                f"observing lacks the channel {', '.join(missing)} of joint {joint.name}",
                where=log.source, allowed=f"needs {', '.join(needed)}; the log has "
                f"{', '.join(has)}", hint=hint,
            )  # fmt: skip
    columns = {f"{s}.{axis}" for s, axes in log.inertial_roles.items() for axis in axes}
    lacking = [c for c in (*loop.columns, *loop.gyro_columns)
               if not c.endswith(".acc") and c not in columns]  # fmt: skip
    if lacking:
        raise MethodError(
            f"the log lacks the readings {', '.join(lacking)}", where=log.source,
            allowed=f"the device's sensors; the log has {', '.join(sorted(columns)) or 'none'}",
        )  # fmt: skip


def _warnings(loop: StateObserver, kept: Mapping[str, Observed]) -> list[str]:
    """Sentences about joints that are not determined, and about samples that were odd."""
    said = []
    for name, told in zip(kept, loop.determined, strict=True):
        if not told:
            said.append(f"{name}: no sensor determines the acceleration of its link; it is taken "
                        "for 0")  # fmt: skip
    for name, own in kept.items():
        for bit in TABLE:
            count = own.status[bit.name]
            if bit.name not in (*_SILENT, "unseen") and count > OFTEN * own.samples:
                said.append(f"{name}: {count} of {own.samples} samples: {bit.sentence}")
    return said
