"""Expressions as C text with the grouping of the Python tree, so that rounding is the same."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from rotatum.export.expressions import constant
from rotatum.export.instance import Instance
from rotatum.export.names import identifier
from rotatum.export.structs import Structs
from rotatum.export.types import Array, Record, Scalar, Type

# Binding strengths. Everything below COMPARE is bracketed wherever it is part of something else.
LOOSE, COMPARE, SUM, PRODUCT, UNARY, ATOM = range(6)

_OPERATORS: dict[type[ast.AST], tuple[str, int]] = {
    ast.Add: ("+", SUM), ast.Sub: ("-", SUM), ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT),
    ast.BitOr: ("|", LOOSE), ast.BitAnd: ("&", LOOSE), ast.BitXor: ("^", LOOSE),
}  # fmt: skip
_COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
}  # fmt: skip
_MATH_NUMBERS = {"pi": "3.141592653589793", "inf": "INFINITY", "nan": "NAN"}
_WIDE = 1 << 15  # products of two smaller literals fit C's int


class CExpressions:
    """Writes the expressions of one instance.

    Args:
        instance: with the types found by inference.
        structs: the stage's structs.
        names: C name of every instance.
    """

    def __init__(self, instance: Instance, structs: Structs, names: Mapping[Instance, str]) -> None:
        self.instance, self.structs, self.names = instance, structs, names

    def text(self, node: ast.expr, least: int = LOOSE) -> str:
        """Return C for an expression, bracketed if it binds less than ``least``."""
        text, strength = self._text(node)
        return f"({text})" if strength < least else text

    def _text(self, node: ast.expr) -> tuple[str, int]:
        known = constant(node, self.instance)
        if known is not None:
            return integer(known), ATOM if known >= 0 else UNARY
        match node:
            case ast.Constant(value=value):
                return (str(value).lower() if isinstance(value, bool) else repr(value)), ATOM
            case ast.Name(id=name):
                return identifier(name), ATOM
            case ast.Attribute() | ast.Subscript():
                return self.place(node), ATOM
            case ast.BinOp():
                return self._binary(node)
            case ast.UnaryOp(op=op, operand=operand):
                sign = {ast.USub: "-", ast.UAdd: "+", ast.Not: "!", ast.Invert: "~"}[type(op)]
                return sign + self.text(operand, ATOM), UNARY
            case ast.BoolOp(op=op, values=values):
                sign = " && " if isinstance(op, ast.And) else " || "
                return sign.join(self.text(v, COMPARE) for v in values), LOOSE
            case ast.Compare():
                return self._compare(node)
            case ast.IfExp(test=test, body=body, orelse=orelse):
                parts = [self.text(part, SUM) for part in (test, body, orelse)]
                return f"{parts[0]} ? {parts[1]} : {parts[2]}", LOOSE
            case ast.Call():
                return self.call(node)
        raise AssertionError(ast.dump(node))  # inference accepts nothing else

    def place(self, node: ast.expr) -> str:
        """Return C for a name, field or element, to read or to assign."""
        match node:
            case ast.Name(id=name):
                return identifier(name)
            case ast.Attribute(value=ast.Name(id="math"), attr=attr):
                return _MATH_NUMBERS[attr]
            case ast.Attribute(value=ast.Name(id=name), attr=attr):
                return f"{identifier(name)}->{identifier(attr)}"
            case ast.Attribute(value=value, attr=attr):
                return f"{self.place(value)}.{identifier(attr)}"
            case ast.Subscript(value=value, slice=index):
                parts = index.elts if isinstance(index, ast.Tuple) else [index]
                return self.place(value) + "".join(f"[{self.text(part)}]" for part in parts)
        raise AssertionError(ast.dump(node))  # inference accepts nothing else

    def reference(self, node: ast.expr, kind: Type, *, constant: bool) -> str:
        """Return C for a pointer to a record or to the first element of an array."""
        text = self.place(node)
        if isinstance(kind, Record):
            return text if isinstance(node, ast.Name) else f"&{text}"
        assert isinstance(kind, Array)
        if len(kind.dims) == 1 or not constant:
            return text
        # C99 does not add const to what a pointer to an array points to on its own.
        return f"({declarator('', kind, self.structs, constant=True)}){text}"

    def call(self, node: ast.Call) -> tuple[str, int]:
        """Return C for a call and its strength."""
        callee = self.instance.calls.get(node)
        if callee is None:
            return self._builtin(node)
        arguments = []
        for argument, (name, kind) in zip(node.args, callee.arguments.items(), strict=True):
            if isinstance(kind, Scalar):
                arguments.append(self.text(argument))
            else:
                constant = name not in callee.written
                arguments.append(self.reference(argument, kind, constant=constant))
        return f"{self.names[callee]}({', '.join(arguments)})", ATOM

    def _builtin(self, node: ast.Call) -> tuple[str, int]:
        if isinstance(node.func, ast.Attribute):
            return f"{node.func.attr}({self.text(node.args[0])})", ATOM
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name == "abs":
            return f"fabs({self.text(node.args[0])})", ATOM
        kind = "int64_t" if name == "int" else "double"
        return f"({kind}){self.text(node.args[0], UNARY)}", UNARY

    def _binary(self, node: ast.BinOp) -> tuple[str, int]:
        sign, strength = _OPERATORS[type(node.op)]
        bits = strength == LOOSE
        left = self.text(node.left, UNARY if bits else strength)
        right = self.text(node.right, ATOM if not bits else UNARY)
        if not bits and strength == SUM:
            right = self.text(node.right, PRODUCT)
            if right.startswith(("-", "+")):
                right = f"({right})"
        return f"{left} {sign} {right}", strength

    def _compare(self, node: ast.Compare) -> tuple[str, int]:
        parts = [node.left, *node.comparators]
        pairs = [
            f"{self.text(a, SUM)} {_COMPARISONS[type(op)]} {self.text(b, SUM)}"
            for a, op, b in zip(parts, node.ops, parts[1:], strict=False)
        ]
        return " && ".join(pairs), COMPARE if len(pairs) == 1 else LOOSE


def integer(value: int) -> str:
    """Return an integer literal wide enough for arithmetic with its like."""
    if value == -(2**63):
        return "INT64_MIN"
    return str(value) if abs(value) < _WIDE else f"INT64_C({value})"


def declarator(name: str, kind: Type, structs: Structs, *, constant: bool) -> str:
    """Return the C declaration of a parameter or local of a type."""
    if isinstance(kind, Scalar):
        return f"{kind.c} {name}"
    const = "const " if constant else ""
    if isinstance(kind, Record):
        return f"{const}{structs.c_type(kind)} *{name}"
    item = structs.c_type(kind.item)
    rest = "".join(f"[{d}]" for d in kind.dims[1:])
    return f"{const}{item} (*{name}){rest}" if rest else f"{const}{item} *{name}"
