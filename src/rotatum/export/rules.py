"""The subset as tables: what is forbidden by name, and why."""

from __future__ import annotations

import ast

MATH = ("sqrt", "exp", "sin", "cos", "asin", "fabs")
"""Functions of ``math`` that compiled code and C take from the same libm."""

MATH_NUMBERS = ("pi", "inf", "nan")

BUILTINS = ("range", "len", "int", "float", "abs")

_NO_ALLOCATION = "a kernel allocates nothing; use a field of the state"
_NO_RAISE = "a kernel never raises; set a bit of the status instead"

NODES: dict[type[ast.AST], tuple[str, str]] = {
    ast.List: ("list", _NO_ALLOCATION),
    ast.Dict: ("dict", _NO_ALLOCATION),
    ast.Set: ("set", _NO_ALLOCATION),
    ast.Tuple: ("tuple", _NO_ALLOCATION),
    ast.ListComp: ("comprehension", _NO_ALLOCATION),
    ast.SetComp: ("comprehension", _NO_ALLOCATION),
    ast.DictComp: ("comprehension", _NO_ALLOCATION),
    ast.GeneratorExp: ("comprehension", _NO_ALLOCATION),
    ast.Slice: ("slice", "write the loop over the elements"),
    ast.Starred: ("star argument", "name every argument"),
    ast.JoinedStr: ("f-string", "kernels know numbers only"),
    ast.Lambda: ("lambda", "write a function at module level"),
    ast.FunctionDef: ("nested function", "write a function at module level"),
    ast.AsyncFunctionDef: ("async function", "a kernel is a plain def"),
    ast.ClassDef: ("class", "a kernel holds statements only"),
    ast.Import: ("import", "import at module level"),
    ast.ImportFrom: ("import", "import at module level"),
    ast.Try: ("try", _NO_RAISE),
    ast.Raise: ("raise", _NO_RAISE),
    ast.Assert: ("assert", _NO_RAISE),
    ast.With: ("with", "a kernel holds no resources"),
    ast.Global: ("global", "a kernel's memory is its state record"),
    ast.Nonlocal: ("nonlocal", "a kernel's memory is its state record"),
    ast.Delete: ("del", "a kernel owns no objects"),
    ast.Match: ("match", "write if and elif"),
    ast.NamedExpr: (":=", "assign in a statement of its own"),
    ast.Await: ("await", "a kernel is a plain def"),
    ast.Yield: ("yield", "a kernel takes one sample and returns"),
    ast.YieldFrom: ("yield", "a kernel takes one sample and returns"),
    ast.Pow: ("**", "compiled code and Python round powers differently; multiply"),
    ast.MatMult: ("@", "write the loops; BLAS adds in another order"),
    ast.FloorDiv: ("//", "rounds down in Python and towards zero in C"),
    ast.Mod: ("%", "takes the divisor's sign in Python and the dividend's in C"),
    ast.LShift: ("<<", "write the constant out"),
    ast.RShift: (">>", "differs in C for negative numbers"),
    ast.Is: ("is", "compare with =="),
    ast.IsNot: ("is not", "compare with !="),
    ast.In: ("in", "write the loop"),
    ast.NotIn: ("not in", "write the loop"),
}

CALLS: dict[str, str] = {
    "sum": "adds in an order C does not promise; write the loop",
    "min": "orders NaN differently in C; write the comparison",
    "max": "orders NaN differently in C; write the comparison",
    "sorted": _NO_ALLOCATION,
    "pow": "compiled code and Python round powers differently; multiply",
    "round": "rounds halves differently in C; add 0.5 and use int()",
    "divmod": "rounds down in Python and towards zero in C",
    "print": "a kernel only fills its output record",
    "enumerate": "write a loop over range()",
    "zip": "write a loop over range()",
    "bool": "write the comparison",
}
