"""Recursive least squares over long runs and at bad conditioning, compiled."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.runtime.bank import Bank
from tests import naive
from tests.kernels.make import solver_stage

BOTH = pytest.mark.parametrize("form", ["ud", "covariance"])


def run(form, R, y, *, spread, variance=1.0, forgetting=1.0):
    stage = solver_stage(form, R.shape[1])
    params = stage.params.zeros(1)
    params["variance"], params["forgetting"], params["spread"] = variance, forgetting, spread
    bank = Bank(stage, params)
    u = stage.input.zeros(len(y), 1)
    u["R"][:, 0], u["y"][:, 0] = R, y
    return bank.run(u)[:, 0], bank


@BOTH
def test_covariance_stays_bounded_without_excitation(form):
    # 1e5 rows at forgetting 0.999 without a new prior: P grows by e^100.
    R = np.zeros((100_000, 2))
    R[:2000] = np.random.default_rng(30).standard_normal((2000, 2))
    y = R @ [3.0, -1.0]
    out, _ = run(form, R, y, spread=1e4, forgetting=0.999)
    # Information of a column swings between lambda^(p-1) and 1 of its prior as its turn comes.
    assert out["largest"][-1] == pytest.approx(1e4, rel=2e-3)
    assert out["largest"].max() <= 1e4 * 1.001
    assert np.isfinite(out["alpha"]).all()
    # What is no longer excited goes back to what was believed before, and not anywhere else.
    assert np.abs(out["alpha"][-1]).max() < 1e-6


@BOTH
def test_tracks_a_jump_within_its_memory(form):
    rng = np.random.default_rng(31)
    R = rng.standard_normal((4000, 2))
    truth = np.where(np.arange(4000)[:, None] < 2000, [2.0, 1.0], [5.0, -1.0])
    y = (R * truth).sum(axis=1)
    out, _ = run(form, R, y, spread=1e6, forgetting=0.99)
    # exp(-n (1 - lambda)) of the jump is left after n rows: 4 in alpha, four parts in 1e5 of it
    # after 1000.
    assert np.abs(out["alpha"][2999] - [5.0, -1.0]).max() < 4.0 * 1e-4
    assert np.abs(out["alpha"][2100] - [5.0, -1.0]).max() > 0.1
    kept, _ = run(form, R, y, spread=1e6)
    assert np.abs(kept["alpha"][-1] - [5.0, -1.0]).max() > 1.0  # without forgetting: the mean


def awas_rows(n=20_000):
    """18 monomials phi^i s^j, i odd to 11, j to 2, in the paper's units: |phi| up to 0.005 rad."""
    t = np.arange(n) * 1e-3
    phi = 0.005 * np.sin(2.0 * np.pi * 0.7 * t)
    lever = 80.0 + 20.0 * np.sin(2.0 * np.pi * 0.05 * t)  # mm, as the paper's settings need
    rows = [phi ** (2 * i + 1) * lever**j for i in range(6) for j in range(3)]
    return np.stack(rows, axis=1), phi * lever**2 * 0.028


def test_ud_form_stays_positive_definite_where_the_printed_form_does_not():
    R, y = awas_rows()
    out, bank = run("ud", R, y, spread=1e20, variance=1e20)
    assert (out["smallest"] > 0.0).all()
    assert np.isfinite(out["alpha"]).all()
    assert (bank.state["d"] > 0.0).all()
    # The outer product of eq. 23 as printed, on the same rows, same settings: P0 c = 1.
    P = naive.covariance_as_printed(R[:5000], np.eye(18))
    assert np.abs(P - P.T).max() > 0.0
    wide = naive.covariance_as_printed(R[:5000], 1e20 * np.eye(18))
    assert np.linalg.eigvalsh(0.5 * (wide + wide.T)).min() < 0.0


def test_ud_form_predicts_the_torque_at_this_conditioning():
    R, y = awas_rows()
    out, _ = run("ud", R, y, spread=1e20, variance=1e20)
    fit = (R * out["alpha"]).sum(axis=1)
    # lever^2 phi is one of the columns, the prior variance 1 against rows of up to 50: 1e-3 of
    # the torque after the first of fourteen periods.
    assert np.abs(fit - y)[2000:].max() < 1e-3 * np.abs(y).max()


def test_one_triangle_of_the_covariance_form_keeps_its_variances():
    # What the printed outer product loses, the same recursion on one triangle keeps, on rows that
    # are not as hard: forgetting 0.999 for 60 s at 1 kHz, a basis of normalised powers.
    t = np.arange(60_000) * 1e-3
    x = np.sin(2.0 * np.pi * 0.7 * t)
    R = np.stack([x, x**3], axis=1)
    out, _ = run("covariance", R, R @ [4.0, 2.0], spread=1e8, forgetting=0.999)
    assert (out["smallest"] > 0.0).all()
    # Noise-free: only the prior (1e-8 of a row) and rounding are between estimate and truth.
    assert np.abs(out["alpha"][-1] - [4.0, 2.0]).max() < 1e-6
