"""Settings of `rotatum` and of selective updates: what is chosen, said and refused."""

from __future__ import annotations

import math
from typing import Any

import pytest

from rotatum.errors import MethodError
from rotatum.estimators.measured import JERK, Measured
from rotatum.estimators.operators import OBSERVER, Operator
from rotatum.estimators.settings import Request, Settings, settle
from rotatum.estimators.tuning import prepare
from rotatum.models import Device, device_from_tables

T = 1e-3
M = 0.05


def device(estimator: dict[str, object] | None = None, **more: Any) -> Device:
    tables: dict[str, object] = {
        "name": "one",
        "link": {"inertia": M},
        "transmission": {"zero": 0.0},
        "basis": {"deflection_range": 0.1, "orders": 2},
        "estimator": estimator or {},
        **more,
    }
    return device_from_tables(tables, "test")


def settled(request: Request, period: float = T, **tables: Any) -> Settings:
    one = device(**tables)
    return settle(one.joints[0], one, period, request)


def notes(request: Request, period: float = T, **tables: Any) -> dict[str, str]:
    one = device(**tables)
    chosen = settle(one.joints[0], one, period, request)
    return prepare(one.joints[0], chosen, period=period, holds={}, zeros=[0.0]).notes


def test_the_link_is_its_side_and_its_lag_follows_from_its_cutoff() -> None:
    found = settled(Request("rotatum"))
    assert (found.side, found.torque, found.fit) == ("link", "estimated", ())
    assert found.operator == Operator(OBSERVER, math.ceil(20.0 / 0.3), 300.0, T)
    assert settled(Request("rotatum", cutoff=50.0)).operator.order == 400
    assert settled(Request("rotatum", cutoff=50.0, order=70)).operator.order == 70
    deadbeat = settled(Request("rotatum", cutoff=math.inf)).operator
    assert (deadbeat.order, deadbeat.delay) == (2, 2 * T)
    assert settled(Request("rotatum", cutoff=math.inf, order=4)).operator.delay == 4 * T
    filed = device(estimator={"method": "rotatum", "cutoff": math.inf})
    assert settle(filed.joints[0], filed, T, Request()).operator == deadbeat


def test_the_default_cutoff_is_what_the_noise_of_the_jerk_allows() -> None:
    counts = {"encoders": {"link": 65536.0}}
    # Nothing is known of any noise; at most half the sample rate.
    assert settled(Request("rotatum")).operator.width == 300.0
    assert settled(Request("rotatum"), period=5e-3).operator.width == 100.0
    # Encoders' counts without a log; a log that has told.
    assert settled(Request("rotatum"), **counts).operator.width == 60.0
    told = Measured(1e-5, 1e-5, {("link", JERK): 42.0})
    found = settled(Request("rotatum", measured=told), **counts)
    assert found.operator.width == 42.0
    assert "noise of the jerk" in found.reasons["cutoff"]
    # No default is one that would be refused: at 10 kHz nothing below 20 rad/s.
    assert settled(Request("rotatum", measured=told), period=1e-4).operator.width == 42.0
    slow = Measured(1e-3, 1e-3, {("link", JERK): 10.0})
    assert settled(Request("rotatum", measured=slow), period=1e-4).operator.width == 20.0
    assert settled(Request("rotatum"), period=1e-6).operator.width == pytest.approx(2000.0)
    asked = settled(Request("rotatum", cutoff=90.0, measured=told))
    assert (asked.operator.width, asked.reasons["cutoff"]) == (90.0, "asked for")


def test_a_cutoff_filed_for_a_low_pass_is_not_the_observers_nor_the_other_way_round() -> None:
    weak = {"cutoff": 250.0, "side": "motor"}
    found = settled(Request("rotatum"), estimator=weak)
    assert (found.side, found.operator.width) == ("link", 300.0)
    assert settled(Request("rotatum"), estimator={"window": 0.2}).operator.width == 300.0
    own = {"method": "rotatum", "cutoff": 80.0}
    assert settled(Request(), estimator=own).operator.width == 80.0
    assert settled(Request(), estimator=own).reasons["cutoff"] == "device file"
    assert settled(Request("weak", side="link"), estimator=own).operator.width == 300.0


@pytest.mark.parametrize(
    ("request_", "told"),
    [
        (Request("rotatum", cutoff=1.0), "2 to 2000 rad/s at a period of 0.001 s, or inf"),
        (Request("rotatum", cutoff=2500.0), "deadbeat, as printed"),
        (Request("rotatum", cutoff=-math.inf), "does not fit the sample period"),
        (Request("rotatum", cutoff=math.nan), "does not fit the sample period"),
        (Request("rotatum", cutoff=math.inf, order=1), "2 <= order"),
        (Request("rotatum", cutoff=100.0, order=0), "1 <= order"),
        (Request("rotatum", window=0.2), "not a window"),
        (Request("rotatum", stride=5), "not a window"),
        (Request("rotatum", side="motor"), "on the link's side"),
        (Request("rotatum", torque="sensor"), "no torque is read"),
        (Request("rotatum", fit=("link_damping",)), "cannot fit this"),
        (Request("rotatum", fit=("offset",)), "cannot fit this"),
        (Request("weak", side="link", cutoff=math.inf), "does not fit the sample period"),
        (Request("rotatm"), 'Did you mean "rotatum"?'),
        (Request("rotatum", selective=-0.1), "0 (all is) or more"),
        (Request("rotatum", selective=math.inf), "0 (all is) or more"),
    ],
)
def test_what_it_cannot_have_is_refused(request_: Request, told: str) -> None:
    with pytest.raises(MethodError) as caught:
        settled(request_)
    assert told in str(caught.value)


def test_it_needs_the_links_inertia() -> None:
    with pytest.raises(MethodError, match="needs the link's inertia"):
        settled(Request("rotatum"), link={"damping": 0.1})


def test_a_speed_that_the_encoder_does_not_tell_from_rest_is_refused() -> None:
    coarse = {"encoders": {"link": 4096.0}}
    request = Request("weak", side="link", selective=0.05, fit=())
    assert "0.05 rad/s" in notes(request)["selective"]
    with pytest.raises(MethodError, match="does not tell such a speed") as caught:
        notes(Request("weak", side="link", selective=1e-3, fit=()), **coarse)
    # What it says is allowed is.
    least = float(str(caught.value).split("allowed: ")[-1].split()[0])
    assert notes(Request("weak", side="link", selective=1.1 * least, fit=()), **coarse)


def test_rows_count_again_once_friction_and_operator_have_forgotten() -> None:
    rubbing = {"link": {"inertia": M, "coulomb": 0.1}, "encoders": {"link": 65536.0}}
    one = device(**rubbing)
    request = Request("weak", side="link", selective=0.1, fit=())
    chosen = settle(one.joints[0], one, T, request)
    made = prepare(one.joints[0], chosen, period=T, holds={}, zeros=[0.0])
    wait = int(made.parts[0]["rows"]["link"]["delay"])
    assert wait >= 5
    span = int(made.params["inner"][0]["gate"]["span"])
    assert span == math.ceil(2.0 * made.delay / T - 1e-9)
    assert span >= 2 * wait


@pytest.mark.parametrize(
    ("request_", "hertz"),
    [
        # -3 dB of n poles is at w sqrt(2^(1/n) - 1).
        (Request(cutoff=100.0), 100.0 * math.sqrt(math.sqrt(2.0) - 1.0) / (2.0 * math.pi)),
        (Request("residual", cutoff=100.0), 100.0 / (2.0 * math.pi)),
        # (u (1 - u))^3 is nearly normal, of variance 1/36: exp(-(w T)^2 / 72) = 0.707 at 5.0.
        (Request(window=0.2), 5.0 / 0.2 / (2.0 * math.pi)),
        (Request("algebraic", window=0.2), 5.0 / 0.2 / (2.0 * math.pi)),
        # Butterworth's square of order 4: 1 / (1 + x^8) = 0.707 at 0.896.
        (Request("rotatum", cutoff=100.0), 89.6 / (2.0 * math.pi)),
    ],
)
def test_every_method_states_the_bandwidth_of_its_settings(request_: Request, hertz: float) -> None:
    motor = {"motor": {"inertia": 1e-3}}
    told = notes(request_, **motor)["bandwidth"]
    # Poles are matched, not continuous: (w T)^2; the window's figure is the normal's. Two per cent.
    assert float(told.split(" Hz")[0]) == pytest.approx(hertz, rel=0.02)
    assert "law is taken for constant" in told
    forgetful = Request(**{**vars(request_), "forgetting": 0.999})
    assert "followed over" in notes(forgetful, **motor)["bandwidth"]


def test_the_notes_tell_lag_and_what_friction_does() -> None:
    told = notes(Request("rotatum", cutoff=100.0), link={"inertia": M, "coulomb": 0.2})
    assert told["cutoff"] == "100 rad/s, 200 ms late (asked for)"
    assert "no part of a rate" in told["friction"]
    deadbeat = notes(Request("rotatum", cutoff=math.inf))
    assert deadbeat["cutoff"] == "deadbeat, 2 ms late (asked for)"
