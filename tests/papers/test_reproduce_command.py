"""`rotatum reproduce`: the list, a case, its page, its JSON, a misspelt name."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rotatum.evaluation.papers.case import Case, Curve, Figure, Map, Outcome, Plot, Value
from rotatum.evaluation.papers.catalogue import PAPERS, Paper
from rotatum.report.case_page import case_page, cells, columns
from tests.cli.runs import run


def test_without_a_paper_the_cases_are_listed() -> None:
    done = run("reproduce")
    assert done.code == 0
    for case in PAPERS["flacco2012"].cases:
        assert f"flacco2012:{case.name}" in done.out
    listed = json.loads(run("reproduce", "--json").out)
    assert list(listed["flacco2012"]) == [case.name for case in PAPERS["flacco2012"].cases]


def test_a_case_prints_its_table_and_writes_its_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "160")  # a narrow terminal folds the labels
    done = run("reproduce", "flacco2012:validation", "-o", tmp_path, "--quick")
    assert done.code == 0
    assert "rms error over rms torque" in done.out
    assert "The paper prints no torques" in done.out
    assert [p.name for p in tmp_path.iterdir()] == ["flacco2012-validation.html"]
    page = (tmp_path / "flacco2012-validation.html").read_text("utf-8")
    assert page.count("data-plot=") == 2  # figures


def test_what_waits_says_so_and_is_no_success(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcome = Outcome((Value("why", "1", own=2.0),), findings=("Not reproduced.",))
    case = Case("later", "a table", "", (), lambda p, q: outcome, "waits for a method")
    monkeypatch.setitem(PAPERS, "someone2030", Paper("someone2030", "A title", (case,)))
    done = run("reproduce", "someone2030:later", "-o", tmp_path, "--json")
    assert done.code == 1
    assert "later waits for a method" in done.err
    (told,) = json.loads(done.out).values()
    assert told["values"][0]["paper_settings"] == 2.0
    assert told["findings"] == ["Not reproduced."]


def test_nothing_of_a_paper_waits() -> None:
    assert not [case.name for paper in PAPERS.values() for case in paper.cases if case.waits]


def test_a_misspelt_case_is_bad_input(tmp_path: Path) -> None:
    done = run("reproduce", "flacco2012:tabel2", "-o", tmp_path)
    assert done.code == 2
    assert 'Did you mean "table2"?' in done.err
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_a_file_is_said_before_the_work(tmp_path: Path) -> None:
    place = tmp_path / "file"
    place.write_text("here")
    done = run("reproduce", "flacco2012:validation", "-o", place)
    assert done.code == 2
    assert "is a file, not a folder" in done.err


def test_a_page_has_every_number_and_figure_and_no_stray_markup() -> None:
    from numpy import arange, ones

    x = arange(1.0, 4.0)
    curves = (Curve("actual", x, x, "dashed"), Curve("<b>", x, 2.0 * x, "points"))
    plots = (
        Plot("left, N m", curves, logarithmic=True, limits=(1.0, 10.0)),
        Plot("arm", (), map=Map("torque", x, x, ones((3, 3)))),
    )
    figure = Figure("one", "A figure", "Read it so.", "deflection, rad", plots)
    outcome = Outcome((Value("a < b", "%", 0.05, None, 1.25e-7),), (figure,), ("Found.",))
    case = Case("c", "a title", "Prints this.", ("Assumed that.",), lambda p, q: outcome)
    page = case_page("A paper", case, outcome)
    for words in ("a &lt; b", "0.05", "1.25e-07", "Found.", "Assumed that.", "Read it so."):
        assert words in page
    assert "<b>" not in page.partition("<script>")[0]
    assert 'id="plot-one"' in page
    assert '"type":"heatmap"' in page.replace(" ", "")
    assert '"type":"log"' in page.replace(" ", "")
    assert "algebraic" not in page.partition("<script>")[0]  # no line has a number of it
    without = case_page("A paper", case, Outcome(outcome.values))
    assert len(without) < 20_000  # nothing to draw: no plotly


def test_a_method_only_some_papers_need_has_a_column_where_it_has_a_number() -> None:
    values = (Value("error", "%", 0.7, 0.5, 0.01, 0.02), Value("other", "%", own=3.0))
    assert columns(values)[2:] == (
        "paper", "ours, the paper's settings", "ours, algebraic", "ours, weak",
    )  # fmt: skip
    assert cells(values[0], columns(values)) == ["error", "%", "0.7", "0.5", "0.02", "0.01"]
    assert cells(values[1], columns(values)) == ["other", "%", "", "3", "", ""]
    assert "ours, algebraic" not in columns(values[1:])


def test_an_observer_stands_between_doing_without_and_the_truth() -> None:
    value = Value("link, rms", "mrad", without=0.5, observed=0.02, true=0.0)
    assert columns([value]) == ("", "unit", "without observer", "observer", "true state")
    assert cells(value, columns([value])) == ["link, rms", "mrad", "0.5", "0.02", "0"]
    told = value.to_json()
    assert [told[k] for k in ("without_observer", "observer", "true_state")] == [0.5, 0.02, 0.0]
    assert told["weak"] is None
    assert "observer" not in Value("error", "%", own=3.0).to_json()


def test_plots_over_one_logarithmic_axis_all_are() -> None:
    from numpy import arange

    x = arange(1.0, 4.0)
    plots = tuple(Plot(title, (Curve("a", x, x),)) for title in ("first", "second", "third"))
    figure = Figure("one", "A figure", "Note.", "noise, rad", plots, logarithmic=True)
    case = Case("c", "a title", "Prints this.", ("Assumed that.",), lambda p, q: Outcome(()))
    page = case_page("A paper", case, Outcome((), (figure,)))
    assert page.replace(" ", "").count('"type":"log"') == 3
