"""The main job: a log and a device in, an ``Estimate`` out, piece by piece in constant memory."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.estimator import Estimator
from rotatum.estimators.settings import Request
from rotatum.estimators.tuning import Prepared
from rotatum.evaluation.confounded import confounded
from rotatum.evaluation.estimate import Estimate, JointEstimate
from rotatum.evaluation.explain import reason, sample_warnings, skew_warning, zero_warning
from rotatum.evaluation.inputs import (
    batches,
    check_channels,
    log_names,
    mean_zeros,
    measured_signals,
)
from rotatum.evaluation.parts import final_external, part_estimates
from rotatum.evaluation.summary import Summary
from rotatum.evaluation.table import reading_columns
from rotatum.kernels.status import STARVED, VERDICTS
from rotatum.logs import Log, LogReader, TableWriter
from rotatum.models import Device

BATCH = 65536  # readings made at once
EXTRA = (
    "q",
    "setpoint",
    "stiffness_true",
    "torque_true",
    "torque_measured",
    *(f"{kind}{end}_true" for kind in ("stiffness", "torque") for end in (1, 2)),
)

Progress = Callable[[int, int | None], None]
"""Called with samples done and samples expected (None: not known)."""


def estimate(
    log: Log | LogReader,
    device: Device,
    *,
    method: str | None = None,
    side: str | None = None,
    torque: str | None = None,
    cutoff: float | None = None,
    window: float | None = None,
    order: int | None = None,
    stride: int | None = None,
    fit: Sequence[str] | None = None,
    forgetting: float | None = None,
    solver: str | None = None,
    shrinkage: bool | None = None,
    selective: float | None = None,
    joints: Sequence[str] | None = None,
    start: float | None = None,
    output: str | Path | None = None,
    progress: Progress | None = None,
) -> Estimate:
    """Estimate the stiffness of every joint of a device over a log.

    Args:
        log: from ``read_log`` or ``open_log`` (constant memory).
        device: from ``load_device``.
        method: ``"weak"``, ``"algebraic"``, ``"rotatum"`` or ``"residual"``; ``None``: the device
            file's, then ``"weak"``.
        side: of the torque balance: ``"motor"``, or ``"link"``, which reads no torque.
        torque: ``"estimated"`` from the motor, the ``"sensor"``'s, or that of the device's own
            ``"model"`` (flacco2012 eq. 44).
        cutoff: of the low-pass rows go through, or of the observer of ``rotatum`` (infinite:
            deadbeat, as printed), rad/s; or
        window: that they look back, s.
        order: poles of the low-pass (2, 3), power of the window (2 to 5), or samples by which the
            observer of ``rotatum`` comes late.
        stride: samples from one row of a window to the next.
        fit: columns fitted beside the stiffness.
        forgetting: weight of a row relative to the next one.
        solver: ``"ud"`` or ``"covariance"``.
        shrinkage: whether high orders are shrunk as far as the data do not ask for them.
        selective: link speed below which nothing is learnt, rad/s; 0: all is.
        joints: names of the joints wanted; ``None``: all.
        start: seconds after the log's first sample from which it is scored; ``None``: once
            converged.
        output: table to write every sample's result to, while it goes on.
        progress: called as samples are done.

    Raises:
        MethodError: a setting, or a channel the method needs and the log lacks (all are named).
        LogError: the log cannot be read to its end.
        OutputError: ``output`` cannot be written; no partial file is left.
    """
    device = device.only(joints)
    names = log_names(log, device)
    request = Request(
        method=method,
        side=side,
        torque=torque,
        cutoff=cutoff,
        window=window,
        order=order,
        stride=stride,
        fit=None if fit is None else tuple(fit),
        forgetting=forgetting,
        solver=solver,
        shrinkage=shrinkage,
        selective=selective,
    )
    check_channels(log, device, request, names)
    loop = Estimator(
        device,
        period=log.period,
        method=method,
        side=side,
        torque=torque,
        cutoff=cutoff,
        window=window,
        order=order,
        stride=stride,
        fit=fit,
        forgetting=forgetting,
        solver=solver,
        shrinkage=shrinkage,
        selective=selective,
        measured=measured_signals(log, device, names),
        holds={j.name: log.holds.get(names[j.name], {}) for j in device.joints},
        zeros=mean_zeros(log, device, names),
    )
    summaries = {j.name: Summary(start, len(device.joints)) for j in device.joints}
    seconds = _run(log, loop, names, summaries, output, progress)
    return _collect(log, loop, summaries, seconds)


def _run(
    log: Log | LogReader,
    loop: Estimator,
    names: Mapping[str, str],
    summaries: Mapping[str, Summary],
    output: str | Path | None,
    progress: Progress | None,
) -> float:
    spent, done = 0.0, 0
    with ExitStack() as stack:
        table = stack.enter_context(TableWriter(output)) if output is not None else None
        batch = max(1, BATCH // len(loop.prepared))
        for piece, part in batches(log, batch):
            columns: dict[str, NDArray[Any]] = {"time": piece.time[part]}
            channels = _channels(piece, loop, names, part)
            begin = clock.perf_counter()
            outputs = loop.run(piece.time[part], channels)
            spent += clock.perf_counter() - begin
            for group, out in zip(loop.groups, outputs, strict=True):
                for i, prepared in enumerate(group.prepared):
                    joint = prepared.joint
                    logged = piece.joints[names[joint.name]]
                    extra = {r: logged[r][part] for r in EXTRA if r in logged}
                    summaries[joint.name].add(out[:, i], extra)
                    if table is not None:
                        columns |= reading_columns(
                            joint, prepared.settings.torque, out[:, i], extra["q"]
                        )
            if table is not None:
                table.write(columns)
            done += part.stop - part.start
            if progress is not None:
                progress(done, log.samples)
    return spent


def _channels(
    piece: Log, loop: Estimator, names: Mapping[str, str], part: slice
) -> list[dict[str, NDArray[np.float64]]]:
    """Samples of every joint of the device, in its order."""
    logged = [piece.joints[names[prepared.joint.name]] for prepared in loop.prepared]
    return [{role: values[part] for role, values in own.items()} for own in logged]


def _collect(
    log: Log | LogReader, loop: Estimator, summaries: Mapping[str, Summary], seconds: float
) -> Estimate:
    joints: dict[str, JointEstimate] = {}
    warnings = list(log.warnings)
    samples = next(iter(summaries.values())).seen
    nanoseconds = 1e9 * seconds / max(1, samples * len(summaries))
    for prepared in loop.prepared:
        name = prepared.joint.name
        summary = summaries[name]
        joint = _joint(summary, loop, name, nanoseconds)
        joints[name] = joint
        warnings += sample_warnings(name, joint.samples, samples)
        for i, part in enumerate(joint.parts):
            warnings += zero_warning(part.label, prepared, part.fitted, part.stiffness)
            warnings += skew_warning(part.label, prepared, i, part.fitted, part.stiffness)
    first = loop.prepared[0].settings
    times = next(j.records["time"] for j in joints.values())
    good = times[np.isfinite(times)]
    cites = tuple(dict.fromkeys(c for p in loop.prepared for c in p.stage.cites))
    return Estimate(
        source=log.source,
        device=loop.device,
        method=first.method,
        side=first.side,
        torque=first.torque,
        period=log.period,
        samples=samples,
        seconds=float(good[-1] - good[0]) if len(good) else 0.0,
        joints=joints,
        warnings=tuple(warnings),
        cites=cites,
    )


def _unknown(loop: Estimator, prepared: Prepared, starved: bool) -> list[list[tuple[str, ...]]]:
    """Of each part, the names that its data do not tell apart."""
    place = next(i for i, own in enumerate(loop.prepared) if own is prepared)
    return [
        confounded(prepared, part, state, starved)
        for part, state in zip(prepared.parts, loop.part_states(place), strict=True)
    ]


def _joint(summary: Summary, loop: Estimator, name: str, nanoseconds: float) -> JointEstimate:
    prepared = next(p for p in loop.prepared if p.joint.name == name)
    last = summary.last
    assert last is not None  # a log has at least one piece of at least one sample
    kept = {k: np.concatenate(v) for k, v in summary.truth_kept.items()}
    converged = float(last["converged_at"]) - (summary.first_time or 0.0)
    unknown = _unknown(loop, prepared, int(last["verdict"]) == STARVED)
    together = tuple(dict.fromkeys(group for own in unknown for group in own))
    parts = part_estimates(prepared, last, summary, unknown)
    return JointEstimate(
        name=name,
        records=np.concatenate(summary.kept),
        every=summary.every,
        columns=tuple(f"{c}{p.end}" for p in parts for c in prepared.columns),
        coefficients=np.concatenate([p.coefficients for p in parts]),
        coefficients_std=np.concatenate([p.coefficients_std for p in parts]),
        parts=parts,
        fitted={
            f"{k}{p.end if prepared.apart else ''}": v for p in parts for k, v in p.fitted.items()
        },
        stiffness=summary.stiffness(),
        stiffness_std=float(last["stiffness_std"]),
        external_stiffness=final_external(prepared, last, kept["q"]),
        torque_rms=summary.torque_rms(),
        verdict=VERDICTS[int(last["verdict"])],
        reason=reason(last, prepared, together),
        confounded=together,
        converged_at=converged if last["converged"] else None,
        truth=summary.score.result() if summary.has_truth and summary.scored.count else None,
        score_from=summary.score_from,
        samples=summary.status,
        ns_per_sample=nanoseconds,
        delay=prepared.delay,
        settings=prepared.notes,
        powers=prepared.powers,
        logged={k: v for k, v in kept.items() if not k.endswith("_true")},
        truth_records={k.removesuffix("_true"): v for k, v in kept.items() if k.endswith("_true")},
    )
