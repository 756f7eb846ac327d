"""Pages written at build time: the API reference (one per package) and the papers cited."""

from __future__ import annotations

import inspect
from collections import defaultdict
from pathlib import Path

from sphinx.application import Sphinx

import rotatum
from checks import surface
from rotatum.report.references import REFERENCES


def write(app: Sphinx) -> None:
    """Write the pages that changed and remove those of packages that are gone."""
    folder = Path(app.srcdir) / "reference" / "api"
    folder.mkdir(parents=True, exist_ok=True)
    pages = _packages()
    texts = {f"{package}.md": _page(package, names) for package, names in pages.items()}
    texts["index.md"] = _index(sorted(pages))
    for stale in {p.name for p in folder.glob("*.md")} - set(texts):
        (folder / stale).unlink()
    for name, text in texts.items():
        _put(folder / name, text)
    _put(folder.parent / "references.md", _references())


def _put(path: Path, text: str) -> None:
    """Write a page unless it is the same: Sphinx then need not read it again."""
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def _packages() -> dict[str, list[str]]:
    """Packages and modules that define something, by the first name below ``rotatum``."""
    found: dict[str, list[str]] = defaultdict(list)
    for module in surface.modules():
        if surface.defined(module) or module.__name__.count(".") == 1:
            found[module.__name__.split(".")[1]].append(module.__name__)
    return found


def _page(package: str, names: list[str]) -> str:
    sections = [f"# rotatum.{package}\n"]
    for name in names:
        if len(names) > 1:
            sections.append(f"## {name}\n")
        options = "   :members:\n   :ignore-module-all:\n   :member-order: bysource\n"
        sections.append(f"```{{eval-rst}}\n.. automodule:: {name}\n{options}```\n")
    return "\n".join(sections)


def _index(packages: list[str]) -> str:
    rows = [_row(name) for name in rotatum.__all__ if not name.startswith("__")]
    return (
        "# Python API\n\n"
        "What `import rotatum as rt` offers:\n\n"
        "| Name | What it is |\n|---|---|\n" + "\n".join(rows) + "\n\n"
        "The packages below hold these and what they are made of.\n\n"
        "```{toctree}\n:maxdepth: 1\n\n" + "\n".join(packages) + "\n```\n"
    )


def _row(name: str) -> str:
    value = getattr(rotatum, name)
    first = (inspect.getdoc(value) or "").partition("\n")[0].replace("|", "\\|").replace("``", "`")
    role = "mod" if inspect.ismodule(value) else "obj"
    return f"| {{py:{role}}}`rt.{name} <{surface.canonical(name)}>` | {first} |"


def _references() -> str:
    """Headings are the keys, so that other pages can link to ``references.md#key``."""
    parts = ["# References\n\nBy the key that stages, reports and docstrings cite.\n"]
    for key, paper in sorted(REFERENCES.items()):
        link = f" [doi:{paper.doi}](https://doi.org/{paper.doi})" if paper.doi else ""
        text = f"{paper.authors}. *{paper.title}*. {paper.where}.{link}"
        parts.append(f"## {key}\n\n{text}\n\nHere: {paper.why}.\n")
    return "\n".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for its sources."""
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True}
