"""What kernels do outside the exportable subset: in texts, files, functions and stages."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from rotatum.export.infer import infer_stage
from rotatum.export.rules import BUILTINS
from rotatum.export.sources import flat_module, meaning_in, reached
from rotatum.export.syntax import Meaning, check_function
from rotatum.export.violations import SubsetError, Violation, violation
from rotatum.runtime.stage import Stage

__all__ = ["in_file", "in_kernels", "in_stage", "in_text", "require_subset"]

_RECORDS = ("Any", "Vector")  # annotations of what only a kernel takes


def in_text(text: str, file: str = "<text>") -> list[Violation]:
    """List what a module's kernels do outside the subset, as far as it shows without types.

    Kernels are the functions with a parameter that is a record (annotated ``Any`` or not at all)
    or a record's vector (``Vector``), and what they call in the same module; the other functions
    belong to Python.
    """
    tree = ast.parse(text)
    functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    meanings = _module_names(tree)

    def meaning(name: str) -> Meaning:
        return meanings.get(name, "unknown")

    found = [v for n in _kernels(functions) for v in check_function(n, meaning, file)]
    return sorted(found)


def in_file(path: Path) -> list[Violation]:
    """List what the kernels of a module file do outside the subset."""
    return in_text(path.read_text(encoding="utf-8"), str(path))


def in_kernels(*kernels: Callable[..., Any]) -> list[Violation]:
    """List what kernels, and all they call, do outside the subset, without types."""
    found = []
    for source in reached(list(kernels)):

        def meaning(name: str, function: Any = source.function) -> Meaning:
            return meaning_in(function, name)

        found += check_function(source.node, meaning, source.file)
    return sorted(set(found))


def in_stage(stage: Stage) -> list[Violation]:
    """List what a stage's kernels do outside the subset, types included.

    Types are looked at once everything that shows without them is in order.
    """
    return in_kernels(stage.init, stage.step) or _wrong_parameters(stage) or _by_types(stage)


def require_subset(stage: Stage) -> None:
    """Raise ``SubsetError`` unless a stage is inside the subset."""
    found = in_stage(stage)
    if found:
        raise SubsetError(found)


def _by_types(stage: Stage) -> list[Violation]:
    return sorted(infer_stage(stage, flat_module(stage)).violations)


def _wrong_parameters(stage: Stage) -> list[Violation]:
    found = []
    sources = reached([stage.init, stage.step])
    for function, takes in ((stage.init, "params, state"), (stage.step, "params, state, u, out")):
        source = next(s for s in sources if s.function is function)
        names = [a.arg for a in source.node.args.args]
        if len(names) != len(takes.split(",")):
            what = f"{source.node.name}({', '.join(names)})"
            found.append(violation(source.file, source.node, what, f"takes {takes}"))
    return found


def _kernels(functions: dict[str, ast.FunctionDef]) -> Iterator[ast.FunctionDef]:
    todo = [name for name, node in functions.items() if _takes_record(node)]
    seen: set[str] = set()
    while todo:
        name = todo.pop(0)
        if name in seen or name not in functions:
            continue
        seen.add(name)
        yield functions[name]
        calls = (n.func for n in ast.walk(functions[name]) if isinstance(n, ast.Call))
        todo += [func.id for func in calls if isinstance(func, ast.Name)]


def _takes_record(node: ast.FunctionDef) -> bool:
    notes = [a.annotation for a in node.args.args]
    return any(n is None or (isinstance(n, ast.Name) and n.id in _RECORDS) for n in notes)


def _module_names(tree: ast.Module) -> dict[str, Meaning]:
    found: dict[str, Meaning] = {}
    for node in tree.body:
        match node:
            case ast.FunctionDef(name=name):
                found[name] = "function"
            case ast.Import(names=names):
                for alias in names:
                    root = alias.name.partition(".")[0]
                    found[(alias.asname or root)] = _module(root)
            case ast.ImportFrom(module=module, names=names):
                for alias in names:
                    found[alias.asname or alias.name] = _imported(module or "", alias.name)
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                found[name] = "number" if _numeric(value, found) else "other"
    return {name: m for name, m in found.items() if name not in BUILTINS}


def _module(root: str) -> Meaning:
    known: dict[str, Meaning] = {"math": "math", "numpy": "numpy"}
    return known.get(root, "module")


def _imported(module: str, name: str) -> Meaning:
    if module.partition(".")[0] in ("math", "numpy"):
        return "other"
    if name.isupper():
        return "number"
    # `from rotatum.kernels import rls` is a module, `from rotatum.kernels.rls import update` not.
    within = importlib.util.find_spec(module) if module else None
    is_package = within is not None and within.submodule_search_locations is not None
    return "module" if is_package else "function"


def _numeric(node: ast.expr, known: dict[str, Meaning]) -> bool:
    return all(
        (isinstance(n, ast.Constant) and type(n.value) in (int, float))
        or (isinstance(n, ast.Name) and known.get(n.id) == "number")
        or isinstance(n, (ast.BinOp, ast.UnaryOp, ast.operator, ast.unaryop, ast.expr_context))
        for n in ast.walk(node)
    )
