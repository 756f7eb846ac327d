"""Every method a log and a device allow, on both sides, scored on the same samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from rotatum.errors import ExtraError, MethodError, check_names
from rotatum.estimators.quantities import COLUMNS
from rotatum.evaluation.agreement import Curve, curve_of, disagreement, score, start_of
from rotatum.evaluation.candidates import CANDIDATES, Candidate, Widths, able, variant
from rotatum.evaluation.comparison import ComparedMethod, Comparison, LeftOut
from rotatum.evaluation.estimate import Estimate, JointEstimate
from rotatum.evaluation.inputs import log_names, log_roles
from rotatum.evaluation.recommend import recommend
from rotatum.evaluation.run import estimate
from rotatum.logs import Log, LogReader
from rotatum.models import Device

__all__ = ["Progress", "compare"]

Progress = Callable[[str, int, int | None], None]
"""Called with the method's label, samples done and samples expected (None: not known)."""


@dataclass(frozen=True)
class _Ran:
    """One method's result for one joint, as far as it is kept: not the samples' records."""

    candidate: Candidate
    found: JointEstimate
    curve: Curve


@dataclass
class _Book:
    """What a comparison has found so far, joint by joint."""

    ran: dict[str, list[_Ran]] = field(default_factory=dict)
    left_out: list[LeftOut] = field(default_factory=list)
    warnings: dict[str, list[str]] = field(default_factory=dict)
    runs: int = 0
    last: Estimate | None = None


def compare(
    log: Log | LogReader,
    device: Device,
    *,
    cutoff: float | None = None,
    window: float | None = None,
    fit: Sequence[str] | None = None,
    joints: Sequence[str] | None = None,
    start: float | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Estimate with every method the log's channels and the device allow, on both sides.

    ``weak`` through a low-pass and through a window, from the motor's side, from the link's side
    and with a torque sensor; ``algebraic``; ``residual``; ``rotatum``. What the device file says of
    ``fit``, ``cutoff`` and ``window`` holds for each method that has it. The log is read once per
    method.

    All methods of a joint are scored on the same samples: against the truth where the log knows
    it, and against one of them, the reference: of the informative ones the one with the narrowest
    interval at the last sample, else the first that ran.

    Args:
        log: from ``read_log`` or ``open_log`` (constant memory; a log beyond 400,000 samples is
            scored at every second, fourth, ... sample).
        device: from ``load_device``.
        cutoff: of the low-passes, rad/s; ``None``: each method's own.
        window: of the windows, s; ``None``: the device file's, then the paper's 1 s for
            ``algebraic`` and for ``weak`` 0.2 s, halved until it lets half of the deflection pass.
        fit: columns fitted beside the stiffness; each method takes those of them it can.
        joints: names of the joints wanted; ``None``: all.
        start: seconds after the log's first sample from which all are scored; ``None``: from the
            latest ``converged_at`` of a joint's methods, or its last half where none converges.
        progress: called as samples are done.

    Raises:
        MethodError: no method can run; says what each lacks.
        LogError: the log cannot be read to its end.
    """
    check_names(fit or (), COLUMNS, what="no such quantity to fit", where=device.source)
    names = log_names(log, device.only(joints))
    wanted = tuple(names)
    advice = recommend(log, device, joints=wanted)
    suited = {name: motion.window for name, motion in advice.motions.items() if motion is not None}
    widths = Widths(cutoff, window, None if fit is None else tuple(fit), suited)
    book = _Book(ran={name: [] for name in wanted})
    for candidate in CANDIDATES:
        _try(log, device, candidate, widths, wanted, book, progress)
    if book.last is None:
        told = dict.fromkeys(f"{out.name} ({out.side} side): {out.why}" for out in book.left_out)
        raise MethodError(
            "no method can estimate this log", where=log.source, hint="; ".join(told) + "."
        )
    methods, references, starts = _judged(book, start)
    return Comparison(
        source=log.source,
        device=device.only(joints),
        period=log.period,
        samples=book.last.samples,
        seconds=book.last.seconds,
        methods=methods,
        left_out=tuple(book.left_out),
        references=references,
        score_from=starts,
        recommendation=advice,
        warnings=_warnings(book),
    )


def _try(
    log: Log | LogReader,
    device: Device,
    candidate: Candidate,
    widths: Widths,
    wanted: Sequence[str],
    book: _Book,
    progress: Progress | None,
) -> None:
    """Run a candidate on the joints it can estimate, and note what the others lack."""
    told = variant(device, candidate, widths)
    names, kept_out = able(told, candidate, log.period, _roles(log, device, wanted), wanted)
    if names:
        try:
            found = _run(log, told, candidate, names, progress)
        except (MethodError, ExtraError) as error:
            why = f"{error.what}. {error.hint}" if error.hint else error.what
            kept_out = dict.fromkeys(names, why)
        else:
            book.last = found
            book.runs += 1
            for warning in found.warnings:
                book.warnings.setdefault(warning, []).append(candidate.label)
            for name, joint in found.joints.items():
                if name in wanted:
                    book.ran[name].append(_kept(candidate, joint))
    book.left_out += [
        LeftOut(name, candidate.name, candidate.side, why)
        for name, why in kept_out.items()
        if name in wanted
    ]


def _run(
    log: Log | LogReader,
    device: Device,
    candidate: Candidate,
    names: Sequence[str],
    progress: Progress | None,
) -> Estimate:
    def shown(done: int, expected: int | None) -> None:
        if progress is not None:
            progress(candidate.label, done, expected)

    if progress is not None:
        progress(candidate.label, 0, log.samples)
    return estimate(log, device, joints=names, progress=shown)


def _kept(candidate: Candidate, found: JointEstimate) -> _Ran:
    """Let go of the samples: of several methods they would fill the memory."""
    curve = curve_of(found)
    return _Ran(
        candidate, replace(found, records=found.records[:0], logged={}, truth_records={}), curve
    )


def _roles(
    log: Log | LogReader, device: Device, wanted: Sequence[str]
) -> Mapping[str, tuple[str, ...]]:
    """Joint of the device to the roles the log has of it; nothing of one that it lacks."""
    known = log_roles(log)
    if len(wanted) == 1 and len(known) == 1:
        return dict.fromkeys(wanted, next(iter(known.values()))) | {
            joint.name: () for joint in device.joints if joint.name not in wanted
        }
    return {joint.name: known.get(joint.name, ()) for joint in device.joints}


def _judged(
    book: _Book, start: float | None
) -> tuple[tuple[ComparedMethod, ...], dict[str, str], dict[str, float]]:
    """Score every joint's methods on its common samples."""
    methods: list[ComparedMethod] = []
    references: dict[str, str] = {}
    starts: dict[str, float] = {}
    assert book.last is not None
    for name, ran in book.ran.items():
        begin = start
        if begin is None:
            begin = start_of([one.found.converged_at for one in ran], book.last.seconds)
        reference = _reference(ran)
        starts[name] = begin
        references[name] = reference.candidate.label if reference is not None else ""
        methods += [_compared(one, reference, begin) for one in ran]
    return tuple(methods), references, starts


def _warnings(book: _Book) -> tuple[str, ...]:
    """Say whose a warning is, unless every method gives it."""
    return tuple(
        warning if len(labels) == book.runs else f"{'; '.join(labels)}: {warning}"
        for warning, labels in book.warnings.items()
    )


def _reference(ran: Sequence[_Ran]) -> _Ran | None:
    informative = [one for one in ran if one.found.verdict == "informative"]
    if not informative:
        return ran[0] if ran else None
    return min(informative, key=lambda one: one.found.stiffness_std)


def _compared(one: _Ran, reference: _Ran | None, start: float) -> ComparedMethod:
    found, candidate = one.found, one.candidate
    other = None
    if reference is not None and reference is not one:
        other = disagreement(one.curve, reference.curve, start)
    return ComparedMethod(
        joint=found.name,
        name=candidate.name,
        method=candidate.method,
        side=candidate.side,
        torque=candidate.torque,
        windowed=candidate.windowed,
        width=_width(found),
        stiffness=found.stiffness["final"],
        stiffness_std=found.stiffness_std,
        verdict=found.verdict,
        reason=found.reason,
        converged_at=found.converged_at,
        delay=found.delay,
        ns_per_sample=found.ns_per_sample,
        fitted=found.fitted,
        truth=score(one.curve, start),
        disagreement=other,
        curve=one.curve,
    )


def _width(found: JointEstimate) -> str:
    """The operator in words, without why it was chosen."""
    told = found.settings.get("cutoff") or found.settings["window"]
    return told.rpartition(" (")[0]
