"""What a log says of its signals: noise beneath a motion, and how wide an operator may be."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.measured import ACCELERATION, VELOCITY
from rotatum.evaluation.noise import (
    ENOUGH,
    HIGHEST,
    LOWEST,
    SMALL,
    highest_cutoff,
    measure,
    measured_noise,
    position_noise,
)
from rotatum.models import device_from_tables

T = 1e-3


def white(seed: int, size: int, std: float) -> np.ndarray:
    return std * np.random.default_rng(seed).standard_normal(size)


@pytest.mark.parametrize("std", [1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("moving", [False, True])
def test_white_noise_is_found_whatever_moves_beneath_it(std: float, moving: bool) -> None:
    t = T * np.arange(20_000)
    # 60 rad/s through sixth differences is (w T)^6 = 5e-8 rad: a thousandth of the smallest.
    motion = 0.5 * np.sin(60.0 * t) if moving else 0.0 * t
    found = position_noise(motion + white(500, len(t), std))
    # A median of independent sizes is good to 0.8 / sqrt(n) of the deviation; sixth differences
    # are correlated over six samples, which makes it sqrt(2) to 2 times as much: 1 %. Three of it.
    assert found == pytest.approx(std, rel=0.03)


@pytest.mark.parametrize("speed", [1.0, 10.0, 60.0])
def test_smooth_motion_gives_almost_nothing(speed: float) -> None:
    t = T * np.arange(5000)
    found = position_noise(np.sin(speed * t))
    # Sines of size 1 shrink to (w T)^6; rounding of 1e-16 is what is left at low speed.
    assert found < (speed * T) ** 6 / np.sqrt(924.0) + 2e-16
    # A polynomial of the fifth degree has no sixth difference at all.
    assert position_noise(np.polynomial.Polynomial([1.0, 2, 3, 4, 5, 6])(t / 5.0)) < 1e-14


def test_of_two_motors_the_noisier_counts_and_what_is_not_logged_is_0() -> None:
    motor = {"inertia": 1e-4}
    device = device_from_tables(
        {
            "name": "arm",
            "joint": [
                {"name": "pair", "actuation": "antagonistic", "motor": [motor, motor]},
                {"name": "one", "motor": motor},
            ],
        },
        "test",
    )
    q, first, second = (white(503 + k, 20_000, std) for k, std in enumerate((1e-4, 1e-5, 3e-4)))
    found = measured_noise(
        {"pair": {"q": q, "theta1": first, "theta2": second}, "one": {"theta": first}}, device
    )
    assert found["pair"] == pytest.approx((1e-4, 3e-4), rel=0.03)
    assert found["one"] == pytest.approx((0.0, 1e-5), rel=0.03)


# --- how wide an operator may be ------------------------------------------------------------------


def smoothed(x: np.ndarray, cutoff: float) -> np.ndarray:
    """Two poles, sample by sample, without their start."""
    a, first, second = np.exp(-cutoff * T), 0.0, 0.0
    found = np.empty_like(x)
    for k, value in enumerate(x.tolist()):
        first = a * first + (1.0 - a) * value
        second = a * second + (1.0 - a) * first
        found[k] = second
    return found[2000:]


@pytest.mark.parametrize("order", [1, 2])
def test_the_cutoff_is_the_highest_at_which_noise_is_a_twentieth(order: int) -> None:
    t, std = T * np.arange(40_000), 2e-4 if order == 1 else 4e-5
    motion, noise = 0.02 * np.sin(12.0 * t), white(510, len(t), std)
    cutoff = highest_cutoff(motion + noise, std, order, T)
    assert LOWEST < cutoff < HIGHEST
    bends = {1: [0.5 / T, 0.0, -0.5 / T], 2: [1.0 / T**2, -2.0 / T**2, 1.0 / T**2]}[order]
    ratios = []
    for width in (cutoff, cutoff / 0.8):
        of_noise, of_motion = (
            smoothed(np.convolve(x, bends, "valid"), width).std() for x in (noise, motion)
        )
        ratios.append(of_noise / of_motion)
    # 38,000 samples of noise, correlated over fifty: its size is known to 2.6 %. Three of it.
    assert ratios[0] < 1.08 * SMALL
    assert ratios[1] > SMALL / 1.08


@pytest.mark.parametrize(("std", "cutoff"), [(0.0, HIGHEST), (1e-9, HIGHEST), (1.0, LOWEST)])
def test_the_cutoff_ends_where_it_must(std: float, cutoff: float) -> None:
    position = np.sin(12.0 * T * np.arange(5000))
    assert highest_cutoff(position + white(511, 5000, std), std, 2, T) == cutoff
    assert highest_cutoff(position[: ENOUGH - 1], 1.0, 2, T) == HIGHEST  # too short to say
    assert highest_cutoff(position, 0.0, 2, 0.01) == 50.0  # half the sample rate


def test_every_position_of_a_joint_is_measured_and_the_worse_motor_decides() -> None:
    motor = {"inertia": 1e-4}
    tables = {"name": "pair", "actuation": "antagonistic", "motor": [motor, motor]}
    device = device_from_tables({"name": "arm", "joint": [tables]}, "test")
    t = T * np.arange(20_000)
    motion = 0.02 * np.sin(12.0 * t)
    stds = {"q": 1e-9, "theta1": 3e-5, "theta2": 1e-9}
    logged = {role: motion + white(512 + k, len(t), s) for k, (role, s) in enumerate(stds.items())}
    found = measure({"pair": logged}, device, T)["pair"]
    assert found.motor == pytest.approx(3e-5, rel=0.03)
    assert found.cutoffs["link", VELOCITY] == found.cutoffs["link", ACCELERATION] == HIGHEST
    noisy = highest_cutoff(logged["theta1"], found.motor, 2, T)
    # Both motors are judged by the larger noise, which only the first one has.
    assert found.cutoffs["motor", ACCELERATION] == pytest.approx(noisy, rel=0.3)
    assert noisy < found.cutoffs["motor", VELOCITY]
