"""An exported project: C, constants, a test vector with its self-test, and how to call it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rotatum.export.folder import project_folder
from rotatum.export.initializers import field_table, params_header
from rotatum.export.structs import words
from rotatum.export.translate import CSource, translate
from rotatum.export.types import of_layout
from rotatum.export.vector import MAGIC, kinds, write_vector
from rotatum.record import Layout, Records
from rotatum.runtime.bank import Bank
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage


class Exported(NamedTuple):
    """What was written.

    Args:
        directory: where.
        files: names of the files, sorted.
        samples: of the test vector.
        joints: names of the joints, in the order of ``NAME_params``.
    """

    directory: Path
    files: tuple[str, ...]
    samples: int
    joints: tuple[str, ...]


def export_c(
    stage: Stage,
    params: Records,
    directory: str | Path,
    *,
    inputs: Records,
    outputs: Records | None = None,
    joints: Sequence[str] | None = None,
) -> Exported:
    """Write a stage as a C99 project; ``make test`` in it compares C with Python bit for bit.

    The functions are called ``NAME_init`` and ``NAME_step``; ``stage._replace(name=...)`` gives
    another name.

    Args:
        stage: what to export.
        params: ``(n,)`` records, the constants of each joint.
        directory: a new or empty folder, or an earlier export, which is replaced.
        inputs: ``(N, n)`` records, or ``(N,)`` for one joint: the test vector.
        outputs: what the stage makes of them; computed when not given.
        joints: names of the joints, for comments.

    Raises:
        SubsetError: a kernel leaves the exportable subset.
        StageError: the records are not the stage's.
        OutputError: the folder holds other files, or cannot be written.
    """
    n = len(params)
    names = tuple(joints) if joints is not None else tuple(f"joint {j}" for j in range(n))
    u = _shaped(stage, "input", inputs, n)
    y = Bank(stage, params).run(u) if outputs is None else _shaped(stage, "output", outputs, n)
    if y.shape != u.shape or len(names) != n or params.dtype != stage.params.dtype:
        raise StageError(f"{u.shape} inputs, {y.shape} outputs, {n} params, {len(names)} names")
    texts = _texts(stage, translate(stage), params, names, len(u))
    listing = sorted([*texts, "test_vector.bin"])
    texts["Makefile"] = texts["Makefile"].replace("@FILES@", " ".join(listing))
    with project_folder(Path(directory)) as work:
        for name, text in texts.items():
            (work / name).write_text(text, encoding="utf-8")
        with (work / "test_vector.bin").open("wb") as file:
            write_vector(file, (stage.input, stage.output), u, y)
    return Exported(Path(directory), tuple(listing), len(u), names)


def _shaped(stage: Stage, role: str, records: Records, joints: int) -> Records:
    layout: Layout = getattr(stage, role)
    shaped = records[:, np.newaxis] if records.ndim == 1 and joints == 1 else records
    if shaped.ndim != 2 or shaped.shape[1] != joints or shaped.dtype != layout.dtype:
        what = f"{role} records of {stage.name} must have the shape (N, {joints})"
        raise StageError(what, value=records.shape)
    return np.ascontiguousarray(shaped)


def _texts(
    stage: Stage, source: CSource, params: Records, joints: Sequence[str], samples: int
) -> dict[str, str]:
    """Return the text files of a project by name."""
    outputs = [name for name, _ in words(of_layout(stage.output))]
    marks = {
        "NAME": stage.name,
        "NAME_UPPER": stage.name.upper(),
        "IN_WORDS": str(stage.input.dtype.itemsize // 8),
        "OUT_WORDS": str(len(outputs)),
        "FIELDS": "\n".join(f'    "{name}",' for name in outputs),
        "KINDS": kinds(stage.output),
        "MAGIC": f"{MAGIC:#x}",
        "JOINTS": ", ".join(joints),
        "SAMPLES": f"{samples:,}",
        "INPUT": field_table(stage.input),
        "OUTPUT": field_table(stage.output),
    }
    texts = {
        f"{stage.name}.h": source.header,
        f"{stage.name}.c": source.source,
        f"{stage.name}_params.h": params_header(stage.name, stage.params, params, joints),
    }
    for template in ("Makefile", "selftest.c", "README.md"):
        texts[template] = _filled(template, marks)
    return texts


def _filled(template: str, marks: Mapping[str, str]) -> str:
    text = (files("rotatum.export") / "templates" / template).read_text(encoding="utf-8")
    for mark, value in marks.items():
        text = text.replace(f"@{mark}@", value)
    return text
