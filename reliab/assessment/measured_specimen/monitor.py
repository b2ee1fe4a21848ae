"""A test while it runs whose specimen is known by its force only: learned anew whenever enough was added.

Whenever the test has grown by a fourth, it is learned and judged as `rebuild_with_force` does it after the
test. While held-out parts of the force are predicted badly the specimen counts as not learned, and no error
is stated. The test is held whole.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, PriorKnowledge
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen, rebuild_with_force
from reliab.assessment.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.noise import is_lost_in_noise
from reliab.assessment.rebuilt_error.running_test import Now, RunningSums, RunningTest, require_readings
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

_ENOUGH = 0.1  # of the force on held-out parts, above which a running test has not shown enough


@dataclass(frozen=True, kw_only=True)
class StatedForce:
    """Stated properties of a test whose specimen is learned from its force, apart from its structure."""

    feedback_lag: float = 0.0  # Time by which the force is fed back late [s]
    channel: ForceChannel = ForceChannel()  # noqa: RUF009 - What the force holds beside that of the specimen
    known: PriorKnowledge = EXACTLY_KNOWN  # Of all values, how far they may be off
    seed: int = 0  # Seed of the draws


class MeasuredMonitor(RunningTest):
    """Follow the error of a test whose specimen is learned from its force; `time_step` [s].

    `structure` [kg, N·s/m, N/m]: the computer's part and the specimen's initial stiffness.
    """

    growth: ClassVar[float] = 0.25

    def __init__(self, structure: Partition, time_step: float, stated: StatedForce) -> None:
        super().__init__(structure, time_step, stated.known.skew_deviation(time_step))
        self._stated = stated
        self._parts: list[Array] = []
        self._samples = 0
        self._specimen: MeasuredSpecimen | None = None
        self._known: RebuiltError | None = None

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._samples

    @property
    def specimen(self) -> MeasuredSpecimen | None:
        """What was learned last; None before anything could be."""
        return self._specimen

    @property
    def learning_time(self) -> float | None:
        """Time up to which the specimen was learned last [s]; None before it was tried."""
        return (self._asked - 1) * self.time_step if self._asked else None

    def feed(self, command: Array, measured_displacement: Array, force: Array) -> None:
        """Add the next samples.

        `command`, `measured_displacement` [m]; `force` [N].
        """
        require_readings(command, measured_displacement)
        self._parts.append(np.stack([command, measured_displacement, force]))
        self._samples += command.size
        self._energy.feed(command, measured_displacement)

    @property
    def now(self) -> Now:
        """What is known at the last sample, errors as they were last computed."""
        last = self._known
        return Now(
            samples=self.samples,
            time=(self.samples - 1) * self.time_step,
            error=None if last is None else float(last.displacements[0].error[-1]),
            rms=None if last is None else last.rms.value,
            mte=None if last is None else last.mte.value,
            damping=self._energy.net,
            near_instability=self._energy.near_instability,
        )

    def _calm(self, name: str) -> float:  # noqa: ARG002 - of the only displacement
        if self._known is None:
            return 0.0
        sums = RunningSums()
        reference = self._known.displacements[0].reference
        sums.add(np.zeros_like(reference), reference)
        return sums.calm * self.time_step

    def ask(self, *, at_end: bool = False) -> RebuiltError | None:
        """Learn the specimen from all samples so far, and compute the error; None while it is not learned.

        At the end it counts as learned where `assess` takes it so, which is less than while it runs.
        """
        self._specimen, self._known = self._learn(at_end=at_end), None
        if self._specimen is not None:
            is_known = self._specimen.learned if at_end else self._specimen.held_out <= _ENOUGH
            self._known = self._specimen.rebuilt if is_known else None
        error = self._known
        if error is None:
            self._conclude(None, {})
            return None
        command, measured_displacement, _ = self._parts[0]
        peak = float(np.abs(error.displacements[0].reference).max())
        is_lost = is_lost_in_noise(command - measured_displacement, peak)
        self._conclude(error, {"": error}, lost_in_noise=is_lost)
        return error

    def _learn(self, *, at_end: bool) -> MeasuredSpecimen | None:
        """Learn the specimen from all samples so far; None while they are too few to learn anything."""
        self._parts = [np.concatenate(self._parts, axis=1)]
        command, measured_displacement, force = self._parts[0]
        try:
            return rebuild_with_force(
                command,
                measured_displacement,
                force,
                self.time_step,
                self.structure,
                feedback_lag=self._stated.feedback_lag,
                force_channel=self._stated.channel,
                known=self._stated.known,
                seed=self._stated.seed,
            )
        except InputError:
            if at_end:
                raise
            return None
