"""Loading: files, folders, catalogues and the built-in suite become one suite of motions.

Every record below a folder without a catalogue is a motion. Its name is its path relative to the folder. The
file extension is left out if it is one of a record format and the name stays unique; channels of one file are
numbered.

Events are known only where the headers say so: records share an event if they are channels of one file, or
if their headers give the same earthquake and date (PEER, SMC), the same origin time and epicentre (K-NET),
the same origin time (CSMIP, COSMOS, GeoNet, AFAD, CWB, ASA, SAC), the same identifier (ESM), the same station
and begin (miniSEED) or the same line ``# event: NAME`` (text). Every other motion counts as a separate event.
To declare events, write a catalogue with a column ``event``.
"""

import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.core.units import AccelerationUnit, find_unit
from reliab.motions.catalogue import CATALOGUE, RecordFile, read_catalogue
from reliab.motions.faults import MotionFault, Report
from reliab.motions.motion import Motion
from reliab.motions.readers.reading import RecordDeclaration
from reliab.motions.readers.registry import FORMATS, TEXT, UNREAD, claims_to_be_record, detect, open_records
from reliab.motions.readers.source import HEAD, is_file, is_folder, open_source
from reliab.motions.suite import MotionEntry, MotionSuite

_COMPONENTS = frozenset(("K-NET",))
"""Formats whose endings name a component, such as ``.NS`` and ``.EW``."""

_DOCUMENTS = frozenset(
    (
        *(".md", ".rst", ".pdf", ".doc", ".docx", ".odt", ".tex", ".bib", ".htm", ".html", ".png", ".jpg"),
        *(".jpeg", ".gif", ".svg", ".tif", ".tiff", ".py", ".ipynb", ".m", ".r", ".sh", ".bat", ".json"),
        *(".toml", ".yaml", ".yml", ".xml"),
    )
)
"""Endings of files that no one takes for records."""

_NOT_RECORDS = ("readme", "license", "licence", "copying", "changelog")


def scan(source: Path, declaration: RecordDeclaration) -> Iterator[tuple[Path, list[RecordFile], Report]]:
    """Find the records of a file, or of a folder with or without a catalogue, which then comes first."""
    catalogue = source / CATALOGUE
    if is_file(catalogue):
        report = Report(file=str(catalogue))
        records = read_catalogue(catalogue, report, declaration)
        yield catalogue, [], report
        yield from ((record.path, [record], Report(file=str(record.path))) for record in records)
    elif is_folder(source):
        yield from _scan_folder(source, declaration)
    else:
        report = Report(file=str(source))
        yield source, _scan_file(source, motion_name(Path(source.name)), declaration, report), report


def _scan_folder(
    folder: Path, declaration: RecordDeclaration
) -> Iterator[tuple[Path, list[RecordFile], Report]]:
    paths = [path for path, reason in _survey(folder) if not reason]
    names = _names(paths, folder)
    for path in paths:
        report = Report(file=str(path))
        resolved_path = report.resolve(folder, path.relative_to(folder).as_posix())
        yield path, _scan_file(path, names[path], declaration, report) if resolved_path else [], report


class UnreadFileWarning(UserWarning):
    """A folder holds files that may be records in a format that is not read."""


def list_skipped_files(source: str | Path) -> list[MotionFault]:
    """Name the files of a folder without a catalogue that are not read, and why."""
    folder = Path(source)
    if source in BUILT_IN or not is_folder(folder) or is_file(folder / CATALOGUE):
        return []
    return [
        MotionFault(
            file=str(path),
            line=None,
            rule="Skipped",
            value=reason,
            remedy="If it is a record, export it as text or CSV",
        )
        for path, reason in _survey(folder)
        if reason
    ]


def _survey(folder: Path) -> Iterator[tuple[Path, str]]:
    """Go through the files of a folder that may be records, each with why it is none; empty if it is one."""
    for path in sorted(folder.rglob("*")):
        hidden = any(component.startswith(".") for component in path.relative_to(folder).parts)
        no_record = path.name.lower() == CATALOGUE or path.stem.lower().lstrip("_").startswith(_NOT_RECORDS)
        if not hidden and not no_record and path.suffix.lower() not in _DOCUMENTS and path.is_file():
            yield path, "" if claims_to_be_record(path) else _reason_to_skip(path)


def _reason_to_skip(path: Path) -> str:
    """Say why a file without the ending of a record is none; empty if its content is that of one."""
    if kind := UNREAD.get(path.suffix.lower()):
        return kind
    report = Report(file=str(path))
    source = open_source(path, report, limit=HEAD, binary=True)
    if source is None:
        return "an empty file" if "empty" in report.faults[0].rule else "a file that cannot be read"
    form = detect(source)
    if form is TEXT:
        return "numbers without a known header or the ending of a text record"
    return "" if form else "an unknown format"


def _scan_file(path: Path, name: str, declaration: RecordDeclaration, report: Report) -> list[RecordFile]:
    """Find the motions in one file."""
    source_and_headers = open_records(path, report, whole=False)
    headers = source_and_headers[1] if source_and_headers else []
    if len(headers) == 1:
        return [RecordFile(path=path, name=name, event=headers[0].event or name, declared=declaration)]
    return [
        RecordFile(
            path=path,
            name=f"{name}/{channel}",
            event=header.event or name,
            channel=channel,
            declared=declaration,
        )
        for channel, header in enumerate(headers, start=1)
    ]


def _names(paths: list[Path], folder: Path) -> dict[Path, str]:
    short = {path: motion_name(path.relative_to(folder)) for path in paths}
    count = Counter(short.values())
    return {
        path: name if count[name] == 1 else path.relative_to(folder).as_posix()
        for path, name in short.items()
    }


def motion_name(path: Path) -> str:
    """Name of a motion after its file: the path without the ending of a record.

    Extensions that name a component, such as ``.NS`` and ``.EW`` of K-NET, are kept.

    >>> motion_name(Path("KOBE/NIS000.AT2")), motion_name(Path("AOM001.EW"))
    ('KOBE/NIS000', 'AOM001.EW')
    """
    forms = (form for form in FORMATS.values() if form.name not in _COMPONENTS)
    is_ending = any(path.suffix.lower() in form.endings for form in forms)
    name = (path.with_suffix("") if is_ending else path).as_posix()
    return name.encode(errors="backslashreplace").decode()  # bytes of a name that are not text


BUILT_IN = ("synthetic",)
"""Names of the suites that come with the package."""

_MOST_NAMES = 3  # largest number of files that a warning lists by name

HELD_OUT = "held_out"
"""The set of a catalogue that is left out unless the user names it."""


def load_motions(
    *sources: str | Path,
    sets: Sequence[str] | None = None,
    time_step: float | None = None,
    units: str | None = None,
) -> MotionSuite:
    """Load a suite of motions; each record is read only when it is needed.

    Parameters
    ----------
    *sources : str or Path
        Record files, folders with or without a ``catalog.csv``, or names of built-in suites
        (``"synthetic"``; a folder of that name is ``"./synthetic"``).
    sets : sequence of str, optional
        Sets of the catalogues to load; None loads all except the set ``held_out``.
    time_step : float, optional
        Step of the records [s], where their headers state none or round it.
    units : str, optional
        Units of the records (g, cm/s2, m/s2), where their headers state none.

    Returns
    -------
    MotionSuite
        The motions in the order of the sources.

    Raises
    ------
    InputError
        If a source does not exist or holds no motion, a catalogue is faulty, a file is not a record, a set is
        unknown, or two motions have the same name.

    Notes
    -----
    In a folder without a catalogue, records are components of one event only if their headers identify the
    event; `reliab.motions.loading` gives the rule. A catalogue with a column ``event`` declares events.
    """
    if not sources:
        raise InputError("No ground motions given", remedy="Name a file, a folder or synthetic")
    suite, faults = find_motions(*sources, sets=sets, time_step=time_step, units=units)
    if faults:
        raise faults[0].error()
    for source in sources:
        _warn_of_skipped(source)
    return suite


def find_motions(
    *sources: str | Path,
    sets: Sequence[str] | None = None,
    time_step: float | None = None,
    units: str | None = None,
) -> tuple[MotionSuite, list[MotionFault]]:
    """Find motions as :func:`load_motions` does, and the faults of those that cannot be found."""
    declaration = declare(time_step, units)
    faults: list[MotionFault] = []
    suite = MotionSuite(entry for source in sources for entry in _entries(source, declaration, faults))
    if not suite and faults:
        raise faults[0].error()
    selected_suite = suite.select(sets=sets if sets is not None else set(suite.set_names) - {HELD_OUT})
    if not selected_suite:
        raise InputError(
            f"No motions left: all belong to the set {HELD_OUT}",
            remedy=f"Name the set {HELD_OUT} to use it",
        )
    return selected_suite, faults


def _warn_of_skipped(source: str | Path) -> None:
    skipped_faults = list_skipped_files(source)
    if not skipped_faults:
        return
    names = [f"{Path(note.file).relative_to(source).as_posix()} ({note.value})" for note in skipped_faults]
    count_text = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    text = f"{source}: skipped {', '.join(names[:_MOST_NAMES])}{count_text}; export records as text or CSV"
    warnings.warn(text, UnreadFileWarning, stacklevel=3)


def read_motion(
    path: str | Path,
    *,
    name: str | None = None,
    event: str = "",
    set_name: str = "",
    time_step: float | None = None,
    units: str | None = None,
    channel: int | None = None,
) -> Motion:
    """Read one record file.

    `path`: a file of one of the formats of `reliab.motions.readers`, or text in columns; `name`: name of the
    motion; the file's name by default; `event`: the earthquake; what the header says by default, or else the
    name; `time_step`: step [s], where the header states none or rounds it; `units`: units (g, cm/s2, m/s2),
    where the header states none; `channel`: which record of a file that holds several, counted from 1.
    """
    record = RecordFile(
        path=Path(path),
        name=name or motion_name(Path(Path(path).name)),
        event=event,
        set_name=set_name,
        channel=channel,
        declared=declare(time_step, units),
    )
    return record.load()


def declare(time_step: float | None, units: str | None) -> RecordDeclaration:
    """Check the step and the units that a caller gives.

    `time_step` [s].
    """
    if time_step is not None:
        require_physical("time step", time_step)
    unit = None if units is None else find_unit(units)
    if units is not None and unit is None:
        raise InputError(
            "Unknown unit of acceleration",
            value=repr(units),
            remedy=f"Use {', '.join(AccelerationUnit)}; gal is cm/s2",
        )
    return RecordDeclaration(time_step=time_step, units=unit)


def _entries(
    source: str | Path, declaration: RecordDeclaration, faults: list[MotionFault]
) -> list[MotionEntry]:
    if source in BUILT_IN:
        from reliab.motions.synthetic.suite import synthetic_suite

        return list(synthetic_suite().entries)
    path = Path(source)
    if not (is_folder(path) or is_file(path)):
        raise InputError(
            f"{source} not found",
            remedy=f"Name a file, a folder or a built-in suite ({', '.join(BUILT_IN)})",
        )
    entries: list[MotionEntry] = []
    fault_count = len(faults)
    for _, records, report in scan(path, declaration):
        faults.extend(report.faults)
        entries.extend(() if report.faults else records)
    if not entries and len(faults) == fault_count:
        raise InputError(
            "No records in this folder",
            remedy=f"Put records or a {CATALOGUE} into it",
            where=str(path),
        )
    return entries
