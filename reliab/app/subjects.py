"""What a question is about: files, folders and names that stand before its options, or that it writes."""

from pathlib import Path
from typing import Annotated, TypedDict

from reliab.app import completion
from reliab.app.declaration import Files, argument
from reliab.app.options import OUTPUT, MotionSource
from reliab.sweep.several import Names


class MotionSources(TypedDict, total=False):
    """Ground motions to list, check or import."""

    sources: Annotated[Files, argument("SOURCE...", "Files, folders or a built-in suite (synthetic).")]


class NewSuite(TypedDict, total=False):
    """A suite of ground motions to write."""

    out: Annotated[Path, OUTPUT.option("FOLDER", "New or empty folder for the suite.", is_required=True)]


class NewStore(TypedDict, total=False):
    """Results to store."""

    out: Annotated[Path, OUTPUT.option("STORE", "The Zarr store to write.", is_required=True)]


class CalibrationFile(TypedDict, total=False):
    """A test made to calibrate channels."""

    test: Annotated[
        Path,
        argument(
            "FILE",
            "Test in which both channels record one motion: a sine, a sweep, or steps with pauses, "
            "without a specimen.",
        ),
    ]


class RigArgument(TypedDict, total=False):
    """Folder of a rig."""

    rig: Annotated[Path, argument("RIG", "Folder of the rig.")]


class NewTests(RigArgument, total=False):
    """Tests to add to a rig."""

    tests: Annotated[list[Path], argument("FILE...", "Tests, in any format that `reliab assess` reads.")]


class KeptTest(RigArgument, total=False):
    """A test of a rig."""

    test: Annotated[str, argument("TEST", "Name of the test, or first digits of its checksum.")]


class KeptTests(RigArgument, total=False):
    """Tests of a rig."""

    tests: Annotated[Names, argument("TEST...", "Names, or first digits of checksums.")]


class RigTableArguments(RigArgument, total=False):
    """The table of a rig's tests."""

    out: Annotated[Path, OUTPUT.option("FILE.csv", "The table as CSV.", is_required=True, endings=(".csv",))]


class RigPdfArguments(RigArgument, total=False):
    """The report of a rig."""

    out: Annotated[Path, OUTPUT.option("FILE.pdf", "The report.", is_required=True, endings=(".pdf",))]


class StudyArgument(MotionSource, total=False):
    """What `reliab.run_study` is asked."""

    study: Annotated[
        str,
        argument(
            "[STUDY]",
            "Folder or file of a study, or the name of one that comes with reliab. Code in the folder is "
            "executed.",
            default="quick",
            completion=completion.studies,
        ),
    ]


class RunArgument(TypedDict, total=False):
    """A finished run."""

    folder: Annotated[Path, argument("DIR", "Run folder that `reliab run` wrote.")]


class ListedData(TypedDict, total=False):
    """Data that the package leaves out."""

    source: Annotated[
        str, argument("FILE|https://…", "The file in the project's sources, or its https address.")
    ]


class SampleFolder(TypedDict, total=False):
    """A folder for samples."""

    folder: Annotated[
        Path, argument("[FOLDER]", "Folder for the samples; `datasets` by default.", default=Path("datasets"))
    ]
