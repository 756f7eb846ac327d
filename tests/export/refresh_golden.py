"""Write the golden C of the low-pass anew: ``python -m tests.export.refresh_golden``.

Do it on purpose only, look at the difference, and say in the change log why it changed.
"""

from __future__ import annotations

from pathlib import Path

from rotatum.export import translate
from tests.export.stages import LOWPASS

GOLDEN = Path(__file__).parent / "golden"

if __name__ == "__main__":
    source = translate(LOWPASS)
    (GOLDEN / "lowpass.h").write_text(source.header)
    (GOLDEN / "lowpass.c").write_text(source.source)
