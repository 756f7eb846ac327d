"""Follows a channel piece by piece: values that are not finite, and values that never change."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError

__all__ = ["ChannelWatch"]

# Channels that say nothing if they never change; a set-point or a load may well be constant.
_MUST_CHANGE = ("q", "theta", "theta1", "theta2", "tau", "tau1", "tau2", "torque_measured")


class ChannelWatch:
    """What is odd about one channel, in constant memory.

    Parameters
    ----------
    owner : what messages call its owner, such as "joint elbow".
    role : what it is of it.
    """

    def __init__(self, owner: str, role: str) -> None:
        self._name = f"{role} of {owner}"
        self._role = role
        self._empty = f"{self._name} never holds a finite number"
        self._rows = 0
        self._bad = 0
        self._bad_runs = 0
        self._in_run = False
        self._first_bad = 0.0
        self._value: float | None = None
        self._changed = False

    def clean(self, values: NDArray[np.float64], time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the next piece of the channel and return it with infinite values as NaN.

        Parameters
        ----------
        values : (N,) the channel.
        time : (N,) the clock [s].
        """
        finite = np.isfinite(values)
        if finite.all():
            self._in_run = False
            self._see(values)
        else:
            self._note_bad(finite, time)
            self._see(values[finite])
            values = np.where(finite, values, np.nan)
        self._rows += values.size
        return values

    def warnings(self) -> list[str]:
        """Return a sentence for everything that is odd so far."""
        if self._rows and self._value is None:
            return [self._empty]
        said: list[str] = []
        if self._bad:
            runs = "one run" if self._bad_runs == 1 else f"{self._bad_runs} runs"
            said.append(
                f"{self._name}: {self._bad} of {self._rows} samples are not finite (in {runs}, "
                f"first at {self._first_bad:.6g} s)"
            )
        if self._value is not None and not self._changed and self._role in _MUST_CHANGE:
            said.append(f"{self._name} is constant ({self._value:.6g})")
        return said

    def refuse_empty(self, source: str) -> None:
        """Raise LogError if the channel never held a finite value."""
        if self._value is None:
            raise LogError(self._empty, where=source)

    def _see(self, finite: NDArray[np.float64]) -> None:
        """Look whether the channel changes."""
        if self._changed or not finite.size:
            return
        if self._value is None:
            self._value = float(finite[0])
        self._changed = bool((finite != self._value).any())

    def _note_bad(self, finite: NDArray[np.bool_], time: NDArray[np.float64]) -> None:
        """Count the bad samples and their runs."""
        bad = ~finite
        if not self._bad:
            self._first_bad = float(time[int(np.argmax(bad))])
        self._bad += int(np.count_nonzero(bad))
        starts = bad.copy()
        starts[1:] &= finite[:-1]
        starts[0] = bad[0] and not self._in_run
        self._bad_runs += int(np.count_nonzero(starts))
        self._in_run = bool(bad[-1])
