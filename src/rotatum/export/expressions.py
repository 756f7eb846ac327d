"""Types of expressions."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence

from rotatum.export.instance import Instance
from rotatum.export.rules import MATH
from rotatum.export.types import BOOL, FLOAT, INT, Array, Record, Scalar, Type, of_field
from rotatum.export.violations import OutsideError, called

Call = Callable[[str, Sequence[Type], ast.Call], Instance]
"""Gives the instance of a kernel for argument types."""


class UnknownTypeError(Exception):
    """The type hangs on something already reported."""


class Expressions:
    """Finds the type of each expression of an instance; raises ``OutsideError`` if it has none.

    Args:
        instance: is filled in.
        call: gives the instance a call of a kernel leads to; None for what is no kernel.
    """

    def __init__(self, instance: Instance, kernels: frozenset[str], call: Call) -> None:
        self.instance, self.kernels, self.call = instance, kernels, call

    def value(self, node: ast.expr, *, may_write: bool = False) -> Type:
        """Return the type of an expression that is used as a value.

        Only where ``may_write`` may it hold a call that writes to its records: C may evaluate the
        parts of an expression in another order than Python, so nothing beside such a call may
        read a record.
        """
        found = self._value(node, may_write)
        self.instance.types[node] = found
        return found

    def number(self, node: ast.expr, *, may_write: bool = False) -> Scalar:
        """Return the type of an expression that must be an int or a float."""
        found = self.value(node, may_write=may_write)
        if found not in (INT, FLOAT) or not isinstance(found, Scalar):
            raise OutsideError(node, str(found), "a number is needed here")
        return found

    def condition(self, node: ast.expr, *, may_write: bool = False) -> None:
        """Check an expression that is used for its truth; C too takes its parts left to right."""
        if isinstance(node, ast.BoolOp):
            for part in node.values:
                self.condition(part, may_write=may_write)
            self.instance.types[node] = BOOL
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            self.condition(node.operand, may_write=may_write)
            self.instance.types[node] = BOOL
        elif self.value(node, may_write=may_write) not in (BOOL, INT):
            raise OutsideError(node, "truth of a float or record", "write the comparison")

    def _value(self, node: ast.expr, may_write: bool) -> Type:
        match node:
            case ast.Constant(value=bool()):
                return BOOL
            case ast.Constant(value=int()):
                return INT
            case ast.Constant(value=float()):
                return FLOAT
            case ast.Name():
                return self._name(node)
            case ast.Attribute():
                return self._attribute(node)
            case ast.Subscript():
                return self._subscript(node)
            case ast.BinOp():
                return self._binary(node, may_write)
            case ast.UnaryOp():
                return self._unary(node, may_write)
            case ast.BoolOp():
                if any(self.value(p, may_write=may_write) is not BOOL for p in node.values):
                    raise OutsideError(node, "and/or of numbers", "write the comparisons")
                return BOOL
            case ast.Compare():
                return self._compare(node, may_write)
            case ast.IfExp():
                return self._choice(node, may_write)
            case ast.Call():
                return self._call(node, may_write)
        raise OutsideError(node, type(node).__name__.lower(), "no expression of the subset")

    def _name(self, node: ast.Name) -> Type:
        found = self.instance.names.get(node.id)
        if found is None:
            raise UnknownTypeError
        return found

    def _attribute(self, node: ast.Attribute) -> Type:
        if isinstance(node.value, ast.Name) and node.value.id == "math":
            return FLOAT
        base = self.value(node.value)
        if not isinstance(base, Record):
            raise OutsideError(node, f"{base}.{node.attr}", "only records have fields")
        if node.attr not in base.layout.fields:
            known = ", ".join(base.layout.fields)
            raise OutsideError(node, node.attr, f"record {base} has the fields {known}")
        return of_field(base.layout.fields[node.attr])

    def _subscript(self, node: ast.Subscript) -> Type:
        base = self.value(node.value)
        index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if not isinstance(base, Array) or len(index) > len(base.dims):
            raise OutsideError(node, f"{base}[{', '.join('i' * len(index))}]", "too many indices")
        for part, size in zip(index, base.dims, strict=False):
            if self.value(part) is not INT:
                raise OutsideError(part, "index", "an index is an int")
            known = constant(part, self.instance)
            if known is not None and not 0 <= known < size:
                why = f"outside 0..{size - 1}; C does not count from the end"
                raise OutsideError(part, f"index {known}", why)
        rest = base.dims[len(index) :]
        return Array(base.item, rest) if rest else base.item

    def _binary(self, node: ast.BinOp, may_write: bool) -> Type:
        left = self.number(node.left, may_write=may_write and _still(node.right))
        right = self.number(node.right, may_write=may_write and _still(node.left))
        if isinstance(node.op, (ast.BitOr, ast.BitAnd, ast.BitXor)):
            if FLOAT in (left, right):
                raise OutsideError(node, "bit operation on a float", "bits are ints")
            return INT
        if isinstance(node.op, ast.Div):
            if left is INT and right is INT:
                raise OutsideError(node, "/ of ints", "C rounds it; convert one with float()")
            return FLOAT
        if not isinstance(node.op, (ast.Add, ast.Sub, ast.Mult)):
            raise UnknownTypeError
        return FLOAT if FLOAT in (left, right) else INT

    def _unary(self, node: ast.UnaryOp, may_write: bool) -> Type:
        if isinstance(node.op, ast.Not):
            self.condition(node.operand, may_write=may_write)
            return BOOL
        found = self.number(node.operand, may_write=may_write)
        if isinstance(node.op, ast.Invert) and found is not INT:
            raise OutsideError(node, "~ of a float", "bits are ints")
        return found

    def _compare(self, node: ast.Compare, may_write: bool) -> Type:
        parts = [node.left, *node.comparators]
        moving = [part for part in parts if not _still(part)]
        alone = may_write and len(moving) == 1
        kinds = {self.value(part, may_write=alone) for part in parts}
        equality = all(isinstance(op, (ast.Eq, ast.NotEq)) for op in node.ops)
        if not (kinds <= {INT, FLOAT} or (kinds == {BOOL} and equality)):
            what = " and ".join(sorted(str(k) for k in kinds))
            raise OutsideError(node, f"comparison of {what}", "compare numbers with numbers")
        return BOOL

    def _choice(self, node: ast.IfExp, may_write: bool) -> Type:
        self.condition(node.test, may_write=may_write)
        one, other = (self.value(n, may_write=may_write) for n in (node.body, node.orelse))
        if one != other or not isinstance(one, Scalar):
            raise OutsideError(node, f"{one} if ... else {other}", "both need one scalar type")
        return one

    def _call(self, node: ast.Call, may_write: bool) -> Type:
        if isinstance(node.func, ast.Attribute):
            self._count(node, 1)
            self.number(node.args[0])
            if node.func.attr not in MATH:
                raise UnknownTypeError
            return FLOAT
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name in self.kernels:
            callee = self.kernel(node, may_write=may_write)
            if callee.returns is None:
                raise OutsideError(node, called(node), "returns nothing")
            return callee.returns
        self._count(node, 1)
        if name == "len":
            base = self.value(node.args[0])
            if not isinstance(base, Array):
                raise OutsideError(node, f"len of {base}", "only vectors and matrices have one")
            return INT
        argument = self.number(node.args[0])
        if name == "abs" and argument is INT:
            raise OutsideError(node, "abs of an int", "write the comparison")
        if name not in ("int", "float", "abs"):
            raise UnknownTypeError
        return INT if name == "int" else FLOAT

    def kernel(self, node: ast.Call, *, may_write: bool) -> Instance:
        """Return the instance a call of a kernel leads to, having checked its arguments."""
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        types = [self.value(argument) for argument in node.args]
        callee = self.instance.calls[node] = self.call(name, types, node)
        for argument, parameter in zip(node.args, callee.arguments, strict=True):
            if parameter in callee.written:
                self.instance.written.setdefault(self.instance.root(argument), node)
        if callee.written and not may_write:
            why = "writes to its records, C may read them before or after: use a local"
            raise OutsideError(node, f"{called(node)} beside other parts", why)
        return callee

    def _count(self, node: ast.Call, count: int) -> None:
        if len(node.args) != count:
            raise OutsideError(node, f"{len(node.args)} arguments", f"takes {count}")


def _still(node: ast.expr) -> bool:
    """Whether no kernel can change an expression's value: locals and constants only."""
    parts = (n for n in ast.walk(node) if isinstance(n, ast.expr))
    return all(isinstance(n, (ast.Constant, ast.Name, ast.BinOp, ast.UnaryOp)) for n in parts)


def constant(node: ast.expr, instance: Instance) -> int | None:
    """Return the value of an integer expression known beforehand, or None."""
    match node:
        case ast.Constant(value=int() as value) if not isinstance(value, bool):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            inner = constant(operand, instance)
            return None if inner is None else -inner
        case ast.Call(func=ast.Name(id="len"), args=[argument]):
            found = instance.types.get(argument)
            return found.dims[0] if isinstance(found, Array) else None
        case ast.BinOp(left=left, op=op, right=right):
            a, b = constant(left, instance), constant(right, instance)
            if a is None or b is None:
                return None
            match op:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return a * b
                case ast.BitOr():
                    return a | b
    return None
