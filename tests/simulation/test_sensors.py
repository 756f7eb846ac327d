"""Each fault alone: what it does, that it does nothing else, and that its seed repeats it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.errors import RotatumError
from rotatum.simulation.drivers.drives import Inputs
from rotatum.simulation.drivers.waves import multisine
from rotatum.simulation.plant.bodies import Body, Plant
from rotatum.simulation.plant.run import run_plant
from rotatum.simulation.sensing.faults import quantise, readings
from rotatum.simulation.sensing.rows import logged_rows
from rotatum.simulation.sensing.sensors import LOGGED, Sensors
from rotatum.simulation.sensing.trajectory import trajectory
from tests.simulation.plants import spring

PERIOD = 1e-3
SPRING = spring("cubic", stiffness=200.0, cubic=1500.0, damping=0.05)
PLANT = Plant("elbow", "series", Body(0.8, 1.0, 0.1), (Body(0.256, 0.32, 0.8),), (SPRING,), 15.0)
TIME = np.arange(1500) * PERIOD
ROLES = (*LOGGED["series"], "tau_ext")


def _move(time, tau, substeps=None):
    nothing = np.zeros_like(time)
    inputs = Inputs(time, tau[:, np.newaxis], nothing, nothing, nothing)
    return trajectory(PLANT, inputs, run_plant(PLANT, inputs, substeps=substeps).at)


TRAJECTORY = _move(TIME, multisine(rms=6.0, low=0.5, high=10.0, count=10, seed=0)(TIME))
TRUE = {**TRAJECTORY.position, **TRAJECTORY.held}


def _read(sensors, seed=0, counts=None):
    return readings(TRAJECTORY, sensors, roles=ROLES, counts=counts or {}, seed=seed)


IDEAL = _read(Sensors())


def _differing(channels):
    pairs = ((role, channels[role], IDEAL[role]) for role in ROLES)
    return {role for role, x, ideal in pairs if not np.array_equal(x, ideal, equal_nan=True)}


def test_without_faults_the_truth_is_read():
    assert not _differing(
        {role: TRUE[role] for role in ROLES[:3]}
        | {"torque_measured": IDEAL["torque_measured"], "tau_ext": np.zeros_like(TIME)}
    )
    phi = TRUE["q"] - TRUE["theta"]
    rate = TRAJECTORY.velocity["q"] - TRAJECTORY.velocity["theta"]
    transmitted = 200.0 * phi + 1500.0 * phi**3 + 0.05 * rate
    # rounding of sums of 30 N m
    np.testing.assert_allclose(IDEAL["torque_measured"], transmitted, atol=1e-13)


@given(
    st.lists(st.floats(-1e3, 1e3, allow_nan=False), min_size=1, max_size=20),
    st.integers(4, 1 << 20),
)
def test_quantisation_is_at_most_half_a_count_off_and_on_the_grid(angles, counts):
    x = np.array(angles)
    step = 2 * math.pi / counts
    read = quantise(x, counts)
    # rounding of angles up to 1e3 rad: 1e-12
    assert np.all(np.abs(read - x) <= step / 2 + 1e-12)
    np.testing.assert_allclose(read / step, np.round(read / step), atol=1e-6)


def test_quantisation_error_is_uniform_over_a_count():
    read = _read(Sensors(), counts={"theta": 4096})
    assert _differing(read) == {"theta"}
    step = 2 * math.pi / 4096
    error = read["theta"] - IDEAL["theta"]
    # a tenth: the motion crosses hundreds of counts, so the phase within a count is well spread
    assert np.std(error) == pytest.approx(step / math.sqrt(12), rel=0.1)


def test_noise_is_white_with_its_std_on_its_channel():
    read = _read(Sensors(noise={"tau": 0.2}))
    assert _differing(read) == {"tau"}
    noise = read["tau"] - IDEAL["tau"]
    # three standard deviations: of a std from 1500 samples 5.5 %, of mean and correlation 1 / 13
    assert np.std(noise) == pytest.approx(0.2, rel=0.055)
    assert abs(np.mean(noise)) < 0.2 / 13
    assert abs(np.mean(noise[1:] * noise[:-1])) < 0.2**2 / 13


def test_noise_comes_before_the_counts():
    read = _read(Sensors(noise={"q": 1e-4}), counts={"q": 4096})["q"]
    step = 2 * math.pi / 4096
    np.testing.assert_allclose(read / step, np.round(read / step), atol=1e-9)


def test_whole_delays_shift_the_channel():
    read = _read(Sensors(delay={"theta": 3 * PERIOD, "tau": 2 * PERIOD}))
    assert _differing(read) == {"theta", "tau"}
    np.testing.assert_array_equal(read["theta"][3:], TRUE["theta"][:-3])
    np.testing.assert_array_equal(read["theta"][:3], TRUE["theta"][0])
    np.testing.assert_array_equal(read["tau"][2:], TRUE["tau"][:-2])
    np.testing.assert_array_equal(read["tau"][:2], 0.0)


@pytest.mark.parametrize("quarters", [1, 2, 3, 5])
def test_fractional_delays_read_the_motion_between_the_samples(quarters):
    # the same motion on a clock four times as fast, under the same held torques
    fine_time = np.arange(4 * TIME.size) * PERIOD / 4
    fine = _move(fine_time, np.repeat(TRUE["tau"], 4), substeps=3)
    read = _read(Sensors(delay={"q": quarters * PERIOD / 4, "torque_measured": PERIOD / 2}))
    whole = 4 * np.arange(2, TIME.size)
    # h^4 / 384 q'''' = 1e-9 rad with 1e5 rad/s^4 where friction turns; the steps differ by 1e-7
    np.testing.assert_allclose(read["q"][2:], fine.position["q"][whole - quarters], atol=2e-7)
    phi = (fine.position["q"] - fine.position["theta"])[whole - 2]
    rate = (fine.velocity["q"] - fine.velocity["theta"])[whole - 2]
    torque = 200.0 * phi + 1500.0 * phi**3 + 0.05 * rate
    # 300 N m/rad times 2e-7 rad, and 0.05 N m s/rad times the slope's error
    np.testing.assert_allclose(read["torque_measured"][2:], torque, atol=1e-4)


def test_a_held_command_delayed_by_half_a_sample_is_the_last_one():
    read = _read(Sensors(delay={"tau": PERIOD / 2}))
    np.testing.assert_array_equal(read["tau"][1:], TRUE["tau"][:-1])


def test_the_zero_of_the_deflection_is_off_by_the_offset():
    read = _read(Sensors(deflection_zero=0.01))
    assert _differing(read) == {"theta"}
    offset = (read["q"] - read["theta"]) - (IDEAL["q"] - IDEAL["theta"])
    np.testing.assert_allclose(offset, 0.01, atol=1e-15)  # rounding


def test_stale_samples_show_the_one_before_on_every_channel():
    read = _read(Sensors(stale=40))
    changed = np.flatnonzero(read["q"] != IDEAL["q"])
    assert changed.size == 40
    for role in ROLES[:4]:
        np.testing.assert_array_equal(read[role][changed], read[role][changed - 1])


def test_nan_runs_have_their_number_and_length():
    read = _read(Sensors(nans=6, nan_rows=7))
    lost = np.array([np.isnan(read[role]) for role in ROLES])
    assert lost.sum() == 42
    assert lost.any(axis=0).sum() == 42  # one channel at a time
    assert not lost[:, 0].any()
    for role in ROLES:
        kept = ~np.isnan(read[role])
        np.testing.assert_array_equal(read[role][kept], IDEAL[role][kept])


def test_no_fault_touches_the_first_sample():
    # runs of 10 in 21 samples: both slots are taken, and sample 0 is in neither
    rows = logged_rows(21, Sensors(dropouts=2, dropout_rows=10), seed=0)
    np.testing.assert_array_equal(rows, [0])


def test_dropouts_and_repeats_change_rows_only():
    rows = logged_rows(1500, Sensors(dropouts=4, dropout_rows=10), seed=0)
    assert rows.size == 1460
    assert np.all(np.diff(rows) >= 1)
    assert set(np.diff(rows)) <= {1, 11, 21, 31, 41}
    rows = logged_rows(1500, Sensors(repeats=25), seed=0)
    assert rows.size == 1525
    assert np.count_nonzero(np.diff(rows) == 0) == 25


FAULTY = {
    "noise": {"q": 1e-4, "theta": 1e-4, "tau": 0.1, "torque_measured": 0.1},
    "stale": 10,
    "nans": 5,
    "repeats": 5,
    "dropouts": 5,
}


@pytest.mark.parametrize("fault", FAULTY)
def test_every_fault_repeats_with_its_seed_and_differs_without(fault):
    sensors = Sensors(**{fault: FAULTY[fault]})
    runs = [(_read(sensors, s), logged_rows(1500, sensors, seed=s)) for s in (3, 3, 4)]
    for role in ROLES:
        np.testing.assert_array_equal(runs[0][0][role], runs[1][0][role])
    np.testing.assert_array_equal(runs[0][1], runs[1][1])
    assert any(
        not np.array_equal(one, other, equal_nan=True)
        for one, other in zip(_columns(runs[0]), _columns(runs[2]), strict=True)
    )


def _columns(run):
    channels, rows = run
    return [*channels.values(), rows]


def test_one_fault_does_not_move_another():
    alone = _read(Sensors(noise={"tau": 0.1}))["tau"]
    among = _read(Sensors(noise={"q": 1e-3, "tau": 0.1}, nans=5))["tau"]
    both = ~np.isnan(among)
    np.testing.assert_array_equal(alone[both], among[both])


def test_no_fault_draws_the_same_numbers_as_another_or_as_an_excitation():
    noise = _read(Sensors(noise=dict.fromkeys(ROLES, 1.0)))
    drawn = [noise[role] - IDEAL[role] for role in ROLES]
    drawn.append(np.random.default_rng(0).standard_normal(TIME.size))
    correlation = np.corrcoef(drawn) - np.eye(len(drawn))
    # four standard deviations of a correlation of 1500 independent pairs
    assert np.max(np.abs(correlation)) < 4 / math.sqrt(1500)


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"delay": {"thets": 1e-3}}, "theta"),
        ({"delay": {"theta": -1e-3}}, "delay.theta"),
        ({"noise": {"tau": math.nan}}, "noise.tau"),
        ({"counts": {"tau": 100}}, "counts"),
        ({"counts": {"q": 0.0}}, "counts.q"),
        ({"deflection_zero": math.inf}, "deflection_zero"),
        ({"stale": -1}, "stale"),
        ({"dropout_rows": 0}, "dropout_rows"),
    ],
)
def test_impossible_sensors_are_refused_by_name(settings, match):
    with pytest.raises(RotatumError, match=match):
        Sensors(**settings)


def test_more_faults_than_samples_are_refused():
    with pytest.raises(RotatumError, match="do not fit"):
        logged_rows(100, Sensors(dropouts=20, dropout_rows=5), seed=0)
