"""What is kept of an observed joint while a log goes by: states, errors, counts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.full_state.design import Design
from rotatum.evaluation.observation import STATES, JointObservation, Score
from rotatum.kernels.status import SETTLING, SINGULAR, TABLE, UNSEEN
from rotatum.models.joint import Joint
from rotatum.record import Records

__all__ = ["Observed"]

Array = NDArray[np.float64]

KEEP = 200_000  # samples kept of all joints together; of a longer log every second, fourth, ...
REFERENCES = ("q", "q_true", "dq_true", "theta_true", "dtheta_true")
PEAKS = ("deflection", "dq_hat", "torque")


class Observed:
    """One joint's running summary.

    Args:
        joint: what is observed.
        design: of its observer.
        determined: whether the sensors determine the acceleration of its link.
        start: seconds after the first sample from which samples are scored; None: once settled.
        joints: how many joints share the room for kept samples.
    """

    def __init__(
        self, joint: Joint, design: Design, determined: bool, start: float | None, joints: int
    ) -> None:
        self.name, self.design, self.determined = joint.name, design, determined
        encoders = joint.encoders
        # The observer counts turns; an encoder that starts again from zero cannot be held against
        # it.
        self._encoder = encoders.wrap_link is None and encoders.wrap_motor is None
        self.samples, self.every = 0, 1
        self._scored, self._told = 0, 0
        self.status = {bit.name: 0 for bit in TABLE}
        self.score_from: float | None = None
        self._start, self._room = start, KEEP // joints
        self._kept: dict[str, list[NDArray[Any]]] = {}
        self._errors = {"q": _Errors(), "deflection": _Errors(), "dq": _Errors(),
                        "rigid": _Errors()}  # fmt: skip
        self._peaks = dict.fromkeys(PEAKS, 0.0)
        self._of = ""
        self._first, self._last = math.nan, math.nan

    @property
    def seconds(self) -> float:
        """From the first sample to the last."""
        return self._last - self._first

    def add(self, time: Array, states: Records, logged: Mapping[str, Array]) -> dict[str, Any]:
        """Take a batch; returns its canonical columns.

        Args:
            time: (N,) s.
            states: (N,) records of the observer's output.
            logged: role to (N,): the motor's position, and what the state can be compared with.
        """
        columns: dict[str, NDArray[Any]] = {key: states[key].copy() for key in STATES}
        columns["status"] = states["status"].copy()
        good = time[np.isfinite(time)]
        if good.size:
            self._first = self._first if math.isfinite(self._first) else float(good[0])
            self._last = float(good[-1])
        self._keep({"time": time, **columns,
                    **{k: logged[k] for k in REFERENCES if k in logged}})  # fmt: skip
        for bit in TABLE:
            self.status[bit.name] += int(np.count_nonzero(states["status"] & bit.bit))
        self._score(time, columns, logged)
        self.samples += len(time)
        return columns

    def result(self) -> JointObservation:
        """Return the joint's result."""
        series = {key: np.concatenate(values) for key, values in self._kept.items()}
        errors = self._errors
        score = None
        if self._of:
            score = Score(
                self._of, errors["q"].rms, errors["q"].largest, errors["rigid"].rms,
                errors["deflection"].largest, errors["dq"].rms, errors["dq"].largest,
            )  # fmt: skip
        return JointObservation(self.name, self.determined, self.design, series, self.every,
                                self._peaks, self.status, self._told / max(1, self._scored),
                                score)  # fmt: skip

    def _keep(self, columns: Mapping[str, NDArray[Any]]) -> None:
        pick = slice((-self.samples) % self.every, None, self.every)
        for key, values in columns.items():
            self._kept.setdefault(key, []).append(np.array(values[pick]))
        while sum(len(values) for values in self._kept["time"]) > self._room:
            self.every *= 2
            for key, pieces in self._kept.items():
                self._kept[key] = [np.concatenate(pieces)[::2].copy()]

    def _score(
        self, time: Array, columns: Mapping[str, NDArray[Any]], logged: Mapping[str, Array]
    ) -> None:
        status = columns["status"]
        scored = (status & SETTLING) == 0
        if self._start is not None:
            scored = time >= self._first + self._start
        scored &= np.isfinite(time)
        if not scored.any():
            return
        if self.score_from is None:
            self.score_from = float(time[int(np.argmax(scored))]) - self._first
        self._scored += int(np.count_nonzero(scored))
        self._told += int(np.count_nonzero(scored & ((status & (SINGULAR | UNSEEN)) == 0)))
        for key in PEAKS:
            peak = float(np.max(np.abs(columns[key][scored])))
            self._peaks[key] = max(self._peaks[key], peak)
        for key, error in self._off(columns, logged).items():
            self._errors[key].add(error[scored])

    def _off(
        self, columns: Mapping[str, NDArray[Any]], logged: Mapping[str, Array]
    ) -> dict[str, Array]:
        """Errors against what is known, if anything is."""
        if "q_true" in logged:
            self._of = "truth"
            q, theta = logged["q_true"], logged.get("theta_true", logged["theta"])
        elif "q" in logged and self._encoder:
            self._of = "encoder"
            q, theta = logged["q"], logged["theta"]
        else:
            return {}
        errors = {
            "q": columns["q_hat"] - q,
            "deflection": columns["q_hat"] - columns["theta_hat"] - (q - theta),
            "rigid": theta - q,
        }
        if "dq_true" in logged:
            errors["dq"] = columns["dq_hat"] - logged["dq_true"]
        return errors


class _Errors:
    """Root mean square and largest of a sequence of errors; NaN before there is one."""

    def __init__(self) -> None:
        self._total, self._count, self._largest = 0.0, 0, math.nan

    def add(self, errors: Array) -> None:
        """Take a batch; what is not finite does not count."""
        good = errors[np.isfinite(errors)]
        if good.size:
            self._total += float(good @ good)
            self._count += good.size
            self._largest = float(np.fmax(self._largest, np.abs(good).max()))

    @property
    def rms(self) -> float:
        """Root mean square."""
        return math.sqrt(self._total / self._count) if self._count else math.nan

    @property
    def largest(self) -> float:
        """By magnitude."""
        return self._largest
