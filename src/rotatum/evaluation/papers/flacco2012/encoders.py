"""Figures 23 and 24: stiffness against the resolution of the encoders."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from rotatum.evaluation.papers.case import Case, Curve, Figure, Outcome, Plot, Progress, Value
from rotatum.evaluation.papers.flacco2012 import awas, vsa2
from rotatum.evaluation.papers.flacco2012.modality import (
    MODALITIES,
    channels,
    printed,
    score,
    total,
    weak,
    weak_law,
)
from rotatum.evaluation.papers.flacco2012.settings import (
    AWAS,
    BOUNDS,
    VSA2,
    WIDE_BOUNDS,
    PaperSettings,
)
from rotatum.evaluation.parallel import spread
from rotatum.logs import Log
from rotatum.models import Device

__all__ = ["ANTAGONISTIC", "SERIAL", "serial_scores"]

SEEDS = 5
COUNTS = (100, 180, 256, 512, 1024, 2048, 4096, 7000, 10_000, 20_000, 40_000)
QUICK = (256, 1024, 4096)
SLOW = 100.0  # rad/s, a cutoff for coarse encoders
FINAL = ", final law"  # end of the names of what is scored by the last coefficients
SMALL, LARGE = 1024, 4096  # counts the paper's method and weak are compared at

Scores = dict[str, float]


def antagonistic_scores(job: tuple[int, int]) -> Scores:
    """Score the VSA-II: method to MSREP, %.

    Args:
        job: counts per turn and seed of the noise.
    """
    counts, seed = job
    device = vsa2.device(counts=counts)
    return _scores(device, device, vsa2.motion(device, seed), VSA2)


def serial_scores(job: tuple[int, int]) -> Scores:
    """Score the AwAS: method to MSREP, %; its set-point encoder keeps its 1024 counts.

    Args:
        job: counts per turn and seed of the noise.
    """
    counts, seed = job
    device = awas.device(counts=counts)
    papers = awas.device(awas.PAPER_ORDERS, counts)
    return _scores(papers, device, awas.motion(device, seed), AWAS)


def _scores(papers: Device, device: Device, log: Log, settings: PaperSettings) -> Scores:
    truth = channels(device, log)["stiffness_true"]
    found: Scores = {}
    for modality in MODALITIES:
        run = printed(papers, log, modality, settings, WIDE_BOUNDS)
        found[modality] = score(log, run.out["stiffness"], truth)[1]
        if modality == "RESIDUAL":
            found[f"RESIDUAL{FINAL}"] = score(log, total(papers, log, run.laws), truth, 0.0)[1]
    fast = printed(papers, log, "RESIDUAL", settings, BOUNDS)
    found["RESIDUAL, section 6"] = score(log, fast.out["stiffness"], truth)[1]
    for name, cutoff in (("weak", None), ("weak, 100 rad/s", SLOW)):
        joint = weak(device, log, cutoff=cutoff)
        found[name] = score(log, joint.records["stiffness"], truth)[1]
        law = weak_law(device, joint)
        found[f"{name}{FINAL}"] = score(log, total(device, log, law), truth, 0.0)[1]
    return found


def _run(
    scores: Callable[[tuple[int, int]], Scores],
    figure: str,
    note: str,
    progress: Progress,
    quick: bool,
) -> Outcome:
    counts, seeds = (QUICK, range(1)) if quick else (COUNTS, range(SEEDS))
    jobs = [(number, seed) for number in counts for seed in seeds]
    every = dict(
        zip(jobs, spread(scores, jobs, progress, workers=1 if quick else None), strict=True)
    )
    names = list(every[jobs[0]])
    medians = {
        number: {name: float(np.median([every[number, s][name] for s in seeds])) for name in names}
        for number in counts
    }
    values = [line for number in counts for line in _lines(number, medians[number])]
    drawn = (
        _drawn(medians, figure, "on line", "", note),
        _drawn(medians, figure, "final law", FINAL, note),
    )
    return Outcome(tuple(values), drawn, _compared(medians))


def _drawn(
    medians: Mapping[int, Mapping[str, float]], figure: str, scored: str, end: str, note: str
) -> Figure:
    """MSREP by resolution of the methods that are scored this way."""
    names = [name for name in next(iter(medians.values())) if name.endswith(FINAL) == bool(end)]
    x = np.array(list(medians), np.float64)
    curves = tuple(
        Curve(name.removesuffix(end), x, np.array([found[name] for found in medians.values()]))
        for name in names
    )
    plot = Plot("MSREP, %", curves, logarithmic=True)
    title = f"MSREP against encoder resolution, {scored} ({figure})"
    key = f"{figure.replace('. ', '')}-{scored.replace(' ', '-')}"
    return Figure(key, title, note, "counts per turn", (plot,), logarithmic=True)


def _lines(number: int, found: Mapping[str, float]) -> list[Value]:
    lines = [
        Value(f"{number} counts: {name}, MSREP", "%", None, found[name])
        for name in MODALITIES
        if name != "RESIDUAL"
    ]
    pairs = (
        ("RESIDUAL", "RESIDUAL", "weak"),
        ("RESIDUAL, final law", "RESIDUAL, final law", "weak, final law"),
        ("RESIDUAL with section 6's variances", "RESIDUAL, section 6", None),
        ("weak at 100 rad/s", None, "weak, 100 rad/s"),
        ("weak at 100 rad/s, final law", None, "weak, 100 rad/s, final law"),
    )
    for label, own, best in pairs:
        ours = None if own is None else found[own]
        theirs = None if best is None else found[best]
        lines.append(Value(f"{number} counts: {label}, MSREP", "%", None, ours, theirs))
    return lines


def _compared(medians: Mapping[int, Mapping[str, float]]) -> tuple[str, ...]:
    """Say how weak at 1024 counts compares with the paper's method at 4096."""
    coarse, fine = medians[SMALL], medians[LARGE]
    said = ["Medians over the noise seeds. The paper's curves are not given in numbers."]
    for cutoff, name in (("default cutoff", "weak"), ("cutoff 100 rad/s", "weak, 100 rad/s")):
        for scored, end in (("on line", ""), ("final law", FINAL)):
            ours, theirs = coarse[name + end], fine["RESIDUAL" + end]
            word = "better" if ours < theirs else "worse"
            said.append(
                f"{scored}: weak ({cutoff}) at {SMALL} counts, {ours:.2g} %, is {word} than the "
                f"paper's method at {LARGE}, {theirs:.2g} %."
            )
    return tuple(said)


NOTE = (
    'V_max = 1e5 and V_min = 1e4 as in the paper\'s section 7; "section 6" has V_max = 10 and '
    "V_min = 0.1. On line from 2 s on; final law: the last coefficients over the whole motion."
)
PRINTS = (
    "without numbers: RESIDUAL is worst at low resolution, all are good from 1024 pulses a turn on."
)

ANTAGONISTIC = Case(
    "fig23",
    "the VSA-II against encoder resolution",
    f"Figure 23, {PRINTS}",
    vsa2.ASSUMED,
    partial(_run, antagonistic_scores, "fig. 23", NOTE),
)
SERIAL = Case(
    "fig24",
    "the AwAS against encoder resolution",
    f"Figure 24, {PRINTS}",
    (*awas.ASSUMED, "The encoder of the lever arm keeps its 1024 counts per turn."),
    partial(_run, serial_scores, "fig. 24", NOTE),
)
CASES = (ANTAGONISTIC, SERIAL)
