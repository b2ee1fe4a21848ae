"""Running a study, and making its report again."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from reliab.core.described_files import read_toml, validate_description
from reliab.core.errors import InputError
from reliab.core.files import decoding, refuse_links, written_whole
from reliab.core.shipped import is_own_data
from reliab.report.document import Document
from reliab.report.pdf import write_pdf
from reliab.report.prose import plain_text
from reliab.report.setting import ReportSetting
from reliab.study.description import FILE, REMEDY, RULE, Study, folders_of_studies, kind_of, study_contents
from reliab.study.kinds import KINDS
from reliab.study.stages import RunFolder, Stage, date_of, study_of


def read_study(path: str | Path) -> Study:
    """Read a study."""
    content = read_toml(path, rule=RULE, remedy=REMEDY)
    return study_from(content, location=str(path))


def study_from(content: Mapping[str, Any], *, location: str = "") -> Study:
    """Make a study of its tables."""
    name = content.get("kind")
    if not isinstance(name, str) or name not in KINDS:
        raise InputError(
            "The study has no kind" if name is None else f"Unknown kind of study: {name!r}",
            remedy=f"Choose among {', '.join(KINDS)}",
            where=location,
        )
    tables = KINDS[name].tables
    return validate_description(
        tables,
        content,
        rule="A study holds the keys that its kind knows, with allowed values",
        remedy=f"A study of the kind {name} knows {', '.join(tables.model_fields)}",
        where=location,
    )


def open_study(name: str | Path) -> Study:
    """Read a study from its folder or its file, or one that ships by its name.

    The code in the folder of a study, `kind.py`, is imported.
    """
    path = Path(name)
    if not path.suffix and len(path.parts) == 1 and not is_own_data(path, FILE):
        present = folders_of_studies()
        if path.name not in present:
            raise InputError(
                f"No study {str(name)!r}",
                remedy=f"Choose among {', '.join(present) or 'your own: none ships with this installation'}",
            )
        path = present[path.name]
    if path.is_dir():
        path = path / FILE
    if path.name == FILE and (kind := kind_of(path.parent)) is not None:
        KINDS.add(kind)
    return read_study(path)


def list_shipped() -> list[dict[str, str]]:
    """Name, kind and title of every study that ships; no code of theirs is imported."""
    return [
        {"name": name, **{key: str(content.get(key, "")) for key in ("kind", "title")}}
        for name, content in study_contents().items()
    ]


REPORT: Final = "report.pdf"
"""File of the report in the folder of a run."""

ANSWER: Final = "answer.txt"
"""File of the report's answer in one sentence, empty for kinds whose reports have none."""


def run_study(
    study: Study,
    out: str | Path,
    *,
    tell: Callable[[str, bool], None] = lambda _name, _finished: None,
    setting: ReportSetting | None = None,
) -> Path:
    """Run a study, from its motions to the report; what is done already is not done again.

    `out`: its run folder; `tell`: called after each stage with its name and whether there was something to
    do.
    """
    stages = list(KINDS[study.kind].stages(study))
    results = [name for stage in stages for name in stage.writes]
    with RunFolder.open(Path(out), study=study.model_dump(mode="json")) as folder:
        for stage in (*stages, _reporting(study, results, setting)):
            tell(stage.name, folder.perform(stage))
    return folder.path / REPORT


def write_report(folder: str | Path, *, setting: ReportSetting | None = None) -> Path:
    """Make the report of a finished run again.

    Parameters
    ----------
    folder : str or pathlib.Path
        The run folder.
    setting : Setting, optional
        Paper, title, date, and name and logo of the laboratory.

    Returns
    -------
    pathlib.Path
        The report, a PDF.

    Raises
    ------
    InputError
        If nothing was run there, the run is not finished, the folder links to files elsewhere, or a file of
        it lacks what a run writes.
    """
    folder = Path(folder)
    refuse_links(folder)
    study = study_from(study_of(folder), location=str(folder))
    rule, remedy = "The files of a run must be as `reliab run` wrote them", "Run the study again"
    with decoding(rule, remedy=remedy, where=folder):  # somebody may have sent it
        document = KINDS[study.kind].report(study, folder)
    _set(document, study, folder, setting)
    return folder / REPORT


def _reporting(study: Study, reads: list[str], setting: ReportSetting | None) -> Stage:
    def work(folder: Path) -> None:
        document = KINDS[study.kind].report(study, folder)
        _set(document, study, folder, setting)
        answer = plain_text(document.verdict) if isinstance(document, Document) else ""
        with written_whole(folder / ANSWER) as place:
            place.write_text(answer, encoding="utf-8")

    inputs = {**study.model_dump(mode="json"), "setting": (setting or ReportSetting()).to_dict()}
    return Stage(name="report", inputs=inputs, reads=reads, writes=(REPORT, ANSWER), work=work)


def _set(
    document: Document | Mapping[str, bytes], study: Study, folder: Path, setting: ReportSetting | None
) -> None:
    write_pdf(document, folder / REPORT, date=study.date or date_of(folder), setting=setting)
