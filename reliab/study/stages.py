"""Stages of a run: each is done once, and again only when what it depends on has changed.

A run folder holds the results as files and `manifest.json`, which remembers for each stage the digest
of its inputs, which the code of the package is one of, and of the files that it wrote, the day, the packages
and the processor. A stage enters the manifest as done when its files are written, so that an interrupted run
resumes where it was; what was begun with other inputs or other code is removed first.
"""

import contextlib
import datetime as dt
import hashlib
import json
import platform
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from reliab.core.described_files import read_json
from reliab.core.errors import IncompleteError, InputError
from reliab.core.files import (
    UNFINISHED,
    lock_for_writing,
    refuse_unwritable,
    remove_abandoned,
    written_whole,
)
from reliab.criterion.scope import read_versions

MANIFEST = "manifest.json"
_CHUNK = 1 << 20
_NAME = re.compile(r"[A-Za-z0-9._-]+")
_PROCESSORS = Path("/proc/cpuinfo")


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One step of a run."""

    name: str  # What it does, for the manifest and the terminal
    inputs: Mapping[str, Any]  # Everything beside files that its outcome depends on, as plain values
    writes: Sequence[str]  # Files or folders that it writes
    work: Callable[[Path], None]  # Does it, in the run folder
    reads: Sequence[str] = ()  # Files of the run folder that it reads


class RunFolder:
    """A folder in which a study is run."""

    def __init__(self, path: Path, *, study: Mapping[str, Any]) -> None:
        self.path = path
        path.mkdir(parents=True, exist_ok=True)
        strangers = [file for file in path.iterdir() if not file.name.startswith(UNFINISHED)]
        if not (path / MANIFEST).exists() and strangers:
            raise InputError(
                f"{path} holds files that no run of a study wrote",
                remedy="Name a new or empty folder",
            )
        remove_abandoned(path.rglob(f"{UNFINISHED}*"))
        stages = _read(path).get("stages", {})
        self._manifest: dict[str, Any] = {"study": dict(study), "stages": stages}
        self._write()

    @classmethod
    @contextlib.contextmanager
    def open(cls, path: Path, *, study: Mapping[str, Any]) -> Iterator["RunFolder"]:
        """Open a run folder, and keep every other process from running a study in it."""
        with refuse_unwritable("Cannot write the run folder", where=path):
            path.mkdir(parents=True, exist_ok=True)
        with lock_for_writing(path, "Only one process may run a study in a folder"):
            try:
                yield cls(path, study=study)
            except OSError as error:
                raise IncompleteError(
                    f"Running the study in {path} failed: {error}. Stages that are done are safe; "
                    "remove the cause and run the same command again."
                ) from error

    def perform(self, stage: Stage) -> bool:
        """Do a stage unless it is done; tell whether it was."""
        inputs = self._digest_inputs(stage)
        entries = self._manifest["stages"]
        entry = entries.get(stage.name, {})
        if entry.get("inputs") == inputs and entry.get("files") == self._digest_files(stage.writes):
            return False
        if entry and entry["inputs"] != inputs:
            for path in (self.path / name for name in stage.writes):
                if path.is_dir():
                    shutil.rmtree(path)
                else:
                    path.unlink(missing_ok=True)
        entries[stage.name] = {"inputs": inputs}
        self._write()
        stage.work(self.path)
        entries[stage.name] = {
            "inputs": inputs,
            "files": self._digest_files(stage.writes),
            "date": dt.datetime.now(tz=dt.UTC).date().isoformat(),
            "packages": read_versions(),
            "environment": environment(),
        }
        self._write()
        return True

    def _digest_inputs(self, stage: Stage) -> str:
        content = {
            "inputs": dict(stage.inputs),
            "reads": self._digest_files(stage.reads),
            "code": code_digest(),
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()

    def _digest_files(self, names: Sequence[str]) -> dict[str, str]:
        return {name: digest(self.path / name) for name in names}

    def _write(self) -> None:
        with written_whole(self.path / MANIFEST) as file:
            file.write_text(json.dumps(self._manifest, indent=2), encoding="utf-8")


def study_of(path: Path) -> dict[str, Any]:
    """Return what was run in a folder."""
    study = _read(path).get("study")
    if study is None:
        raise InputError(
            f"This is no folder of a run: it has no {MANIFEST}",
            remedy="Name the folder that `reliab run --out` wrote",
            where=str(path),
        )
    return dict(study)


def software_provenance(path: Path) -> dict[str, Any]:
    """Return the packages with which the results of a run were made.

    Returns versions by package, under "packages"; where stages were run with different ones, by stage. A
    stage that is not done yet, such as the one that draws a report, has none.
    """
    packages = {name: entry["packages"] for name, entry in _results(path).items() if entry.get("packages")}
    distinct = list(
        {json.dumps(versions, sort_keys=True): versions for versions in packages.values()}.values()
    )
    if not distinct:
        return {}
    return {"packages": distinct[0] if len(distinct) == 1 else packages}


def date_of(path: Path) -> dt.date:
    """Return the day on which the last results of a run were made."""
    days = [entry["date"] for entry in _results(path).values() if "date" in entry]
    return dt.date.fromisoformat(max(days)) if days else dt.datetime.now(tz=dt.UTC).date()


def _results(path: Path) -> dict[str, dict[str, Any]]:
    """Entries of the stages that made results; the report is none."""
    return {name: entry for name, entry in _read(path).get("stages", {}).items() if name != "report"}


def _read(path: Path) -> dict[str, Any]:
    """Read the manifest; empty where there is none, or none that a run has written."""
    try:
        manifest = _Manifest.model_validate(read_result(path / MANIFEST))
    except (InputError, ValidationError):
        return {}
    return manifest.model_dump(exclude_unset=True, mode="json")


def read_result(path: Path) -> Any:  # noqa: ANN401 - JSON holds anything
    """Read a JSON file of a run; an `InputError` if it is none."""
    rule = "The files of a run must be as `reliab run` wrote them"
    return read_json(path, rule=rule, remedy="Run the study again")


class _Stage(BaseModel):
    model_config = ConfigDict(extra="forbid")

    inputs: str
    files: dict[str, str] = {}
    date: dt.date | None = None
    packages: dict[str, str] = {}
    environment: dict[str, Any] = {}


class _Manifest(BaseModel):
    model_config = ConfigDict(extra="forbid")

    study: dict[str, Any]
    stages: dict[str, _Stage]


@cache
def code_digest() -> str:
    """SHA-256 of the package's own code: what it computes may change with any of its files."""
    package = Path(__file__).parents[1]
    digests = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        digests.update(str(file.relative_to(package)).encode())
        digests.update(file.read_bytes())
    return digests.hexdigest()


def digest(path: Path) -> str:
    """SHA-256 of a file, or of all files in a folder; empty where there is nothing."""
    total = hashlib.sha256()
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    for file in files:
        if file.is_file():
            total.update(str(file.relative_to(path)).encode())
            with file.open("rb") as stream:
                while chunk := stream.read(_CHUNK):
                    total.update(chunk)
    return total.hexdigest() if any(file.is_file() for file in files) else ""


def environment() -> dict[str, Any]:
    """Describe what results are computed with.

    Equal input gives equal bytes where all of this is equal; with another processor or other packages the
    last digits of numbers may differ.

    Returns "python", "system", "processor" and "packages": versions of this package and of all that it needs,
    directly or through others.
    """
    return {
        "python": platform.python_version(),
        "system": platform.platform(),
        "processor": _processor(),
        "packages": dict(_packages()),
    }


@cache
def _packages() -> tuple[tuple[str, str], ...]:
    waiting, versions = ["reliab"], {}
    while waiting:
        name = waiting.pop()
        if name in versions:
            continue
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue  # needed on other systems only
        requirements = [line for line in requires(name) or () if "extra ==" not in line]
        names = [match[0].lower() for line in requirements if (match := _NAME.match(line))]
        waiting.extend(re.sub(r"[-_.]+", "-", package) for package in names)  # a package has one name
    return tuple(sorted(versions.items()))


@cache
def _processor() -> str:
    """Name of the processor, as the system states it."""
    try:
        text = _PROCESSORS.read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    match = re.search(r"^model name\s*:\s*(.+)$", text, re.MULTILINE)
    return match[1].strip() if match else platform.processor() or platform.machine()
