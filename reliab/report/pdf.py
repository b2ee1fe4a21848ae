"""From a report to a PDF, through typst.

The template and all fonts come with the packages, so that the same report gives the same bytes on any
machine.
"""

import datetime as dt
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, cast

import typst

from reliab.errors import InputError
from reliab.files import decoding, written_whole
from reliab.report.content import files_of
from reliab.report.document import Document
from reliab.report.setting import Setting
from reliab.version import __version__

_NAMES: Final = ("main.typ", "page.typ", "parts.typ", "table.typ")


def write_pdf(
    document: Document | Mapping[str, bytes], path: Path, *, date: dt.date, setting: Setting | None = None
) -> None:
    """Write a report as PDF; identical input gives identical bytes.

    Parameters
    ----------
    document : Document or mapping of str to bytes
        The report, or its content as :func:`reliab.report.content.saved_content` gives it.
    path : pathlib.Path
        The file, replaced if it is there.
    date : datetime.date
        Date on the report and in the file, unless the setting has another.
    setting : Setting, optional
        Paper, title, date, and name and logo of the laboratory.

    Raises
    ------
    InputError
        If the file cannot be written, or the logo is damaged.
    """
    content = compiled_report(document, date=date, setting=setting)
    try:
        with written_whole(path) as file:
            file.write_bytes(content)
    except OSError as error:
        raise InputError(
            "The file of a report must be writable",
            value=error.strerror,
            remedy="Name another",
            where=str(path),
        ) from None


def compiled_report(
    document: Document | Mapping[str, bytes], *, date: dt.date, setting: Setting | None = None
) -> bytes:
    """Set a report as PDF.

    Parameters
    ----------
    document : Document or mapping of str to bytes
        The report, or its content.
    date : datetime.date
        Its date, unless the setting has another.
    setting : Setting, optional
        Paper, title, date, and name and logo of the laboratory.

    Returns
    -------
    bytes
        The PDF.

    Raises
    ------
    InputError
        If the logo is damaged.
    """
    setting = setting or Setting()
    date = setting.date or date
    content = files_of(document) if isinstance(document, Document) else document
    with _logo_decoded(setting):
        pdf = typst.compile(
            cast("Any", {**templates(), **content, **setting.files()}),  # typst's type hints know of no dict
            ignore_system_fonts=True,
            format="pdf",
            sys_inputs={"date": date.isoformat(), "version": __version__, **setting.inputs()},
            timestamp=dt.datetime.combine(date, dt.time(), tzinfo=dt.UTC),
        )
    return bytes(pdf)


def _logo_decoded(setting: Setting) -> AbstractContextManager[None]:
    """Blame the logo, the only part of a report that a user draws, where one is set that cannot be."""
    if setting.logo is None:
        return nullcontext()
    return decoding("A logo must be a sound picture", remedy="Export it again", where=setting.logo)


def templates() -> dict[str, bytes]:
    """Read the template's files, by name; `main.typ` is the first."""
    folder = files("reliab.report") / "templates"
    return {name: (folder / name).read_bytes() for name in _NAMES}
