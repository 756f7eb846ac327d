"""From a stage's flat text back to the lines its author wrote."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from rotatum.export.rules import BUILTINS
from rotatum.export.syntax import Meaning, without_docstring
from rotatum.runtime.errors import StageError
from rotatum.runtime.flatten import flatten
from rotatum.runtime.stage import Stage


class Source(NamedTuple):
    """A kernel as written: its file and its tree, with the positions it has in that file."""

    file: str
    node: ast.FunctionDef
    function: Callable[..., Any]

    @property
    def origin(self) -> str:
        """Dotted name of the kernel."""
        return f"{self.function.__module__}.{self.function.__qualname__}"


def source_of(function: Callable[..., Any]) -> Source:
    """Read a kernel's source. Raises ``StageError`` when there is none."""
    if not isinstance(function, FunctionType):
        raise StageError("a kernel must be a plain Python function", value=function)
    try:
        lines, first = inspect.getsourcelines(function)
    except OSError as error:
        raise StageError(
            f"the source of kernel {function.__qualname__} cannot be read: define it in a file"
        ) from error
    text = textwrap.dedent("".join(lines))
    node = ast.parse(text).body[0]
    if not isinstance(node, ast.FunctionDef):
        raise StageError("a kernel must be a def", value=function.__qualname__)
    indent = len(lines[0]) - len(lines[0].lstrip())
    for n in ast.walk(node):
        if isinstance(n, (ast.expr, ast.stmt)):
            n.lineno += max(first, 1) - 1
            n.col_offset += indent
    return Source(function.__code__.co_filename, node, function)


def reached(functions: list[Callable[..., Any]]) -> list[Source]:
    """Return the kernels that are called, directly or not, callers first."""
    todo, found = list(functions), dict[int, Source]()
    while todo:
        function = todo.pop(0)
        if id(function) in found:
            continue
        source = source_of(function)
        found[id(function)] = source
        for call in (n for n in ast.walk(source.node) if isinstance(n, ast.Call)):
            callee = resolve(source.function, call.func)
            if isinstance(callee, FunctionType):
                todo.append(callee)
    return list(found.values())


def resolve(function: Callable[..., Any], node: ast.expr) -> object:
    """Return what a name, or an attribute of a module, is in a function's module."""
    assert isinstance(function, FunctionType)  # source_of has looked
    if isinstance(node, ast.Name) and node.id not in function.__code__.co_varnames:
        return function.__globals__.get(node.id)
    if isinstance(node, ast.Attribute):
        module = resolve(function, node.value)
        if isinstance(module, ModuleType):
            return getattr(module, node.attr, None)
    return None


def meaning_in(function: Callable[..., Any], name: str) -> Meaning:
    """Return what a name that is not local means where the kernel is defined."""
    assert isinstance(function, FunctionType)  # source_of has looked
    if name not in function.__globals__:
        return "unknown"
    value = function.__globals__[name]
    if isinstance(value, FunctionType):
        return "function"
    if isinstance(value, ModuleType):
        known: dict[str, Meaning] = {"math": "math", "numpy": "numpy"}
        return known.get(value.__name__.partition(".")[0], "module")
    numeric = isinstance(value, (int, float)) and not isinstance(value, bool)
    return "number" if numeric and name not in BUILTINS else "other"


class FlatModule(NamedTuple):
    """A stage's flat text, parsed; positions are those of the authors' files where known.

    Args:
        functions: by flat name, callees before callers.
        sources: by flat name, where each was written.
    """

    functions: dict[str, ast.FunctionDef]
    sources: dict[str, Source]


def flat_module(stage: Stage) -> FlatModule:
    """Flatten and parse a stage. Raises ``StageError`` for what cannot be flattened."""
    functions = parse_functions(flatten(stage.init, stage.step))
    sources: dict[str, Source] = {}
    todo: list[tuple[str, Callable[..., Any]]] = [("init", stage.init), ("step", stage.step)]
    while todo:
        name, function = todo.pop()
        if name in sources:
            continue
        source = sources[name] = source_of(function)
        _Placer(functions, source, todo).function(functions[name])
    return FlatModule(functions, sources)


def parse_functions(text: str) -> dict[str, ast.FunctionDef]:
    """Return the top-level functions of a module text by name."""
    return {n.name: n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef)}


class _Placer:
    """Copies positions from a kernel as written to its flat twin, and finds its callees."""

    def __init__(
        self,
        functions: dict[str, ast.FunctionDef],
        source: Source,
        todo: list[tuple[str, Callable[..., Any]]],
    ) -> None:
        self.functions, self.source, self.todo = functions, source, todo

    def function(self, flat: ast.FunctionDef) -> None:
        original = self.source.node
        self._mark(flat, original)
        body = without_docstring(original)
        for a, b in zip(flat.body, body, strict=False):  # only a docstring leaves `pass` behind
            self.place(a, b)

    def place(self, flat: ast.AST, original: ast.AST) -> None:
        if type(flat) is not type(original):
            for node in ast.walk(flat):
                self._mark(node, original)
            return
        self._mark(flat, original)
        if isinstance(flat, ast.Call) and isinstance(original, ast.Call):
            self._callee(flat.func, original.func)
        for a, b in zip(ast.iter_child_nodes(flat), ast.iter_child_nodes(original), strict=False):
            self.place(a, b)

    def _callee(self, flat: ast.expr, original: ast.expr) -> None:
        vars(flat)["kernel_name"] = ast.unparse(original)
        if isinstance(flat, ast.Name) and flat.id in self.functions:
            function = resolve(self.source.function, original)
            if isinstance(function, FunctionType):
                self.todo.append((flat.id, function))

    def _mark(self, flat: ast.AST, original: ast.AST) -> None:
        if isinstance(flat, (ast.expr, ast.stmt)) and isinstance(original, (ast.expr, ast.stmt)):
            flat.lineno, flat.col_offset = original.lineno, original.col_offset
        # A plain attribute: every node of a flat text may come from another file.
        vars(flat)["kernel_file"] = self.source.file
