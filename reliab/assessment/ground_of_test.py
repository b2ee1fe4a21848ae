"""The ground acceleration of a test at its own samples: its own channel, or the part of a record that it saw.

The computer's equation holds at the interface whatever the specimen does, and is linear in the ground motion:
the force of the specimen, less what the command alone leaves for it, is what the ground motion leaves for it
while the interface stands still. Where both histories are most alike lies the test in its record.
"""

from dataclasses import dataclass, replace

import numpy as np

from reliab.arrays import Array
from reliab.assessment.alignment import Padded, similarity
from reliab.assessment.exact_response import ExactTest
from reliab.motions import Motion

_ALIKE = 0.7  # correlation of the force with what the ground motion leaves for it, at least
_ALIKE_SOMEWHERE = (
    0.5  # of what the ground motion leaves with the rest of the force, at some place of a record
)
_AGREES = 0.25  # relative, of the factor by which the ground motion explains the force


@dataclass(frozen=True, kw_only=True, eq=False)
class GroundOfTest:
    """Ground motion of a test."""

    acceleration: Array  # At the samples of the test [m/s²], shape (n,)
    factor: float = 1.0  # By which what was given explains the test best [-]

    @property
    def differs(self) -> bool:
        """Whether the motion was given at another scale, and was brought to that of the test."""
        return abs(self.factor - 1.0) > _AGREES


def ground_of_test(
    test: ExactTest, motion: Motion | None = None, *, force_known: bool = True
) -> GroundOfTest | None:
    """Find the ground motion of a test, recorded or given; None where it is that of another one.

    `force_known`: whether the specimen's force is that of the test; that of a linear one, which may have
    yielded, says of a recorded ground motion only its sign.
    """
    if motion is not None:
        return _placed(test, motion)
    own = own_ground(test, _ALIKE if force_known else 0.0)
    return None if own is None else GroundOfTest(acceleration=own)


def own_ground(test: ExactTest, least: float = _ALIKE) -> Array | None:
    """Ground acceleration with which the computer's equation explains the force; None where none does.

    `least`: smallest correlation of both.
    """
    structure, step = test.stated.structure, test.time_step
    if test.ground is None or structure.all_driven:
        return None
    for ground in (test.ground, -test.ground):
        moved = structure.displacements(test.command, ground, step)
        needed = structure.force_of_computer(moved, ground, step)
        if float(np.sum(needed * test.fed_back)) > least * float(
            np.linalg.norm(needed) * np.linalg.norm(test.fed_back)
        ):
            return ground
    return None


def _placed(test: ExactTest, motion: Motion) -> GroundOfTest | None:
    """Find the part of a record that a test saw; forces and moments count by what the specimen bears."""
    structure, step, size = test.stated.structure, test.time_step, test.command.shape[1]
    if structure.all_driven:
        return None
    none, borne = np.zeros(size), np.linalg.norm(test.fed_back, axis=1)
    alone = structure.force_of_computer(structure.displacements(test.command, none, step), none, step)
    unit = np.where(borne > 0.0, borne, np.inf)[:, np.newaxis]
    by_ground = (test.fed_back - alone) / unit
    history = Padded.around(motion, step * size).sampled(step)
    still = structure.displacements(np.zeros((borne.size, history.size)), history, step)
    of_ground = structure.force_of_computer(still, history, step) / unit
    alike = similarity(by_ground, of_ground, in_size=False)
    begin = int(np.argmax(np.abs(alike)))
    if abs(alike[begin]) < _ALIKE_SOMEWHERE:
        return None
    of_record = of_ground[:, begin : begin + size]
    factor = float(np.sum(of_record * by_ground) / np.sum(of_record**2))
    placed = GroundOfTest(acceleration=history[begin : begin + size], factor=factor)
    return replace(placed, acceleration=factor * placed.acceleration) if placed.differs else placed
