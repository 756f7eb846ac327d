"""Rows of the elastic rotatum: what they are made of, and that the differentiated balance holds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rotatum.estimators.observers.jerk import jerk_observer
from rotatum.estimators.observers.recursion import Recursion
from rotatum.estimators.observers.stage import fill_observer
from rotatum.estimators.operators import OBSERVER
from rotatum.estimators.rowstages import rows_stage
from rotatum.estimators.shapes import Shape
from rotatum.kernels.status import DISABLED, SETTLING
from tests import naive
from tests.kernels.driven import T, drive, starts
from tests.kernels.linked import D, G, K, M
from tests.kernels.make import Sines

ROOM = 16
SLOW, LAG = 400.0, 10  # rad/s and samples: a smoothed observer whose window fits the room
EPS = np.spacing(1.0)


def deadbeat(period: float = T) -> Recursion:
    """The stencil of five samples, two samples late."""
    return jerk_observer(period, bandwidth=None).recursion


def smoothed() -> Recursion:
    return jerk_observer(T, bandwidth=SLOW, lag=LAG).recursion


def stencils(x: Any) -> Any:
    return naive.stencils(x, T)


def problem(
    powers: list[tuple[int, int]],
    observer: Recursion,
    *,
    actuation: str = "series",
    scale: float = 1.0,
    middle: float = 0.0,
    half: float = 1.0,
    room: int = ROOM,
    **link: float,
) -> tuple[Any, Any]:
    """Rows stage and parameters: columns ``phi^i s^j``, of a pendulum."""
    b = len(powers) * (2 if actuation == "antagonistic" else 1)
    highest = max(max(power) for power in powers)
    shape = Shape(
        "rotatum", "estimated", b, b, highest,
        actuation=actuation, side="link", operator=OBSERVER, size=room,
    )  # fmt: skip
    stage = rows_stage(shape)
    P = stage.params.zeros(1)[0]
    fill_observer(P["observer"], observer, "test", 1e-6)
    basis = P["basis"]
    basis["scale"], basis["middle"], basis["half"] = scale, middle, half
    basis["power"], basis["setpoint_power"] = np.transpose(powers)
    basis["setpoint_order"] = max(j for _, j in powers)
    for name, value in ({"inertia": M, "damping": D, "gravity": G} | link).items():
        P["rotatum"][name] = value
    return stage, P


def run(
    stage: Any, P: Any, q: Any, theta: Any, *, fresh: tuple[int, ...] = (0,), enable: int = 1,
    **more: Any,
) -> Any:  # fmt: skip
    return drive(stage, P, q=q, theta=theta, enable=enable, fresh=starts(len(q), fresh), **more)


# --- what a row is made of ------------------------------------------------------------------------

POWERS = [(1, 0), (1, 1), (3, 0), (3, 2)]


def test_rows_are_the_stencils_of_any_motion_whatever() -> None:
    q, theta, s = np.random.default_rng(470).standard_normal((3, 60))
    stage, P = problem(POWERS, deadbeat(), actuation="serial", scale=0.5, middle=0.25, half=2.0)
    out = run(stage, P, q, theta, setpoint=s)
    y, R = naive.rotatum_rows(
        stencils, q, theta, (s - 0.25) / 2.0, POWERS, inertia=M, damping=D, gravity=G
    )
    # Rounding of samples of order 3 over T^3; of phi^3 s^2 over T.
    np.testing.assert_allclose(out["y"][4:], y, rtol=0.0, atol=100.0 * EPS * M / T**3)
    scaled = R / 0.5 ** np.array([1, 1, 3, 3])
    np.testing.assert_allclose(out["R"][4:], scaled, rtol=0.0, atol=1e4 * EPS / T)
    _, _, bend, jerk = stencils(q)
    np.testing.assert_allclose(out["suspect"][4:], jerk, rtol=0.0, atol=100.0 * EPS / T**3)
    np.testing.assert_allclose(out["drag"][4:], bend, rtol=0.0, atol=100.0 * EPS / T**2)
    # What is read out is of now: two samples later than the row.
    x, s1 = (q - theta) / 0.5, (s - 0.25) / 2.0
    np.testing.assert_allclose(out["F"][:, 3], x**3 * s1**2, rtol=1e-12)
    np.testing.assert_allclose(out["D"][:, 3], 3.0 * x**2 * s1**2 / 0.5, rtol=1e-12)


@pytest.mark.parametrize(("observer", "lag"), [(deadbeat(), 2), (smoothed(), LAG)])
def test_of_cubics_in_time_every_row_is_exact_and_as_late_as_it_says(
    observer: Recursion, lag: int
) -> None:
    t = T * np.arange(300)
    at = t - lag * T
    # Of degree 3, 1 and 2: all that is observed, phi s, is of degree 3. A sine would not be.
    q, theta, s = (np.polynomial.Polynomial(c) for c in (
        (0.3, -0.7, 0.0, 1.5), (0.1, 0.4, 0.0, 1.5), (0.2, 1.0, -0.5)
    ))  # fmt: skip
    stage, P = problem([(1, 0), (1, 1)], observer, actuation="serial", gravity=0.0)
    out = run(stage, P, q(t), theta(t), setpoint=s(t))
    phi = q - theta
    y = -(M * q.deriv(3)(at) + D * q.deriv(2)(at))
    R = np.stack([phi.deriv()(at), (phi * s).deriv()(at)], axis=1)
    seen = out["valid"] == 1
    assert seen.sum() > 20
    assert np.flatnonzero(seen)[0] >= 2 * lag
    # Poles at 0.38 times 400 rad/s: after 240 samples 1e-16 of the start is left. Then rounding of
    # the stencil's 1 / T^3, or of seventeen gains up to 2e6 / s^3.
    late = slice(250, None)
    left = {2: 20.0 * EPS / T**3, LAG: 17.0 * 2e6 * EPS}[lag]
    np.testing.assert_allclose(out["y"][late], y[late], rtol=0.0, atol=M * left)
    np.testing.assert_allclose(out["R"][late], R[late], rtol=0.0, atol=1e-11)


def test_an_arms_rotatum_and_its_links_acceleration_stand_for_the_pendulums() -> None:
    q, theta = np.random.default_rng(471).standard_normal((2, 30))
    said, bend = np.random.default_rng(476).standard_normal((2, 30))
    powers = [(1, 0), (3, 0)]
    stage, P = problem(powers, deadbeat(), arm=1)
    arm = {"rotatum": said, "acceleration": bend}
    out = run(stage, P, q, theta, **arm)
    np.testing.assert_array_equal(out["y"][4:], said[4:] - D * bend[4:])
    np.testing.assert_array_equal(out["drag"][4:], bend[4:])
    # A pendulum reads none of it, and the spring does not know what moves its link.
    stage, P = problem(powers, deadbeat())
    alone = run(stage, P, q, theta)
    assert run(stage, P, q, theta, **arm).tobytes() == alone.tobytes()
    np.testing.assert_array_equal(out["R"], alone["R"])


@pytest.mark.parametrize("observer", [deadbeat(), smoothed()])
def test_each_rate_is_what_the_observer_makes_of_the_signal_alone(observer: Recursion) -> None:
    q, theta, s = np.random.default_rng(477).standard_normal((3, 80))
    stage, P = problem(POWERS, observer, actuation="serial", arm=1)
    out = run(stage, P, q, theta, setpoint=s)
    first = observer.window - 1
    for h, (i, j) in enumerate(POWERS):
        alone = observer.run((q - theta) ** i * s**j)[:, 1]
        # Rounding of terms of order 100 times gains of order 1 / T.
        np.testing.assert_allclose(out["R"][first:, h], alone, rtol=0.0, atol=1e4 * EPS / T)


# --- the balance ----------------------------------------------------------------------------------


def hardening(q: Sines, t: Any, H: float) -> Any:
    """Deflection of K phi + H phi^3 under what the pendulum asks for, by Newton's method."""
    torque = -(M * q(t, 2) + D * q(t, 1) + G * np.sin(q(t)))
    phi = torque / K
    for _ in range(30):
        phi = phi - (K * phi + H * phi**3 - torque) / (K + 3.0 * H * phi**2)
    return phi


def error(period: float, kind: str) -> tuple[float, float]:
    """Rms of y - R^T alpha on an exact motion, and of y."""
    rng = np.random.default_rng(472)
    q, s, squeeze = Sines(rng, 1.0, 20.0, 60.0), Sines(rng, 0.3, 5.0, 30.0), Sines(rng, 0.1, 5, 30)
    t = period * np.arange(round(0.5 / period))
    torque = -(M * q(t, 2) + D * q(t, 1) + G * np.sin(q(t)))
    more: dict[str, Any] = {}
    if kind == "cubic spring":
        powers, alpha, phi = [(1, 0), (3, 0)], [K, 400.0], hardening(q, t, 400.0)
    elif kind == "moving set-point":
        powers, alpha = [(1, 0), (1, 1)], [K, 20.0]
        phi = torque / (K + 20.0 * s(t))
        more["setpoint"] = s(t)
    else:
        powers, alpha, phi = [(1, 0)], [K, 50.0], squeeze(t)
        more["theta2"] = q(t) - (torque - K * phi) / 50.0
    actuation = {"cubic spring": "series", "moving set-point": "serial"}.get(kind, "antagonistic")
    stage, P = problem(powers, deadbeat(period), actuation=actuation)
    out = run(stage, P, q(t), q(t) - phi, **more)[4:]
    return float(np.std(out["y"] - out["R"] @ alpha)), float(np.std(out["y"]))


@pytest.mark.parametrize("kind", ["cubic spring", "moving set-point", "antagonistic pair"])
def test_the_differentiated_balance_holds_to_the_second_order_of_the_period(kind: str) -> None:
    (coarse, size), (fine, _) = error(2e-3, kind), error(1e-3, kind)
    # The jerk's stencil leaves T^2 / 4 of the fifth derivative: of 60 rad/s 0.4 % at 2 ms; the rest
    # is of the fourth order, (w T)^2 / 10 beside it.
    assert coarse / fine == pytest.approx(4.0, rel=0.03)
    assert 1e-5 * size < fine < 1e-3 * size


def test_a_hardening_spring_is_not_bent_by_an_observer_as_slow_as_the_motion() -> None:
    rng = np.random.default_rng(478)
    q, t, lag = Sines(rng, 1.0, 20.0, 300.0), T * np.arange(2000), 50
    phi = hardening(q, t, 400.0)
    observer = jerk_observer(T, bandwidth=SLOW, lag=lag).recursion
    stage, P = problem([(1, 0), (3, 0)], observer, room=64)
    out = run(stage, P, q(t), q(t) - phi)[400:]
    left = np.std(out["y"] - out["R"] @ [K, 400.0]) / np.std(out["y"])
    # The observer takes what is near 400 rad/s off both sides alike; what is left is e^-20 of it
    # for its lag, and (300 T)^4 / 700, of the derivatives of a sampled signal.
    assert left < 1e-4
    # Of the observed deflection, F_phi phi' is another signal.
    seen = observer.run(phi)[401 - observer.window :]
    bent = out["y"] - (K + 1200.0 * seen[:, 0] ** 2) * seen[:, 1]
    assert np.std(bent) > 0.1 * np.std(out["y"])


def test_a_pair_is_the_sum_of_what_each_motor_alone_gives() -> None:
    q, theta, theta2 = np.random.default_rng(473).standard_normal((3, 40))
    powers = [(1, 0), (3, 0)]
    stage, P = problem(powers, smoothed(), actuation="antagonistic", scale=0.5)
    P["zero"]["zero"], P["zero2"]["zero"] = 0.25, -0.125
    both = run(stage, P, q, theta, theta2=theta2, fresh=(0, 15))
    for which, angle in ((0, theta), (1, theta2)):
        stage, P = problem(powers, smoothed(), scale=0.5)
        P["zero"]["zero"] = (0.25, -0.125)[which]
        alone = run(stage, P, q, angle, fresh=(0, 15))
        for name in ("y", "valid", "fresh", "status", "suspect"):
            assert both[name].tobytes() == alone[name].tobytes(), name
        for name in ("R", "F", "D", "H"):
            own = np.ascontiguousarray(both[name][:, which::2])
            assert own.tobytes() == alone[name].tobytes(), name
        assert both[("phi", "phi2")[which]].tobytes() == alone["phi"].tobytes()


# --- starts, restarts, switches -------------------------------------------------------------------


def test_rows_are_valid_once_settled_and_enabled() -> None:
    zeros = np.zeros(10)
    stage, P = problem([(1, 0)], deadbeat())
    out = run(stage, P, zeros, zeros)
    assert out["valid"].tolist() == [0] * 4 + [1] * 6
    assert out["status"].tolist() == [SETTLING] * 4 + [0] * 6
    assert out["fresh"].tolist() == [1] + [0] * 9
    out = run(stage, P, zeros, zeros, enable=0)
    assert not out["valid"].any()
    assert out["status"].tolist() == [SETTLING | DISABLED] * 4 + [DISABLED] * 6


@pytest.mark.parametrize("actuation", ["serial", "antagonistic"])
@pytest.mark.parametrize("observer", [deadbeat(), smoothed()])
def test_a_restart_forgets_everything_but_the_zero(observer: Recursion, actuation: str) -> None:
    q, theta, other = np.random.default_rng(474).standard_normal((3, 70))
    powers = [(1, 0), (1, 1)] if actuation == "serial" else [(1, 0)]
    name = "setpoint" if actuation == "serial" else "theta2"
    stage, P = problem(powers, observer, actuation=actuation)
    whole = run(stage, P, q, theta, fresh=(0, 30), **{name: other})
    tail = run(stage, P, q[30:], theta[30:], **{name: other[30:]})
    seen = slice(observer.window - 1, None)
    for field in ("y", "R", "valid", "status"):
        assert whole[30:][seen][field].tobytes() == tail[seen][field].tobytes(), field
    assert not whole["valid"][30 : 30 + observer.window - 1].any()
    assert whole["fresh"][30] == 1


def test_both_zeros_are_waited_for_and_taken_off() -> None:
    t = T * np.arange(40)
    stage, P = problem([(3, 0)], deadbeat(), actuation="antagonistic")
    P["zero"]["samples"], P["zero2"]["samples"] = 3, 5
    q = np.where(np.arange(40) < 5, 0.0, t**3)
    out = run(stage, P, q, 0.0 * q - 0.3, theta2=0.0 * q + 0.2)
    # Zeros 0.3 and -0.2: both deflections are those of the link. The observers start at sample 5.
    np.testing.assert_allclose(out["phi"][5:], q[5:], rtol=0.0, atol=EPS)
    np.testing.assert_allclose(out["phi2"][5:], q[5:], rtol=0.0, atol=EPS)
    assert np.flatnonzero(out["valid"]).tolist() == list(range(9, 40))
    cubic = stencils(q[5:] ** 3)[1]
    np.testing.assert_allclose(out["R"][9:, 0], cubic, rtol=0.0, atol=EPS)
    assert (out["fresh"][:6] == 1).all()


def test_without_powers_of_a_setpoint_it_is_not_looked_at() -> None:
    q, theta, s = np.random.default_rng(475).standard_normal((3, 30))
    stage, P = problem([(1, 0), (3, 0)], smoothed())
    one, other = (run(stage, P, q, theta, setpoint=x) for x in (0.0, s))
    assert one.tobytes() == other.tobytes()
