"""A recorded log in, the stiffness of its joint out: table, file and report.

python examples/01_estimate_a_log.py                      # a simulated log
python examples/01_estimate_a_log.py run.csv joint.toml   # your own
"""

import sys
import tempfile
from pathlib import Path

import rotatum as rt


def main() -> None:
    folder = Path(tempfile.mkdtemp(prefix="rotatum-"))
    if len(sys.argv) == 3:
        joint = rt.load_device(sys.argv[2])
        log = rt.open_log(sys.argv[1], joint)  # piece by piece: the log may be larger than memory
    else:
        joint, log = rt.demo_log()

    found = rt.estimate(log, joint, method="weak", output=folder / "stiffness.csv")

    for name, result in found.joints.items():
        final, half = result.stiffness["final"], 1.96 * result.stiffness_std
        print(f"{name}: {final:.1f} +- {half:.1f} N m/rad, {result.verdict}")
        print(f"  {result.reason}")
        if result.truth is not None:
            print(f"  truth inside the interval: {result.truth['coverage_percent']:.0f} %")
    for warning in found.warnings:
        print(f"warning: {warning}")

    report = rt.write_report(found, folder / "report.html")
    print(f"every sample: {folder / 'stiffness.csv'}")
    print(f"to look at:   {report}")


if __name__ == "__main__":
    main()
