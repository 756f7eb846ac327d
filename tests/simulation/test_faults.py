"""Faults of sensors against their closed forms, on a motion known at every instant."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.errors import RotatumError
from rotatum.simulation.sensing.faults import readings, wrapped
from rotatum.simulation.sensing.rows import Rows, lateness
from rotatum.simulation.sensing.sensors import LOGGED, Sensors
from rotatum.simulation.sensing.streams import STREAMS, stream
from tests.simulation.moving import SWINGS, angle, speed, swinging, torque
from tests.simulation.plants import JOINT, PERIOD

MOTION = swinging()
TIME = MOTION.time
ROLES = LOGGED["series"]


def _read(sensors, *, seed=0, counts=None, number=0, every=1):
    return readings(
        MOTION, sensors, roles=ROLES, counts=counts or {}, seed=seed, number=number, every=every
    )


IDEAL = _read(Sensors())


def _differing(read):
    return {role for role in ROLES if not np.array_equal(read[role], IDEAL[role], equal_nan=True)}


def test_gain_and_offset_are_a_straight_line():
    read = _read(Sensors(gain={"tau": 1.4, "q": -1.0}, offset={"tau": 0.3, "theta": -0.2}))
    assert _differing(read) == {"tau", "q", "theta"}
    np.testing.assert_array_equal(read["tau"], 1.4 * IDEAL["tau"] + 0.3)
    np.testing.assert_array_equal(read["q"], -IDEAL["q"])
    np.testing.assert_array_equal(read["theta"], IDEAL["theta"] - 0.2)


@pytest.mark.parametrize(("turns", "given"), [(1.0, {}), (80.0, {"theta": 80.0})])
def test_eccentricity_is_one_sine_of_the_angle(turns, given):
    sensors = Sensors(eccentricity={"theta": 2e-3}, eccentricity_turns=given)
    read = _read(sensors)
    assert _differing(read) == {"theta"}
    x = IDEAL["theta"]
    waves = np.column_stack([np.sin(turns * x), np.cos(turns * x)])
    found, *_ = np.linalg.lstsq(waves, read["theta"] - x, rcond=None)
    # rounding of angles of a radian, times 80
    np.testing.assert_allclose(waves @ found, read["theta"] - x, atol=1e-13)
    assert math.hypot(*found) == pytest.approx(2e-3, rel=1e-9)
    other, *_ = np.linalg.lstsq(waves, _read(sensors, seed=1)["theta"] - x, rcond=None)
    assert math.hypot(*(other - found)) > 1e-5  # another phase


def test_eccentricity_looks_at_the_disc_not_at_the_zero_of_the_deflection():
    with_zero = _read(Sensors(eccentricity={"theta": 2e-3}, deflection_zero=0.1))["theta"]
    without = _read(Sensors(eccentricity={"theta": 2e-3}))["theta"]
    np.testing.assert_allclose(without - with_zero, 0.1, atol=1e-15)


def test_saturation_clips_what_noise_and_gain_made():
    read = _read(Sensors(gain={"torque_measured": 2.0}, saturation={"torque_measured": 15.0}))
    clipped = np.clip(2.0 * IDEAL["torque_measured"], -15.0, 15.0)
    np.testing.assert_array_equal(read["torque_measured"], clipped)
    assert np.count_nonzero(np.abs(read["torque_measured"]) == 15.0) > 100
    noisy = _read(Sensors(noise={"tau": 3.0}, saturation={"tau": 500.0}))["tau"]
    assert np.max(noisy) == 500.0


@given(
    st.lists(st.integers(-(10**6), 10**6), min_size=1, max_size=30),
    st.integers(8, 65536),
    st.sampled_from([0.5, 1.0, 2.0]),
)
def test_wrapped_counts_stay_counts_below_the_turn(counts, per_turn, turns):
    step = 2.0 * math.pi / per_turn
    wrap = turns * 2.0 * math.pi
    shown = wrapped(step * np.array(counts), wrap)
    assert np.all((shown >= 0.0) & (shown < wrap))
    whole = np.mod(np.array(counts), turns * per_turn)
    # rounding of 1e6 counts of up to 0.8 rad
    np.testing.assert_allclose(shown, step * whole, atol=1e-9)


def test_a_wrapped_encoder_unwraps_to_its_counts():
    counts = {"q": 4096.0}
    read = _read(Sensors(wrap={"q": 0.25}), counts=counts)
    plain = _read(Sensors(), counts=counts)["q"]
    assert _differing(read) == {"q"}
    again = np.unwrap(read["q"], period=0.25)
    np.testing.assert_allclose(again - again[0], plain - plain[0], atol=1e-12)
    assert np.max(read["q"]) < 0.25
    assert np.min(read["q"]) >= 0.0


def test_a_stuck_sensor_shows_its_last_value_for_its_time():
    read = _read(Sensors(stuck={"q": (0.5, 0.25), "tau": (1.9, 10.0), "theta": (0.0, 0.01)}))
    assert _differing(read) == {"q", "tau", "theta"}
    np.testing.assert_array_equal(read["q"][500:750], IDEAL["q"][499])
    np.testing.assert_array_equal(read["q"][:500], IDEAL["q"][:500])
    np.testing.assert_array_equal(read["q"][750:], IDEAL["q"][750:])
    np.testing.assert_array_equal(read["tau"][1900:], IDEAL["tau"][1899])
    np.testing.assert_array_equal(read["theta"][:10], IDEAL["theta"][0])


@given(st.integers(1, 1900))
def test_delays_of_whole_samples_are_plain_shifts(samples):
    read = _read(Sensors(delay={"q": samples * PERIOD}))["q"]
    np.testing.assert_array_equal(read[samples:], IDEAL["q"][:-samples])
    np.testing.assert_array_equal(read[:samples], IDEAL["q"][0])


@given(st.integers(0, 10**6), st.sampled_from([1, 3, 10]))
def test_delays_from_sample_to_sample_read_the_motion_in_between(seed, every):
    kept = TIME[::every]
    back = np.random.default_rng(seed).uniform(-2.0, 5.0, kept.size) * PERIOD
    back[kept - back > TIME[-1]] = 0.0
    then = MOTION.before(back, every)
    t = np.maximum(kept - back, 0.0)
    moving = kept - back >= 0.0
    for role in ("q", "theta"):
        amplitude, rate, _ = SWINGS[role]
        # of a cubic through values and slopes, h^4 / 384 x''''; its slope, h^3 sqrt(3) / 216 x'''';
        # and the instants are rounded to 1e-9 periods
        bound = PERIOD**4 / 384 * amplitude * rate**4 + 1e-12 * amplitude * rate
        assert np.max(np.abs(then.position[role] - angle(role, t))) <= bound + 1e-15
        slope = PERIOD**3 * math.sqrt(3.0) / 216 * amplitude * rate**4 + 1e-10
        assert np.max(np.abs(then.velocity[role] - speed(role, t))[moving]) <= slope
    # 255 N m/rad times the deflection's error
    np.testing.assert_allclose(then.elastic[0], torque(t), atol=1e-9)
    # a held torque is that of the sample before; where that is a matter of rounding, either
    place = t / PERIOD
    clear = moving & (np.abs(place - np.round(place)) > 1e-6)
    np.testing.assert_array_equal(then.held["tau"][clear], np.floor(place[clear]))


def test_after_the_last_instant_it_is_taken_instead():
    then = MOTION.before(-np.full(TIME.size, 3.0 * PERIOD))
    np.testing.assert_array_equal(then.position["q"][-4:], IDEAL["q"][-1])
    np.testing.assert_array_equal(then.position["q"][:-3], IDEAL["q"][3:])


def test_what_springs_do_beyond_their_laws_is_delayed_too():
    """Hysteresis and drift are in the elastic torque, but no function of the deflection."""
    extra = 0.5 * np.sign(speed("q", TIME)) + 0.3 * TIME
    rubbing = type(MOTION)(
        JOINT, TIME, MOTION.position, MOTION.velocity, MOTION.held, (MOTION.elastic[0] + extra,)
    )
    then = rubbing.before(0.25 * PERIOD).elastic[0]
    straight = np.interp(TIME - 0.25 * PERIOD, TIME, extra)
    # 255 N m/rad times the cubic's error, 6e-14 rad
    np.testing.assert_allclose(
        then, torque(np.maximum(TIME - 0.25 * PERIOD, 0)) + straight, atol=1e-9
    )


def test_jittered_delays_scatter_by_speed_and_never_see_the_future():
    read = _read(Sensors(delay={"q": 2e-3}, delay_jitter={"q": 2e-4}))
    assert _differing(read) == {"q"}
    moving = (np.abs(speed("q", TIME)) > 3.0) & (TIME > 0.01)
    late = (angle("q", TIME) - read["q"])[moving] / speed("q", TIME)[moving]
    # 49 rad/s^2 over 2 ms shift it by 2 %; the std of 900 samples is known to 2.4 %, threefold
    assert np.mean(late) == pytest.approx(2e-3, rel=0.03)
    assert np.std(late) == pytest.approx(2e-4, rel=0.08)
    eager = _read(Sensors(delay_jitter={"q": 2e-4}))["q"]
    ahead = (eager - angle("q", TIME)) * np.sign(speed("q", TIME))
    assert np.max(ahead[np.abs(speed("q", TIME)) > 0.1]) < 1e-12
    # half of them would be, and are not delayed instead
    assert np.count_nonzero(eager == IDEAL["q"]) == pytest.approx(1000, abs=3 * math.sqrt(500))


def test_jitter_moves_the_instants_in_order_and_the_stamps_tell():
    sensors = Sensors(jitter=1.5e-4)
    late = lateness(TIME.size, sensors, period=PERIOD, seed=0)
    assert np.std(late) == pytest.approx(1.5e-4, rel=0.05)  # of 2000 samples 1.6 %, threefold
    rows = Rows(TIME, PERIOD, sensors, 0)
    assert np.all(np.diff(rows.stamps) > 0.0)
    np.testing.assert_array_equal(rows.stamps, TIME + late)
    read = _read(sensors)
    assert _differing(read) == {"q", "theta", "torque_measured"}  # the command is not
    seen = np.clip(rows.stamps, 0.0, TIME[-1])
    # cubic, as above
    np.testing.assert_allclose(read["q"], angle("q", seen), atol=1e-11)
    hidden = Rows(TIME, PERIOD, Sensors(jitter=1.5e-4, stamped=False), 0)
    np.testing.assert_array_equal(hidden.stamps, TIME)
    np.testing.assert_array_equal(_read(Sensors(jitter=1.5e-4, stamped=False))["q"], read["q"])


def test_most_jitter_is_cut_before_samples_change_places():
    late = lateness(20000, Sensors(jitter=PERIOD / 4), period=PERIOD, seed=0)
    assert np.max(np.abs(late)) == 0.45 * PERIOD
    with pytest.raises(RotatumError, match="quarter of the sampling period"):
        lateness(10, Sensors(jitter=0.3 * PERIOD), period=PERIOD, seed=0)


def test_a_fast_clock_stretches_time():
    rows = Rows(TIME, PERIOD, Sensors(clock_rate=0.01), 0)
    np.testing.assert_array_equal(rows.stamps, 1.01 * TIME)
    assert rows.clock.period == 1.01 * PERIOD
    assert rows.clock.describe() == []


def test_slower_sampling_takes_every_so_many_instants():
    read = _read(Sensors(), every=7)
    for role in ROLES:
        np.testing.assert_array_equal(read[role], IDEAL[role][::7])
    late = _read(Sensors(delay={"q": 3 * PERIOD}), every=7)["q"]
    # on the motion's own grid, not between the samples
    np.testing.assert_array_equal(late[1:], IDEAL["q"][4:-3:7])


@pytest.mark.parametrize(
    "other",
    [
        {"noise": dict.fromkeys(("theta", "tau"), 0.1)},
        {"eccentricity": {"theta": 1e-3}},
        {"delay_jitter": {"theta": 1e-4}},
        {"jitter": 1e-5},
        {"repeats": 5, "dropouts": 3},
        {"stuck": {"theta": (0.1, 0.1)}},
        {"gain": {"tau": 2.0}, "offset": {"tau": 1.0}, "saturation": {"tau": 5.0}},
    ],
)
def test_switching_a_fault_on_draws_nothing_from_another(other):
    faults = {
        "noise": {"q": 1e-3},
        "eccentricity": {"q": 1e-3},
        "delay_jitter": {"q": 1e-4},
        "stale": 7,
        "nans": 3,
    }
    merged = faults | other
    for name in ("noise", "eccentricity", "delay_jitter"):
        merged[name] = faults[name] | other.get(name, {})
    alone, among = _read(Sensors(**faults)), _read(Sensors(**merged))
    # jitter itself moves q by 5 rad/s times its 10 us, cut at 4.5 std; the rest leaves it alone
    atol = 5.5 * 4.5e-5 if "jitter" in other else 0.0
    np.testing.assert_allclose(among["q"], alone["q"], atol=atol, rtol=0.0)


def test_all_streams_of_all_joints_are_different():
    drawn = [stream(0, name, n).standard_normal(400) for name in STREAMS for n in (0, 1, 7)]
    correlation = np.corrcoef(drawn) - np.eye(len(drawn))
    # 6000 pairs: one in them is beyond 3.9 standard deviations, none beyond five
    assert np.max(np.abs(correlation)) < 5.0 / math.sqrt(400)
    assert not np.array_equal(_read(Sensors(stale=9), number=1)["q"], _read(Sensors(stale=9))["q"])


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"gain": {"tau": 0.0}}, "gain.tau"),
        ({"offset": {"tau": math.nan}}, "offset.tau"),
        ({"eccentricity": {"tau": 1e-3}}, "eccentricity"),
        ({"eccentricity_turns": {"q": 0.0}}, "eccentricity_turns.q"),
        ({"saturation": {"q": 1.0}}, "saturation"),
        ({"saturation": {"tau": -1.0}}, "saturation.tau"),
        ({"wrap": {"q": 0.0}}, "wrap.q"),
        ({"stuck": {"q": (1.0,)}}, "stuck.q"),
        ({"stuck": {"q": (1.0, -1.0)}}, "stuck.q"),
        ({"stuck": {"thetta": (1.0, 1.0)}}, "'theta'"),
        ({"jitter": -1e-4}, "jitter"),
        ({"delay_jitter": {"q": -1e-4}}, "delay_jitter.q"),
        ({"clock_rate": -1.0}, "clock_rate"),
    ],
)
def test_impossible_faults_are_refused_by_name(settings, match):
    with pytest.raises(RotatumError, match=match):
        Sensors(**settings)


def test_faults_of_channels_the_joint_does_not_have_are_refused():
    for fault in ("gain", "offset", "saturation"):
        with pytest.raises(RotatumError, match=f"sensors.{fault}"):
            Sensors(**{fault: {"tau1": 1.0}}).fit("series")
    with pytest.raises(RotatumError, match=r"sensors\.stuck"):
        Sensors(stuck={"theta2": (0.0, 1.0)}).fit("serial")
