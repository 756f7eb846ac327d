"""Paths: through their points, derivatives that are derivatives, smooth beginnings."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rotatum.errors import RotatumError
from rotatum.simulation import Sines, sine
from rotatum.simulation.drivers.paths import FadeIn, Path, Ramps, Superposed, hold

SIZES = st.floats(-2.0, 2.0)


@st.composite
def ramps(draw):
    values = draw(st.lists(SIZES, min_size=1, max_size=5))
    steps = draw(st.lists(st.floats(0.3, 2.0), min_size=len(values), max_size=len(values)))
    return Ramps(tuple(np.cumsum(steps).tolist()), tuple(values))


@st.composite
def sines(draw):
    count = draw(st.integers(1, 3))
    numbers = st.lists(SIZES, min_size=count, max_size=count).map(tuple)
    return Sines(draw(numbers), draw(numbers), draw(numbers), draw(SIZES))


PLAIN = ramps() | sines()
PATHS = (
    PLAIN
    | st.builds(FadeIn, PLAIN, st.floats(0.3, 2.0), st.floats(0.0, 1.0), SIZES)
    | st.builds(lambda a, b, w: Superposed((a, b), (1.0, w)), PLAIN, PLAIN, SIZES)
)


@given(PATHS, st.floats(0.0, 8.0))
def test_velocity_and_acceleration_are_the_derivatives(path, time):
    assert isinstance(path, Path)
    bends = [t for part in _ramps(path) for t in part.times]
    assume(not any(time < bend < time + 0.1 for bend in bends))
    # The integral of a derivative is the change. Ten nodes are exact for quintics, and for sines
    # below 2 Hz (up to 1.3 rad over 0.1 s) right to 1e-20, times quintics too.
    nodes, weights = np.polynomial.legendre.leggauss(10)
    near, ends = time + 0.05 * (nodes + 1.0), np.array([time, time + 0.1])
    for before, after in (("position", "velocity"), ("velocity", "acceleration")):
        change = 0.05 * weights @ getattr(path, after)(near)
        # rounding of accelerations of up to 2,000 1/s^2, over 0.1 s
        expected = np.diff(getattr(path, before)(ends))[0]
        np.testing.assert_allclose(change, expected, atol=1e-12)


def _ramps(path):
    """The quintics a path is made of."""
    if isinstance(path, Ramps):
        return [path]
    if isinstance(path, FadeIn):
        return [Ramps((path.start, path.start + path.seconds), (0.0, 1.0)), *_ramps(path.path)]
    parts = path.paths if isinstance(path, Superposed) else ()
    return [found for part in parts for found in _ramps(part)]


@given(ramps())
def test_ramps_pass_their_points_at_rest_and_stay_outside(path):
    knots = np.array(path.times)
    # 1e-15 for each addition of the pieces
    np.testing.assert_allclose(path.position(knots), path.values, atol=1e-14)
    np.testing.assert_array_equal(path.velocity(knots), 0.0)
    np.testing.assert_array_equal(path.acceleration(knots), 0.0)
    outside = np.array([knots[0] - 1.0, knots[-1] + 1.0])
    np.testing.assert_allclose(
        path.position(outside), [path.values[0], path.values[-1]], atol=1e-14
    )
    np.testing.assert_array_equal(path.velocity(outside), 0.0)


def test_quintic_has_the_peaks_of_the_book():
    path = Ramps((1.0, 3.0), (0.0, 0.8))
    # rise h in T: speed 15 h / (8 T) in the middle, acceleration 10 h / (sqrt 3 T^2) at
    # u = (1 - 1 / sqrt 3) / 2 (the quintic's derivatives set to zero)
    assert float(path.velocity(2.0)) == pytest.approx(15 * 0.8 / (8 * 2.0), rel=1e-14)
    steepest = 1.0 + 2.0 * (1 - 1 / np.sqrt(3)) / 2
    assert float(path.acceleration(steepest)) == pytest.approx(10 * 0.8 / (np.sqrt(3) * 4))
    assert np.max(path.acceleration(np.linspace(1, 3, 10_001))) <= 10 * 0.8 / (np.sqrt(3) * 4)


def test_sines_lead_by_a_quarter_of_a_turn_a_derivative():
    path = sine(0.3, 0.5, 0.4, offset=1.0)
    time = np.linspace(0.0, 4.0, 101)
    angle = np.pi * time + 0.4
    # rounding of the arguments of the sines
    np.testing.assert_allclose(path.position(time), 1.0 + 0.3 * np.sin(angle), atol=1e-14)
    np.testing.assert_allclose(path.velocity(time), 0.3 * np.pi * np.cos(angle), atol=1e-14)
    np.testing.assert_allclose(path.acceleration(time), -0.3 * np.pi**2 * np.sin(angle), atol=1e-13)


def test_a_path_faded_in_starts_from_rest_and_becomes_itself():
    path = sine(0.3, 0.5, 0.9)
    faded = FadeIn(path, 2.0, start=1.0, rest=0.1)
    before, after = np.linspace(0.0, 1.0, 11), np.linspace(3.0, 6.0, 31)
    np.testing.assert_array_equal(faded.position(before), 0.1)
    for order in ("velocity", "acceleration"):
        np.testing.assert_array_equal(getattr(faded, order)(before), 0.0)
        np.testing.assert_allclose(getattr(faded, order)(after), getattr(path, order)(after))
    np.testing.assert_allclose(faded(after), path(after), atol=1e-15)


def test_a_held_position_does_not_move():
    time = np.linspace(0.0, 4.0, 5)
    np.testing.assert_array_equal(hold(0.3).position(time), 0.3)
    np.testing.assert_array_equal(hold(0.3).velocity(time), 0.0)
    np.testing.assert_array_equal(hold(0.3).acceleration(time), 0.0)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: FadeIn(hold(0.0), seconds=0.0), "fade-in.seconds"),
        (lambda: FadeIn(hold(0.0), seconds=1.0, rest=np.inf), "fade-in.rest"),
        (lambda: Superposed(()), "at least one"),
        (lambda: Superposed((hold(0.0),), (1.0, 2.0)), "as many weights"),
        (lambda: Ramps((0.0, np.nan), (0.0, 1.0)), "ramps.times"),
        (lambda: Ramps((0.0, 1.0), (0.0, np.inf)), "ramps.values"),
    ],
)
def test_impossible_paths_name_the_field(make, says):
    with pytest.raises(RotatumError, match=says):
        make()
