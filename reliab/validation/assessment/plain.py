"""Judge a test from plain arguments: a file or a name, and numbers, as on the command line."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, overload

import pandas as pd

from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.loop.hybrid_test.model_file import UpdatedModel, read_model
from reliab.loop.structure import Structure
from reliab.motions import Motion, read_motion
from reliab.shipped import or_shipped
from reliab.stated_value import StatedValue
from reliab.validation.assessment.assess import assess as assess_recording
from reliab.validation.assessment.assessment import Assessment
from reliab.validation.assessment.reading import read_recording
from reliab.validation.assessment.recording import Recording
from reliab.validation.assessment.several import Assessments

Quantity = float | str | StatedValue
"""A number, a number with its standard deviation as text ("1±0.01"), or such a value."""


Test = str | Path | pd.DataFrame | Recording
"""A test, its file, its data frame, or the name of one that ships."""


@overload
def assess(
    test: Test,
    structure: Structure | None = None,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    motion: str | Path | Motion | None = None,
    criterion: str | Path | Criterion | None = None,
    model: str | Path | UpdatedModel | None = None,
    **options: Any,  # noqa: ANN401 - handed on as they are
) -> Assessment: ...
@overload
def assess(
    test: Iterable[Test],
    structure: Structure | None = None,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    motion: str | Path | Motion | None = None,
    criterion: str | Path | Criterion | None = None,
    model: str | Path | UpdatedModel | None = None,
    **options: Any,  # noqa: ANN401
) -> Assessments: ...


def assess(
    test: Test | Iterable[Test],
    structure: Structure | None = None,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    motion: str | Path | Motion | None = None,
    criterion: str | Path | Criterion | None = None,
    model: str | Path | UpdatedModel | None = None,
    **options: Any,
) -> Assessment | Assessments:
    """Judge a test, or several, by the error computed from command and measured displacement.

    Parameters
    ----------
    test : str, pathlib.Path, pandas.DataFrame or Recording, or several of them
        The test, its file, a data frame with a history in each column, or the name of one that ships
        ("sample_test").
    structure : Structure, optional
        The structure under test, in place of `f`, `xi` and `alpha`.
    f, xi, alpha : float, str or StatedValue, optional
        Natural frequency [Hz], damping ratio [-] and share of the stiffness in the laboratory [-], with a
        standard deviation where they are not certain: "1±0.01". By default what the file's header states;
        a share of 1 where it states none.
    motion : str, pathlib.Path or Motion, optional
        The test's ground motion, or its file.
    criterion : str, pathlib.Path or Criterion, optional
        The criterion, or its file as `reliab criterion --out` writes it; by default the one that ships.
    model : str, pathlib.Path or UpdatedModel, optional
        Model of a nonlinear specimen, or its file as `reliab diagnose` writes it.
    **options
        `threshold`, `confidence`, `metric`, `stated`, `error_window`, `taper` and `seed` of
        :func:`reliab.validation.assessment.assess.assess`.

    Returns
    -------
    Assessment or Assessments
        Error of the test with its interval, verdict, index and what to improve first; of several tests those
        by file, with the reasons why some could not be judged.

    Raises
    ------
    InputError
        If the file of a single test, or a file that several share, cannot be read or judged, or the structure
        is stated twice or not at all.

    Examples
    --------
    >>> verdict = assess("sample_test", f=1, xi=0.02)
    >>> verdict.reliable, round(verdict.error.rebuilt.rms.value, 3)
    (True, 0.023)
    """
    shared = {
        "motion": read_motion(motion) if isinstance(motion, str | Path) else motion,
        "criterion": Criterion.read(criterion) if isinstance(criterion, str | Path) else criterion,
        "model": read_model(model) if isinstance(model, str | Path) else model,
        **options,
    }
    numbers = {"f": f, "xi": xi, "alpha": alpha}
    if isinstance(test, Test):
        return _assess(test, structure, numbers, shared)
    return _assess_several(test, structure, numbers, shared)


def _assess_several(
    tests: Iterable[Test],
    structure: Structure | None,
    numbers: dict[str, Quantity | None],
    shared: dict[str, Any],
) -> Assessments:
    by_file: dict[str, Test] = {}
    for test in tests:
        file = test.name if isinstance(test, Recording) else _name(test, len(by_file))
        if file in by_file:
            raise InputError(
                "Every test must be given once",
                value=f"{file} twice",
                remedy="Leave it out, or give the recordings different names",
            )
        by_file[file] = test
    judged, faults = {}, {}
    for file, test in by_file.items():
        try:
            judged[file] = _assess(test, structure, numbers, shared)
        except InputError as error:
            faults[file] = str(error)
    return Assessments(files=tuple(by_file), judged=judged, faults=faults)


def _name(test: str | Path | pd.DataFrame, place: int) -> str:
    return f"data frame {place + 1}" if isinstance(test, pd.DataFrame) else str(test)


def _assess(
    test: Test, structure: Structure | None, numbers: dict[str, Quantity | None], shared: dict[str, Any]
) -> Assessment:
    recording = test if isinstance(test, Recording) else _read(test)
    stated = _stated(recording, structure, numbers)
    return assess_recording(
        recording,
        structure
        or Structure(
            frequency=stated["f"].value,
            damping_ratio=stated["xi"].value,
            experimental_fraction=stated["alpha"].value,
        ),
        **{**shared, "stated": {**stated, **shared.get("stated", {})}},
    )


def _read(test: str | Path | pd.DataFrame) -> Recording:
    if isinstance(test, pd.DataFrame):
        return read_recording(test)
    return read_recording(or_shipped(Path(test), "datasets", "test.csv"))


def _stated(
    recording: Recording, structure: Structure | None, given: dict[str, Quantity | None]
) -> dict[str, StatedValue]:
    """Return the stated values of the structure with standard deviations; empty for a given `structure`."""
    numbers = {name: value for name, value in given.items() if value is not None}
    if structure is not None:
        if numbers:
            raise InputError(
                "The structure must be stated once only",
                value=f"a structure and {', '.join(numbers)}",
                remedy="Leave either out",
            )
        return {}
    stated = {"alpha": StatedValue(1.0), **recording.stated}
    stated |= {name: _value(value, name) for name, value in numbers.items()}
    for name, quantity in (("f", "natural frequency [Hz]"), ("xi", "damping ratio")):
        if name not in stated:
            raise InputError(
                f"The {quantity} of the structure must be stated",
                value=f"no {name}",
                remedy=f"Give {name}, or a structure; the verdict rests on it",
                where=recording.name,
            )
    return stated


def _value(quantity: Quantity, name: str) -> StatedValue:
    if isinstance(quantity, StatedValue):
        return quantity
    return StatedValue.parse(quantity, name) if isinstance(quantity, str) else StatedValue(float(quantity))
