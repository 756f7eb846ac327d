"""``python -m benchmarks.faults``: what each trouble costs the estimate, and what helps.

Every ready scenario ``trouble/...`` is simulated with several seeds and estimated as it stands,
then with what a user who read the verdict, or knows the joint, would do. Prints Markdown.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks.timing import say
from rotatum.evaluation import JointEstimate, estimate
from rotatum.evaluation.parallel import spread
from rotatum.evaluation.sweep.score import joint_values
from rotatum.simulation.scenario import load_scenario, scenario_names

COLUMNS = (
    "fault",
    "estimated with",
    "verdicts",
    "error %",
    "read-out %",
    "± %",
    "outside",
    "MSREP %",
    "cover %",
)
SCORE_FROM = 5.0  # s, where every trouble's motion has been through the spring's whole range


class Remedy(NamedTuple):
    """Another way to estimate the same log.

    Args:
        name: for the table.
        told: [told] of the scenario: what the device file says instead; None: as it stands.
        fit, torque, cutoff, forgetting: as for ``rotatum.estimate``.
    """

    name: str
    told: Mapping[str, Any] | None = None
    fit: tuple[str, ...] | None = None
    torque: str | None = None
    cutoff: float | None = None
    forgetting: float | None = None


class Job(NamedTuple):
    """One simulation with its estimate."""

    scenario: str
    remedy: Remedy
    seed: int


PLAIN = Remedy("")
SENSOR = Remedy("torque sensor", torque="sensor")
INERTIA = Remedy("fit inertia", fit=("inertia", "offset"))
FRICTION = Remedy("fit coulomb, damping", fit=("coulomb", "damping", "offset"))
SKEW = Remedy("fit skew", fit=("skew", "offset"))
SLOWER = Remedy("cutoff 100 rad/s", cutoff=100.0)
FORGET = Remedy("forgetting 0.999", forgetting=0.999)


def _accuracy(rad: float) -> Remedy:
    return Remedy(f"accuracy {1e3 * rad:g} mrad", told={"encoders.accuracy": rad})


REMEDIES: Mapping[str, tuple[Remedy, ...]] = {
    "backlash": (_accuracy(0.001),),
    "clock-drift": (INERTIA, SENSOR),
    "clock-jitter": (INERTIA, SLOWER),
    "coarse-encoder": (SLOWER,),
    "coulomb": (FRICTION, SENSOR),
    "damping": (Remedy("fit damping", fit=("damping", "offset")),),
    "delay-jitter": (SKEW,),
    "eccentricity": (_accuracy(0.0005),),
    "hall-sensors": (SLOWER,),
    "hysteresis": (SENSOR, _accuracy(0.002)),
    "load-friction": (SENSOR,),
    "rotor-inertia": (INERTIA, SENSOR),
    "saturation": (Remedy("limit told", told={"motor.torque_limit": 0.05}), SENSOR),
    "skew": (SKEW,),
    "slow-log": (SENSOR,),
    "stale-samples": (INERTIA, SLOWER),
    "stiffness-drift": (FORGET,),
    "stiffness-step": (FORGET,),
    "stribeck": (FRICTION, SENSOR),
    "torque-delay": (INERTIA, SENSOR),
    "torque-gain": (INERTIA, SENSOR),
    "torque-sign": (INERTIA, SENSOR),
    "zero-offset": (Remedy("zero read at rest", told={"transmission.zero": "first"}),),
}


def faults() -> list[str]:
    """Return the names of the troubles, the clean one first."""
    names = [name.removeprefix("trouble/") for name in scenario_names() if "trouble/" in name]
    return sorted(names, key=lambda name: (name != "clean", name))


def measured(job: Job) -> dict[str, Any]:
    """Simulate and estimate; return what ``joint_values`` does of the only joint."""
    scenario = load_scenario(f"trouble/{job.scenario}")
    remedy = job.remedy
    if remedy.told is not None:
        scenario = scenario.with_values({f"told.{key}": v for key, v in remedy.told.items()})
    log = scenario.run(job.seed)
    found = estimate(
        log,
        scenario.device,
        method="weak",
        torque=remedy.torque,
        cutoff=remedy.cutoff,
        fit=remedy.fit,
        forgetting=remedy.forgetting,
        start=SCORE_FROM,
    )
    (joint,) = found.joints.values()
    (logged,) = log.joints.values()
    return joint_values(joint, log) | {"read_out_percent": _read_out(joint, logged)}


def _read_out(joint: JointEstimate, logged: Mapping[str, Any]) -> float:
    """Return what the error of the last deflection makes of the stiffness there, per cent.

    ``sigma'(phi) (phi - phi_true) / sigma_true``; NaN for a joint of two deflections.
    """
    if "theta_true" not in logged:
        return float("nan")
    last = joint.records[-1]
    missed = float(last["deflection"]) - float(logged["q_true"][-1] - logged["theta_true"][-1])
    return 100.0 * float(last["dstiffness"]) * missed / float(logged["stiffness_true"][-1])


def row(name: str, remedy: Remedy, results: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Return one line of the table: medians over the seeds."""
    verdicts = Counter(str(result["verdict"]) for result in results)
    error = np.array([abs(result["error_percent"]) for result in results])
    true = np.array([result["stiffness_true"] for result in results])
    half = 196.0 * np.array([result["stiffness_std"] for result in results]) / true
    trusted = np.array([result["verdict"] == "informative" for result in results])
    outside = int(np.count_nonzero(trusted & (error > half)))
    counted = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common())
    return (
        "" if remedy.name else name,
        remedy.name,
        counted if len(verdicts) > 1 else next(iter(verdicts)),
        number(np.median(error)),
        number(np.median([abs(result["read_out_percent"]) for result in results])),
        number(np.median(half)),
        str(outside) if trusted.any() else "-",
        number(np.median([result["msrep_percent"] for result in results])),
        f"{np.median([result['coverage_percent'] for result in results]):.0f}",
    )


def number(value: float) -> str:
    """Return two digits that count, as people write them."""
    if not np.isfinite(value):
        return "-"
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}"


def as_markdown(rows: Sequence[tuple[str, ...]]) -> str:
    """Return the table, numbers to the right."""
    rule = ("---", "---", "---", *["---:"] * 6)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (COLUMNS, rule, *rows))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run every trouble with every remedy and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.faults",
        description="What each fault costs, as a Markdown table: medians over the seeds.",
    )
    parser.add_argument("--seeds", type=int, default=5, metavar="N", help="per line (5)")
    parser.add_argument("--only", nargs="+", choices=faults(), metavar="FAULT", help="only these")
    options = parser.parse_args(arguments)
    names = options.only or faults()
    lines = [(name, remedy) for name in names for remedy in (PLAIN, *REMEDIES.get(name, ()))]
    jobs = [Job(name, remedy, seed) for name, remedy in lines for seed in range(options.seeds)]
    say(f"{len(jobs)} simulations with their estimates ...")
    results = spread(measured, jobs)
    pieces = [results[k : k + options.seeds] for k in range(0, len(jobs), options.seeds)]
    print(as_markdown([row(*line, piece) for line, piece in zip(lines, pieces, strict=True)]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
