"""The estimator in a control loop: one sample in, one answer out.

The stiffness is used only while the verdict says that it may be; until then, and whenever the
verdict is withdrawn, the controller falls back to what it was told.

    python examples/02_control_loop.py
"""

import numpy as np

import rotatum as rt

TOLD = 180.0  # N m/rad, what the data sheet says


def main() -> None:
    joint, log = rt.demo_log()  # stands in for the robot
    robot = log.joints["demo-elbow"]
    loop = rt.Estimator(joint, period=log.period, method="weak")

    used = np.empty(log.samples)
    for k in range(log.samples):
        out = loop.update(
            q=robot["q"][k],
            theta=robot["theta"][k],
            tau=robot["tau"][k],
            time=log.time[k],
        )
        informative = out.verdict[0] == "informative"
        used[k] = out.stiffness[0] if informative else TOLD
        # A controller would go on here, such as with the feed-forward deflection torque / used[k].
        if k % 2000 == 0:
            half = 1.96 * out.stiffness_std[0]
            print(
                f"{log.time[k]:5.1f} s  {out.stiffness[0]:7.1f} +- {half:5.1f}"
                f" N m/rad  {out.verdict[0]:12s} using {used[k]:.1f}"
            )

    truth = robot["stiffness_true"]
    error = np.sqrt(np.mean((used / truth - 1.0) ** 2))
    sheet = np.sqrt(np.mean((TOLD / truth - 1.0) ** 2))
    print(
        f"relative error (rms): {100 * error:.1f} % used, {100 * sheet:.1f} % from the data sheet"
    )


if __name__ == "__main__":
    main()
