"""A test while it runs whose specimen is known by its force only: learned anew whenever enough was added.

Whenever the test has grown by a fourth, it is learned and judged as `rebuild` does it after the test. While
held-out parts of the force are predicted badly the specimen counts as not learned, and no error is stated.
The test is held whole.
"""

from typing import ClassVar

import numpy as np

from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, PriorKnowledge
from reliab.assessment.measured_specimen.force_channel import NOTHING_STATED, ForceChannel
from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.assessment.rebuilt_error.noise import is_lost_in_noise
from reliab.assessment.rebuilt_error.running_test import Now, RunningSums, RunningTest, require_readings
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

_ENOUGH = 0.1  # of the force on held-out parts, above which a running test has not shown enough


class MeasuredMonitor(RunningTest):
    """Follow the error of a test whose specimen is learned from its force; `time_step`, `feedback_lag` [s].

    `structure` [kg, N·s/m, N/m]: the computer's part and the specimen's initial stiffness; `channel`: what
    the force holds beside that of the specimen; `known`: how far what is stated may be off.
    """

    growth: ClassVar[float] = 0.25

    def __init__(
        self,
        structure: Partition,
        time_step: float,
        *,
        feedback_lag: float = 0.0,
        channel: ForceChannel = NOTHING_STATED,
        known: PriorKnowledge = EXACTLY_KNOWN,
    ) -> None:
        super().__init__(structure, time_step, known.skew_deviation(time_step))
        self._lag, self._channel, self._prior = feedback_lag, channel, known
        self._parts: list[Array] = []
        self._samples = 0
        self._learned: RebuiltError | None = None  # last, if anything was
        self._known: RebuiltError | None = None  # the same, if it counts as learned

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._samples

    @property
    def specimen(self) -> MeasuredSpecimen | None:
        """What was learned last; None before anything could be."""
        return None if self._learned is None else self._learned.specimen

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
        self._learned, self._known = self._learn(at_end=at_end), None
        if self.specimen is not None:
            is_known = self.specimen.learned if at_end else self.specimen.held_out <= _ENOUGH
            self._known = self._learned if is_known else None
        error = self._known
        if error is None:
            self._conclude(None, {})
            return None
        command, measured_displacement, _ = self._parts[0]
        peak = float(np.abs(error.displacements[0].reference).max())
        is_lost = is_lost_in_noise(command - measured_displacement, peak)
        self._conclude(error, {"": error}, lost_in_noise=is_lost)
        return error

    def _learn(self, *, at_end: bool) -> RebuiltError | None:
        """Learn the specimen from all samples so far; None while they are too few to learn anything."""
        self._parts = [np.concatenate(self._parts, axis=1)]
        command, measured_displacement, force = self._parts[0]
        try:
            return rebuild(
                command,
                measured_displacement,
                self.time_step,
                self.structure,
                feedback_lag=self._lag,
                force=force,
                force_channel=self._channel,
                known=self._prior,
            )
        except InputError:
            if at_end:
                raise
            return None
