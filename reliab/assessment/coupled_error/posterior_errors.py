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
    nominal_error: CoupledError,
    command: Array,
    measured_displacement: Array,
    ground: Array,
    *,
    stated: Mapping[str, StatedValue],
    equipment: Equipment,
    tolerances: Mapping[str, float],
    left_by_faults: Mapping[str, float],
) -> tuple[CoupledError, InferredError] | None:
    """Infer the errors of all interface displacements; None where a test does not begin at rest.

    `nominal_error`: the error with all as stated but for the sensors' noise; `command`,
    `measured_displacement` [m], shape (p, n), at the sensors; `ground`: acceleration [m/s²]; the others as of
    `infer_error`.
    """
    if any(start.standing or not start.at_rest for start in nominal_error.starts):
        return None
    offsets = np.array([start.offset for start in nominal_error.starts])
    channels = ChannelSpectra.from_channels(
        command,
        measured_displacement - offsets[:, np.newaxis],
        nominal_error.time_step,
        nominal_error.structure,
        ground=ground,
        interface_matrix=nominal_error.histories.carry,
    )
    circumstances = Circumstances(
        partition=nominal_error.structure,
        channels=replace(
            channels,
            offset_size=np.array([start.offset_deviation for start in nominal_error.starts]),
            initial_size=0.0,
        ),
        stated=stated,
        equipment=equipment,
        tolerances=tolerances,
        feedback_lag=stated.get("feedback_lag", StatedValue(0.0)).value / MILLI,
        left_by_faults=left_by_faults,
    )
    inferred_error = infer_errors(circumstances, nominal_error.every, seed=0)
    full = channels.band.full_history
    references, errors = (
        full(inferred_error.errors.exact_spectrum),
        full(inferred_error.errors.error_spectrum),
    )
    raw = nominal_error.histories.carry_to_interface(measured_displacement - offsets[:, np.newaxis])
    displacements = tuple(
        _take_from_posterior(inferred_error, place, degree, references[place], errors[place], raw[place])
        for place, degree in enumerate(nominal_error.displacements)
    )
    return replace(nominal_error, displacements=displacements, exact=inferred_error.exact), inferred_error


def _take_from_posterior(
    inferred_error: InferredError, place: int, degree: DegreeError, reference: Array, error: Array, raw: Array
) -> DegreeError:
    """Take the error of a displacement from the posterior; what its noise leaves open stays."""
    displacement_errors = inferred_error.errors.displacements[place]
    return replace(
        degree,
        error=raw - reference,
        smooth_error=error,
        reference=reference,
        rms=displacement_errors.estimate(Metric.RMS),
        mte=displacement_errors.estimate(Metric.MTE),
        draws=inferred_error.spread(place, error),
    )
