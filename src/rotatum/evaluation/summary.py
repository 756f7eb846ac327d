"""What is kept of a run while it goes on: every k-th record, running sums, scores."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rotatum.evaluation.metrics import TruthScore
from rotatum.kernels.status import PRIOR, TABLE
from rotatum.record import Records

KEEP = 400_000  # readings kept in all; of a longer log every second, fourth, ... sample


class Summary:
    """One joint's running summary.

    Args:
        start: seconds after the first sample from which samples are scored; None: once converged.
        joints: how many joints share the room for kept readings.
    """

    def __init__(self, start: float | None, joints: int) -> None:
        self.start = start
        self.every = 1
        self._room = KEEP // joints
        self.kept: list[Records] = []
        self.truth_kept: dict[str, list[NDArray[np.float64]]] = {}
        self.seen = 0
        self.status = {bit.name: 0 for bit in TABLE}
        self.scored = _Range()
        self.learned = _Range()
        self.score = TruthScore()
        self.part_scores = (TruthScore(), TruthScore())
        self.has_truth = False
        self.score_from: float | None = None
        self.last: Records | None = None
        self.first_time: float | None = None

    def add(self, out: Records, extra: dict[str, NDArray[np.float64]]) -> None:
        """Take a batch: (N,) readings, and columns of the log worth keeping beside them.

        Args:
            out: readings; copied where kept.
            extra: link position, set-point, truth, measured torque where the log has them.
        """
        pick = slice((-self.seen) % self.every, None, self.every)
        self.kept.append(out[pick].copy())
        for name, values in extra.items():
            self.truth_kept.setdefault(name, []).append(values[pick].copy())
        if sum(len(records) for records in self.kept) > self._room:
            self._thin()
        self.seen += len(out)
        if self.first_time is None:
            finite = out["time"][np.isfinite(out["time"])]
            self.first_time = float(finite[0]) if finite.size else None
        origin = self.first_time or 0.0
        for bit in TABLE:
            self.status[bit.name] += int(np.count_nonzero(out["status"] & bit.bit))
        if self.start is None:
            scored = out["converged"] != 0
        else:
            scored = out["time"] >= origin + self.start
        if self.score_from is None and scored.any():
            self.score_from = float(out["time"][int(np.argmax(scored))]) - origin
        self.scored.add(out, scored)
        self.learned.add(out, (out["status"] & PRIOR) == 0)
        if "stiffness_true" in extra:
            self.has_truth = True
            truth = extra["stiffness_true"][scored]
            self.score.update(out["stiffness"][scored], out["stiffness_std"][scored], truth)
        for i, score in enumerate(self.part_scores):
            if f"stiffness{i + 1}_true" in extra and "part_stiffness" in (out.dtype.names or ()):
                sigma, std = out["part_stiffness"][scored, i], out["part_stiffness_std"][scored, i]
                score.update(sigma, std, extra[f"stiffness{i + 1}_true"][scored])
        self.last = out[-1].copy()

    def _thin(self) -> None:
        self.every *= 2
        self.kept = [np.concatenate(self.kept)[::2].copy()]
        for name, pieces in self.truth_kept.items():
            self.truth_kept[name] = [np.concatenate(pieces)[::2].copy()]

    def stiffness(self) -> dict[str, float]:
        """final, mean, min, max; the last three over scored samples, else over all with data."""
        chosen = self.scored if self.scored.count else self.learned
        final = float("nan") if self.last is None else float(self.last["stiffness"])
        return {"final": final, **chosen.stiffness()}

    def torque_rms(self) -> float:
        """Root mean square of the fitted elastic torque, N m."""
        chosen = self.scored if self.scored.count else self.learned
        return chosen.torque_rms()


class _Range:
    def __init__(self) -> None:
        self.count = 0
        self.total = 0.0
        self.low = np.inf
        self.high = -np.inf
        self.torque2 = 0.0

    def add(self, out: Records, mask: NDArray[np.bool_]) -> None:
        if not mask.any():
            return
        values = out["stiffness"][mask]
        self.count += values.size
        self.total += float(values.sum())
        self.low = min(self.low, float(values.min()))
        self.high = max(self.high, float(values.max()))
        self.torque2 += float(np.square(out["torque"][mask]).sum())

    def stiffness(self) -> dict[str, float]:
        if not self.count:
            return {"mean": float("nan"), "min": float("nan"), "max": float("nan")}
        return {"mean": self.total / self.count, "min": self.low, "max": self.high}

    def torque_rms(self) -> float:
        return float(np.sqrt(self.torque2 / self.count)) if self.count else float("nan")
