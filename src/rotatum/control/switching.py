"""When control on an estimate has to leave to motor position control, and why it did."""

from __future__ import annotations

from dataclasses import dataclass

from rotatum.errors import RotatumError

__all__ = ["ASTRAY", "BLIND", "LIMITED", "SINGULAR", "UNTRUSTED", "Switching"]

UNTRUSTED = 1
"""Flag: the estimate is not to be trusted now."""
SINGULAR = 2
"""Flag: the motors can hardly change the stiffness here."""
LIMITED = 4
"""Flag: a motor is at its limit."""
ASTRAY = 16
"""Flag: the link is far from where it is to be; what the estimate says of the springs is not so."""
BLIND = 8
"""Flag: the state is no number, so that the torques before are kept, or the estimate is none."""


@dataclass(frozen=True)
class Switching:
    """When the decoupling law has to leave, and when it may come back.

    Attributes
    ----------
    low, high : steerability below which it leaves, and above which it may come back; on the side
        of the singularity where the first trusted law was.
    wait : for so long all must be well before it comes (back) [s].
    astray : position error beyond which it leaves [rad].
    patience : for so long a motor may be at its limit without a break [s].
    fade : time constant with which the difference of both laws' torques at a switch dies away, and
        with which motor set-points move to a new preset [s].

    Raises `RotatumError` unless 0 <= low < high and the others are positive.
    """

    low: float = 0.04
    high: float = 0.06
    astray: float = 0.3
    wait: float = 0.2
    patience: float = 0.05
    fade: float = 0.05

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not 0.0 <= self.low < self.high:
            what = "the threshold for coming back must be above that for leaving"
            raise RotatumError(what, where="switching.low, high", value=(self.low, self.high))
        for name in ("astray", "wait", "patience", "fade"):
            if not getattr(self, name) > 0.0:
                what = "must be greater than zero"
                raise RotatumError(what, where=f"switching.{name}", value=getattr(self, name))
