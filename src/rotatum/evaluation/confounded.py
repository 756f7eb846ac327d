"""Which fitted quantities the data cannot tell apart, from the solver's information matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.estimators.tuning import Prepared

Array = NDArray[np.float64]

NOTHING = 0.5
"""Share of a direction's information that noise and prior may be before the data say nothing."""

INVOLVED = 0.2
"""Share of the largest column in a direction from which another one is named with it."""

ENTANGLED = 0.95
"""Correlation with the stiffness from which a quantity is named as the reason it is starved."""

STIFFNESS = "stiffness"


def covariance_of(solver: Any) -> Array:
    """Return P over the rows' variance, (p, p), of a solver's state in either form."""
    if "U" in solver.dtype.names:
        U = np.asarray(solver["U"])
        factored: Array = U @ np.diag(solver["d"]) @ U.T
        return factored
    upper = np.triu(solver["P"])
    whole: Array = upper + np.triu(upper, 1).T
    return whole


def null_directions(P: Array, noise: Array, spread: Array, rows: float) -> list[Array]:
    """Return directions of the coefficients in which the data tell nothing.

    The information is ``A = P^-1``; noise of variance v in each column and the prior contribute
    ``N = n diag(v) + diag(1 / P(0))`` to it, whatever the truth. A direction w with
    ``w^T N w >= w^T A w / 2`` is one of which the data say nothing: the eigenvectors of
    ``N^1/2 P N^1/2`` above a half.

    Args:
        P: (p, p) over the rows' variance.
        noise: (p,) variance of noise in each column.
        spread: (p,) prior variance over the rows' variance.
        rows: n.

    Returns:
        (p,) each, in units of what the columns do to a row: 1 is a column's own size.
    """
    half = np.sqrt(rows * noise + 1.0 / spread)
    shares, vectors = np.linalg.eigh(half[:, None] * P * half[None, :])
    information = np.linalg.pinv(P, hermitian=True)
    size = np.sqrt(np.maximum(np.diag(information), 0.0))
    found = []
    for share, vector in zip(shares, vectors.T, strict=True):
        if share >= NOTHING:
            found.append((P @ (half * vector)) * size)
    return found


def confounded(
    prepared: Prepared, part: Any, state: Any, starved: bool = False
) -> list[tuple[str, ...]]:
    """Return groups of names that the data cannot tell apart; a group of one drowns in noise.

    Args:
        prepared: the joint's columns.
        part: parameter record of a transmission with rows of its own.
        state: its state record.
        starved: whether the stiffness is: then what it is entangled with is named as well.
    """
    evidence = part["evidence"]
    names = _names(prepared, len(evidence["noise"]))
    P = covariance_of(state["solver"])
    if not np.all(np.isfinite(P)):
        return []
    found = []
    for direction in null_directions(
        P,
        np.asarray(evidence["noise"]),
        np.asarray(evidence["spread"]),
        float(state["evidence"]["rows"]),
    ):
        size = np.abs(direction)
        involved = size >= INVOLVED * size.max()
        group = tuple(dict.fromkeys(n for n, told in zip(names, involved, strict=True) if told))
        # A law's own orders are told apart by shrinking; here only what is no spring counts.
        if group != (STIFFNESS,) and group not in found:
            found.append(group)
    if starved and not any(STIFFNESS in group for group in found):
        mixed = entangled(P, np.asarray(state["row"]["D"]))
        group = tuple(n for n, told in zip(prepared.settings.fit, mixed, strict=False) if told)
        found += [(*group, STIFFNESS)] if group else []
    return found


def entangled(P: Array, read: Array) -> NDArray[np.bool_]:
    """Return which coefficients' errors go with the read-out's, ``ENTANGLED`` or closer.

    The correlation of ``D^T alpha`` with ``alpha_j`` is ``(P D)_j / sqrt(D^T P D P_jj)``.

    Args:
        P: (p, p) over the rows' variance.
        read: (p,) D.
    """
    together = P @ read
    scale = np.sqrt(max(float(read @ together), 0.0) * np.maximum(np.diag(P), 0.0))
    return np.abs(together) >= ENTANGLED * np.where(scale > 0.0, scale, np.inf)


def _names(prepared: Prepared, columns: int) -> list[str]:
    fitted = list(prepared.settings.fit)
    terms = [STIFFNESS] * (columns - len(fitted))
    if prepared.powers and sum(prepared.powers[0]) == 0:
        terms[0] = "offset"
    return fitted + terms
