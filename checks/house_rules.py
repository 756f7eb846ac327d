"""House rules of the source that no linter knows: ``python -m checks.house_rules``.

Sizes (a file fits into the head, a function onto a screen), no star imports, no ``**kwargs``
handed on, no rooms for everything, no inner module importing through the front door, and no
address or path of somebody's machine.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILE_LINES = 400
FUNCTION_LINES = 60
EVERYTHING_ROOMS = {"utils", "util", "misc", "common", "helpers", "helper", "core", "base"}
PROSE = (".md", ".toml", ".txt", ".cff", ".py", ".cfg", ".yml")
FOLDERS = ("src", "tests", "docs", "examples", "benchmarks", "checks", ".ci")
HOMES = ("home", "Users", "root", "tmp/[a-z]")
ADDRESS = re.compile(
    r"(?<![\w.])/(?:"
    + "|".join(HOMES)
    + r")/|index"
    + r"-url|https?://[\w.]*(?:pypi|pythonhosted)\."
)


def main() -> int:
    """Print every breach; return 1 if there is one."""
    breaches = [*_sources(), *_texts()]
    for breach in breaches:
        print(breach)
    print(f"house rules: {len(breaches)} breaches" if breaches else "house rules: kept")
    return 1 if breaches else 0


def _sources() -> Iterator[str]:
    for path in sorted((ROOT / "src").rglob("*.py")):
        where = path.relative_to(ROOT)
        text = path.read_text("utf-8")
        lines = text.count("\n")
        if lines > FILE_LINES:
            yield f"{where}: {lines} lines, at most {FILE_LINES}: split it by idea"
        if EVERYTHING_ROOMS & {part.removesuffix(".py") for part in where.parts}:
            yield f"{where}: a room for everything; name it after its one idea"
        tree = ast.parse(text)
        for node in ast.walk(tree):
            yield from (f"{where}:{line}: {what}" for line, what in _judge(node, where))


def _judge(node: ast.AST, where: Path) -> Iterator[tuple[int, str]]:
    if isinstance(node, ast.ImportFrom):
        if any(alias.name == "*" for alias in node.names):
            yield node.lineno, "star import"
        if node.module == "rotatum" and "cli" not in where.parts and _names_values(node):
            yield node.lineno, "import from the module that defines it, not from the package's root"
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        if node.args.kwarg is not None and _passes_on(node, node.args.kwarg.arg):
            yield node.lineno, f"{node.name}: passes **{node.args.kwarg.arg} on; name the arguments"
        size = _body_lines(node)
        if size > FUNCTION_LINES:
            yield node.lineno, f"{node.name}: {size} lines, at most {FUNCTION_LINES}"


def _passes_on(node: ast.AST, name: str) -> bool:
    """Whether a function hands its ``**name`` to another."""
    calls = (call for call in ast.walk(node) if isinstance(call, ast.Call))
    return any(
        word.arg is None and isinstance(word.value, ast.Name) and word.value.id == name
        for call in calls
        for word in call.keywords
    )


def _names_values(node: ast.ImportFrom) -> bool:
    """Whether ``from rotatum import ...`` asks for more than submodules."""
    package = ROOT / "src" / "rotatum"
    return any(
        not (package / alias.name).is_dir() and not (package / f"{alias.name}.py").exists()
        for alias in node.names
    )


def _body_lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function without its signature and docstring."""
    body = node.body[1:] if ast.get_docstring(node) is not None else node.body
    return (body[-1].end_lineno or 0) - body[0].lineno + 1 if body else 0


def _texts() -> Iterator[str]:
    paths = [p for folder in FOLDERS for p in (ROOT / folder).rglob("*") if p.suffix in PROSE]
    paths += [p for p in ROOT.iterdir() if p.suffix in PROSE or p.name == "Makefile"]
    for path in sorted(paths):
        where = path.relative_to(ROOT)
        if "_build" in where.parts or where.parts[0] == ".venv":
            continue
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            if found := ADDRESS.search(line):
                yield f"{where}:{number}: somebody's machine or registry: {found.group()}"


if __name__ == "__main__":
    sys.exit(main())
