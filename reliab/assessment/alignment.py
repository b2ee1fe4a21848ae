"""Where in a ground motion's record a test begins, and its ground acceleration at its own samples.

A test's file seldom begins with the record: it may hold a part of it, or seconds before and after it. The
place is found by the recorded ground acceleration where the test's file has it, else by the response: the
exact response of the structure to the record is compared, at every place, with the exact response computed
from the test, in size and shape and, if that fails, in shape alone.

Of a test with any specimen: the computer's equation holds at the interface whatever the specimen does, and is
linear in the ground motion. The force of the specimen, less what the command alone leaves for it, is what the
ground motion leaves for it while the interface stands still: where both are most alike lies the test.
"""

from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.exact_response import ExactTest
from reliab.core.arrays import Array
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.signals.spectra import convolve_valid
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.blocks import cut
from reliab.structures.structure import Structure

LEAST_MATCH = 0.9
"""Similarity from which on a place counts as found: 1 for equal histories, 0 for unrelated ones."""

_QUIET = 1e-2  # share of the largest energy of a stretch below which it is compared with nothing

_ALIKE_SOMEWHERE = (
    0.5  # of what the ground motion leaves with the rest of the force, at some place of a record
)
_AGREES = 0.25  # relative, of the factor by which the ground motion explains the force


@dataclass(frozen=True, kw_only=True, eq=False)
class Alignment:
    """The part of a ground motion that a test saw."""

    # begin, end: Begin and end of the test on the record's time axis [s]; negative, or beyond the record,
    # where the test's file begins before or ends after it
    begin: float
    end: float
    match: float  # Similarity at that place [-]
    # Whether the match suffices; else the stretch of the test's length with the strongest response was taken
    matched: bool
    by: str  # By what it was found, shape of the
    # Whether the test began at rest there, rather than in the motion that the record before it caused
    from_rest: bool


def align(recording: Recording, reference: Array, structure: Structure, motion: Motion) -> Alignment:
    """Find a test in the record of its ground motion.

    `reference` [m].
    """
    step, size = recording.time_step, recording.command.size
    record = PaddedMotion.around(motion, recording.duration)
    response = record.response(structure, step)
    match, criterion, place = 0.0, "", 0
    if recording.ground is not None:
        similar = similarity(recording.ground, record.resample(step), compare_size=True)
        place, criterion = int(np.argmax(similar)), "ground acceleration"
        match = float(similar[place])
    if match < LEAST_MATCH:
        place, match, criterion = _find_by_response(reference, response)
    is_matched = match >= LEAST_MATCH
    if not is_matched:
        place = int(np.argmax(_energies(response, size)))
    begin = place * step
    response_from_rest = record.cut(begin, begin + recording.duration).response(structure, step)[:size]
    moving = response[place : place + size]
    return Alignment(
        begin=begin - record.before,
        end=begin - record.before + recording.duration,
        match=match,
        matched=is_matched,
        by=criterion,
        from_rest=_distance(response_from_rest, reference) <= _distance(moving, reference),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class PaddedMotion:
    """A ground motion with rest before and after it."""

    acceleration: Array  # Ground acceleration [m/s²], shape (n,)
    time_step: float  # Step between samples [s]
    before: float  # Rest before the record [s]

    @classmethod
    def around(cls, motion: Motion, rest_duration: float) -> "PaddedMotion":
        """Add rest of at least a length [s] on both sides."""
        samples = int(np.ceil(rest_duration / motion.time_step)) + 2
        return cls(
            acceleration=np.pad(motion.acceleration, samples),
            time_step=motion.time_step,
            before=samples * motion.time_step,
        )

    def cut(self, begin: float, end: float) -> "PaddedMotion":
        """Keep what lies between two times [s], counted from the first sample."""
        count = int(np.ceil((end - begin) / self.time_step - 1e-9)) + 1
        times = begin + self.time_step * np.arange(count)
        sample_times = self.time_step * np.arange(self.acceleration.size)
        acceleration = np.interp(times, sample_times, self.acceleration, right=0.0)
        return PaddedMotion(acceleration=acceleration, time_step=self.time_step, before=self.before - begin)

    def resample(self, step: float) -> Array:
        """Acceleration at other steps [m/s²], linear between samples."""
        sample_times = self.time_step * np.arange(self.acceleration.size)
        return np.interp(
            np.arange(0.0, sample_times[-1] * (1.0 + 1e-12), step), sample_times, self.acceleration
        )

    def response(self, structure: Structure, step: float) -> Array:
        """Response of a structure at rest at the first sample, without actuator errors [m]."""
        excitation = Excitation(acceleration=self.acceleration, time_step=self.time_step)
        return cut(excitation, structure, step=step).ideal


def _find_by_response(reference: Array, response: Array) -> tuple[int, float, str]:
    size_similarity = similarity(reference, response, compare_size=True)
    place = int(np.argmax(size_similarity))
    if size_similarity[place] >= LEAST_MATCH:
        return place, float(size_similarity[place]), "response"
    shape_similarity = np.abs(similarity(reference, response, compare_size=False))
    place = int(np.argmax(shape_similarity))
    return place, float(shape_similarity[place]), "shape of the response"


def similarity(part: Array, history: Array, *, compare_size: bool) -> Array:
    """Similarity of a history with each stretch of its length in a longer one, or of several together.

    2⟨p, w⟩/(⟨p, p⟩ + ⟨w, w⟩), or ⟨p, w⟩/√(⟨p, p⟩⟨w, w⟩) where sizes do not count; shapes (n,) or (histories,
    n), products are sums over the histories.
    """
    pairs = list(zip(np.atleast_2d(part), np.atleast_2d(history), strict=True))
    products = np.sum([convolve_valid(longer, shorter[::-1]) for shorter, longer in pairs], axis=0)
    energy = float(np.sum(part**2))
    energies = np.sum([_energies(longer, shorter.size) for shorter, longer in pairs], axis=0)
    if compare_size:
        return np.asarray(2.0 * products / (energy + energies))
    loud = np.maximum(energies, _QUIET * energies.max())
    return np.asarray(products / np.sqrt(energy * loud))


def _energies(history: Array, size: int) -> Array:
    total = np.concatenate([[0.0], np.cumsum(history**2)])
    return np.asarray(total[size:] - total[:-size])


def _distance(response: Array, reference: Array) -> float:
    return float(np.linalg.norm(response - reference[: response.size]))


@dataclass(frozen=True, kw_only=True, eq=False)
class GroundOfTest:
    """Ground motion of a test."""

    acceleration: Array  # At the samples of the test [m/s²], shape (n,)
    factor: float = 1.0  # By which what was given explains the test best [-]

    @property
    def differs(self) -> bool:
        """Whether the motion was given at another scale, and was brought to that of the test."""
        return abs(self.factor - 1.0) > _AGREES


def ground_of_test(test: ExactTest, motion: Motion | None = None) -> GroundOfTest | None:
    """Find the ground motion of a test, recorded or given; None where it is that of another one."""
    if motion is not None:
        return _place_on_record(test, motion)
    return None if test.ground is None else GroundOfTest(acceleration=test.ground)


def _forces_of_ground(test: ExactTest, ground: Array) -> tuple[Array, Array]:
    """Return forces on the specimen that the ground must have caused, and those that a ground motion causes.

    `ground` [m/s²], shape (n,). Forces and moments are over what the specimen bears.
    """
    structure, step = test.stated.structure, test.time_step
    no_ground, borne = np.zeros(test.command.shape[1]), np.linalg.norm(test.fed_back, axis=1)
    undisturbed_force = structure.force_of_computer(
        structure.displacements(test.command, no_ground, step), no_ground, step
    )
    unit = np.where(borne > 0.0, borne, np.inf)[:, np.newaxis]
    still = structure.displacements(np.zeros((borne.size, ground.size)), ground, step)
    return (test.fed_back - undisturbed_force) / unit, structure.force_of_computer(still, ground, step) / unit


def _place_on_record(test: ExactTest, motion: Motion) -> GroundOfTest | None:
    """Find the part of a record that a test saw; forces and moments count by what the specimen bears."""
    structure, step, size = test.stated.structure, test.time_step, test.command.shape[1]
    if structure.all_driven:
        return None
    history = PaddedMotion.around(motion, step * size).resample(step)
    required_forces, ground_forces = _forces_of_ground(test, history)
    similarities = similarity(required_forces, ground_forces, compare_size=False)
    begin = int(np.argmax(np.abs(similarities)))
    if abs(similarities[begin]) < _ALIKE_SOMEWHERE:
        return None
    record_forces = ground_forces[:, begin : begin + size]
    factor = float(np.sum(record_forces * required_forces) / np.sum(record_forces**2))
    ground = GroundOfTest(acceleration=history[begin : begin + size], factor=factor)
    return replace(ground, acceleration=factor * ground.acceleration) if ground.differs else ground
