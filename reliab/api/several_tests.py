"""Several tests judged one after the other, and why some could not be."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from reliab.api.channels import Channels, Test
from reliab.errors import InputError
from reliab.progress import Progress
from reliab.recordings import CoupledRecording, Recording

if TYPE_CHECKING:
    from reliab.assessment import Assessment, Assessments, CoupledAssessment, FrameAssessment

Judge: TypeAlias = Callable[[Channels, Test], "Assessment | FrameAssessment | CoupledAssessment"]
"""Reads and judges a test."""


def assess_each(
    tests: Iterable[tuple[str, Channels, Test]], judge: Judge, progress: Progress
) -> "Assessments":
    """Judge tests, each with its name and what is stated of its channels."""
    from reliab.assessment import Assessments

    by_file: dict[str, tuple[Channels, Test]] = {}
    for file, channels, test in tests:
        if file in by_file:
            raise InputError(
                "Every test must be given once",
                value=f"{file} twice",
                remedy="Leave it out, or give the recordings different names",
            )
        by_file[file] = channels, test
    if not by_file:
        raise InputError(
            "A test's file is needed",
            value="none",
            remedy="Name it, or ask before a test what is tolerable (`reliab assess --design`, in Python "
            "`reliab.design_test`)",
        )
    judged, faults = {}, {}
    for done, (file, (channels, test)) in enumerate(by_file.items(), start=1):
        try:
            judged[file] = judge(channels, test)
        except InputError as error:
            faults[file] = str(error)
        progress(done, len(by_file))
    return Assessments(files=tuple(by_file), judged=judged, faults=faults)


def name_of_test(test: Test, place: int) -> str:
    """Name a test; data frames by their place."""
    if isinstance(test, Recording | CoupledRecording):
        return test.name
    return str(test) if isinstance(test, str | Path) else f"data frame {place + 1}"
