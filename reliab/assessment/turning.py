"""What nobody stated and would turn a verdict: a specimen that yields, a filter on one channel."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.assessment.budget import LowPass
from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.nonlinear_reference import reference_of_model
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.assessment.verdict import Word, word_of_probability
from reliab.effects import Hysteresis
from reliab.recordings import Recording
from reliab.significant import percent, significant
from reliab.simulation.hybrid_test import HybridTest
from reliab.structures import Specimen, Structure
from reliab.vocabulary import Metric

DUCTILITIES: Final = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
"""Largest displacement over the yield displacement, from the smallest that is tried."""

CORNERS: Final = (500.0, 400.0, 300.0, 200.0, 150.0, 120.0, 100.0, 80.0, 60.0, 50.0, 40.0, 30.0, 20.0)
"""Corners of a filter of second order on one channel [Hz], from the weakest filter that is tried."""

_HARDENING = 0.03  # stiffness after yielding over that before
_SHARPNESS = 8.0  # exponent of the hysteresis
_LEAST_RATE, _PER_PERIOD = 200.0, 80.0  # samples simulated in a second, and in a period


@dataclass(frozen=True, kw_only=True)
class Turning:
    """What would turn the verdict on a test, though it was not stated; None where nothing tried does."""

    # Smallest of `DUCTILITIES` with which the error lies on the other side of the threshold [-]
    smallest_ductility: float | None = None
    # Highest of `CORNERS` with which it does, on command or measured displacement alone [Hz]
    highest_filter: float | None = None
    nonlinear_asked: bool = False  # Whether a ductility was asked: not where a force was recorded

    @property
    def sentences(self) -> tuple[str, ...]:
        """Say what would turn the verdict."""
        sentences = []
        if self.nonlinear_asked:
            yields = (
                f"no ductility up to {significant(DUCTILITIES[-1])} would turn the verdict"
                if self.smallest_ductility is None
                else "the verdict would turn if it yielded to a ductility of "
                f"{significant(self.smallest_ductility)} or more"
            )
            sentences.append(
                f"No force was recorded, so that the specimen is taken as linear: {yields} (stiffness as "
                f"stated before yielding, {percent(_HARDENING)} of it after)."
            )
        if self.highest_filter is not None:
            sentences.append(
                "Filters of the two channels were not stated: one of second order at "
                f"{significant(self.highest_filter)} Hz or lower on one channel alone would turn the verdict."
            )
        return tuple(sentences)

    def to_dict(self) -> dict[str, float | None]:
        """Put it into plain values."""
        return {"smallest_ductility": self.smallest_ductility, "highest_filter_hz": self.highest_filter}


def examine_turning(error: ErrorOfTest, recording: Recording, question: Question) -> Turning:
    """Find what would turn the verdict; nothing is asked where it is undecided or everything was stated."""
    undecided = word_of_probability(error.probability) is Word.UNDECIDED
    if undecided or question.equipment is None or question.model is not None:
        return Turning()
    without_force, without_filters = recording.force is None, "filter_delay" not in question.stated
    return Turning(
        smallest_ductility=_first(DUCTILITIES, error, _yielding(error.rebuilt, question))
        if without_force
        else None,
        highest_filter=_first(CORNERS, error, _filtered(error)) if without_filters else None,
        nonlinear_asked=without_force,
    )


def _first(values: tuple[float, ...], error: ErrorOfTest, sizes: Callable[[float], Array]) -> float | None:
    """First value with which one of the sizes of the error lies on the other side of the threshold."""
    below = error.of(error.metric).value < error.threshold
    for value in values:
        if ((sizes(value) < error.threshold) != below).any():
            return value
    return None


def _size(strayed: Array, reference: Array, metric: Metric) -> float:
    """RMS^R or MTE^R of x_m − x_I [-]."""
    largest = np.sqrt(mean_square(strayed)) if metric is Metric.RMS else np.abs(strayed).max()
    return float(largest / np.abs(reference).max())


def _yielding(rebuilt: RebuiltError, question: Question) -> Callable[[float], Array]:
    """Give the error if the specimen yielded to a ductility, as `rebuild_with_specimen` has it."""
    structure = question.structure
    rate = max(_LEAST_RATE, _PER_PERIOD * structure.frequency)
    thin = rebuilt.histories.thinned(max(int(1.0 / (rate * rebuilt.time_step)), 1))
    peak = float(np.abs(thin.measured).max())

    def sizes(ductility: float) -> Array:
        reference = reference_of_model(yielding_model(structure, peak / ductility), thin)
        return np.array([_size(thin.measured - reference, reference, question.metric)])

    return sizes


def yielding_model(structure: Structure, displacement: float) -> HybridTest:
    """Test with a perfect actuator of a specimen that yields at a displacement [m], per unit mass."""
    stiffness = structure.experimental_fraction * structure.circular_frequency**2
    bilinear = Hysteresis(
        force_n=(1.0 - _HARDENING) * stiffness * displacement,
        displacement_m=displacement,
        exponent=_SHARPNESS,
        lost_share=1.0,
    )
    return HybridTest(structure=structure, specimen=Specimen(stiffness=stiffness), effects=(bilinear,))


def _filtered(error: ErrorOfTest) -> Callable[[float], Array]:
    """Give the errors if one of the displacements had passed a filter with a corner [Hz]."""
    rebuilt, histories = error.rebuilt, error.rebuilt.histories
    rate = np.gradient(histories.measured, histories.time_step)
    recursion = Recursion.of_displacement(rebuilt.structure, histories.time_step)
    moved = respond(recursion, rate)[0]

    def sizes(corner: float) -> Array:
        delay = LowPass(corner=corner).delay
        return np.array(
            [
                _size(
                    rebuilt.smooth_error + late * (rate - moved),
                    rebuilt.reference + late * moved,
                    error.metric,
                )
                for late in (delay, -delay)
            ]
        )

    return sizes
