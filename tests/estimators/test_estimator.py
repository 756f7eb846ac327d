"""The loop and the batch are the same; joints do not know of each other; settings are checked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rotatum as rt
from rotatum.errors import MethodError
from rotatum.models import device_from_tables

PERIOD = 1e-3
JOINT: dict[str, Any] = {
    "motor": {"inertia": 4e-5, "damping": 5e-5, "gear_ratio": 80.0},
    "transmission": {"zero": 0.0},
    "encoders": {"link": 65536.0, "motor": 65536.0},
    "estimator": {"fit": ["offset"]},
}


def device(*names: str, **changes: Any) -> rt.Device:
    joint = {**JOINT, **changes}
    if len(names) == 1:
        return device_from_tables({"name": names[0], **joint}, "test")
    tables = [{"name": name, **joint} for name in names]
    return device_from_tables({"name": "arm", "joint": tables}, "test")


def signals(samples: int, stiffness: float) -> dict[str, np.ndarray]:
    """theta and phi are sines; the torque is the motor's equation solved for it: known truth."""
    t = PERIOD * np.arange(samples)
    theta = 0.4 * np.sin(9.0 * t)
    phi = 0.05 * np.sin(14.0 * t + 0.3)
    motor = 4e-5 * 80.0**2 * (-0.4 * 81.0 * np.sin(9.0 * t))
    motor += 5e-5 * 80.0**2 * 0.4 * 9.0 * np.cos(9.0 * t)
    return {"time": t, "q": theta + phi, "theta": theta, "tau": motor - stiffness * phi}


def test_loop_equals_batch_to_the_bit() -> None:
    data = signals(1500, 150.0)
    loop = rt.Estimator(device("one"), period=PERIOD)
    (group,) = loop.groups
    u = group.bank.stage.input.zeros(1500, 1)
    u["enable"] = 1
    for name, values in data.items():
        u[name] = values[:, None]
    batch = group.bank.run(u)
    loop.reset()
    for k in range(1500):
        out = loop.update(**{n: float(v[k]) for n, v in data.items()})
        assert out.stiffness[0] == batch["stiffness"][k, 0]
        assert out.stiffness_std[0] == batch["stiffness_std"][k, 0]


def test_known_stiffness_comes_out() -> None:
    data = signals(4000, 150.0)
    log = in_memory(data, "one")
    found = rt.estimate(log, device("one")).joints["one"]
    # No noise: what is left is the hat's quadrature error, (omega T)^4 / 240 of a period's torque.
    assert found.stiffness["final"] == pytest.approx(150.0, rel=1e-7)
    assert found.verdict == "informative"


def test_weak_is_blind_to_the_cutoff_and_residual_is_not() -> None:
    log = in_memory(signals(4000, 150.0), "one")
    values = {
        (m, c): rt.estimate(log, device("one"), method=m, cutoff=c).joints["one"]
        for m in ("weak", "residual")
        for c in (100.0, 1000.0)
    }
    weak = [values["weak", c].stiffness["final"] for c in (100.0, 1000.0)]
    residual = [values["residual", c].stiffness["final"] for c in (100.0, 1000.0)]
    assert weak == pytest.approx([150.0, 150.0], rel=1e-6)
    # A lag of 1/K_I shrinks the slope by about x^2 / (1 + x^2), x = 14 / K_I: 1.9 % and 0.02 %;
    # the motor's own sine at 9 rad/s adds to it.
    assert abs(residual[0] - 150.0) > 20.0 * abs(residual[1] - 150.0)


def in_memory(data: dict[str, np.ndarray], name: str) -> rt.Log:
    from rotatum.logs import Clock

    roles = {r: v for r, v in data.items() if r != "time"}
    return rt.Log("test", data["time"], {name: roles}, {name: {}}, Clock(PERIOD))


def test_two_joints_of_different_shape() -> None:
    arm = device_from_tables(
        {
            "name": "arm",
            "joint": [
                {"name": "a", **JOINT},
                {
                    "name": "b",
                    **JOINT,
                    "basis": {"deflection_range": 0.1, "orders": 2},
                    "estimator": {"fit": ["coulomb", "offset"]},
                },
            ],
        },
        "test",
    )
    loop = rt.Estimator(arm, period=PERIOD)
    assert len(loop.groups) == 2
    a, b = signals(3000, 150.0), signals(3000, 90.0)
    for k in range(3000):
        both = {n: [float(a[n][k]), float(b[n][k])] for n in ("q", "theta", "tau")}
        out = loop.update(**both, time=float(a["time"][k]))
    assert out.stiffness == pytest.approx([150.0, 90.0], rel=1e-5)
    assert out.verdict == ("informative", "informative")
    assert out["rows"].tolist()[0] > 2900


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"method": "waek"}, 'Did you mean "weak"'),
        ({"cutoff": 0.0}, "cutoff"),
        ({"cutoff": 1e5}, "sample period"),
        ({"fit": ["inertai"]}, 'Did you mean "inertia"'),
        ({"fit": ["skew", "damping"]}, "same column"),
        ({"method": "residual", "fit": ["inertia"]}, "Method weak can"),
        ({"torque": "sensor", "fit": ["inertia"]}, "cannot fit this"),
        ({"side": "link"}, "side"),
        ({"forgetting": 1.5}, "forgetting"),
        ({"solver": "qr"}, "solver"),
        ({"period": -1.0}, "period"),
    ],
)
def test_bad_settings_say_what_is_allowed(options: dict[str, Any], told: str) -> None:
    with pytest.raises(MethodError, match=told):
        rt.Estimator(device("one"), **{"period": PERIOD, **options})


def test_an_estimated_torque_needs_the_inertia() -> None:
    basis = {"deflection_range": 0.1, "orders": 2}  # a stage that others compile as well
    bare = device("one", motor={"gear_ratio": 80.0}, basis=basis)
    with pytest.raises(MethodError, match="inertia"):
        rt.Estimator(bare, period=PERIOD)
    rt.Estimator(bare, period=PERIOD, fit=["inertia", "offset"])


def test_channels_a_method_lacks_are_named() -> None:
    data = signals(500, 150.0)
    del data["tau"]
    with pytest.raises(MethodError, match="tau"):
        rt.estimate(in_memory(data, "one"), device("one"))
    with pytest.raises(MethodError, match="torque_measured"):
        rt.estimate(in_memory(signals(500, 150.0), "one"), device("one"), torque="sensor")
