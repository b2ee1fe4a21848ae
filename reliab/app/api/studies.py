"""Studies from their names to their reports; sample files, fetched data and facts of an installation."""

import platform
import shutil
import sys
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Any, ClassVar, Unpack
from urllib.parse import urlsplit

from reliab.app import options, questions
from reliab.app.api.sources import as_list
from reliab.app.declaration import asks
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.files import ordinary, refuse_unwritable, written_whole
from reliab.core.plain_values import PlainResult, ResultWithRows
from reliab.core.shipped import KINDS, checksum_of, checksums, find_fetched, find_shipped_folder, shipped
from reliab.report.setting import ReportSetting
from reliab.study import running
from reliab.study.running import ANSWER, list_shipped, open_study, write_report
from reliab.version import __version__

_PACKAGES = (
    *("numpy", "scipy", "pandas", "xarray", "numba", "matplotlib", "seaborn", "emcee", "arviz-stats", "zarr"),
    *("h5netcdf", "h5py", "typst", "typer", "rich", "pydantic", "dask", "distributed"),
)
_MEGABYTE = 1e6
_KIND = "datasets"
_SAMPLES = (
    "sample_test",
    "sample_rig",
    "sample_rig/tests",
    "campaigns/README.md",
    "campaigns/rig_a",
    "campaigns/rig_b",
    "campaigns/rig_c",
    "frames",
)


def describe_installation() -> dict[str, Any]:
    """Describe the installation, for a bug report.

    Returns
    -------
    dict
        Versions of reliab, Python and the packages that it uses, the platform, folder and size [MB] of the
        shipped datasets and studies, and the folder of compiled code; ready for JSON.

    Examples
    --------
    >>> describe_installation()["packages"]["numpy"].split(".")[0]
    '2'
    """
    return {
        "reliab": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "executable": sys.executable,
        "packages": {name: _version(name) for name in _PACKAGES},
        "shipped": {kind: _folder(kind) for kind in KINDS},
        "compiled code": _describe_compiled_code(),
    }


def _version(name: str) -> str:
    from importlib import metadata

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def _folder(kind: str) -> str:
    folder = find_shipped_folder(kind)
    if not folder.is_dir():
        return "none"
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    return f"{folder}, {size / _MEGABYTE:.1f} MB"


def _describe_compiled_code() -> str:
    try:
        from reliab.core.compiled import kernel_folder
    except ImportError as error:
        return f"none ({error})"
    folder = kernel_folder()
    if folder is None:
        return "not kept"
    return "__pycache__ beside each module" if folder.name == "__pycache__" else str(folder.parent)


@asks(questions.SAMPLE_FOLDER)
def copy_samples(folder: str | Path = "datasets") -> tuple[Path, ...]:
    """Write the samples that come with reliab into a folder; files with other content are not overwritten.

    Returns
    -------
    tuple of pathlib.Path
        The samples, files and folders.

    Raises
    ------
    InputError
        If a file of another content has the name of a sample, or the folder cannot be written.
    """
    folder, home = Path(folder), shipped("datasets", "")
    copies = {folder / file.relative_to(home): file for sample in _SAMPLES for file in _files(home / sample)}
    with refuse_unwritable("Cannot write to the folder for the samples", where=folder):
        contents = {path: file.read_bytes() for path, file in copies.items()}
        for path, content in contents.items():
            if path.exists() and path.read_bytes() != content:
                raise InputError(
                    "You have changed this file, so nothing was written",
                    remedy="Name another folder, or move the file",
                    where=str(path),
                )
        for path, content in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            with written_whole(path) as temporary:
                temporary.write_bytes(content)
    return tuple(folder / sample for sample in _SAMPLES)


def _files(sample: Path) -> list[Path]:
    return sorted(path for path in sample.iterdir() if path.is_file()) if sample.is_dir() else [sample]


@asks(questions.LISTED_DATA)
def fetch_dataset(source: str | Path) -> Path:
    """Bring shipped data that the wheel leaves out, and compare its checksum.

    Returns
    -------
    pathlib.Path
        The file in the user's data folder.

    Raises
    ------
    InputError
        If the name or the checksum is none that is listed, or something cannot be read or written.
    """
    source = str(source)
    name = _name_of(source)
    target = find_fetched(_KIND, name)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with written_whole(target) as file:
            with _open_source(source) as content, file.open("wb") as copy:
                shutil.copyfileobj(content, copy)
            _check(file, name, source)
    except OSError as error:
        raise InputError(
            "Cannot fetch the file",
            value=str(error),
            remedy="Check the path or address, or name another folder in RELIAB_DATA",
            where=source,
        ) from error
    return target


def _name_of(source: str) -> str:
    """Path below the datasets of the file that a source has the name of."""
    last = PurePosixPath(urlsplit(source).path if _is_address(source) else Path(source).as_posix()).name
    names = [name for name in checksums(_KIND) if PurePosixPath(name).name == last and name.endswith(".nc")]
    if len(names) != 1:
        raise InputError(
            "No dataset of this name",
            value=last,
            remedy=f"Choose among {', '.join(name for name in checksums(_KIND) if name.endswith('.nc'))}",
        )
    return names[0]


def _is_address(source: str) -> bool:
    return "://" in source


def _open_source(source: str) -> AbstractContextManager[IO[bytes]]:
    if not _is_address(source):
        return ordinary(source).open("rb")
    if urlsplit(source).scheme != "https":
        raise InputError(
            "Data are fetched by https only", value=source, remedy="Give an https address or a file"
        )
    from urllib.request import urlopen

    response: AbstractContextManager[IO[bytes]] = urlopen(source, timeout=60)  # noqa: S310 - https, as checked
    return response


def _check(file: Path, name: str, source: str) -> None:
    if (actual := checksum_of(file)) != checksums(_KIND)[name]:
        raise InputError(
            "The fetched file has another checksum than this version of reliab expects",
            value=f"SHA-256 {actual}",
            remedy="Fetch the file of this version; nothing was kept",
            where=source,
        )


_OUT = Path("reliab-run")


@dataclass(frozen=True, kw_only=True)
class PerformedStudy(PlainResult):
    """A study that was run: its folder, its report and its stages."""

    keys: ClassVar[Mapping[str, str]] = {
        "study": "title",
        "folder": "folder",
        "report": "report",
        "stages": "stages",
        "answer": "answer",
    }

    title: str
    folder: Path
    report: Path
    stages: Mapping[str, bool]
    answer: str = ""  # What the report says in one sentence


@asks(questions.StudyArgument, options.FOLDER)
def run_study(
    study: str | Path = "quick",
    *,
    out: str | Path | None = None,
    setting: ReportSetting | None = None,
    tell: Callable[[str, bool], None] = lambda _name, _is_new: None,
    **request: Unpack[options.MotionSource],
) -> PerformedStudy:
    """Run a study: simulate, fit, derive, validate, report.

    Parameters
    ----------
    tell : callable, optional
        Called after each stage with its name and whether there was something to do.

    Raises
    ------
    InputError
        If there is no such study, it asks for what is not there, or the folder holds something else.
    """
    description = open_study(study)
    if request["motions"] or request["sets"]:
        description = description.replace_motions(as_list(request["motions"]), as_list(request["sets"]))
    place = Path(study).resolve()
    name = place.parent.name if place.name == "study.toml" else place.stem
    folder = _OUT / name if out is None else Path(out)
    stages: dict[str, bool] = {}

    def count(stage: str, is_new: bool) -> None:  # noqa: FBT001 - called by position
        stages[stage] = is_new
        tell(stage, is_new)

    report = running.run_study(description, folder, tell=count, setting=setting)
    answer_file = folder / ANSWER
    answer = answer_file.read_text(encoding="utf-8") if answer_file.exists() else ""
    return PerformedStudy(title=description.title, folder=folder, report=report, stages=stages, answer=answer)


@dataclass(frozen=True)
class StudyList(ResultWithRows):
    """Studies that ship."""

    rows_in = "studies"
    keys: ClassVar[Mapping[str, str]] = {"studies": "rows"}
    table_columns: ClassVar[Columns] = {"study": ("name", ""), "kind": ("kind", ""), "title": ("title", "")}

    rows: list[dict[str, str]]


def list_studies() -> StudyList:
    """List the studies that ship.

    Returns
    -------
    StudyList
        Their names, kinds and titles.

    Examples
    --------
    >>> "quick" in [row["name"] for row in list_studies().rows]
    True
    """
    return StudyList(list_shipped())


@dataclass(frozen=True, kw_only=True)
class WrittenReport(PlainResult):
    """A report that was made of a finished run."""

    folder: Path
    report: Path


@asks(questions.RUN_FOLDER)
def report_run(folder: str | Path, *, setting: ReportSetting | None = None) -> WrittenReport:
    """Write the PDF of a finished run again, from its folder alone."""
    return WrittenReport(folder=Path(folder), report=write_report(folder, setting=setting))
