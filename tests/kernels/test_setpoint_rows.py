"""Rows of serial joints: the set-point goes with the deflection of its own sample."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.shapes import Shape
from rotatum.kernels import basis, kinematic, residual, rows
from rotatum.models.laws import LAWS
from rotatum.record import Layout
from rotatum.runtime.bank import Bank
from tests import naive
from tests.kernels.driven import T, problem, run
from tests.kernels.make import Sines, nested, plain
from tests.kernels.test_weak import B, D

TERMS = [(1, 0), (1, 1), (1, 2), (3, 0)]
MIDDLE, HALF, SCALE = 0.09, 0.03, 0.01


def serial(cutoff=200.0, **settings):
    """Stage and params of weak rows with products of deflection and set-point."""
    stage, P = problem([i for i, _ in TERMS], cutoff=cutoff, scale=SCALE, inertia=B, **settings)
    P["basis"]["middle"], P["basis"]["half"], P["basis"]["setpoint_order"] = MIDDLE, HALF, 2
    P["basis"]["setpoint_power"] = [j for _, j in TERMS]
    return stage, P


def products(phi, setpoint):
    s = (setpoint - MIDDLE) / HALF
    return np.stack([(phi / SCALE) ** i * s**j for i, j in TERMS], axis=1)


def moving(seed, n=300):
    """Angles, torque and set-point without any relation but their sizes."""
    rng = np.random.default_rng(seed)
    q, theta, tau, setpoint = rng.standard_normal((4, n)) * [[1e-3], [1e-3], [1.0], [0.01]]
    return q, theta, tau, MIDDLE + setpoint


def test_weak_rows_agree_with_the_twin():
    q, theta, tau, setpoint = moving(110)
    out = run(*serial(damping=D), q, theta, tau, setpoint=setpoint)
    y, R = naive.weak_rows(
        products(q - theta, setpoint), theta, tau, period=T, cutoff=200.0, inertia=B, damping=D
    )
    # The same sums in another order: rounding of terms of B 1e-3 / T^2 = 20 N m, and of order 1.
    np.testing.assert_allclose(out["y"][2:], y, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(out["R"][2:], R, rtol=0.0, atol=1e-12)
    # What is read out is of now, without any filter.
    np.testing.assert_allclose(out["F"], products(q - theta, setpoint), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("delay", [1, 5, 31])
def test_with_friction_the_setpoint_waits_with_the_deflection(delay):
    # The friction's sign needs samples from both sides, so that the row is of `delay` ago: all of
    # it. Without friction it is the row of a joint that began as much later, to the bit.
    q, theta, tau, setpoint = moving(111)
    late = run(*serial(delay=delay, width=1.0), q, theta, tau, setpoint=setpoint)
    rest = [x[delay:] for x in (q, theta, tau)]
    soon = run(*serial(), *rest, setpoint=setpoint[delay:])
    n = len(q) - 2 * delay
    assert late["R"][2 * delay + 2 :].tobytes() == soon["R"][2:n].tobytes()
    assert late["y"][2 * delay + 2 :].tobytes() == soon["y"][2:n].tobytes()
    # And what is read out is of now all the same.
    np.testing.assert_allclose(late["F"], products(q - theta, setpoint), rtol=1e-12, atol=1e-15)


def test_the_row_of_a_moving_lever_holds():
    # tau_e = (a + b s) x with s as fast as x: the hat over products is exact to the fourth order.
    rng = np.random.default_rng(112)
    theta, phi, lever = (Sines(rng, size, 3.0, 40.0) for size in (0.1, SCALE, HALF))
    t = np.arange(400) * T
    alpha = np.array([1.2, 0.5, 0.0, 0.3])
    law = products(phi(t), MIDDLE + lever(t)) @ alpha
    tau = B * theta(t, 2) - law
    out = run(*serial(), phi(t) + theta(t), theta(t), tau, setpoint=MIDDLE + lever(t))
    # T^4 / 240 times fourth derivatives: products of up to three sines of 40 rad/s and torques
    # of up to 2 N m, theta's sixth; and rounding of theta over T^2.
    bound = 1e-12 / 240.0 * (2.0 * 2.0 * 120.0**4 + B * theta.bound(6)) + 4.0 * B * 1.4e-17 / T**2
    np.testing.assert_allclose(out["y"][2:], (out["R"] @ alpha)[2:], rtol=0.0, atol=bound)
    # It could fail: with the set-point of one sample later.
    other = run(*serial(), phi(t) + theta(t), theta(t), tau, setpoint=MIDDLE + lever(t + T))
    assert np.abs(other["y"] - other["R"] @ alpha)[2:].max() > 100.0 * bound


# --- residual -------------------------------------------------------------------------------------


def test_residual_takes_the_setpoint_through_the_filter_of_the_angles():
    # Products of signals that lag alike: flacco2012 filters what it evaluates F with.
    q, theta, tau, setpoint = moving(113, 120)
    sizes = {"b": len(TERMS)}
    params = nested(
        zero=rows.ZeroParams.layout(),
        basis=basis.BasisParams.layout(**sizes),
        kinematic=kinematic.KinematicParams.layout(),
        setpoint=kinematic.KinematicParams.layout(),
        residual=residual.ResidualParams.layout(),
    )
    filters = kinematic.KinematicState.layout()
    state = nested(
        zero=rows.ZeroState.layout(),
        terms=basis.BasisState.layout(**sizes, m=4, r=basis.ROOM + 3),
        residual=residual.ResidualState.layout(),
        link=filters,
        motor=filters,
        setpoint=filters,
    )
    for name in ("kinematic", "setpoint"):
        one = params[name]
        one["period"], one["position_gain"], one["velocity_gain"] = T, 0.3, 0.05
    own = params["basis"]
    own["scale"], own["middle"], own["half"], own["setpoint_order"] = SCALE, MIDDLE, HALF, 2
    own["power"], own["setpoint_power"] = zip(*TERMS, strict=True)
    params["residual"]["period"], params["residual"]["gain"] = T, 100.0
    params["residual"]["inertia"], params["residual"]["width"] = B, 1.0
    P, S = plain(params), plain(state)
    sample = plain(rows.Sample.layout().zeros(1)[0])
    out = plain(rows.Row.layout(p=len(TERMS)).zeros(1)[0])
    residual.motor_init(P, S)
    found = []
    for k in range(len(q)):
        sample.q, sample.theta, sample.torque = float(q[k]), float(theta[k]), float(tau[k])
        sample.setpoint, sample.fresh, sample.enable = float(setpoint[k]), int(k == 0), 1
        residual.motor_step(P, S, sample, out)
        found.append(list(out.R))
    smooth = [filtered(params["kinematic"], x) for x in (q, theta, setpoint)]
    expected = products(smooth[0] - smooth[1], smooth[2])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)  # rounding
    raw = products(q - theta, setpoint)
    assert np.abs(np.array(found) - raw).max() > 0.1


def filtered(params, signal):
    """Positions of the kinematic filter, which has tests of its own."""
    p, s = plain(params), plain(kinematic.KinematicState.layout().zeros(1)[0])
    kinematic.start(p, s, float(signal[0]))
    found = [s.position]
    for value in signal[1:].tolist():
        kinematic.observe(p, s, value)
        found.append(s.position)
    return np.array(found)


# --- torque from the device's own law -------------------------------------------------------------


@pytest.mark.parametrize("samples", [0, 20])
def test_the_model_stands_in_for_a_measured_torque(samples):
    law = LAWS["lever"]
    shape = Shape("weak", "model", 1, 1, 1, law="lever", constants=len(law.constants))
    stage = rows_stage(shape)
    params = stage.params.zeros(1)
    one: Layout = params[0]
    one["zero"]["samples"], one["zero"]["zero"] = samples, 0.002
    one["basis"]["scale"], one["basis"]["half"], one["basis"]["power"] = SCALE, 1.0, 1
    one["weak"]["period"] = T
    one["operator"]["pole"], one["operator"]["order"] = np.exp(-200.0 * T), 2
    spring, preload, r0, b = 14220.0, 0.003, 0.1, 4e-4
    one["model"]["constants"], one["model"]["preload"] = spring, preload
    one["model"]["offset"], one["model"]["slope"] = r0, -b
    rng = np.random.default_rng(114)
    theta, phi = rng.standard_normal(200), 0.01 * rng.standard_normal(200)
    angle = 40.0 * rng.standard_normal(200)
    phi[:samples] = 0.002  # at rest, where the zero is read
    u = stage.input.zeros(200, 1)
    u["q"][:, 0], u["theta"][:, 0], u["setpoint"][:, 0] = theta + phi, theta, angle
    u["enable"], u["fresh"][0] = 1, 1
    out = Bank(stage, params).run(u)[:, 0]
    # flacco2012 eq. 49, k r^2 sin(2 phi), with the lever arm of the logged angle, at the
    # deflection less its zero, plus the preload.
    reached = phi - 0.002 + preload
    torque = spring * (r0 - b * angle) ** 2 * np.sin(2.0 * reached)
    # The sample that completes the zero is the first one a hat may reach back to.
    begin = max(0, samples - 1)
    y, R = naive.weak_rows(
        ((phi - 0.002) / SCALE)[begin:, None],
        0.0 * theta[begin:],
        -torque[begin:],
        period=T,
        cutoff=200.0,
        inertia=0.0,
    )
    # A zero of 0.002 is the mean of twenty differences of angles of order 1: 1e-16 each, times
    # 14220 r^2 = 200 N m/rad.
    np.testing.assert_allclose(out["y"][begin + 2 :], y, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(out["R"][begin + 2 :], R, rtol=0.0, atol=1e-12)
