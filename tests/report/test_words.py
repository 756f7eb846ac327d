"""Numbers and units in words."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotatum.estimators.registry import example_stages
from rotatum.kernels.status import VERDICTS
from rotatum.report.palette import VERDICT_COLOURS, VERDICT_MEANINGS
from rotatum.report.references import REFERENCES, reference
from rotatum.report.view import view
from rotatum.report.words import measure, number
from tests.report.scenes import DEVICE, small_device, small_estimate


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (545.145, 0.579, "545.1 +- 1.1"),
        (-0.00123, 0.00404, "-0.0012 +- 0.0079"),
        (4.9236e6, 4.5e5, "(4.92 +- 0.88)e6"),
        (12_345.6, 61.0, "12350 +- 120"),
        (3.0, 0.0, "3"),
        (float("nan"), 1.0, "-"),
    ],
)
def test_a_value_has_the_digits_of_its_interval(value: float, std: float, text: str) -> None:
    assert measure(value, std) == text


@given(
    st.floats(1e-9, 1e9) | st.floats(-1e9, -1e-9),
    st.floats(1e-4, 1e2),
)
def test_a_value_can_be_read_back(value: float, relative: float) -> None:
    half = 1.96 * abs(value) * relative
    found = re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", measure(value, half / 1.96).replace("+-", " "))
    scale = 10.0 ** int(found[2]) if len(found) == 3 else 1.0
    # two digits of the interval: it is right to 5 %, and the value to 5 % of the interval
    assert float(found[1]) * scale == pytest.approx(half, rel=0.051)
    assert float(found[0]) * scale == pytest.approx(value, abs=0.051 * half)


def test_numbers_without_value_are_dashes() -> None:
    assert number(None) == number(float("inf")) == "-"
    assert number(4363.21, 3) == "4360"


def test_a_current_makes_ampere_per_radian() -> None:
    current = DEVICE.replace('hold = "held"', 'hold = "held", unit = "mA"')
    assert small_device(current).joints[0].torque_unit("estimated") == "A"
    assert small_device(current).joints[0].torque_unit("sensor") == "N m"
    assert small_device().joints[0].torque_unit("estimated") == "N m"


def test_a_view_is_in_order_of_time() -> None:
    found = small_estimate()
    joint = found.joints["elbow"]
    records = joint.records.copy()
    records["time"][100:110] = records["time"][50:60]
    records["time"][200] = float("nan")
    changed = type(joint)(**{**vars(joint), "records": records})
    shown = view(type(found)(**{**vars(found), "joints": {"elbow": changed}}), "elbow")
    assert len(shown.time) == len(records) - 11
    assert (shown.time[1:] > shown.time[:-1]).all()


def test_every_paper_a_stage_cites_is_written_out() -> None:
    cited = {key for example in example_stages(10) for key in example.stage.cites}
    assert {"flacco2012", "menard2013", "shinbrot1957"} <= cited
    assert cited <= set(REFERENCES)
    assert set(small_estimate().cites) <= set(REFERENCES)
    assert "10.1177/0278364912461813" in reference("flacco2012").text()
    assert reference("somebody2040").authors == "somebody2040"


def test_every_verdict_has_colour_and_meaning() -> None:
    assert list(VERDICT_COLOURS) == list(VERDICT_MEANINGS) == list(VERDICTS)
