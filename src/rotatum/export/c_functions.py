"""One instance of a kernel as a C function."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from rotatum.export.c_expressions import SUM, CExpressions, declarator, integer
from rotatum.export.expressions import constant
from rotatum.export.flow import assigned
from rotatum.export.instance import Instance
from rotatum.export.names import identifier, unique
from rotatum.export.scopes import declarations
from rotatum.export.structs import ROLES, Structs
from rotatum.export.types import Scalar

_INDENT = "    "
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.BitOr: "|", ast.BitAnd: "&", ast.BitXor: "^",
}  # fmt: skip


def prototype(instance: Instance, name: str, structs: Structs) -> str:
    """Return the head of the C function of an instance, without ``static``."""
    returns = "void" if instance.returns is None else instance.returns.c
    parameters = ", ".join(
        declarator(identifier(p), kind, structs, constant=p not in instance.written)
        for p, kind in instance.arguments.items()
    )
    return f"{returns} {name}({parameters or 'void'})"


def entry_prototype(instance: Instance, stage: str) -> str:
    """Return the head of the exported ``STAGE_init`` or ``STAGE_step``."""
    parameters = ", ".join(
        f"{'' if p in instance.written else 'const '}{stage}_{role}_t *{identifier(p)}"
        for p, role in zip(instance.arguments, ROLES, strict=False)
    )
    return f"void {stage}_{instance.kernel}({parameters})"


def body(instance: Instance, structs: Structs, names: Mapping[Instance, str]) -> str:
    """Return the braces of the C function of an instance and what is between them."""
    writer = _Writer(instance, structs, names)
    unused = [f"{_INDENT}(void){identifier(p)};" for p in instance.arguments if not writer.reads(p)]
    return "\n".join(["{", *unused, *writer.block(instance.node.body, 1), "}"])


class _Writer:
    def __init__(self, instance: Instance, structs: Structs, names: Mapping[Instance, str]) -> None:
        self.instance, self.structs = instance, structs
        self.c = CExpressions(instance, structs, names)
        self.declare = declarations(instance.node)
        self.taken = {identifier(n) for n in instance.names}

    def reads(self, name: str) -> bool:
        return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(self.instance.node))

    def block(self, statements: Sequence[ast.stmt], depth: int) -> list[str]:
        lines = []
        for statement in statements:
            for name in self.declare.before.get(statement, []):
                lines.append(f"{self._declaration(name)};")
            lines += self.statement(statement)
        return [_INDENT + line if line else line for line in lines] if depth else lines

    def statement(self, node: ast.stmt) -> list[str]:
        match node:
            case ast.Assign(targets=[target], value=value):
                return [self._assignment(node, target, value)]
            case ast.AnnAssign(target=target, value=value) if value is not None:
                return [self._assignment(node, target, value)]
            case ast.AugAssign(target=target, op=op, value=value):
                return [f"{self.c.place(target)} {_OPERATORS[type(op)]}= {self.c.text(value)};"]
            case ast.Expr(value=ast.Call() as call):
                return [f"{self.c.call(call)[0]};"]
            case ast.If():
                return self._if(node)
            case ast.While(test=test, body=inner):
                return [f"while ({self.c.text(test)}) {{", *self.block(inner, 1), "}"]
            case ast.For():
                return self._for(node)
            case ast.Return(value=value):
                return ["return;" if value is None else f"return {self.c.text(value)};"]
            case ast.Break():
                return ["break;"]
            case ast.Continue():
                return ["continue;"]
        return []  # pass

    def _assignment(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> str:
        if isinstance(target, ast.Name) and not isinstance(self.instance.names[target.id], Scalar):
            fixed = self._fixed(target.id)
            kind = self.instance.names[target.id]
            text = self.c.reference(value, kind, constant=fixed)
        else:
            text = self.c.text(value)
        name = self.declare.first.get(node)
        left = self.c.place(target) if name is None else self._declaration(name)
        return f"{left} = {text};"

    def _declaration(self, name: str) -> str:
        kind = self.instance.names[name]
        return declarator(identifier(name), kind, self.structs, constant=self._fixed(name))

    def _fixed(self, name: str) -> bool:
        root = self.instance.roots.get(name)
        return root is not None and root not in self.instance.written

    def _if(self, node: ast.If) -> list[str]:
        lines = [f"if ({self.c.text(node.test)}) {{", *self.block(node.body, 1)]
        while len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
            if node.orelse[0] in self.declare.before:
                break
            node = node.orelse[0]
            lines += [f"}} else if ({self.c.text(node.test)}) {{", *self.block(node.body, 1)]
        if node.orelse:
            lines += ["} else {", *self.block(node.orelse, 1)]
        return [*lines, "}"]

    def _for(self, node: ast.For) -> list[str]:
        assert isinstance(node.target, ast.Name)  # the syntax has been checked
        assert isinstance(node.iter, ast.Call)
        arguments = node.iter.args
        step = constant(arguments[2], self.instance) if len(arguments) > 2 else 1
        assert step is not None  # range() takes a literal step only
        i, lines = identifier(node.target.id), list[str]()
        begin = "0"
        if len(arguments) > 1:
            begin = self._once(f"{i}_begin", arguments[0], {node.target.id}, lines)
        end = arguments[1] if len(arguments) > 1 else arguments[0]
        stop = self._once(f"{i}_end", end, assigned(node), lines)
        test = f"{i} {'<' if step > 0 else '>'} {stop}"
        count = {1: f"++{i}", -1: f"--{i}"}.get(step, f"{i} += {integer(step)}")
        head = f"for (int64_t {i} = {begin}; {test}; {count}) {{"
        return [*lines, head, *self.block(node.body, 1), "}"]

    def _once(self, name: str, bound: ast.expr, changed: set[str], lines: list[str]) -> str:
        """Return C for a bound; through a constant if C, looking again, could see another value."""
        stays = all(
            isinstance(n, (ast.Constant, ast.BinOp))
            or (isinstance(n, ast.Name) and n.id not in changed)
            for n in _parts(bound, self.instance)
        )
        if stays:
            return self.c.text(bound, SUM)
        constant_name = unique(name, self.taken)
        lines.append(f"const int64_t {constant_name} = {self.c.text(bound)};")
        return constant_name


def _parts(node: ast.expr, instance: Instance) -> Iterator[ast.AST]:
    """Yield the nodes of an expression, leaving out what is known beforehand."""
    if constant(node, instance) is not None:
        return
    yield node
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):
            yield from _parts(child, instance)
