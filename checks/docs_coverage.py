"""Is everything public documented? ``python -m checks.docs_coverage docs/_build/html/objects.inv``.

Every public name has a docstring and an entry in the built API reference; every record and field
says what it is; every key of a device file, verdict and status bit is on its reference page.
"""

from __future__ import annotations

import inspect
import re
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

import rotatum
from checks import surface
from rotatum import models
from rotatum.kernels import status
from rotatum.models.explain import key_names
from rotatum.models.quantity import Uncertain
from rotatum.models.table import Table

REFERENCE = Path(__file__).resolve().parent.parent / "docs" / "reference"


def main(inventory: Path) -> int:
    """Print every gap; return 1 if there is one."""
    gaps = [*_names(_inventory(inventory)), *_records(), *_pages()]
    for gap in gaps:
        print(gap)
    print(f"docs coverage: {len(gaps)} gaps" if gaps else "docs coverage: complete")
    return 1 if gaps else 0


def _inventory(path: Path) -> set[str]:
    """Names in a Sphinx inventory: four header lines, then compressed `name domain:role ...`."""
    with path.open("rb") as file:
        for _ in range(4):
            file.readline()
        lines = zlib.decompress(file.read()).decode("utf-8").splitlines()
    return {line.split(" ", 1)[0] for line in lines if " py:" in line}


def _names(documented: set[str]) -> Iterator[str]:
    wanted = {
        f"{m.__name__}.{name}": v
        for m in surface.modules()
        for name, v in surface.defined(m).items()
    }
    for name in rotatum.__all__:
        if not name.startswith("__"):
            wanted.setdefault(surface.canonical(name), getattr(rotatum, name))
    for name, value in sorted(wanted.items()):
        if not (inspect.getdoc(value) or "").strip():
            yield f"{name}: no docstring"
        if name not in documented:
            yield f"{name}: not in the API reference"


def _records() -> Iterator[str]:
    for record in surface.records():
        for name, field in record.fields().items():
            if not field.doc:
                yield f"{surface.home(record)}.{record.__name__}.{name}: says nothing of itself"


def _pages() -> Iterator[str]:
    keys = {key for table in _tables() for key in key_names(table)}
    keys -= {"given"}  # a law's constants, which stand in elastic-laws.md
    keys |= {field for field in Uncertain.__dataclass_fields__}
    yield from _missing("device-file.md", keys | set(models.FIT_QUANTITIES))
    yield from _missing("log-files.md", {role for roles in models.ROLES.values() for role in roles})
    yield from _missing("verdicts.md", set(status.VERDICTS))


def _tables() -> set[type[Table]]:
    return set(Table.__subclasses__())


def _missing(page: str, words: set[str]) -> Iterator[str]:
    """Words that stand nowhere in the page as code."""
    text = (REFERENCE / page).read_text("utf-8")
    code = " ".join(re.findall(r"```.*?```|`[^`\n]+`", text, flags=re.DOTALL))
    present = set(re.findall(r"\w+", code))
    for word in sorted(words - present):
        yield f"docs/reference/{page}: nothing on `{word}`"


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
