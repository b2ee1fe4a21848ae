"""What commands write beside their answer, and the tests that a command line names."""

from pathlib import Path
from typing import Annotated, TypedDict

from reliab.app import completion
from reliab.app.declaration import argument
from reliab.app.options import COVER, OUTPUT, FrameFile


class Json(TypedDict, total=False):
    """What every command writes for programs."""

    json_target: Annotated[
        str | None,
        OUTPUT.option(
            "FILE|-", "Write JSON to a file; - prints only JSON to standard output.", names=("--json",)
        ),
    ]


class Cover(TypedDict, total=False):
    """How a report is set."""

    title: Annotated[str | None, COVER.advanced("TEXT", "Title of the report, in place of its own.")]
    date: Annotated[
        str | None,
        COVER.advanced("DATE", "Date on the report, 2026-03-01, in place of that of the results."),
    ]
    paper: Annotated[
        str, COVER.advanced("a4|letter", "Paper of the report.", default="a4", completion=completion.papers)
    ]
    laboratory: Annotated[str | None, COVER.advanced("NAME", "Name of the laboratory on the report.")]
    logo: Annotated[
        str | Path | None, COVER.advanced("FILE.svg|png|jpg", "Logo of the laboratory on the report.")
    ]


class Listing(TypedDict, total=False):
    """What can be chosen."""

    list_all: Annotated[bool, OUTPUT.flag("List what ships and can be chosen.", names=("--list",))]


class Check(TypedDict, total=False):
    """The verdict as an exit code."""

    check: Annotated[bool, OUTPUT.flag("Exit with code 1 unless the test is reliable.")]


class Details(TypedDict, total=False):
    """How much is printed."""

    details: Annotated[bool, OUTPUT.flag("Print all results, not only the most important ones.")]


class Chart(TypedDict, total=False):
    """The answer as a figure."""

    figure: Annotated[
        Path | None,
        OUTPUT.option("FILE.svg|png|pdf", "Draw the answer as a chart.", endings=(".svg", ".png", ".pdf")),
    ]


class Folder(TypedDict, total=False):
    """A folder of results."""

    out: Annotated[Path | None, OUTPUT.option("DIR", "Folder for report and results.")]


class Tests(FrameFile, total=False):
    """Tests of a command line, and a table of what is found."""

    tests: Annotated[
        list[Path] | None,
        argument(
            "[TEST]...",
            "Files with command and measured displacement: text, MATLAB, HDF5, TDMS or NetCDF; or "
            "sample_test, which comes with reliab.",
            default=None,
            completion=completion.samples,
        ),
    ]
    out: Annotated[
        Path | None,
        OUTPUT.option("FILE.csv", "Write the answer as a table, one row for each test.", endings=(".csv",)),
    ]
