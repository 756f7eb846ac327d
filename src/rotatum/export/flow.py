"""Locals along every path through a kernel: assigned before used, used at all, returned alike."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

Problem = tuple[ast.AST, str, str]


def parameters(node: ast.FunctionDef) -> set[str]:
    """Return the names of a function's parameters."""
    args = node.args
    named = [*args.posonlyargs, *args.args, *args.kwonlyargs]
    return {a.arg for a in (*named, args.vararg, args.kwarg) if a is not None}


def assigned(node: ast.AST) -> set[str]:
    """Return the names stored to anywhere below a node, loop variables included."""
    return {
        n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }


def problems(node: ast.FunctionDef) -> list[Problem]:
    """Return what is wrong with the paths through a function."""
    path = _Path(node)
    end = path.block(node.body, parameters(node))
    found = path.found + list(_unused(node))
    returns = [n for n in ast.walk(node) if isinstance(n, ast.Return)]
    valued = [n for n in returns if n.value is not None]
    if valued and (end is not None or len(valued) < len(returns)):
        odd = next((n for n in returns if n.value is None), node)
        found.append((odd, "return", "every path must return a number, or none"))
    return found


def _unused(node: ast.FunctionDef) -> Iterator[Problem]:
    read = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
    for statement in ast.walk(node):
        if isinstance(statement, (ast.Assign, ast.AugAssign, ast.AnnAssign)):
            for name in sorted(assigned(statement) - read):
                yield statement, name, "assigned and never used"


class _Path:
    """Definite assignment: the set of names assigned on every way to a point.

    ``None`` stands for a point that no way reaches.
    """

    def __init__(self, node: ast.FunctionDef) -> None:
        self.found: list[Problem] = []
        self.locals = assigned(node)

    def block(self, statements: Sequence[ast.stmt], before: set[str] | None) -> set[str] | None:
        at = before
        for statement in statements:
            if at is None:
                self.found.append((statement, "unreachable statement", "remove it"))
                return None
            at = self.statement(statement, at)
        return at

    def statement(self, node: ast.stmt, at: set[str]) -> set[str] | None:
        match node:
            case ast.If():
                self.read(node.test, at)
                return _meet(self.block(node.body, at), self.block(node.orelse, at))
            case ast.For():
                return self.loop(node, at)
            case ast.While():
                self.read(node.test, at)
                self.block(node.body, at)
                return at
            case ast.Return() | ast.Break() | ast.Continue():
                self.read(node, at)
                return None
            case ast.AugAssign(target=ast.Name() as target):
                self.read(node.value, at)
                self.read(ast.copy_location(ast.Name(target.id, ast.Load()), target), at)
                return at
            case _:
                self.read(node, at)
                return at | assigned(node)

    def loop(self, node: ast.For, at: set[str]) -> set[str]:
        self.read(node.iter, at)
        variable = node.target.id if isinstance(node.target, ast.Name) else ""
        for inner in node.body:
            for store in ast.walk(inner):
                if (
                    isinstance(store, ast.Name)
                    and store.id == variable
                    and isinstance(store.ctx, ast.Store)
                ):
                    self.found.append((store, variable, "the variable of a loop is assigned in it"))
        self.block(node.body, at | {variable})
        return at - {variable}

    def read(self, node: ast.AST, at: set[str]) -> None:
        for n in ast.walk(node):
            loaded = isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load) and n.id in self.locals
            if isinstance(n, ast.Name) and loaded and n.id not in at:
                why = "not assigned on every path to here (a loop may run zero times)"
                self.found.append((n, n.id, why))


def _meet(a: set[str] | None, b: set[str] | None) -> set[str] | None:
    if a is None or b is None:
        return b if a is None else a
    return a & b
