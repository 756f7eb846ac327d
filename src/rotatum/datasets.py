"""Public logs recorded on hardware: fetched once from where their authors keep them, and checked.

Set ROTATUM_DATA to a folder to use local copies: `<ROTATUM_DATA>/<data set>/<file>`.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from rotatum.errors import DatasetError, nearest

__all__ = ["Dataset", "describe", "load", "names"]


@dataclass(frozen=True)
class Dataset:
    """A log in a public repository.

    Parameters
    ----------
    name : the data set.
    about : what it is, in a sentence.
    repository : owner/name on GitHub.
    commit : the version of the repository.
    path : of the log in the repository.
    sha256 : of the log.
    licence : SPDX name.
    """

    name: str
    about: str
    repository: str
    commit: str
    path: str
    sha256: str
    licence: str

    @property
    def file(self) -> str:
        """Name of the log's file."""
        return self.path.rpartition("/")[2]

    @property
    def url(self) -> str:
        """Where the log is fetched from."""
        return f"https://raw.githubusercontent.com/{self.repository}/{self.commit}/{self.path}"


_DATASETS = (
    Dataset(
        name="utokyo-two-inertia",
        about=(
            "Two servo motors joined by a flexible coupling, multisine from 11 to 250 Hz: "
            "2500 Hz, 20 s. Reference: 545 A/rad. Device: examples/devices/utokyo-two-inertia.toml."
        ),
        repository="WataruOhnishi/FdiTools",
        commit="760b945947491d93917557a145e8637fa209c7d8",
        path="Examples/private/MultisineTypeA.mat",
        sha256="a15dadc2e756ceddd927935f9c4c547cdcaef95c8611fc39087c848b3a8acb26",
        licence="MIT",
    ),
    Dataset(
        name="kuka-kr300",
        about=(
            "KUKA KR300 R2500 ultra with encoders on both sides of the gears, axes 1 to 3 move: "
            "250 Hz, 10 s. Device: examples/devices/kuka-kr300-mat.toml."
        ),
        repository="JonasWeigand/Robot_Identification",
        commit="9e403c07d9dadbb391a9f3921e8d219f714636a8",
        path="data/recorded_trajectories/2020-10-21_10s_FF_A_data.mat",
        sha256="4c152c5b7f2c899731fdeebcf0d011cc103df72be19fac160caf47aa9b73ab75",
        licence="MIT",
    ),
    Dataset(
        name="hebi-unloaded",
        about=(
            "HEBI X5-1 series-elastic actuator without a load: 100 Hz, 10 s. A binary .hebilog, "
            "which HEBI's own tools convert; rotatum does not read it."
        ),
        repository="HebiRobotics/hebi-matlab-examples",
        commit="9360aceebfec40753b3fafce62e5b9cd19c40ee6",
        path="basic/actuator/logs/exampleLog.hebilog",
        sha256="b022d9ea8efd492409321cba16b44b9109856554697a2a6bd3811ea73c2f9113",
        licence="Apache-2.0",
    ),
)


def names() -> tuple[str, ...]:
    """Return the names of the data sets, sorted."""
    return tuple(sorted(dataset.name for dataset in _DATASETS))


def describe(name: str) -> Dataset:
    """Return what is known of a data set: source, licence, checksum.

    Raises
    ------
    DatasetError if there is none of that name.
    """
    for dataset in _DATASETS:
        if dataset.name == name:
            return dataset
    close = nearest(name, names())
    hint = f'Did you mean "{close}"?' if close else None
    raise DatasetError("no such data set", value=name, allowed=names(), hint=hint)


def load(name: str) -> Path:
    """Return the path of a data set's log, fetching it if it is not there yet.

    A local copy below the folder ROTATUM_DATA comes first, then the cache of earlier downloads,
    then the public source. Whatever its way, its SHA-256 is checked.

    Parameters
    ----------
    name : one of `names()`.

    Raises
    ------
    DatasetError if there is no such data set, it cannot be fetched, or its content is not what
    it should be.
    """
    dataset = describe(name)
    local = _local_copy(dataset)
    return local if local is not None else _fetch(dataset)


def _local_copy(dataset: Dataset) -> Path | None:
    """Return the copy below ROTATUM_DATA, if there is one."""
    folder = os.environ.get("ROTATUM_DATA")
    path = Path(folder) / dataset.name / dataset.file if folder else None
    if path is None or not path.is_file():
        return None
    try:
        with path.open("rb") as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise DatasetError(f"cannot be read ({error.strerror})", where=str(path)) from error
    if found != dataset.sha256:
        what = f"is not the published log of {dataset.name}: its SHA-256 differs"
        raise DatasetError(what, where=str(path), value=found, allowed=dataset.sha256)
    return path


def _fetch(dataset: Dataset) -> Path:
    """Return the copy in the cache, downloading it first if it is not there."""
    import pooch

    folder = Path(pooch.os_cache("rotatum")) / dataset.name
    try:
        path: str = pooch.retrieve(
            dataset.url, known_hash=f"sha256:{dataset.sha256}", fname=dataset.file, path=folder
        )
    except ValueError as error:
        what = f"what was downloaded from {dataset.url} has another SHA-256 than expected"
        raise DatasetError(what, where=dataset.name) from error
    except OSError as error:  # no network, no such address, no space: requests' errors are these
        hint = (
            f"If there is no network here, fetch it elsewhere, put it at {dataset.name}/"
            f"{dataset.file} in a folder and point the environment variable ROTATUM_DATA to it."
        )
        what = f"cannot be downloaded from {dataset.url} ({type(error).__name__})"
        raise DatasetError(what, where=dataset.name, hint=hint) from error
    return Path(path)
