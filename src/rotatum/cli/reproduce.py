"""`rotatum reproduce`: the papers' tables and figures, computed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rotatum.cli.failures import DONE, NO_ANSWER, say
from rotatum.cli.options import Json

if TYPE_CHECKING:
    from rotatum.evaluation.papers.case import Case, Outcome
    from rotatum.evaluation.papers.catalogue import Paper

__all__ = ["reproduce"]


def reproduce(
    request: Annotated[
        str | None,
        typer.Argument(
            metavar="PAPER[:CASE]",
            help="Such as flacco2012 or flacco2012:table1; without it the cases are listed.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for a page with the figures per case.")
    ] = Path("rotatum-reproduce"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer noise seeds and sparser sweeps.")
    ] = False,
    json: Json = False,
) -> int:
    """Compute the papers' tables and figures again.

    Prints, for each case, the paper's value, ours with the paper's own settings, and ours with
    method weak (of menard2013 with algebraic, of trumic2022 with rotatum too; of deluca2007 with
    its observer and without), and says what was assumed where the paper is silent.

    Exit code 0: done; 1: every case asked for still waits for something, which is said.
    """
    from rotatum.evaluation.papers.catalogue import PAPERS, asked_for

    if request is None:
        _list(PAPERS, json)
        return DONE
    from rotatum.cli.places import check_folder
    from rotatum.cli.printing import print_json

    paper, cases = asked_for(request)
    check_folder(output)
    told = {}
    for case in cases:
        outcome = _run(case, quick)
        page = _written(paper, case, outcome, output)
        told[f"{paper.key}:{case.name}"] = {**outcome.to_json(), "page": str(page)}
        if not json:
            _print(paper, case, outcome, page)
    if json:
        print_json(told)
    return NO_ANSWER if all(case.waits for case in cases) else DONE


def _run(case: Case, quick: bool) -> Outcome:
    from rotatum.cli.progress import progress

    with progress(case.name) as shown:
        outcome = case.run(shown, quick)
    if case.waits:
        say(f"warning: {case.name} {case.waits}")
    return outcome


def _written(paper: Paper, case: Case, outcome: Outcome, folder: Path) -> Path:
    from rotatum.report.case_page import write_case_page

    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{paper.key}-{case.name}.html"
    return write_case_page(paper.title, case, outcome, path)


def _print(paper: Paper, case: Case, outcome: Outcome, page: Path) -> None:
    from rotatum.cli.printing import stdout
    from rotatum.cli.tables import table_of
    from rotatum.report.case_page import cells, columns

    title = f"{paper.key}:{case.name}: {case.title}"
    titles = columns(outcome.values)
    table = table_of(*titles, title=title, numbers=tuple(range(2, len(titles))))
    for value in outcome.values:
        table.add_row(*cells(value, titles))
    console = stdout()
    console.print(table)
    for sentence in (case.prints, *outcome.findings, *case.assumed):
        console.print(f"- {sentence}")
    console.print(f"{page}\n")


def _list(papers: dict[str, Paper], json: bool) -> None:
    from rotatum.cli.printing import print_json, stdout
    from rotatum.cli.tables import table_of

    if json:
        print_json({p.key: {case.name: case.title for case in p.cases} for p in papers.values()})
        return
    console = stdout()
    for paper in papers.values():
        table = table_of("case", "what it is", title=f"{paper.key}: {paper.title}")
        for case in paper.cases:
            table.add_row(f"{paper.key}:{case.name}", case.title)
        console.print(table)
    console.print("rotatum reproduce PAPER runs all of a paper, rotatum reproduce PAPER:CASE one.")
