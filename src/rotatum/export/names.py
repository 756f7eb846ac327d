"""Python names as C identifiers."""

from __future__ import annotations

import re

_C = """auto break case char const continue default do double else enum extern float for goto if
inline int long register restrict return short signed sizeof static struct switch typedef union
unsigned void volatile while bool true false NAN INFINITY NULL
sqrt exp sin cos asin fabs int64_t main"""
_CPP = """alignas alignof and asm catch class compl constexpr decltype delete explicit export friend
mutable namespace new noexcept not nullptr operator or private protected public template this throw
try typeid typename using virtual wchar_t xor"""

RESERVED = frozenset(f"{_C} {_CPP}".split())
"""Words that mean something else in C99, in C++ (which reads headers), or in generated code."""


def identifier(name: str) -> str:
    """Return a name usable in C and C++: itself, or with a trailing underscore."""
    return f"{name}_" if name in RESERVED else name


def snake(name: str) -> str:
    """Return a CamelCase name in lower case with underscores.

    >>> snake("UdState")
    'ud_state'
    """
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def unique(name: str, taken: set[str]) -> str:
    """Return a name not taken yet, by counting up, and take it."""
    candidate, count = name, 1
    while candidate in taken:
        count += 1
        candidate = f"{name}_{count}"
    taken.add(candidate)
    return candidate
