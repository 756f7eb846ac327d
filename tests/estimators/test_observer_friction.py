"""Coulomb friction in the observer of deluca2007: as steep at rest as the error can bear."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.drivetrain import Drivetrain
from rotatum.estimators.full_state.friction import (
    friction_slope,
    friction_width,
    steepest_friction,
)
from rotatum.estimators.full_state.poles import Pair, discretise, injection
from tests.kernels.observing import Observer

T = 1e-3
PAIRS = (Pair(250.0, 0.9), Pair(250.0, 0.9))
SLOW = Design(Drivetrain(0.25, 2000.0, coulomb=3.0), 3.0 * T, PAIRS)


def error_at_rest(design, slope):
    """What one sample makes of the error where friction is linear."""
    constants = design.drivetrain
    step = discretise(design.pairs, design.period, design.gyro)
    c = (constants.damping + constants.motor_damping) / constants.inertia
    push, speed = (step.before + step.after)[:, 1], [-c, 1.0, 0.0, 0.0]
    return step.transition - slope * np.outer(push, speed)


def radius(matrix):
    return np.abs(np.linalg.eigvals(matrix)).max()


@st.composite
def designs(draw):
    """Poles up to 0.8 pi / T, any damping of the joint; gyroscopes as the observer sets them."""
    first = draw(st.floats(10.0, 2500.0))
    pairs = tuple(
        Pair(first * draw(st.floats(0.5, 1.0)), draw(st.floats(0.3, 1.0))) for _ in range(2)
    )
    axis = Drivetrain(inertia=1.0, stiffness=1e4, damping=draw(st.floats(0.0, 1000.0)))
    return Design(axis, T, pairs, draw(st.sampled_from([0.0, 0.5 * first])))


@settings(deadline=None, max_examples=100)
@given(design=designs())
def test_the_error_decays_below_the_steepest_friction(design):
    limit = steepest_friction(design)
    assert limit > 0.0
    for share in np.linspace(0.0, 0.98, 15):  # angles looked at are 2 % apart
        assert radius(error_at_rest(design, share * limit)) < 1.0
    # The circle criterion with the torque's response by partial fractions: 1/s + Re G > 0.
    none = error_at_rest(design, 0.0)
    push = none - error_at_rest(design, 1.0)
    z = np.exp(1j * np.pi * np.geomspace(1e-6, 1.0, 5000))
    poles, vectors = np.linalg.eig(none)
    residues = np.diag(np.linalg.solve(vectors, push @ vectors))
    if np.linalg.cond(vectors) < 1e6:  # else poles coincide and have no such form
        real = (residues / (z[:, None] - poles)).sum(axis=1).real
        assert 1.0 / (0.98 * limit) + real.min() > 0.0


def test_the_error_decays_though_friction_comes_and_goes():
    for design in (Design(Drivetrain(0.25, 2000.0, 0.5), T, PAIRS), SLOW):
        full = error_at_rest(design, 0.98 * steepest_friction(design))
        none, product = error_at_rest(design, 0.0), np.eye(4)
        for on in np.random.default_rng(5).integers(0, 2, 3000):
            product = (full if on else none) @ product
        assert np.abs(product).max() < 1e-6


def test_beyond_the_steepest_it_may_not():
    # Fast poles: there the worst of the circle is z = -1, where an eigenvalue goes.
    assert radius(error_at_rest(SLOW, 1.001 * steepest_friction(SLOW))) > 1.0


def test_friction_at_rest_adds_half_to_the_damping_of_the_error_or_less_on_a_slow_clock():
    half = 0.5 * injection(PAIRS)[0]
    quick = SLOW._replace(period=T)
    assert friction_slope(quick) == half
    assert friction_slope(SLOW) == 0.5 * steepest_friction(SLOW) < 0.8 * half
    for design in (quick, SLOW):
        assert friction_width(design) == pytest.approx(3.0 / (0.25 * friction_slope(design)))


def test_without_friction_there_is_no_width():
    assert friction_width(Design(Drivetrain(0.25, 2000.0), T)) == 1.0


def test_what_friction_bears_at_rest_becomes_torsion_as_slowly_as_the_slope_says():
    """A motor that friction alone holds.

    Nothing tells friction from torsion at a standstill: in the end all of it, f / K, is torsion to
    the observer. How fast is what the slope decides, and what a control loop feels of it.
    """
    stiffness, borne = 2000.0, 2.0
    design = Design(Drivetrain(0.25, stiffness, coulomb=3.0), T, PAIRS)
    observer = Observer(design, coulomb=3.0, width=friction_width(design))
    left = np.array([
        1.0 + observer.push(theta=0.0, torque=borne, acceleration=0.0)[1] * stiffness / borne
        for _ in range(400)
    ])  # fmt: skip
    slowest = max(np.linalg.eigvals(error_at_rest(design, friction_slope(design))), key=abs)
    assert abs(slowest) > radius(error_at_rest(design, 0.0)) ** 0.25  # four times as slow, and more
    # The other modes are gone after 100 samples. A pair z, z* obeys its polynomial.
    tail = left[100:300]
    rest = tail[2:] - 2.0 * slowest.real * tail[1:-1] + abs(slowest) ** 2 * tail[:-2]
    assert np.abs(rest).max() < 1e-9 * np.abs(tail).max()
    assert abs(left[300]) < 1e-4
