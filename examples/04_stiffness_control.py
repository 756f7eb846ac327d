"""A variable-stiffness joint follows a position and a stiffness, controlled on its estimate.

The VSA-II is simulated with encoders of 4059 counts. Its two motors swing in position control until
the estimate is informative; then input-output linearisation on the estimated torque, stiffness and
its derivatives takes over.

    python examples/04_stiffness_control.py
"""

import numpy as np

import rotatum as rt
from rotatum.evaluation.loop.antagonistic import run_stiffness_loop
from rotatum.evaluation.loop.stiffness_task import Excitation, StiffnessTask, Swing
from rotatum.kernels.status import VERDICTS


def main() -> None:
    task = StiffnessTask(
        Excitation((0.4, -0.4), 0.12, ((0.7, 1.9), (1.1, 2.7))),  # rad, Hz
        position=Swing(0.0, 0.2, 0.4),  # rad, Hz
        stiffness=Swing(0.6, 0.08, 0.25),  # N m/rad, Hz
        excite=3.0,
    )
    run = run_stiffness_loop(rt.load_device("vsa-ii"), task, {"method": "weak"}, seconds=12.0)
    print(f"handed over after {run.handed_over:.2f} s")
    for k in range(0, len(run.time), 1000):
        print(
            f"{run.time[k]:5.1f} s  q {run.q[k]:+.3f} rad of {run.columns['q_d'][k]:+.3f}  "
            f"stiffness {run.sigma[k]:.3f} N m/rad of {run.columns['sigma_d'][k]:.3f}  "
            f"{VERDICTS[run.verdict[k]]:12s} {'decoupled' if run.decoupled[k] else 'positions'}"
        )
    q, sigma = run.errors(task.settled + 0.5)
    print(f"largest errors, of the swings: position {100 * q:.1f} %, stiffness {100 * sigma:.1f} %")
    print(f"largest torque: {np.max(np.abs(run.columns['tau1'])):.2f} N m")


if __name__ == "__main__":
    main()
