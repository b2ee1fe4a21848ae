"""What a test shows of its structure, compared with what was stated."""

from collections.abc import Mapping
from dataclasses import dataclass

from reliab.assessment.conflicts import Identification, find_conflicts, identify_structure, open_exact
from reliab.assessment.inference.posterior import TestPosterior
from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.recorded_ground import ShownGround
from reliab.assessment.verdict import Contradiction
from reliab.core.significant_digits import percent
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

_FEWEST_PERIODS = 5.0


@dataclass(frozen=True, kw_only=True)
class OwnEquation:
    """What the test shows about its structure."""

    # Frequency, damping ratio and, with a recorded force, share and lag; None where the ground acceleration
    # is not recorded or does not belong to the test
    identified: Identification | None = None
    # Names of stated values that the test contradicts: "f", "xi", "alpha", "feedback_lag"
    wrong: tuple[str, ...] = ()
    contradictions: tuple[str, ...] = ()  # The same in sentences
    nonlinear: str = ""  # A sentence, where the recorded force shows a nonlinear specimen; else empty
    notes: tuple[str, ...] = ()  # What was found about the recorded ground acceleration, in sentences
    doubts: tuple[Contradiction, ...] = ()  # Where it contradicts the test, or the test what was stated

    @property
    def all_contradictions(self) -> tuple[str, ...]:
        """Where the test contradicts what was stated, and a linear specimen, in sentences."""
        return *self.contradictions, *filter(None, [self.nonlinear])


def compare_with_stated(
    posterior: TestPosterior,
    structure: Structure,
    ground: ShownGround,
    stated_values: Mapping[str, StatedValue],
    *,
    nonlinear: str,
) -> OwnEquation:
    """Compare stated values with what the channels show.

    Where everything is taken as exact, a quantity of the structure and one of the channels can look alike, so
    that a value that differs is told, and the verdict left open, but none is replaced. `nonlinear`: as of
    `OwnEquation`.
    """
    shown: list[tuple[TestPosterior, tuple[str, ...]]] = [(posterior, ())]
    if posterior.circumstances.equipment.is_exact:
        shown += open_exact(posterior, has_ground=ground.fits)
    conflicts = {
        conflict.option if names else conflict.finding: conflict
        for opened_posterior, names in shown
        for conflict in find_conflicts(opened_posterior, structure, stated_values, names)
    }
    posteriors = [opened_posterior for opened_posterior, _ in shown]
    return OwnEquation(
        identified=identify_structure(posteriors, structure, ground.misfit or 0.0) if ground.fits else None,
        wrong=tuple(conflict.option for conflict in conflicts.values() if conflict.option),
        contradictions=tuple(conflict.finding for conflict in conflicts.values()),
        nonlinear=nonlinear,
        notes=ground.notes,
        doubts=(*ground.doubts, *(conflict for conflict in conflicts.values() if conflict.remedy)),
    )


def looks_nonlinear(recording: Recording, structure: Structure) -> str:
    """Say that the recorded force is that of a nonlinear specimen; empty where it is not."""
    if recording.force is None or recording.duration * structure.frequency < _FEWEST_PERIODS:
        return ""
    noise = estimate_noise(recording.command, recording.measured, recording.time_step)
    smooth_displacement = noise.smooth(recording.measured)
    check = examine_specimen(smooth_displacement, recording.force, recording.time_step, structure.frequency)
    if not check.nonlinear:
        return ""
    share = percent(check.share, decimals=1)
    return (
        f"The specimen looks nonlinear: {share} of its force follows no spring, dashpot or mass. The error "
        "was computed for a linear specimen."
    )
