"""`reliab.compare`: tests of one rig, such as one with each compensator, ranked by their errors."""

from collections.abc import Iterable
from typing import Unpack

from reliab.app import questions
from reliab.app.api.assessment import assess
from reliab.app.api.channels import Test
from reliab.assessment.comparison import Comparison, rank_tests
from reliab.assessment.frame_assessment import CoupledAssessment
from reliab.assessment.several import Assessments
from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.structure import Structure


def compare(
    tests: Iterable[Test],
    structure: Structure | FrameUnderTest | str | None = None,
    **stated: Unpack[questions.StatedOfTest],
) -> Comparison:
    """Rank tests of one structure and rig by their errors, such as one motion with each compensator.

    Parameters
    ----------
    tests : iterable of str, pathlib.Path, pandas.DataFrame or Recording
        The tests, at least two.
    structure : Structure, FrameUnderTest or str, optional
        The structure under test, as for :func:`reliab.assess`.
    **stated
        All other arguments of :func:`reliab.assess`; they hold for every test.

    Returns
    -------
    Comparison
        The smallest error first, each with its interval and its difference from the first.

    Raises
    ------
    InputError
        As :func:`reliab.assess`, or if fewer than two tests could be judged.

    Examples
    --------
    >>> import numpy as np
    >>> import pandas as pd
    >>> time, noise = np.arange(0.0, 30.0, 0.005), np.random.default_rng(0).normal(size=6000)
    >>> moved = lambda delay: 0.02 * np.sin(6.0 * (time - delay)) * np.sin(0.1 * time) ** 2
    >>> tests = [
    ...     pd.DataFrame({"time_s": time, "command_m": moved(0.0), "measured_m": moved(delay) + 1e-5 * noise})
    ...     for delay in (0.004, 0.001)
    ... ]
    >>> [test.file for test in compare(tests, f=1, xi=0.05).tests]
    ['data frame 2', 'data frame 1']
    """
    return compare_assessments(assess(tests, structure, **stated))


def compare_assessments(assessments: Assessments) -> Comparison:
    """Rank tests that were judged."""
    judged = {
        file: found for file, found in assessments.judged.items() if not isinstance(found, CoupledAssessment)
    }
    if len(judged) < len(assessments.judged):
        raise InputError(
            "Only tests of one actuator can be compared",
            value="a frame with several",
            remedy="Judge each with `reliab assess`: its governing displacement is listed first",
        )
    return rank_tests(judged, assessments.faults)
