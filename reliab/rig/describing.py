"""What a rig's table holds of a test, taken from its assessment."""

import math
from collections.abc import Mapping

import numpy as np

from reliab.assessment import Assessment, FrameAssessment
from reliab.boundary import ellipse_of_response
from reliab.recordings import Recording
from reliab.rig.rig_test import RigTest
from reliab.vocabulary import MILLI

_STEEPEST = 0.999  # quantile of the speeds, beyond which there is the noise of the command


def describe_test(
    assessment: Assessment | FrameAssessment, texts: Mapping[str, str], covariates: Mapping[str, float]
) -> RigTest:
    """Take from an assessment what a rig's table holds; `texts` are its names and labels."""
    content = assessment.to_dict()
    errors = content["error"]
    own_a, own_b = _own_ellipse(assessment)
    peak, velocity = _peaks_of(assessment.recording)
    return RigTest(
        **texts,
        f=content.get("f"),
        xi=content.get("xi"),
        alpha=content.get("alpha"),
        structure=str(content.get("structure", "")),
        threshold=content["threshold"],
        verdict=content["verdict"],
        reliable=content["reliable"],
        probability=content["probability"],
        A=content["A"],
        d_ms=content["d_ms"],
        f_eq_hz=content["f_eq_hz"],
        remainder=assessment.tracking.noise_share,
        rms=errors["rms"]["value"],
        rms_low=errors["rms"]["low"],
        rms_high=errors["rms"]["high"],
        mte=errors["mte"]["value"],
        peak_mm=peak,
        velocity_mm_s=velocity,
        own_a=own_a,
        own_b_ms2=own_b,
        duration_s=assessment.recording.duration,
        covariates=covariates,
    )


def _peaks_of(recording: Recording) -> tuple[float, float]:
    """Peak displacement [mm] and speed [mm/s] of the command."""
    command = recording.command - recording.command.mean()
    speed = np.abs(np.gradient(command, recording.time_step))
    return MILLI * float(np.abs(command).max()), MILLI * float(np.quantile(speed, _STEEPEST))


def _own_ellipse(assessment: Assessment | FrameAssessment) -> tuple[float | None, float | None]:
    """How much gain and delay weigh in the response of this very test; unknown for frames."""
    if not isinstance(assessment, Assessment):
        return None, None
    rebuilt = assessment.error.rebuilt
    ellipse = ellipse_of_response(rebuilt.reference, rebuilt.time_step, assessment.structure)
    if not all(math.isfinite(value) and value > 0.0 for value in (ellipse.amplitude, ellipse.delay)):
        return None, None
    return ellipse.amplitude, ellipse.delay
