"""From a report to a PDF, through typst.

The template and all fonts come with the packages, so that the same report gives the same bytes on any
machine.
"""

import datetime as dt
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, cast

import typst

from reliab.core.files import decoding, refuse_unwritable, written_whole
from reliab.report.content import CONTENT_REMEDY, CONTENT_RULE, files_of
from reliab.report.document import Document
from reliab.report.setting import ReportSetting
from reliab.version import __version__

_TEMPLATES: Final = files("reliab.report") / "templates"
_MARK_INFO: Final = b"/MarkInfo<</Marked true/Suspects false>>"
_BLANKED_MARK_INFO: Final = _MARK_INFO.replace(b"/Suspects false", b" " * len(b"/Suspects false"))
"""What typst writes of a tagged file, and the same without a default that Poppler calls a syntax error; the
length stays, so that every offset in the file holds."""

_NAMES: Final = ("main.typ", "page.typ", "parts.typ", "table.typ")


def write_pdf(
    document: Document | Mapping[str, bytes],
    path: Path,
    *,
    date: dt.date,
    setting: ReportSetting | None = None,
) -> None:
    """Write a report as PDF; identical input gives identical bytes.

    `document`: the report, or its content as :func:`reliab.report.content.read_content` gives it; `path`:
    the file, replaced if it is there; `date`: date on the report and in the file, unless the setting has
    another; `setting`: paper, title, date, and name and logo of the laboratory.
    """
    content = compile_report(document, date=date, setting=setting)
    with refuse_unwritable("Cannot write the file of a report", where=path), written_whole(path) as file:
        file.write_bytes(content)


def compile_report(
    document: Document | Mapping[str, bytes], *, date: dt.date, setting: ReportSetting | None = None
) -> bytes:
    """Set a report as PDF."""
    setting = setting or ReportSetting()
    date = setting.date or date
    _require_sound_logo(setting)
    if isinstance(document, Document):
        return _set(files_of(document), setting, date)
    with decoding(CONTENT_RULE, remedy=CONTENT_REMEDY, where="report"):
        return _set(document, setting, date)


def _set(content: Mapping[str, bytes], setting: ReportSetting, date: dt.date) -> bytes:
    """Set content with the package's templates, which stand for any of the same name."""
    pdf = _compile_typst(
        {**content, **setting.files(), **templates()},
        format="pdf",
        sys_inputs={"date": date.isoformat(), "version": __version__, **setting.inputs()},
        timestamp=dt.datetime.combine(date, dt.time(), tzinfo=dt.UTC),
    )
    return bytes(pdf).replace(_MARK_INFO, _BLANKED_MARK_INFO)


def _require_sound_logo(setting: ReportSetting) -> None:
    """Set the logo alone, so that it is blamed for its own faults only."""
    if setting.logo is None:
        return
    with decoding("A logo must be a sound picture", remedy="Export it again", where=setting.logo):
        page = b"#image(sys.inputs.logo)"
        _compile_typst({"main.typ": page, **setting.files()}, format="svg", sys_inputs=setting.inputs())


def _compile_typst(sources: Mapping[str, bytes], **options: Any) -> Any:  # noqa: ANN401 - bytes, or a list of them
    """Compile files in memory, which can read no other file than the package's templates."""
    files = cast("Any", dict(sources))  # typst's type hints know of no dict
    return typst.compile(files, root=str(_TEMPLATES), ignore_system_fonts=True, **options)


def templates() -> dict[str, bytes]:
    """Read the template's files, by name; `main.typ` is the first."""
    return {name: (_TEMPLATES / name).read_bytes() for name in _NAMES}
