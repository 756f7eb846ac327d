"""The part of the subset that can be seen without knowing types."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Literal

from rotatum.export import flow
from rotatum.export.rules import BUILTINS, CALLS, MATH, MATH_NUMBERS, NODES
from rotatum.export.violations import Violation, violation

Meaning = Literal["function", "number", "math", "numpy", "module", "other", "unknown"]
Meanings = Callable[[str], Meaning]
"""What a name that is not local means in the module a kernel is written in."""

_STATEMENTS = (
    ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Expr, ast.For, ast.While, ast.If,
    ast.Return, ast.Break, ast.Continue, ast.Pass,
)  # fmt: skip


def check_function(node: ast.FunctionDef, meanings: Meanings, file: str) -> list[Violation]:
    """List what a kernel's own text does outside the subset, in order of position."""
    checker = _Checker(node, meanings, file)
    checker.function(node)
    for place, what, why in flow.problems(node):
        checker.report(place, what, why)
    return sorted(set(checker.found))


def without_docstring(node: ast.FunctionDef) -> list[ast.stmt]:
    """Return the statements of a function after its docstring."""
    return node.body[1:] if ast.get_docstring(node) is not None else node.body


class _Checker(ast.NodeVisitor):
    def __init__(self, node: ast.FunctionDef, meanings: Meanings, file: str) -> None:
        self.meanings, self.file = meanings, file
        self.local = flow.parameters(node) | flow.assigned(node)
        self.found: list[Violation] = []

    def report(self, node: ast.AST, what: str, why: str) -> None:
        self.found.append(violation(self.file, node, what, why))

    def function(self, node: ast.FunctionDef) -> None:
        args = node.args
        if args.defaults or args.kw_defaults:
            self.report(node, "default argument", "pass every argument")
        if args.vararg or args.kwarg or args.kwonlyargs:
            self.report(node, "star or keyword-only parameter", "name every parameter")
        for decorator in node.decorator_list:
            self.report(decorator, "decorator", "kernels are compiled by the runtime")
        for statement in without_docstring(node):
            self.visit(statement)

    def visit(self, node: ast.AST) -> None:
        known = NODES.get(type(node))
        if known is not None:
            self.report(node, *known)
        elif isinstance(node, ast.stmt) and not isinstance(node, _STATEMENTS):
            self.report(node, type(node).__name__.lower(), "no statement of the subset")
        else:
            super().visit(node)

    def visit_Assign(self, node: ast.Assign) -> None:
        if len(node.targets) > 1:
            self.report(node, "a = b = ...", "write one assignment per line")
        self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is None:
            self.report(node, "declaration without a value", "assign a value")
            return
        self.visit(node.target)
        self.visit(node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._operator(node, node.op)
        self.visit(node.target)
        self.visit(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Call):
            self.report(node, "expression statement", "it has no effect")
        self.visit(node.value)

    def visit_For(self, node: ast.For) -> None:
        if node.orelse:
            self.report(node.orelse[0], "for ... else", "C has no such thing")
        if not isinstance(node.target, ast.Name):
            self.report(node.target, "loop target", "loop over one integer")
        loop = node.iter
        if isinstance(loop, ast.Call) and isinstance(loop.func, ast.Name):
            if loop.func.id != "range":
                self.visit(loop)
                self.report(loop, "for over a call", "loop over range()")
            else:
                self._range(loop)
        else:
            self.report(loop, "for over a sequence", "loop over range()")
        for statement in node.body:
            self.visit(statement)

    def visit_While(self, node: ast.While) -> None:
        if node.orelse:
            self.report(node.orelse[0], "while ... else", "C has no such thing")
        if isinstance(node.test, ast.Constant):
            self.report(node, "while without a bound", "loop over range() and break")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if not isinstance(value, (int, float)):
            what = "string" if isinstance(value, (str, bytes)) else repr(value)
            self.report(node, what, "kernels know numbers only")
        elif isinstance(value, float) and value - value != 0.0:
            self.report(node, "constant overflow", "no float64 holds it")
        elif isinstance(value, int) and abs(value) >= 2**63:
            self.report(node, "constant overflow", "no 64-bit integer holds it")

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self._operator(node, node.op)
        if isinstance(node.op, (ast.Add, ast.Sub)) and (_zero(node.left) or _zero(node.right)):
            # GCC 12 makes -fabs(x) out of 0.0 - fabs(x), should a user leave out our flags.
            self.report(node, "0.0 in a sum", "compilers drop it and lose the sign of a zero")
        self.visit(node.left)
        self.visit(node.right)

    def visit_Compare(self, node: ast.Compare) -> None:
        for op in node.ops:
            self._operator(node, op)
        for middle in node.comparators[:-1]:
            if any(isinstance(n, ast.Call) for n in ast.walk(middle)):
                self.report(middle, "chained comparison of a call", "C would call it twice")
        for part in (node.left, *node.comparators):
            self.visit(part)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)
        index = node.slice
        for part in index.elts if isinstance(index, ast.Tuple) else [index]:
            self.visit(part)

    def visit_Name(self, node: ast.Name) -> None:
        if node.id in self.local:
            return
        meaning = self.meanings(node.id)
        if meaning == "numpy":
            self.report(node, "numpy", "differs from libm in the last bit; use math")
        elif meaning == "unknown" and node.id not in BUILTINS:
            self.report(node, node.id, "no local, kernel or number constant of that name")
        elif meaning == "other":
            self.report(node, node.id, "a global: only kernels and number constants are reached")

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if self._of_module(node) == "math" and node.attr not in MATH_NUMBERS:
            self.report(node, f"math.{node.attr}", f"math has {', '.join(MATH)} in the subset")
        elif self._of_module(node) != "module":
            self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        for keyword in node.keywords:
            self.report(node, f"keyword argument {keyword.arg}", "pass arguments by position")
        self._callee(node.func)
        for argument in node.args:
            self.visit(argument)

    def _callee(self, func: ast.expr) -> None:
        if isinstance(func, ast.Name):
            if func.id in self.local:
                self.report(func, f"{func.id}()", "a local is not a kernel")
            elif func.id in CALLS:
                self.report(func, f"{func.id}()", CALLS[func.id])
            elif func.id == "range":
                self.report(func, "range()", "only in the head of a for loop")
            elif func.id not in BUILTINS and self.meanings(func.id) != "function":
                self.report(func, f"{func.id}()", "unknown function; kernels call kernels and math")
        elif isinstance(func, ast.Attribute) and self._of_module(func) == "math":
            if func.attr not in MATH:
                known = ", ".join(MATH)
                self.report(func, f"math.{func.attr}()", f"the subset has {known} of math")
        elif not (isinstance(func, ast.Attribute) and self._of_module(func) == "module"):
            numpy = isinstance(func, ast.Attribute) and self._of_module(func) == "numpy"
            why = "differs from libm; use math" if numpy else "no methods in kernels"
            self.report(func, f"{ast.unparse(func)}()", why)

    def _of_module(self, node: ast.Attribute) -> Meaning | None:
        if isinstance(node.value, ast.Name) and node.value.id not in self.local:
            return self.meanings(node.value.id)
        return None

    def _operator(self, node: ast.AST, op: ast.operator | ast.cmpop) -> None:
        known = NODES.get(type(op))
        if known is not None:
            self.report(node, *known)

    def _range(self, call: ast.Call) -> None:
        for keyword in call.keywords:
            self.report(call, f"keyword argument {keyword.arg}", "pass arguments by position")
        if len(call.args) == 3 and not _literal_step(call.args[2]):
            self.report(call.args[2], "step of range()", "write a non-zero integer constant")
        for argument in call.args:
            self.visit(argument)


def _literal_step(node: ast.expr) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value != 0


def _zero(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) is float and node.value == 0.0
