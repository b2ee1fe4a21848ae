"""The verdict on a test of a partitioned frame: its own error, and its stability margin."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from reliab.errors import InputError
from reliab.indices.frequency_evaluation import FrequencyEvaluation, frequency_evaluation
from reliab.loop.partition.critical_delay import critical_delay
from reliab.loop.partition.frame_file import FrameUnderTest
from reliab.loop.partition.partition import Partition
from reliab.rebuilt_error import RebuiltError, WholeStructure, rebuild
from reliab.validation.assessment.recording import Recording
from reliab.validation.assessment.verdict import Word, word_of_probability
from reliab.vocabulary import Metric

_MILLISECONDS = 1e3


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameAssessment:
    """What a test of a partitioned frame reveals.

    Attributes
    ----------
    frame : FrameUnderTest
        The frame.
    tracking : FrequencyEvaluation
        A, φ, f_eq and d.
    error : RebuiltError
        The error of the measured interface displacement, from the test alone.
    metric : Metric
        Which error is judged.
    threshold : float
        Largest error of a reliable test [-].
    critical_delay : float
        Exact critical delay at the measured amplitude [s]; infinite where no delay is critical.
    """

    frame: FrameUnderTest
    tracking: FrequencyEvaluation
    error: RebuiltError
    metric: Metric
    threshold: float
    critical_delay: float

    @property
    def probability(self) -> float:
        """Probability that the error is below the threshold."""
        return self.error.probability(self.threshold, self.metric)

    @property
    def word(self) -> Word:
        """Reliable, undecided or not reliable."""
        return word_of_probability(self.probability)

    @property
    def stability_margin(self) -> float:
        """Share of the critical delay that is free, 1 − d/τ_c [-]; 1 where the actuator leads."""
        if not (math.isfinite(self.critical_delay) and self.critical_delay > 0.0):
            return 1.0 if self.critical_delay else -math.inf
        return 1.0 - max(self.tracking.equivalent_delay, 0.0) / self.critical_delay

    def to_dict(self) -> dict[str, Any]:
        """Plain content, with the keys of every other assessment where they mean the same."""
        tracking, error = self.tracking, self.error
        finite = math.isfinite(self.critical_delay)
        return {
            "structure": self.frame.name,
            "error_of": "the measured interface displacement",
            "A": tracking.amplitude,
            "phi": tracking.phase,
            "f_eq_hz": tracking.equivalent_frequency,
            "d_ms": _MILLISECONDS * tracking.equivalent_delay,
            "critical_delay_ms": _MILLISECONDS * self.critical_delay if finite else None,
            "stability_margin": self.stability_margin,
            "modes": [
                {"f_hz": float(f), "xi": float(xi), "alpha": float(alpha)}
                for f, xi, alpha in zip(
                    self.frame.partition.frame.modes.frequency,
                    self.frame.partition.frame.damping_ratios,
                    self.frame.partition.stiffness_shares,
                    strict=True,
                )
            ],
            "error": {
                **{
                    str(metric): {"value": item.value, "low": item.low, "high": item.high}
                    for metric, item in ((Metric.RMS, error.rms), (Metric.MTE, error.mte))
                },
                "probability": self.probability,
            },
            "metric": str(self.metric),
            "threshold": self.threshold,
            "verdict": str(self.word),
            "reliable": self.word is Word.RELIABLE,
        }


def whole_structure(partition: Partition) -> WholeStructure:
    """Matrices of a partition as the rebuilt error takes them."""
    frame, specimen = partition.frame, partition.specimen
    return WholeStructure(
        mass=np.array(frame.mass),
        damping=np.array(frame.damping),
        stiffness=np.array(frame.stiffness),
        interface=np.array(partition.interface),
        specimen_stiffness=specimen.stiffness,
        specimen_damping=specimen.damping,
        specimen_mass=specimen.mass,
    )


def assess_frame(
    recording: Recording,
    frame: FrameUnderTest,
    *,
    threshold: float = 0.05,
    metric: Metric = Metric.RMS,
    feedback_lag: float = 0.0,
) -> FrameAssessment:
    """Judge a test of a partitioned frame by the error that its displacements reveal.

    Parameters
    ----------
    recording : Recording
        Command and measured displacement at the interface.
    frame : FrameUnderTest
        The frame; its specimen must be linear.
    threshold : float, optional
        Largest error of a reliable test [-].
    metric : Metric, optional
        Which error.
    feedback_lag : float, optional
        Time by which the force was fed back late [s].

    Returns
    -------
    FrameAssessment
        A, d, the stability margin, the error with its interval, and the verdict.

    Raises
    ------
    InputError
        If the specimen is nonlinear, the error asked about is another than that of the interface, or the
        recording cannot be judged.
    """
    if frame.partition.effects:
        raise InputError(
            "The error of a frame is rebuilt for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out if the specimen is nearly linear",
        )
    if frame.output is not None:
        raise InputError(
            "A test reveals the error of its measured interface displacement",
            value=frame.error_of,
            remedy='Leave [error] out, or give of = "interface"',
        )
    tracking = frequency_evaluation(recording.command, recording.measured, recording.time_step)
    error = rebuild(
        recording.command,
        recording.measured,
        recording.time_step,
        whole_structure(frame.partition),
        feedback_lag=feedback_lag,
    )
    return FrameAssessment(
        frame=frame,
        tracking=tracking,
        error=error,
        metric=metric,
        threshold=threshold,
        critical_delay=critical_delay(frame.partition, tracking.amplitude)[0],
    )
