"""A device file for a log in its own units, and what goes wrong without it.

A logger writes milliseconds, degrees and N mm, the motor's angle before the gear. The device file
says so once; every number in it and in the results is SI.

    python examples/03_own_device.py
"""

import tempfile
from pathlib import Path

import numpy as np

import rotatum as rt

DEVICE = """\
name = "my-joint"

[motor]                            # on the motor's side of the gear
inertia = 4.0e-5                   # kg m^2
damping = 5.0e-5                   # N m s/rad
gear_ratio = 80

[transmission]                     # known here because the log is simulated
law = "linear"
stiffness = 200.0                  # N m/rad

[link]
inertia = 0.8                      # kg m^2
damping = 1.0                      # N m s/rad

[encoders]                         # counts per turn of the joint
link = 65536
motor = 1310720

[basis]
deflection_range = 0.15            # rad
orders = 1

[estimator]
fit = ["offset"]
"""

CHANNELS = """
[channels]
time = { name = "t_ms", unit = "ms" }
q = { name = "link_deg", unit = "deg" }
theta = { name = "motor_deg", unit = "deg", side = "motor" }
tau = { name = "torque_Nmm", unit = "N mm", side = "motor", hold = "held" }
"""


def main() -> None:
    folder = Path(tempfile.mkdtemp(prefix="rotatum-"))
    record_log(folder / "run.csv")

    (folder / "joint.toml").write_text(DEVICE)
    try:
        rt.open_log(folder / "run.csv", rt.load_device(folder / "joint.toml"))
    except rt.RotatumError as error:
        print(f"without [channels]: {error}")

    (folder / "joint.toml").write_text(DEVICE + CHANNELS)
    joint = rt.load_device(folder / "joint.toml")
    found = rt.estimate(rt.read_log(folder / "run.csv", joint), joint)
    print(f"with them:          {found.joints['my-joint'].reason}")
    print(
        f"the same from the command line: rotatum estimate {folder / 'run.csv'} "
        f"--device {folder / 'joint.toml'}"
    )


def record_log(path: Path) -> None:
    """Write a log as somebody else's logger might."""
    (folder := path.parent).mkdir(exist_ok=True)
    (folder / "plant.toml").write_text(DEVICE)
    joint = rt.load_device(folder / "plant.toml").joints[0]
    from rotatum.simulation import multisine

    shake = multisine(rms=5.0, low=0.3, high=10.0, count=20, seed=1)
    log = rt.simulate_joint(joint, seconds=5.0, period=1e-3, drives={"tau": shake})
    robot, gear = log.joints["my-joint"], joint.motors[0].gear_ratio
    rt.write_table(
        path,
        {
            "t_ms": 1e3 * log.time,
            "link_deg": np.degrees(robot["q"]),
            "motor_deg": np.degrees(robot["theta"]) * gear,
            "torque_Nmm": 1e3 * robot["tau"] / gear,
        },
    )


if __name__ == "__main__":
    main()
