"""What type inference finds out about one kernel called with one list of argument types."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from rotatum.export.types import Scalar, Type


@dataclass(eq=False)
class Instance:
    """A kernel for given argument types: one C function.

    Args:
        kernel: name of the kernel in the flat text.
        node: its tree.
        arguments: type by parameter, in order.
        names: type by local, parameters included; loop variables are integers.
        returns: type of the result, None without one.
        types: type of every expression.
        calls: what each call of a kernel calls.
        written: parameters whose records are written to, each with a place where that is done.
        roots: for a local that stands for part of a record, the parameter it belongs to.
    """

    kernel: str
    node: ast.FunctionDef
    arguments: dict[str, Type]
    names: dict[str, Type] = field(default_factory=dict)
    returns: Scalar | None = None
    types: dict[ast.expr, Type] = field(default_factory=dict)
    calls: dict[ast.Call, Instance] = field(default_factory=dict)
    written: dict[str, ast.AST] = field(default_factory=dict)
    roots: dict[str, str] = field(default_factory=dict)

    def root(self, node: ast.expr) -> str:
        """Return the parameter whose record an expression refers into."""
        while isinstance(node, (ast.Attribute, ast.Subscript)):
            node = node.value
        name = node.id if isinstance(node, ast.Name) else ""
        return self.roots.get(name, name)
