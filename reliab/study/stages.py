"""Stages of a run: each is done once, and again only when what it depends on has changed.

A run folder holds the results as files and `manifest.json`, which remembers for each stage the digest
of its inputs and of the files that it wrote. A stage is written to a temporary place and renamed, and
enters the manifest last, so that a run that is killed continues where it was.
"""

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.errors import InputError

MANIFEST = "manifest.json"
_CHUNK = 1 << 20


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One step of a run.

    Parameters
    ----------
    name : str
        What it does, for the manifest and the terminal.
    inputs : mapping
        Everything beside files that its outcome depends on, as plain values.
    reads : sequence of str, optional
        Files of the run folder that it reads.
    writes : sequence of str
        Files or folders that it writes.
    work : callable
        Does it, in the run folder.
    """

    name: str
    inputs: Mapping[str, Any]
    writes: Sequence[str]
    work: Callable[[Path], None]
    reads: Sequence[str] = ()


class RunFolder:
    """A folder in which a study is run.

    Parameters
    ----------
    path : pathlib.Path
        The folder; made if it is not there.
    study : mapping
        What is run in it, as plain values.

    Raises
    ------
    InputError
        If the folder cannot be made, or holds something else than a run.
    """

    def __init__(self, path: Path, *, study: Mapping[str, Any]) -> None:
        self.path = path
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                "The run folder must be writable",
                value=error.strerror,
                remedy="Name another",
                where=str(path),
            ) from None
        if not (path / MANIFEST).exists() and any(path.iterdir()):
            raise InputError(
                "A run folder is new, empty or that of an earlier run",
                value=f"{path} holds other files",
                remedy="Name another folder",
            )
        known = _read(path).get("stages", {})
        self._manifest: dict[str, Any] = {"study": dict(study), "stages": known}
        self._write()

    def perform(self, stage: Stage) -> bool:
        """Do a stage unless it is done; tell whether it was.

        Parameters
        ----------
        stage : Stage
            The stage.

        Returns
        -------
        bool
            Whether work was done.
        """
        inputs = self._digest_inputs(stage)
        known = self._manifest["stages"].get(stage.name)
        if known and known["inputs"] == inputs and known["files"] == self._digest_files(stage.writes):
            return False
        stage.work(self.path)
        self._manifest["stages"][stage.name] = {"inputs": inputs, "files": self._digest_files(stage.writes)}
        self._write()
        return True

    def _digest_inputs(self, stage: Stage) -> str:
        content = {"inputs": dict(stage.inputs), "reads": self._digest_files(stage.reads)}
        return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()

    def _digest_files(self, names: Sequence[str]) -> dict[str, str]:
        return {name: digest(self.path / name) for name in names}

    def _write(self) -> None:
        unfinished = self.path / f".{MANIFEST}"
        unfinished.write_text(json.dumps(self._manifest, indent=2), encoding="utf-8")
        unfinished.replace(self.path / MANIFEST)


def study_of(path: Path) -> dict[str, Any]:
    """Return what was run in a folder.

    Parameters
    ----------
    path : pathlib.Path
        A run folder.

    Returns
    -------
    dict
        The study as plain values.

    Raises
    ------
    InputError
        If nothing was run there.
    """
    study = _read(path).get("study")
    if study is None:
        raise InputError(
            "A report is made of the folder of a run",
            value=f"no {MANIFEST} in it",
            remedy="Name the folder that `reliab run --out` wrote",
            where=str(path),
        )
    return dict(study)


def _read(path: Path) -> dict[str, Any]:
    try:
        return dict(json.loads((path / MANIFEST).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}


def digest(path: Path) -> str:
    """SHA-256 of a file, or of all files in a folder; empty where there is nothing.

    Parameters
    ----------
    path : pathlib.Path
        File or folder.

    Returns
    -------
    str
        The digest in hexadecimal.
    """
    found = hashlib.sha256()
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    for file in files:
        if file.is_file():
            found.update(str(file.relative_to(path)).encode())
            with file.open("rb") as stream:
                while chunk := stream.read(_CHUNK):
                    found.update(chunk)
    return found.hexdigest() if any(file.is_file() for file in files) else ""
