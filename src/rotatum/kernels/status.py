"""The one table of status bits and verdicts: kernels, C, reports and docs use it."""

from __future__ import annotations

from typing import NamedTuple


class Status(NamedTuple):
    """One bit of ``status``.

    Args:
        name: short name, as in tables and JSON.
        bit: its value.
        sentence: what it means and what to do about it.
    """

    name: str
    bit: int
    sentence: str


NOT_FINITE = 1
REPEATED = 2
BACKWARDS = 4
BRIDGED = 8
GAP = 16
JUMP = 32
SATURATED = 64
RESTARTED = 128
SETTLING = 256
DISABLED = 512
WIDE = 1024
PRIOR = 2048
DEFLECTION = 4096
LAG = 8192
INERTIA = 16384
OFFSET = 32768
DRIFT = 65536
NEGATIVE = 131072
VELOCITY = 262144
HELD = 524288
STILL = 1048576
SINGULAR = 2097152
UNSEEN = 4194304

REJECTED = NOT_FINITE | REPEATED | BACKWARDS | SATURATED
WRONG = LAG | INERTIA | OFFSET | DRIFT | NEGATIVE | VELOCITY

TABLE: tuple[Status, ...] = (
    Status(
        "not_finite", NOT_FINITE, "a channel or the time was NaN, infinite or beyond 1e12: not used"
    ),
    Status("repeated", REPEATED, "the time stamp came again or too early: sample skipped"),
    Status("backwards", BACKWARDS, "time ran backwards: sample skipped"),
    Status("bridged", BRIDGED, "a few samples were missing: filled by straight lines"),
    Status("gap", GAP, "too many samples were missing: filters restarted, estimate kept"),
    Status("jump", JUMP, "a channel jumped further than it can move: filters restarted"),
    Status("saturated", SATURATED, "a channel is at its limit: sample skipped, filters restarted"),
    Status("restarted", RESTARTED, "filters start here"),
    Status("settling", SETTLING, "filters have not forgotten their start"),
    Status("disabled", DISABLED, "updates are switched off by the caller"),
    Status(
        "wide",
        WIDE,
        "1.96 standard deviations exceed half of the stiffness: the joint has to be deflected "
        "more, or for longer, or less of the model fitted",
    ),
    Status(
        "prior",
        PRIOR,
        "the data have hardly narrowed the prior in the direction of this stiffness: the joint has "
        "not been deflected in this range",
    ),
    Status(
        "deflection",
        DEFLECTION,
        "the deflection that informs the stiffness is not large against the encoders' error: the "
        "spring moves less than q - theta can be trusted",
    ),
    Status(
        "lag",
        LAG,
        "the residual is a delayed copy of the elastic torque: the method's own filter (raise the "
        "cutoff, or use `weak`), or a torque that comes late",
    ),
    Status(
        "inertia",
        INERTIA,
        "the residual follows the motor's acceleration: a wrong inertia, a torque that is "
        "not what the channel says (torque constant, gear ratio), or the lag of the filters of "
        "`residual`: fit `inertia`, or use `weak`; or time stamps that jitter, of which fitting "
        "makes it worse: lower the cutoff",
    ),
    Status(
        "offset",
        OFFSET,
        "the residual has a mean: a wrong zero of the deflection or of the torque; fit `offset`",
    ),
    Status(
        "drift",
        DRIFT,
        "recent data ask for another stiffness than all data together: it changes over time (use "
        "forgetting), or something else in the model does",
    ),
    Status(
        "negative",
        NEGATIVE,
        "the stiffness comes out negative beyond doubt: a wrong sign, side or channel, or friction "
        "that looks like a spring",
    ),
    Status(
        "velocity",
        VELOCITY,
        "the residual follows the link's velocity: a skew between the encoder channels, or viscous "
        "friction that is not modelled; fit `skew` or `damping`",
    ),
    Status(
        "held",
        HELD,
        "updates are held: the link is near a standstill, or has just been (selective updates)",
    ),
    Status(
        "still",
        STILL,
        "updates have been held for a second or longer: the stiffness is read out of what was "
        "learnt before, and nothing confirms it",
    ),
    Status(
        "singular",
        SINGULAR,
        "the accelerometers hardly tell the links' accelerations in this pose: what they do not "
        "tell is damped towards zero",
    ),
    Status(
        "unseen",
        UNSEEN,
        "no sensor determines the acceleration of this link: its position follows the motor's",
    ),
)

STARVED = 0
CONVERGING = 1
INFORMATIVE = 2
INCONSISTENT = 3

VERDICTS: tuple[str, ...] = ("starved", "converging", "informative", "inconsistent")
