"""What is outside the exportable subset, where, and why."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import NamedTuple

from rotatum.errors import RotatumError

_SHOWN = 5  # violations spelled out in the message of an error; all are on the error


class Violation(NamedTuple):
    """One construct outside the subset.

    Args:
        file: path of the source, or the name of the text.
        line: counted from 1.
        column: counted from 1.
        what: the construct.
        why: what is wrong with it, or what to write instead.
    """

    file: str
    line: int
    column: int
    what: str
    why: str

    def __str__(self) -> str:
        """Spell the violation out as compilers do."""
        return f"{self.file}:{self.line}:{self.column}: {self.what}: {self.why}"


class SubsetError(RotatumError):
    """Kernels that cannot run bit for bit alike interpreted, compiled and as C.

    Args:
        violations: everything found, in order of file and line.
    """

    def __init__(self, violations: Sequence[Violation]) -> None:
        self.violations = tuple(violations)
        lines = [str(v) for v in self.violations[:_SHOWN]]
        if len(self.violations) > _SHOWN:
            lines.append(f"... and {len(self.violations) - _SHOWN} more")
        super().__init__("outside the exportable subset:\n" + "\n".join(lines) + "\n")


class OutsideError(Exception):
    """Raised inside the analysis at the node that leaves the subset; becomes a ``Violation``."""

    def __init__(self, node: ast.AST, what: str, why: str) -> None:
        super().__init__(what)
        self.node, self.what, self.why = node, what, why


def called(node: ast.AST) -> str:
    """Return how a call is written, as ``lowpass.smooth()``."""
    func = node.func if isinstance(node, ast.Call) else node
    name = func.id if isinstance(func, ast.Name) else "function"
    return f"{getattr(func, 'kernel_name', name)}()"


def violation(file: str, node: ast.AST, what: str, why: str) -> Violation:
    """Return the violation at a node of a tree parsed from ``file``."""
    line, column = getattr(node, "lineno", 1), getattr(node, "col_offset", 0) + 1
    return Violation(getattr(node, "kernel_file", file), line, column, what, why)
