"""The C of the low-pass is what a reviewer has seen; see ``refresh_golden``."""

from __future__ import annotations

from rotatum.export import translate
from tests.export.refresh_golden import GOLDEN
from tests.export.stages import LOWPASS


def test_lowpass_is_translated_to_the_reviewed_text() -> None:
    source = translate(LOWPASS)
    assert source.header == (GOLDEN / "lowpass.h").read_text()
    assert source.source == (GOLDEN / "lowpass.c").read_text()
