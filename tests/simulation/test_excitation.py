"""Waves: the written-out formulas, band limits, seeds, spectra, files played back."""

import math

import numpy as np
import pytest

from rotatum.errors import LogError, RotatumError
from rotatum.logs.writer import write_table
from rotatum.simulation import After, Chirp, Ramps, Sawtooth, Sines, Square, hold, multisine, sine
from rotatum.simulation.drivers.binary import Prbs
from rotatum.simulation.drivers.combined import Scaled, Together
from rotatum.simulation.drivers.recorded import Recorded, recorded

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


def test_phase_and_offset_shift_a_wave_in_time_and_up():
    for kind in (Sawtooth, Square):
        plain, moved = kind(2.0, 0.25), kind(2.0, 0.25, phase=1.0, offset=0.5)
        ahead = 1.0 / (2 * math.pi * 0.25)
        # off the jumps, which come at multiples of 2 s less the shift
        time = TIME[np.abs((TIME + ahead) % 2.0 - 1.0) < 0.999]
        np.testing.assert_allclose(moved(time), plain(time + ahead) + 0.5, atol=1e-12)
    sweep = Chirp(2.0, 1.0, 9.0, 8.0, offset=0.5)
    np.testing.assert_allclose(sweep(TIME), Chirp(2.0, 1.0, 9.0, 8.0)(TIME) + 0.5, atol=1e-15)
    raised = multisine(rms=1.0, low=1.0, high=5.0, count=9, seed=0, offset=3.0)
    # whole periods of all its sines: the mean is the offset, to rounding
    assert np.mean(raised(TIME)) == pytest.approx(3.0, abs=1e-12)


def test_sums_and_multiples_are_of_any_kind():
    parts = (sine(1.0, 0.5), Square(2.0, 0.3), After(1.0, Sawtooth(1.0, 2.0)), hold(0.5))
    total = Scaled(-2.0, Together(parts))(TIME)
    # 1e-15 of a few N m, in another order
    np.testing.assert_allclose(total, -2.0 * sum(part(TIME) for part in parts), atol=1e-14)


@pytest.mark.parametrize("order", [2, 5, 10])
def test_prbs_is_a_maximum_length_sequence(order):
    length, bit, amplitude = 2**order - 1, 0.02, 3.0
    wave = Prbs(amplitude, bit, seed=4, order=order)
    # sampled on the beats themselves, where 0.06 / 0.02 is 2.9999999999999996
    bits = wave(np.arange(2 * length) * bit)
    np.testing.assert_array_equal(bits[:length], bits[length:])
    assert set(bits) == {-amplitude, amplitude}
    # 2^(n-1) highs and one low less: the balance of a maximum-length sequence
    assert np.sum(bits[:length]) == amplitude
    one = bits[:length]
    correlation = [float(np.mean(one * np.roll(one, lag))) for lag in range(length)]
    # exact but for the rounding of a mean
    expected = [amplitude**2] + [-(amplitude**2) / length] * (length - 1)
    np.testing.assert_allclose(correlation, expected, rtol=1e-12)


def test_prbs_holds_each_bit_for_its_time_on_any_grid():
    wave = Prbs(1.0, 0.1, order=7, offset=0.25)
    for period in (1e-3, 1e-2, 0.05):
        per_bit = round(0.1 / period)
        values = wave(np.arange(100 * per_bit) * period).reshape(100, per_bit)
        assert np.all(values == values[:, :1])
        np.testing.assert_array_equal(values[:, 0], wave(np.arange(100) * 0.1 + 0.05))
    assert set(values[:, 0]) == {-0.75, 1.25}


def test_seeds_of_prbs_start_the_same_sequence_elsewhere():
    length = 2**10 - 1
    beats = np.arange(length) * 0.01
    one, two = (Prbs(1.0, 0.01, seed=seed)(beats) for seed in (0, 1))
    assert not np.array_equal(one, two)
    shifts = np.fft.irfft(np.fft.rfft(one) * np.conj(np.fft.rfft(two)), length)
    assert np.max(shifts) == pytest.approx(length)


def test_recorded_values_are_held_or_joined_and_end_as_told():
    clock, values = np.array([5.0, 5.1, 5.3]), np.array([1.0, 2.0, -2.0])
    time = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.4])
    held = Recorded(clock, values)
    np.testing.assert_array_equal(held(time), [1.0, 1.0, 2.0, 2.0, -2.0, -2.0])
    linear = Recorded(clock, values, between="linear", after="zero")
    # the clock's differences are rounded to 1e-15 s of 5 s, at slopes of 20 per second
    np.testing.assert_allclose(linear(time), [1.0, 1.5, 2.0, 0.0, -2.0, 0.0], atol=1e-13)


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_a_file_is_played_back_as_it_was_written(tmp_path, ending):
    path = tmp_path / f"torques.{ending}"
    torque = multisine(rms=2.0, low=1.0, high=8.0, count=5, seed=3)(TIME)
    write_table(path, {"time": TIME, "arm.tau": torque, "arm.q": 0.0 * TIME})
    played = recorded(path, "arm.tau")
    # a text table has twelve digits
    np.testing.assert_allclose(played(TIME), torque, rtol=1e-11 if ending == "csv" else 0.0)
    # half a step later it is still held
    np.testing.assert_array_equal(played(TIME + 0.5e-3), played(TIME))


def test_files_that_are_no_drive_name_file_and_column(tmp_path):
    path = tmp_path / "torques.csv"
    write_table(path, {"time": TIME, "tau": np.where(TIME == 0.5, np.nan, 1.0), "back": -TIME})
    with pytest.raises(LogError, match=r"torques.csv.*got 'tua'.*Did you mean \"tau\""):
        recorded(path, "tua")
    with pytest.raises(LogError, match=r"torques.csv, columns time and tau: 1 of 10000 .* got 500"):
        recorded(path, "tau")
    with pytest.raises(LogError, match=r"torques.csv, columns back and time: the clock must grow"):
        recorded(path, "time", time="back")
    with pytest.raises(LogError, match=r"unknown word, got 'linaer'.*Did you mean 'linear'"):
        recorded(path, "time", between="linaer")
    with pytest.raises(LogError, match="no such file"):
        recorded(tmp_path / "none.csv", "tau")


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Sines((1.0, 2.0), (1.0,), (0.0,)), "length"),
        (lambda: sine(1.0, math.nan), "sines.frequencies"),
        (lambda: multisine(rms=1.0, low=0.0, high=5.0, count=3, seed=0), "band"),
        (lambda: multisine(rms=1.0, low=6.0, high=5.0, count=3, seed=0), "band"),
        (lambda: multisine(rms=1.0, low=1.0, high=5.0, count=0, seed=0), "count"),
        (lambda: Chirp(1.0, 1.0, 2.0, seconds=0.0), "chirp.seconds"),
        (lambda: Chirp(1.0, 1.0, math.inf, seconds=1.0), "chirp.high"),
        (lambda: Sawtooth(1.0, 0.0), "sawtooth.frequency"),
        (lambda: Square(math.nan, 1.0), "square.amplitude"),
        (lambda: Prbs(1.0, bit=0.0), "prbs.bit"),
        (lambda: Prbs(1.0, bit=0.1, order=1), r"prbs.order.* 2 to 20"),
        (lambda: Scaled(math.nan, hold(0.0)), "scaled.factor"),
        (lambda: Together(()), "sum.of"),
        (lambda: Recorded(np.arange(2.0), np.arange(3.0)), "as many"),
        (lambda: Ramps((0.0, 1.0), (0.1,)), "as many"),
        (lambda: Ramps((), ()), "at least one"),
        (lambda: Ramps((1.0, 1.0), (0.1, 0.2)), "ramps.times"),
    ],
)
def test_impossible_drives_are_refused(make, says):
    with pytest.raises(RotatumError, match=says):
        make()
