"""The checker of the exportable subset: kernels that mean the same in Python, numba and C.

``python -m rotatum.export.subset [FILES...]`` prints ``file:line:column: what: why`` for
everything outside it and exits with 1 if there is anything. Without files it looks at the package's
kernels and elastic laws and, with types, at every registered stage.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import rotatum.kernels
import rotatum.models.laws
from rotatum.export.checker import in_file, in_kernels, in_stage, in_text, require_subset
from rotatum.export.violations import SubsetError, Violation
from rotatum.runtime.stage import Stage

__all__ = [
    "SubsetError",
    "Violation",
    "in_file",
    "in_kernels",
    "in_stage",
    "in_text",
    "main",
    "require_subset",
]


def main(files: Sequence[str]) -> int:
    """Print every violation; return 1 if there is one."""
    found: list[Violation] = []
    for path in [Path(f) for f in files] or _package_files():
        found += in_file(path)
    if not files:
        for stage in _registered():
            found += in_stage(stage)
    for v in dict.fromkeys(found):
        print(v)
    return 1 if found else 0


def _package_files() -> list[Path]:
    roots = (*rotatum.kernels.__path__, *rotatum.models.laws.__path__)
    return sorted(p for root in roots for p in Path(root).glob("*.py"))


def _registered() -> list[Stage]:
    from rotatum.estimators.registry import example_stages

    return [stage for stage, *_ in example_stages()]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
