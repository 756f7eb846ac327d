"""Section 6.3: two VSA-IIs driving a 2R arm. Listed, and why it is not there yet."""

from __future__ import annotations

from rotatum.evaluation.papers.case import Case, Outcome, Progress, Value

__all__ = ["CASE"]

GRAVITY = 9.81  # m/s^2
ROD, LENGTH = 0.1, 0.5  # kg and m, each of two uniform rods
ACTUATOR = 0.345  # kg, at the elbow
MOTORS = 2 * 0.05  # N m, both motors of the first joint

WAITS = "waits for the simulator of several joints"


def _run(progress: Progress, quick: bool) -> Outcome:
    # Stretched out: both rods at their middles and the actuator at the elbow.
    load = GRAVITY * (ROD * 0.5 * LENGTH + ROD * 1.5 * LENGTH + ACTUATOR * LENGTH)
    return Outcome(
        (
            Value("gravity torque at joint 1, arm stretched out", "N m", own=load),
            Value("both motors of joint 1 together", "N m", MOTORS),
            Value("gravity over motors", "1", own=load / MOTORS),
        ),
        findings=(
            "Not reproduced: it waits for the simulator of several joints.",
            "As printed it cannot be: with gravity the motors swing the first link by a few "
            'hundredths of a radian about hanging down, so that "the whole robot workspace" is '
            "not explored. It takes a horizontal arm, or torques and springs some 25 times as "
            "large.",
        ),
    )


CASE = Case(
    "sec6.3",
    f"two VSA-IIs driving a 2R arm ({WAITS})",
    "Figures 17 to 20, without numbers.",
    ("Nothing is simulated here.",),
    _run,
    WAITS,
)
