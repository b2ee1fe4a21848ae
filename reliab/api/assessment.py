"""`reliab.assess`: the verdict on a test, or on several."""

from collections.abc import Iterable
from pathlib import Path
from typing import Unpack, overload

from reliab.api.arguments import Quantity, stated_values
from reliab.api.channels import Channels, Test
from reliab.api.former import Former, accepted
from reliab.api.judging import Judge, Terms
from reliab.assessment import Assessment, Assessments, FrameAssessment
from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.motions import Motion
from reliab.progress import Progress, silent
from reliab.recordings import Recording
from reliab.simulation.frames import FrameUnderTest
from reliab.simulation.hybrid_test import UpdatedModel
from reliab.structures import Structure


class Stated(Former, total=False):
    """Arguments of `assess` that need a name; they are declared here for the checkers of types."""

    f: Quantity | None
    xi: Quantity | None
    alpha: Quantity | None
    scale: Quantity | None
    feedback_lag: Quantity | None
    mass: Quantity | None
    motion: str | Path | Motion | None
    criterion: str | Path | Criterion | None
    model: str | Path | UpdatedModel | None
    threshold: float | None
    confidence: float | None
    metric: str | None
    command: str | None
    measured: str | None
    time: str | None
    rate: float | None
    units: str | None
    time_units: str | None
    delimiter: str | None
    progress: Progress


@overload
def assess(  # type: ignore[overload-overlap]  # a text is one file
    test: Test, structure: Structure | None = None, **stated: Unpack[Stated]
) -> Assessment: ...
@overload
def assess(  # type: ignore[overload-overlap]
    test: Test, structure: FrameUnderTest | str | Path, **stated: Unpack[Stated]
) -> FrameAssessment: ...
@overload
def assess(
    test: Iterable[Test],
    structure: Structure | FrameUnderTest | str | Path | None = None,
    **stated: Unpack[Stated],
) -> Assessments: ...


def assess(
    test: Test | Iterable[Test],
    structure: Structure | FrameUnderTest | str | Path | None = None,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    scale: Quantity | None = None,
    feedback_lag: Quantity | None = None,
    mass: Quantity | None = None,
    motion: str | Path | Motion | None = None,
    criterion: str | Path | Criterion | None = None,
    model: str | Path | UpdatedModel | None = None,
    threshold: float | None = None,
    confidence: float | None = None,
    metric: str | None = None,
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate: float | None = None,
    units: str | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
    progress: Progress = silent,
    **former: Unpack[Former],
) -> Assessment | FrameAssessment | Assessments:
    """Judge a test, or several, by the error computed from command and measured displacement.

    Parameters
    ----------
    test : str, pathlib.Path, pandas.DataFrame or Recording, or several of them
        The test, its file, a data frame with a history in each column, or the name of one that ships
        ("sample_test").
    structure : Structure, FrameUnderTest, str or pathlib.Path, optional
        The structure under test, in place of `f`, `xi` and `alpha`; or a frame with its part in the
        laboratory, or the file of one.
    f, xi, alpha : float, str or StatedValue, optional
        Natural frequency [Hz], damping ratio [-] and share of the stiffness in the laboratory [-], with a
        standard deviation where they are not certain: "1±0.01". By default those of the model, or what the
        file's header states. Without a damping ratio 0.02 is assumed, and the test is undecided where the
        verdict depends on it; without a share it is 1.
    scale, feedback_lag, mass : float, str or StatedValue, optional
        Scale of the displacement sensor [-], 1 by default; time by which the force is fed back late [ms], 0
        by default; mass of the structure [kg], with which a recorded force is also used to identify the
        structure.
    motion : str, pathlib.Path or Motion, optional
        The test's ground motion, or its file; the index is then judged by the boundary of this motion.
    criterion : str, pathlib.Path or Criterion, optional
        The criterion, or its file as `reliab criterion --out` writes it; by default the one that ships.
    model : str, pathlib.Path or UpdatedModel, optional
        Model of a nonlinear specimen, or its file as `reliab diagnose` writes it.
    threshold, confidence : float, optional
        Error of the whole test, 0.05 by default, and share of ground motions, 0.95 by default; a criterion
        brings its own.
    metric : {"rms", "mte"}, optional
        Error of the whole test, RMS^R or MTE^R; a criterion brings its own.
    command, measured, time : str, optional
        Names of the columns, where they are not recognised.
    rate : float, optional
        Sampling rate [Hz], where the file holds no time.
    units, time_units : str, optional
        Unit of both displacements and of the time, where the file states none.
    delimiter : str, optional
        What separates the columns of a text.
    progress : callable, optional
        Called after each of several tests.
    **former
        `stated`, `taper` and `seed` of :func:`reliab.assessment.assess`, which end with version 0.4.

    Returns
    -------
    Assessment, FrameAssessment or Assessments
        Error of the test with its interval, verdict, index and what to improve first; of several tests those
        by file, with the reasons why some could not be judged.

    Raises
    ------
    InputError
        If a single test, or a file that several share, cannot be read or judged, the structure is stated
        twice, not at all, or not as that of the model, or an argument would have no effect.

    Examples
    --------
    >>> verdict = assess("sample_test", f=1, xi=0.02)
    >>> verdict.reliable, round(verdict.error.rebuilt.rms.value, 3)
    (True, 0.023)
    """
    judge = Terms(
        numbers=stated_values(f=f, xi=xi, alpha=alpha, scale=scale, feedback_lag=feedback_lag, mass=mass),
        structure=structure,
        motion=motion,
        criterion=criterion,
        model=model,
        threshold=threshold,
        confidence=confidence,
        metric=metric,
        former=accepted(former),
    ).judge()
    channels = Channels(
        command=command,
        measured=measured,
        time=time,
        rate=rate,
        units=units,
        time_units=time_units,
        delimiter=delimiter,
    )
    if isinstance(test, Test):
        return judge(channels.read(test))
    return _assess_several(test, channels, judge, progress)


def _assess_several(
    tests: Iterable[Test], channels: Channels, judge: Judge, progress: Progress
) -> Assessments:
    by_file: dict[str, Test] = {}
    for test in tests:
        file = _name(test, len(by_file))
        if file in by_file:
            raise InputError(
                "Every test must be given once",
                value=f"{file} twice",
                remedy="Leave it out, or give the recordings different names",
            )
        by_file[file] = test
    if not by_file:
        raise InputError(
            "A test's file is needed",
            value="none",
            remedy="Name it, or ask before a test what is tolerable (`reliab assess --design`, in Python "
            "`reliab.design_test`)",
        )
    judged, faults = {}, {}
    for done, (file, test) in enumerate(by_file.items(), start=1):
        try:
            judged[file] = judge(channels.read(test))
        except InputError as error:
            faults[file] = str(error)
        progress(done, len(by_file))
    return Assessments(files=tuple(by_file), judged=judged, faults=faults)


def _name(test: Test, place: int) -> str:
    if isinstance(test, Recording):
        return test.name
    return str(test) if isinstance(test, str | Path) else f"data frame {place + 1}"
