"""How noisy positions are, measured on noise that is known."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.evaluation.noise import position_noise

N = 10_000
T = 1e-3
COUNT = 2.0 * np.pi / 4059.0


def motion(speed: float) -> np.ndarray:
    """A swing at 1 Hz on top of a turn at some speed, rad."""
    t = T * np.arange(N)
    return speed * t + np.sin(2.0 * np.pi * t)


@pytest.mark.parametrize("std", [1e-9, 1e-5, 1e-2])
def test_white_noise_on_a_motion(std: float) -> None:
    rng = np.random.default_rng(5)
    found = position_noise(motion(0.0) + std * rng.standard_normal(N))
    # 10^4 sixth differences, some 3000 of them independent: one per cent and a half.
    assert found == pytest.approx(std, rel=0.05)


@pytest.mark.parametrize("speed", [0.0, 1.0, 3.0])
def test_counts_are_a_box_as_wide_as_one(speed: float) -> None:
    rounded = COUNT * np.round(motion(speed) / COUNT)
    # Not white where about a count is moved in a sample, and 0 at the turns: 0.88 to 1.01 of it.
    # More than there is makes a right model look wrong; less does not matter, counts are known.
    assert 0.85 <= position_noise(rounded) / (COUNT / np.sqrt(12.0)) <= 1.05


def test_jumps_and_gaps_are_no_noise() -> None:
    rng = np.random.default_rng(6)
    position = motion(0.0) + 1e-4 * rng.standard_normal(N)
    position[4000:] += 1.0
    position[::500] = np.nan
    assert position_noise(position) == pytest.approx(1e-4, rel=0.05)


def test_rare_steps_and_short_logs_tell_nothing() -> None:
    slow = COUNT * np.round(0.01 * T * np.arange(N) / COUNT)
    assert position_noise(slow) == 0.0
    assert position_noise(np.zeros(100)) == 0.0
