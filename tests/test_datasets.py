"""Public logs: local copies, checksums, and no traceback without a network."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pooch
import pytest

from rotatum import datasets
from rotatum.errors import DatasetError


def _refuse(*args: object, **kwargs: object) -> str:
    raise ConnectionError("no network")


def test_every_entry_is_pinned() -> None:
    assert datasets.names() == ("hebi-unloaded", "kuka-kr300", "utokyo-two-inertia")
    for name in datasets.names():
        entry = datasets.describe(name)
        assert re.fullmatch(r"[0-9a-f]{64}", entry.sha256)
        assert re.fullmatch(r"[0-9a-f]{40}", entry.commit)
        assert entry.url.startswith("https://raw.githubusercontent.com/")
        assert entry.url.endswith(entry.file)


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(DatasetError, match='Did you mean "kuka-kr300"'):
        datasets.load("kuka-kr30")


def test_a_local_copy_needs_no_network(
    shared_data: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = shared_data("utokyo-two-inertia/MultisineTypeA.mat")
    monkeypatch.setenv("ROTATUM_DATA", str(copy.parent.parent))
    monkeypatch.setattr(pooch, "retrieve", _refuse)
    assert datasets.load("utokyo-two-inertia") == copy


def test_a_local_copy_of_other_content_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "utokyo-two-inertia").mkdir()
    (tmp_path / "utokyo-two-inertia" / "MultisineTypeA.mat").write_bytes(b"something else")
    monkeypatch.setenv("ROTATUM_DATA", str(tmp_path))
    with pytest.raises(DatasetError, match="SHA-256 differs"):
        datasets.load("utokyo-two-inertia")


def test_offline_says_where_to_put_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROTATUM_DATA", str(tmp_path))
    monkeypatch.setattr(pooch, "retrieve", _refuse)
    with pytest.raises(DatasetError, match=r"cannot be downloaded .* ROTATUM_DATA"):
        datasets.load("hebi-unloaded")


def test_a_changed_download_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def other_content(*args: object, **kwargs: object) -> str:
        raise ValueError("SHA256 hash of downloaded file does not match the known hash")

    monkeypatch.delenv("ROTATUM_DATA", raising=False)
    monkeypatch.setattr(pooch, "retrieve", other_content)
    with pytest.raises(DatasetError, match="another SHA-256"):
        datasets.load("hebi-unloaded")


def test_the_download_asks_for_the_pinned_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, object] = {}

    def retrieve(url: str, *, known_hash: str, fname: str, path: Path) -> str:
        asked.update(url=url, known_hash=known_hash)
        return str(path / fname)

    monkeypatch.delenv("ROTATUM_DATA", raising=False)
    monkeypatch.setattr(pooch, "retrieve", retrieve)
    entry = datasets.describe("kuka-kr300")
    assert datasets.load("kuka-kr300").name == entry.file
    assert asked == {"url": entry.url, "known_hash": f"sha256:{entry.sha256}"}
