"""The C compiler of this machine."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from rotatum.errors import RotatumError

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-frounding-math")
"""What exported C is compiled with.

No contraction to fused multiply-adds, which round once instead of twice. And nothing folded that
hangs on rounding: without ``-frounding-math`` GCC 12 makes ``-fabs(x)`` out of ``0.0 - fabs(x)``,
a zero of the other sign. It costs at most 2 % of the time of a step.
"""

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")


class CompilerError(RotatumError):
    """There is no C compiler, or it refused exported code."""


def compiler() -> str:
    """Return the compiler's path: ``CC``, or the first of cc, gcc and clang.

    Raises:
        CompilerError: none is installed.
    """
    wanted = os.environ.get("CC")
    for name in [wanted] if wanted else ["cc", "gcc", "clang"]:
        found = shutil.which(name)
        if found is not None:
            return found
    raise CompilerError(
        "no C compiler was found",
        value=wanted,
        allowed="cc, gcc or clang on the PATH, or another one named by CC",
    )


def compile_shared(sources: Sequence[Path], library: Path) -> None:
    """Compile C files to a shared library. Raises ``CompilerError`` with the compiler's words."""
    command = [compiler(), *FLAGS, *WARNINGS, "-fPIC", "-shared", "-o", str(library)]
    command += [*map(str, sources), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise CompilerError(f"the C compiler refused exported code:\n{done.stderr}")
