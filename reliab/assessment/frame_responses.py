"""Errors of every floor and storey of a tested frame, besides those of the measured displacements.

What is not driven follows from the interface displacements and the ground motion, whatever the specimen does
(see `Substructures`): the difference of two such motions follows from that of the interface, x_c − x_I,
alone. Over the largest undisturbed response it needs that response, and so the ground motion.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final

import numpy as np

from reliab.assessment.alignment import GroundOfTest, ground_of_test
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.exact_response import ExactTest, exact_test
from reliab.assessment.inferred_error import ACCURACY
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.spread import ErrorDraws, Estimate
from reliab.assessment.substructures import Substructures
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import percent_with_interval, significant
from reliab.core.vocabulary import MILLI, Metric
from reliab.motions.motion import Motion

_NEEDS = (
    "The errors of floors and storeys are stated in millimetres: to relate them to the largest response, the "
    "ground motion of the test is needed, as `motion` or as a channel of its file."
)
_OTHER_MOTION = (
    "The ground motion does not explain the force at the interface: it is assumed to belong to another "
    "test, and errors of floors and storeys are stated in millimetres."
)
_SPECIMENS: Final = {
    "linear": "for a linear specimen",
    "measured": "for the specimen learned from its force",
}


@dataclass(frozen=True, kw_only=True)
class ResponseError(PlainResult):
    """Error of a floor's displacement, or of a storey's drift, as the computer had it in the test."""

    name: str  # "floor 3", "storey 2", or "degree theta" of what the ground does not move along with it
    kind: str  # "floor", "storey" or "degree"
    # rms_mm, peak_mm: RMS and largest deviation from the undisturbed structure [mm; of rotations mrad]
    rms_mm: Estimate
    peak_mm: Estimate
    # rms, mte: The same over the largest undisturbed response [-]; None without the ground motion
    rms: Estimate | None
    mte: Estimate | None

    @property
    def size(self) -> float:
        """What it is ordered by: RMS^R, or the RMS in millimetres where that is not known."""
        return self.rms_mm.value if self.rms is None else self.rms.value


@dataclass(frozen=True, kw_only=True)
class ResponseErrors(PlainResult):
    """Errors of all floors and storeys of a frame, the largest first."""

    keys: ClassVar[Keys] = {
        "in_words": "sentence",
        "specimen": "specimen",
        "governing_storey": "governing_storey.name",
        **same_names("unit", "each", "ground_factor", "needs"),
    }

    each: tuple[ResponseError, ...]  # Error of each floor and storey, with its interval
    specimen: str = "linear"  # How the specimen is known: "linear" or "measured"
    # Factor by which the ground motion explains the test best [-]; None without a ground motion of this
    # test
    ground_factor: float | None = None
    other_motion: bool = False  # Whether a ground motion was given, and is another test's
    # Whether errors over the largest responses are known, beside those in millimetres
    over_peaks: bool = False

    @property
    def governing_storey(self) -> ResponseError | None:
        """The storey with the largest error; None where the frame has no storeys."""
        return next((error for error in self.each if error.kind == "storey"), None)

    @property
    def unit(self) -> str:
        """Unit of the responses: degrees of freedom that the ground does not move may turn."""
        return "mm or mrad" if any(error.kind == "degree" for error in self.each) else "mm"

    @property
    def sentence(self) -> str:
        """Which storey governs, or what is needed to say so."""
        governing = self.governing_storey
        if governing is None or governing.rms is None:
            return _NEEDS
        rms = governing.rms
        return (
            f"Of all storeys, {governing.name} has the largest error of the drift: RMS error "
            f"{percent_with_interval(rms.value, rms.low, rms.high)} of its own peak, "
            f"{_SPECIMENS[self.specimen]}."
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where the ground motion is not that of the test, in a sentence."""
        if self.other_motion:
            return (_OTHER_MOTION,)
        if self.ground_factor is None:
            return ()
        sentence = (
            "The ground motion explains the test when it is multiplied by "
            f"{significant(self.ground_factor, 2)}: errors of floors and storeys are relative to peaks "
            "under the multiplied motion, and wrong if the test had another motion."
        )
        return (sentence,)

    @property
    def needs(self) -> str | None:
        """What relates the errors to the largest responses, where it is missing, in a sentence."""
        return None if self.over_peaks else _NEEDS


def errors_of_responses(
    error: ErrorOfTest,
    degrees: tuple[str, ...],
    ground: Array | None,
    motion: Motion | None = None,
) -> ResponseErrors:
    """Compute the errors of all floors and storeys of a frame from those of the interface.

    `degrees`: names of all degrees of freedom; `ground`: recorded ground acceleration of this test [m/s²];
    `motion`: the ground motion in place of it.
    """
    test = exact_test(error, degrees, ground)
    names, weights = _responses(test)
    found = ground_of_test(test, motion)
    looking = _Looking(test=test, weights=weights, ground=found)
    draws = looking.sizes_of_draws((draw.structure, draw.at_interface) for draw in test.draws())
    errors = [
        _response(looking.as_stated[:, place], draws[..., place], *name) for place, name in enumerate(names)
    ]
    return ResponseErrors(
        each=tuple(sorted(errors, key=lambda response: -response.size)),
        specimen="linear" if error.specimen is None else "measured",
        ground_factor=found.factor if found is not None and found.differs else None,
        other_motion=not looking.has_peaks and (motion is not None or test.has_other_ground),
        over_peaks=looking.has_peaks,
    )


def _responses(test: ExactTest) -> tuple[list[tuple[str, str]], Array]:
    """Kinds and names of floors and storeys, and their weights of the degrees of freedom."""
    influence = test.stated.structure.influence
    degrees = test.degrees or tuple(str(place + 1) for place in range(influence.size))
    storeys, drifts = weights_of_storeys(degrees, influence)
    names = [
        ("floor" if factor else "degree", name)
        for name, factor in zip(degrees, influence.tolist(), strict=True)
    ]
    return names + [("storey", name) for name in storeys], np.vstack([np.eye(influence.size), drifts])


def weights_of_storeys(names: tuple[str, ...], influence: Array) -> tuple[list[str], Array]:
    """Names of storeys, and the weights of all degrees of freedom in their drifts; none without names.

    A storey lies below each floor that the ground moves along with it, above the one before.
    """
    directions = np.flatnonzero(influence) if names else np.zeros(0, dtype=np.int64)
    drifts = np.diff(np.eye(influence.size)[directions], axis=0, prepend=np.zeros((1, influence.size)))
    return [names[place] for place in directions], drifts


@dataclass(frozen=True, kw_only=True, eq=False)
class _Looking:
    """Looks at responses of a test: their RMS and largest deviations, and largest undisturbed values [m]."""

    test: ExactTest
    weights: Array  # Of the degrees of freedom in each response [-], shape (responses, n)
    ground: GroundOfTest | None

    @property
    def has_peaks(self) -> bool:
        """Whether the undisturbed responses are known."""
        return self.ground is not None or self.test.stated.structure.all_driven

    @cached_property
    def as_stated(self) -> Array:
        """With all as stated, shape (3, responses)."""
        return self._sizes(self.test.stated.structure, self.test.stated.at_interface, 1)

    @cached_property
    def _sampling_ratio(self) -> Array:
        """What all samples give over what each `every`-th gives, shape (3, responses)."""
        exact_response, stride = self.test.stated, self.test.every
        coarse = self._sizes(exact_response.structure, exact_response.at_interface[:, ::stride], stride)
        return np.divide(self.as_stated, coarse, out=np.ones_like(coarse), where=coarse > 0.0)

    def sizes_of_draws(self, draws: Iterator[tuple[Substructures, Array]]) -> Array:
        """Of draws of structures and exact responses at the interface, shape (draws, 3, responses)."""
        sizes = np.stack([self._sizes(structure, exact, self.test.every) for structure, exact in draws])
        numerical_factor = 1.0 + ACCURACY * np.random.default_rng(0).standard_normal((len(sizes), 2, 1))
        sizes[:, :2] *= numerical_factor
        return np.asarray(self._sampling_ratio * sizes)

    def _sizes(self, structure: Substructures, exact: Array, stride: int) -> Array:
        step = stride * self.test.time_step
        no_ground = np.zeros(exact.shape[1])
        deviations = structure.displacements(self.test.command[:, ::stride] - exact, no_ground, step)
        deviations = np.ascontiguousarray(self.weights @ deviations)
        peaks = np.full(len(deviations), np.nan)
        if self.has_peaks:
            ground = no_ground if self.ground is None else self.ground.acceleration[::stride]
            peaks = np.abs(self.weights @ structure.displacements(exact, ground, step)).max(axis=1)
        rms = np.sqrt([mean_square(row) for row in deviations])
        return np.stack([rms, np.abs(deviations).max(axis=1), peaks])


def _response(sizes: Array, draws: Array, kind: str, name: str) -> ResponseError:
    """Error of one response from RMS, largest deviation and peak, (3,), and those of draws, (draws, 3)."""

    def estimates(values: Array, unit: float | None) -> list[Estimate]:
        rms, largest, peak = draws.T
        scale = peak if unit is None else unit
        errors = ErrorDraws(
            rms=rms / scale, mte=largest / scale, weights=np.ones(rms.size), values=tuple(values.tolist())
        )
        return [errors.estimate(metric) for metric in (Metric.RMS, Metric.MTE)]

    rms_mm, peak_mm = estimates(MILLI * sizes[:2], 1.0 / MILLI)
    rms = mte = None
    if np.isfinite(sizes[2]):
        rms, mte = estimates(sizes[:2] / sizes[2], None)
    return ResponseError(name=f"{kind} {name}", kind=kind, rms_mm=rms_mm, peak_mm=peak_mm, rms=rms, mte=mte)
