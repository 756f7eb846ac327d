"""Where a kernel's locals are declared in C: as late and as deep as every use allows."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

Block = Sequence[ast.stmt]


@dataclass
class Declarations:
    """Names to declare at a statement.

    Args:
        first: names declared by the very assignment that is the key.
        before: names declared, without a value, before the statement that is the key.
    """

    first: dict[ast.stmt, str] = field(default_factory=dict)
    before: dict[ast.stmt, list[str]] = field(default_factory=dict)


def declarations(node: ast.FunctionDef) -> Declarations:
    """Place the declaration of every local of a function, loop variables apart."""
    found = Declarations()
    parameters = {a.arg for a in node.args.args}
    names = dict.fromkeys(name for name in _stored(node.body) if name not in parameters)
    for name in names:
        _place(name, node.body, found)
    return found


def _place(name: str, block: Block, found: Declarations) -> None:
    users = [s for s in block if _mentions(name, s)]
    if not users:
        return
    first = users[0]
    if len(users) == 1 and not _mentions_head(name, first):
        for inner in _blocks(first):
            _place(name, inner, found)
        return
    if _assigns(name, first):
        found.first[first] = name
    else:
        found.before.setdefault(first, []).append(name)


def _assigns(name: str, statement: ast.stmt) -> bool:
    match statement:
        case ast.Assign(targets=[ast.Name(id=target)], value=value):
            return target == name and not _reads(name, value)
        case ast.AnnAssign(target=ast.Name(id=target), value=value) if value is not None:
            return target == name and not _reads(name, value)
    return False


def _reads(name: str, node: ast.AST) -> bool:
    return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(node))


def _mentions(name: str, statement: ast.stmt) -> bool:
    """Whether a statement uses a local, and not only a loop variable of the same name."""
    if isinstance(statement, ast.For) and _is_variable(name, statement):
        return _reads(name, statement.iter)
    if _mentions_head(name, statement):
        return True
    return any(_mentions(name, s) for block in _blocks(statement) for s in block)


def _mentions_head(name: str, statement: ast.stmt) -> bool:
    match statement:
        case ast.If(test=test) | ast.While(test=test):
            return _reads(name, test)
        case ast.For(iter=head):
            return _reads(name, head)
    return _reads(name, statement)


def _is_variable(name: str, loop: ast.For) -> bool:
    return isinstance(loop.target, ast.Name) and loop.target.id == name


def _blocks(statement: ast.stmt) -> list[Block]:
    match statement:
        case ast.If(body=body, orelse=orelse):
            return [body, orelse]
        case ast.For(body=body) | ast.While(body=body):
            return [body]
    return []


def _stored(block: Block) -> Iterator[str]:
    """Yield the names assigned in a block and below, loop variables apart."""
    for statement in block:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)]):
                yield name
            case ast.AnnAssign(target=ast.Name(id=name)) | ast.AugAssign(target=ast.Name(id=name)):
                yield name
        for inner in _blocks(statement):
            yield from _stored(inner)
