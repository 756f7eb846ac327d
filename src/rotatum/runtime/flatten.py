"""All kernels a stage reaches, as one text.

That text is what runs interpreted, what numba compiles and caches (its cache looks only at the
file of the decorated function, so callees must not live in another one), and what is exported as C.
"""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable
from numbers import Integral, Real
from types import FunctionType, ModuleType
from typing import Any

from rotatum.runtime.errors import StageError

DRIVERS = """
def start(params, state):
    for j in range(len(state)):
        init(params[j], state[j])

def run(params, state, u, out):
    j = 0
    for k in range(len(u)):
        step(params[j], state[j], u[k], out[k])
        j = j + 1
        if j == len(state):
            j = 0
"""


def flatten(init: Callable[..., None], step: Callable[..., None]) -> str:
    """Return one module text with ``init`` and ``step`` last and every callee before its caller.

    Callees get the name ``<module>_<function>``; integer and float constants are written out as
    literals; docstrings, annotations and decorators go.
    """
    walker = _Walker()
    walker.visit(init, "init")
    walker.visit(step, "step")
    return "import math\n\n" + "\n\n".join(walker.texts) + "\n"


class _Walker:
    def __init__(self) -> None:
        self.texts: list[str] = []
        self.names: dict[FunctionType, str] = {}

    def visit(self, function: Callable[..., None], name: str) -> str:
        if not isinstance(function, FunctionType):
            raise StageError("a kernel must be a plain Python function", value=function)
        node = _definition(function)
        node.name = name
        self.names[function] = name
        _Rename(self, function).visit(node)
        self.texts.append(ast.unparse(ast.fix_missing_locations(node)))
        return name

    def callee(self, function: FunctionType) -> str:
        if function not in self.names:
            name = f"{function.__module__.rsplit('.', 1)[-1]}_{function.__name__}"
            while name in self.names.values():
                name += "_"
            self.visit(function, name)
        return self.names[function]


class _Rename(ast.NodeTransformer):
    """Replace what a name means in the kernel's module by what it is called in the flat text."""

    def __init__(self, walker: _Walker, function: FunctionType) -> None:
        self.walker, self.function = walker, function
        code = function.__code__
        self.local = set(code.co_varnames)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id in self.local:
            return node
        value = _resolve(self.function, node.id)
        if isinstance(value, FunctionType):
            return ast.copy_location(ast.Name(self.walker.callee(value), node.ctx), node)
        if _is_number(value):
            return ast.copy_location(_literal(value), node)
        if value is math or node.id in ("range", "len", "int", "float", "abs"):
            return node
        raise StageError(
            f"kernel {self.function.__qualname__} uses {node.id!r}, line {node.lineno}: only other "
            "kernels, math and number constants can be reached",
            value=value,
        )

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if isinstance(node.value, ast.Name) and node.value.id not in self.local:
            module = _resolve(self.function, node.value.id)
            if isinstance(module, ModuleType) and module is not math:
                value = getattr(module, node.attr, None)
                if isinstance(value, FunctionType):
                    return ast.copy_location(ast.Name(self.walker.callee(value), node.ctx), node)
                if _is_number(value):
                    return ast.copy_location(_literal(value), node)
        return self.generic_visit(node)


def _resolve(function: FunctionType, name: str) -> Any:
    return function.__globals__.get(name)


def _is_number(value: object) -> bool:
    return isinstance(value, (Integral, Real)) and not isinstance(value, bool)


def _literal(number: Any) -> ast.expr:
    # numpy's numbers print themselves with their type, which no text that is C too can say.
    value = int(number) if isinstance(number, Integral) else float(number)
    if value < 0:
        return ast.UnaryOp(ast.USub(), ast.Constant(-value))
    return ast.Constant(value)


def _definition(function: FunctionType) -> ast.FunctionDef:
    try:
        source = textwrap.dedent(inspect.getsource(function))
    except OSError as error:
        raise StageError(
            f"the source of kernel {function.__qualname__} cannot be read: define it in a file"
        ) from error
    node = ast.parse(source).body[0]
    if not isinstance(node, ast.FunctionDef):
        raise StageError("a kernel must be a def", value=function.__qualname__)
    node.decorator_list = []
    node.returns = None
    for arg in node.args.args:
        arg.annotation = None
    if ast.get_docstring(node) is not None:
        node.body = node.body[1:] or [ast.Pass()]
    return node
