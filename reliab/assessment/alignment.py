"""Where in a ground motion's record a test begins.

A test's file seldom begins with the record: it may hold a part of it, or seconds before and after it. The
place is found by the recorded ground acceleration where the test's file has it, else by the response: the
exact response of the structure to the record is compared, at every place, with the exact response computed
from the test, in size and shape and, if that fails, in shape alone.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.motions import Motion
from reliab.recordings import Recording
from reliab.signals import convolved
from reliab.simulation import Excitation
from reliab.simulation.linear_loop import cut
from reliab.structures import Structure

LEAST_MATCH = 0.9
"""Similarity from which on a place counts as found: 1 for equal histories, 0 for unrelated ones."""

_QUIET = 1e-2  # share of the largest energy of a stretch below which it is compared with nothing


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
    record = Padded.around(motion, recording.duration)
    response = record.response(structure, step)
    match, by, place = 0.0, "", 0
    if recording.ground is not None:
        similar = similarity(recording.ground, record.sampled(step), in_size=True)
        place, by = int(np.argmax(similar)), "ground acceleration"
        match = float(similar[place])
    if match < LEAST_MATCH:
        place, match, by = _by_response(reference, response)
    matched = match >= LEAST_MATCH
    if not matched:
        place = int(np.argmax(_energies(response, size)))
    begin = place * step
    rest = record.cut(begin, begin + recording.duration).response(structure, step)[:size]
    moving = response[place : place + size]
    return Alignment(
        begin=begin - record.before,
        end=begin - record.before + recording.duration,
        match=match,
        matched=matched,
        by=by,
        from_rest=_distance(rest, reference) <= _distance(moving, reference),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Padded:
    """A ground motion with rest before and after it."""

    acceleration: Array  # Ground acceleration [m/s²], shape (n,)
    time_step: float  # Step between samples [s]
    before: float  # Rest before the record [s]

    @classmethod
    def around(cls, motion: Motion, rest: float) -> "Padded":
        """Add rest of at least a length [s] on both sides."""
        samples = int(np.ceil(rest / motion.time_step)) + 2
        return cls(
            acceleration=np.pad(motion.acceleration, samples),
            time_step=motion.time_step,
            before=samples * motion.time_step,
        )

    def cut(self, begin: float, end: float) -> "Padded":
        """Keep what lies between two times [s], counted from the first sample."""
        count = int(np.ceil((end - begin) / self.time_step - 1e-9)) + 1
        times = begin + self.time_step * np.arange(count)
        known = self.time_step * np.arange(self.acceleration.size)
        kept = np.interp(times, known, self.acceleration, right=0.0)
        return Padded(acceleration=kept, time_step=self.time_step, before=self.before - begin)

    def sampled(self, step: float) -> Array:
        """Acceleration at other steps [m/s²], linear between samples."""
        known = self.time_step * np.arange(self.acceleration.size)
        return np.interp(np.arange(0.0, known[-1] * (1.0 + 1e-12), step), known, self.acceleration)

    def response(self, structure: Structure, step: float) -> Array:
        """Response of a structure at rest at the first sample, without actuator errors [m]."""
        excitation = Excitation(acceleration=self.acceleration, time_step=self.time_step)
        return cut(excitation, structure, step=step).ideal


def _by_response(reference: Array, response: Array) -> tuple[int, float, str]:
    in_size = similarity(reference, response, in_size=True)
    place = int(np.argmax(in_size))
    if in_size[place] >= LEAST_MATCH:
        return place, float(in_size[place]), "response"
    in_shape = np.abs(similarity(reference, response, in_size=False))
    place = int(np.argmax(in_shape))
    return place, float(in_shape[place]), "shape of the response"


def similarity(part: Array, whole: Array, *, in_size: bool) -> Array:
    """Similarity of a history with each stretch of its length in a longer one, or of several together.

    2⟨p, w⟩/(⟨p, p⟩ + ⟨w, w⟩), or ⟨p, w⟩/√(⟨p, p⟩⟨w, w⟩) where sizes do not count; shapes (n,) or (histories,
    n), products are sums over the histories.
    """
    pairs = list(zip(np.atleast_2d(part), np.atleast_2d(whole), strict=True))
    products = np.sum([convolved(longer, shorter[::-1]) for shorter, longer in pairs], axis=0)
    energy = float(np.sum(part**2))
    energies = np.sum([_energies(longer, shorter.size) for shorter, longer in pairs], axis=0)
    if in_size:
        return np.asarray(2.0 * products / (energy + energies))
    loud = np.maximum(energies, _QUIET * energies.max())
    return np.asarray(products / np.sqrt(energy * loud))


def _energies(whole: Array, size: int) -> Array:
    total = np.concatenate([[0.0], np.cumsum(whole**2)])
    return np.asarray(total[size:] - total[:-size])


def _distance(expected: Array, reference: Array) -> float:
    return float(np.linalg.norm(expected - reference[: expected.size]))
