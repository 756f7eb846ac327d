"""Types of a whole stage: one instance of a kernel per list of argument types it is called with."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

from rotatum.export.expressions import Expressions, UnknownTypeError
from rotatum.export.instance import Instance
from rotatum.export.sources import FlatModule
from rotatum.export.types import BOOL, FLOAT, INT, Scalar, Type, of_layout
from rotatum.export.violations import OutsideError, Violation, called, violation
from rotatum.runtime.stage import Stage


def infer_stage(stage: Stage, flat: FlatModule) -> Inference:
    """Infer the types of a stage's kernels from its layouts; ``entries`` has init and step."""
    inference = Inference(flat.functions, f"<flat {stage.name}>")
    layouts = (stage.params, stage.state, stage.input, stage.output)
    params, state, u, out = map(of_layout, layouts)
    for name, types in (("init", (params, state)), ("step", (params, state, u, out))):
        names = [a.arg for a in flat.functions[name].args.args]
        inference.entry(name, types, written=names[1::2])  # state, and in step out
    return inference


class Inference:
    """Walks kernels from their entry; collects instances, callees first, and violations.

    Args:
        functions: every kernel of the flat text.
        file: name of the text, for kernels whose file is not known.
    """

    def __init__(self, functions: Mapping[str, ast.FunctionDef], file: str) -> None:
        self.functions, self.file = functions, file
        self.instances: list[Instance] = []
        self.entries: dict[str, Instance] = {}
        self.violations: list[Violation] = []
        self._known: dict[tuple[str, tuple[Type, ...]], Instance | None] = {}

    def entry(self, name: str, arguments: Sequence[Type], written: Sequence[str]) -> None:
        """Infer an entry kernel, which may write to the parameters named and to no others."""
        node = self.functions[name]
        try:
            instance = self.instance(name, arguments, node)
        except OutsideError as outside:
            self.report(outside)
            return
        for parameter, place in instance.written.items():
            if parameter not in written:
                why = "a kernel leaves its params and its input as they are"
                self.report(OutsideError(place, f"{parameter} is written to", why))
        instance.written |= dict.fromkeys(written, node)
        self.entries[name] = instance

    def instance(self, name: str, arguments: Sequence[Type], place: ast.AST) -> Instance:
        """Return the instance of a kernel for argument types, inferring it at first sight."""
        key = name, tuple(arguments)
        if key in self._known:
            found = self._known[key]
            if found is None:
                raise OutsideError(place, f"{called(place)} calls itself", "write a loop")
            return found
        node = self.functions[name]
        parameters = [a.arg for a in node.args.args]
        if len(parameters) != len(arguments):
            what = f"{called(place)} with {len(arguments)} arguments"
            raise OutsideError(place, what, f"takes {len(parameters)}: {', '.join(parameters)}")
        self._known[key] = None
        instance = Instance(name, node, dict(zip(parameters, arguments, strict=True)))
        instance.names |= instance.arguments
        _Body(self, instance).run()
        self._known[key] = instance
        self.instances.append(instance)
        return instance

    def report(self, outside: OutsideError) -> None:
        """Note a violation, once."""
        found = violation(self.file, outside.node, outside.what, outside.why)
        if found not in self.violations:
            self.violations.append(found)


class _Body:
    """The statements of one instance, in order."""

    def __init__(self, inference: Inference, instance: Instance) -> None:
        self.inference, self.instance = inference, instance
        kernels = frozenset(inference.functions)
        self.expressions = Expressions(instance, kernels, inference.instance)

    def run(self) -> None:
        self.block(self.instance.node.body)

    def block(self, statements: Sequence[ast.stmt]) -> None:
        for statement in statements:
            try:
                self.statement(statement)
            except OutsideError as outside:
                self.inference.report(outside)
            except UnknownTypeError:
                continue  # follows from a violation that has been reported

    def statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Assign(targets=[target], value=value):
                self.assign(target, value)
            case ast.AnnAssign(target=target, value=value) if value is not None:
                self.assign(target, value)
            case ast.AugAssign():
                self.augmented(node)
            case ast.Expr(value=ast.Call() as call):
                self.call(call)
            case ast.If():
                self.guarded(node.test)
                self.block(node.body)
                self.block(node.orelse)
            case ast.While():
                self.guarded(node.test)
                self.block(node.body)
            case ast.For():
                self.loop(node)
            case ast.Return(value=value) if value is not None:
                self.result(node, value)

    def guarded(self, test: ast.expr) -> None:
        try:
            self.expressions.condition(test, may_write=True)
        except OutsideError as outside:  # the branches are checked all the same
            self.inference.report(outside)
        except UnknownTypeError:
            return

    def call(self, node: ast.Call) -> None:
        if isinstance(node.func, ast.Name) and node.func.id in self.inference.functions:
            self.expressions.kernel(node, may_write=True)
        else:
            raise OutsideError(node, "expression statement", "it has no effect")

    def assign(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Name):
            found = self.expressions.value(value, may_write=True)
            self.local(target, found)
            if not isinstance(found, Scalar):
                self.alias(target, value)
            return
        found = self.expressions.value(value, may_write=_plain(target))
        self.store(target, found)

    def local(self, target: ast.Name, found: Type) -> None:
        before = self.instance.names.setdefault(target.id, found)
        self.instance.types[target] = before
        if before != found:
            what = f"{target.id} is {before} and {found}"
            raise OutsideError(target, what, "a local keeps one type; write 0.0 for a float zero")

    def alias(self, target: ast.Name, value: ast.expr) -> None:
        stores = [
            n for n in ast.walk(self.instance.node)
            if isinstance(n, ast.Name) and n.id == target.id and isinstance(n.ctx, ast.Store)
        ]  # fmt: skip
        if len(stores) > 1 or target.id in self.instance.arguments:
            raise OutsideError(target, f"{target.id} names two records", "use a name for each")
        self.instance.roots[target.id] = self.instance.root(value)

    def store(self, target: ast.expr, found: Type) -> None:
        kind = self.expressions.value(target)
        self.instance.written.setdefault(self.instance.root(target), target)
        if not isinstance(kind, Scalar) or not isinstance(found, Scalar):
            raise OutsideError(target, f"assignment to {kind}", "copy element by element in a loop")
        if kind != found and not (kind is FLOAT and found is INT):
            why = "convert with int()" if found is FLOAT else "write 1 and 0"
            raise OutsideError(target, f"{found} stored in a field of {kind}", why)

    def augmented(self, node: ast.AugAssign) -> None:
        target = node.target
        read = ast.copy_location(ast.BinOp(_load(target), node.op, node.value), node)
        vars(read)["kernel_file"] = vars(node).get("kernel_file", self.inference.file)
        found = self.expressions.value(read)
        if isinstance(target, ast.Name):
            self.local(target, found)
        else:
            self.store(target, found)

    def loop(self, node: ast.For) -> None:
        assert isinstance(node.target, ast.Name)  # the syntax has been checked before types are
        assert isinstance(node.iter, ast.Call)
        for argument in node.iter.args:
            if self.expressions.value(argument) is not INT:
                raise OutsideError(argument, "range() of a float", "loops count ints")
        self.local(node.target, INT)
        self.block(node.body)

    def result(self, node: ast.Return, value: ast.expr) -> None:
        found = self.expressions.value(value, may_write=True)
        if found not in (INT, FLOAT, BOOL) or not isinstance(found, Scalar):
            raise OutsideError(
                value, f"return of {found}", "a kernel returns one number or nothing"
            )
        if self.instance.returns not in (None, found):
            what = f"returns {self.instance.returns} and {found}"
            raise OutsideError(node, what, "every return has one type; write 0.0 for a float zero")
        self.instance.returns = found


def _load(target: ast.expr) -> ast.expr:
    """Return the target of an augmented assignment as it is read."""
    match target:
        case ast.Name(id=name):
            return ast.copy_location(ast.Name(name, ast.Load()), target)
        case _:
            return target


def _plain(target: ast.expr) -> bool:
    """Whether where a target lies cannot depend on records: fields, locals and constants only."""
    while isinstance(target, (ast.Attribute, ast.Subscript)):
        if isinstance(target, ast.Subscript):
            index = target.slice.elts if isinstance(target.slice, ast.Tuple) else [target.slice]
            if not all(isinstance(i, (ast.Name, ast.Constant)) for i in index):
                return False
        target = target.value
    return True
