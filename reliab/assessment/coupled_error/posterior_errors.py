"""Errors of a test with several actuators, from the posterior of everything that is uncertain about it."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.coupled_error.coupled_error import CoupledError, DegreeError
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.uncertain_quantity import Circumstances
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.core.arrays import Array
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, Metric


def infer_coupled(
    as_stated: CoupledError,
    command: Array,
    measured: Array,
    ground: Array,
    *,
    stated: Mapping[str, StatedValue],
    equipment: Equipment,
    tolerances: Mapping[str, float],
    left_by_faults: Mapping[str, float],
) -> tuple[CoupledError, InferredError] | None:
    """Infer the errors of all interface displacements; None where the channels determine no posterior.

    `as_stated`: the error with all as stated but for the sensors' noise; `command`, `measured` [m], shape
    (p, n), at the sensors; `ground`: acceleration [m/s²]; the others as of `infer_error`.
    """
    if any(start.standing or not start.at_rest for start in as_stated.starts):
        return None
    offsets = np.array([start.offset for start in as_stated.starts])
    channels = ChannelSpectra.of_channels(
        command,
        measured - offsets[:, np.newaxis],
        as_stated.time_step,
        as_stated.structure,
        ground=ground,
        to_interface=as_stated.histories.carry,
    )
    circumstances = Circumstances(
        partition=as_stated.structure,
        channels=replace(
            channels,
            offset_size=np.array([start.offset_deviation for start in as_stated.starts]),
            initial_size=0.0,
        ),
        stated=stated,
        equipment=equipment,
        tolerances=tolerances,
        feedback_lag=stated.get("feedback_lag", StatedValue(0.0)).value / MILLI,
        left_by_faults=left_by_faults,
    )
    inferred = infer_errors(circumstances, as_stated.every, seed=0)
    full = channels.band.full_history
    references, errors = full(inferred.errors.exact_spectrum), full(inferred.errors.error_spectrum)
    raw = as_stated.histories.carry_to_interface(measured - offsets[:, np.newaxis])
    displacements = tuple(
        _judged_by(inferred, place, degree, references[place], errors[place], raw[place])
        for place, degree in enumerate(as_stated.displacements)
    )
    return replace(as_stated, displacements=displacements, exact=inferred.exact), inferred


def _judged_by(
    inferred: InferredError, place: int, degree: DegreeError, reference: Array, error: Array, raw: Array
) -> DegreeError:
    """Take the error of a displacement from the posterior; what its noise leaves open stays."""
    of_test = inferred.errors.displacements[place]
    return replace(
        degree,
        error=raw - reference,
        smooth_error=error,
        reference=reference,
        rms=of_test.estimate(Metric.RMS),
        mte=of_test.estimate(Metric.MTE),
        draws=inferred.spread(place, error),
    )
