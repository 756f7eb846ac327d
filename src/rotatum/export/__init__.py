"""C99 from stages: the subset checker, the translation, and the exported project."""

from __future__ import annotations

from rotatum.export.compiler import CompilerError
from rotatum.export.project import Exported, export_c
from rotatum.export.shared import CompiledC, build_shared
from rotatum.export.translate import CSource, translate
from rotatum.export.violations import SubsetError, Violation

__all__ = [
    "CSource",
    "CompiledC",
    "CompilerError",
    "Exported",
    "SubsetError",
    "Violation",
    "build_shared",
    "export_c",
    "translate",
]
