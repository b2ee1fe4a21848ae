"""The error of one test, rebuilt from its command and measured displacement."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error import Estimate, Parts, RebuiltError, Tolerances, Widening, rebuild
from reliab.assessment.rebuilt_error.nonlinear_reference import rebuild_with_specimen
from reliab.assessment.rebuilt_error.whole_structure import whole_structure
from reliab.assessment.verdict import word_of_probability
from reliab.recordings import Recording
from reliab.significant import significant
from reliab.simulation.hybrid_test import UpdatedModel
from reliab.stated_value import StatedValue
from reliab.structures import Structure
from reliab.vocabulary import MILLI, PERCENT, Metric

_RELATIVE = {
    "f": "frequency",
    "xi": "damping_ratio",
    "alpha": "experimental_fraction",
    "scale": "sensor_scale",
}
_HALF = 0.5
PART_NAMES: Final[Mapping[str, str]] = {
    "amplitude": "amplitude",
    "delay": "delay",
    "neither": "what is neither gain nor delay",
    "fed_back_force": "lag of the fed-back force",
}
"""Parts of the error in words."""

_SPOKEN = {
    "frequency": "the natural frequency",
    "damping_ratio": "the damping ratio",
    "experimental_fraction": "the share of the stiffness in the laboratory",
    "sensor_scale": "the scale of the displacement sensor",
    "sensor_offset": "the offset of the displacement sensor",
    "time_shift": "the shift between the two channels",
    "feedback_lag": "the lag of the fed-back force",
    "initial_state": "the error's initial value and velocity",
    "sensor_noise": "the noise of the displacement sensor",
}
_REMEDIES = {
    "initial_state": "Record from rest: the unknown initial error widens the interval most.",
    "sensor_noise": "A displacement sensor with less noise narrows the interval most.",
    "sensor_offset": "Record from rest, which shows the sensor's offset: it widens the interval most.",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Question:
    """Structure, metric and threshold by which a test is judged."""

    structure: Structure  # The structure under test
    # Frequency "f" [Hz], damping ratio "xi", share "alpha", sensor "scale" [-] and "feedback_lag" [ms], each
    # with its standard deviation
    stated: Mapping[str, StatedValue]
    metric: Metric  # Which error
    threshold: float  # Error of the whole test [-]
    model: UpdatedModel | None  # Calibrated model of a nonlinear specimen
    seed: int  # Seed of the draws

    @property
    def tolerances(self) -> Tolerances:
        """Standard deviations of what is stated."""
        relative = {
            name: self.stated[key].deviation / abs(self.stated[key].value)
            for key, name in _RELATIVE.items()
            if key in self.stated and self.stated[key].value
        }
        lag = self.stated.get("feedback_lag", StatedValue(0.0))
        return Tolerances(**relative, feedback_lag=lag.deviation / MILLI)


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfTest:
    """Error of a test.

    Attributes
    ----------
    rebuilt : RebuiltError
        The error with its histories and draws.
    metric : Metric
        Which error is asked about.
    threshold : float
        Error with which it is compared [-].
    damping_ratio : float
        ξ of the structure with which it was rebuilt [-].
    under : str
        What was taken to hold beside what was stated, in words; empty where nothing was.
    alternatives : tuple of ErrorOfTest
        Errors of the same test under other explanations of what it shows, none of which can be excluded.
    """

    rebuilt: RebuiltError
    metric: Metric
    threshold: float
    damping_ratio: float
    under: str = ""
    alternatives: tuple["ErrorOfTest", ...] = ()

    def of(self, metric: Metric) -> Estimate:
        """Error by one metric, with its 90 % interval [-]."""
        return self.rebuilt.estimate(metric)

    @property
    def probability(self) -> float:
        """Probability that the error asked about stays below the threshold.

        Where alternatives lead to other verdicts, it is the mean of all: each may be the true one.
        """
        as_stated = self.rebuilt.probability(self.threshold, self.metric)
        if not self.contested:
            return as_stated
        return float(np.mean([as_stated, *(another.probability for another in self.alternatives)]))

    @property
    def contested(self) -> bool:
        """Whether the verdict is another one under some alternative."""
        word = word_of_probability(self.rebuilt.probability(self.threshold, self.metric))
        return any(word_of_probability(another.probability) is not word for another in self.alternatives)

    @property
    def reference(self) -> Array:
        """Response without actuator errors, computed from the test [m], shape (n,)."""
        return self.rebuilt.reference

    @cached_property
    def parts(self) -> Parts:
        """Parts of the error: amplitude, delay, neither, and a late force."""
        return self.rebuilt.parts()

    @cached_property
    def widenings(self) -> tuple[Widening, ...]:
        """What widens the interval, the widest first."""
        return self.rebuilt.widenings(self.metric)

    @property
    def would_decide(self) -> tuple[str, ...]:
        """What would narrow the interval most, in a sentence; none where nothing widens it."""
        if not self.widenings:
            return ()
        widest = self.widenings[0]
        if widest.name in _REMEDIES:
            return (_REMEDIES[widest.name],)
        spoken = _SPOKEN[widest.name]
        if widest.deviation_for_half is None or widest.name in ("time_shift", "feedback_lag"):
            return (f"Determine {spoken} better: its uncertainty widens the interval most.",)
        half = PERCENT * widest.deviation_for_half
        return (f"Determine {spoken} to {significant(half, 2)} %: the interval is then half as wide.",)


def error_of_test(
    recording: Recording,
    question: Question,
    *,
    sensor_offset: float | None = None,
    specimen_damping: float = 0.0,
) -> ErrorOfTest:
    """Rebuild the error of a test.

    `sensor_offset` [m]; `specimen_damping` [s].
    """
    scale = question.stated.get("scale", StatedValue(1.0)).value
    lag = question.stated.get("feedback_lag", StatedValue(0.0)).value / MILLI
    measured = recording.measured / scale
    whole = whole_structure(question.structure)
    if question.model is not None:
        rebuilt = rebuild_with_specimen(
            recording.command,
            measured,
            recording.time_step,
            question.model.test,
            deviations=question.model.deviations,
            sensor_offset=sensor_offset,
            tolerances=question.tolerances,
            seed=question.seed,
        )
    else:
        rebuilt = rebuild(
            recording.command,
            measured,
            recording.time_step,
            replace(whole, specimen_damping=specimen_damping * whole.specimen_stiffness),
            feedback_lag=lag,
            sensor_offset=sensor_offset,
            tolerances=question.tolerances,
            seed=question.seed,
        )
    return ErrorOfTest(
        rebuilt=rebuilt,
        metric=question.metric,
        threshold=question.threshold,
        damping_ratio=question.structure.damping_ratio,
    )
