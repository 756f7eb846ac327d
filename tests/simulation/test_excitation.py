"""Drives: the written-out formulas, band limits, seeds."""

import math

import numpy as np
import pytest

from rotatum.errors import RotatumError
from rotatum.simulation import Chirp, Ramps, Sawtooth, Sines, Square, hold, multisine, sine

TIME = np.arange(0.0, 10.0, 1e-3)


def test_sine_is_the_formula():
    expected = [3.0 * math.sin(2 * math.pi * 0.7 * t + 0.2) for t in TIME]
    # 1e-12: numpy's and libm's sine of the same argument
    np.testing.assert_allclose(sine(3.0, 0.7, 0.2)(TIME), expected, atol=1e-12)


def test_sines_add_up():
    both = sine(3.0, 0.7) + sine(1.0, 2.0, 0.5)
    assert both == Sines((3.0, 1.0), (0.7, 2.0), (0.0, 0.5))
    np.testing.assert_array_equal(both(TIME), sine(3.0, 0.7)(TIME) + sine(1.0, 2.0, 0.5)(TIME))


def test_multisine_has_its_rms_and_stays_in_its_band():
    # all frequencies are multiples of 0.5 Hz, so ten seconds hold whole periods of each
    torque = multisine(rms=4.0, low=0.5, high=10.0, count=20, seed=1)(TIME)
    assert np.sqrt(np.mean(torque**2)) == pytest.approx(4.0, rel=1e-12)
    spectrum = np.abs(np.fft.rfft(torque)) * 2 / TIME.size
    lines = 5 * np.arange(1, 21)
    np.testing.assert_allclose(spectrum[lines], 4.0 * math.sqrt(2 / 20), rtol=1e-10)
    # 1e-10 N m: rounding of a transform of 10,000 samples
    assert np.max(np.delete(spectrum, lines)) < 1e-10


def test_seeds_are_reproducible_and_differ():
    made = [multisine(rms=1.0, low=1.0, high=5.0, count=8, seed=s) for s in (0, 0, 1)]
    assert made[0] == made[1]
    assert made[0].phases != made[2].phases


def test_chirp_runs_through_its_frequencies_and_then_stays():
    chirp = Chirp(2.0, low=1.0, high=9.0, seconds=8.0)
    fine = np.arange(0.0, 10.0, 1e-5)
    torque = chirp(fine)
    rises = fine[1:][(torque[:-1] < 0.0) & (torque[1:] >= 0.0)]
    middle, frequency = (rises[1:] + rises[:-1]) / 2, 1.0 / np.diff(rises)
    expected = np.minimum(1.0 + middle, 9.0)
    # 2 %: a period's mean frequency is not that of its middle while the slope is 1 Hz/s
    np.testing.assert_allclose(frequency[2:], expected[2:], rtol=0.02)
    assert np.max(np.abs(torque)) == pytest.approx(2.0, rel=1e-6)
    # no jump where the sweep ends: one step is at most A w dt
    assert np.max(np.abs(np.diff(torque))) <= 2.0 * 2 * math.pi * 9.0 * 1e-5 * 1.001


def test_sawtooth_is_the_series_of_its_sines():
    # off its jumps, where a series of 20,000 sines is right to A / (20,000 pi sin(pi x))
    time = np.array([0.0, 1.3, 4.9, 5.1, 8.0, 12.7])
    order = np.arange(1, 20_001)[:, np.newaxis]
    series = (
        -2 / np.pi * np.sum((-1.0) ** order / order * np.sin(order * 0.2 * np.pi * time), axis=0)
    )
    np.testing.assert_allclose(Sawtooth(50.0, 0.1)(time), 50.0 * series, atol=0.05)
    assert np.max(Sawtooth(50.0, 0.1)(TIME)) == pytest.approx(50.0, rel=1e-3)


def test_square_is_the_sign_of_its_sine():
    # half a step off the grid: between two samples lies every change of sign
    time = TIME + 0.5e-3
    np.testing.assert_array_equal(Square(10.0, 0.3)(time), 10.0 * np.sign(sine(1.0, 0.3)(time)))


def test_ramps_go_smoothly_through_their_points_and_hold_where_two_are_equal():
    path = Ramps((1.0, 3.0, 5.0, 6.0), (0.10, 0.08, 0.08, 0.12))
    np.testing.assert_allclose(
        path([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.5, 6.0, 9.0]),
        [0.10, 0.10, 0.09, 0.08, 0.08, 0.08, 0.10, 0.12, 0.12],
        rtol=1e-14,
    )
    fine = np.arange(0.0, 8.0, 1e-3)
    velocity = np.gradient(path(fine), 1e-3)
    # the steepest slope of the quintic is 15/8 of the mean one, 0.04 per second
    assert np.max(velocity) == pytest.approx(0.04 * 15 / 8, rel=1e-5)
    # no jump of velocity or acceleration: the steepest change is 5.774 per second squared of 0.04
    assert np.max(np.abs(np.diff(velocity))) < 5.78 * 0.04 * 1e-3
    assert np.all(hold(0.3)(fine) == 0.3)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Sines((1.0, 2.0), (1.0,), (0.0,)),
        lambda: multisine(rms=1.0, low=0.0, high=5.0, count=3, seed=0),
        lambda: multisine(rms=1.0, low=6.0, high=5.0, count=3, seed=0),
        lambda: multisine(rms=1.0, low=1.0, high=5.0, count=0, seed=0),
        lambda: Chirp(1.0, 1.0, 2.0, seconds=0.0),
        lambda: Ramps((0.0, 1.0), (0.1,)),
        lambda: Ramps((), ()),
        lambda: Ramps((1.0, 1.0), (0.1, 0.2)),
    ],
)
def test_impossible_drives_are_refused(make):
    with pytest.raises(RotatumError):
        make()
