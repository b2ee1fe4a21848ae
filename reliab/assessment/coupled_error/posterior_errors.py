"""Errors of a test with several actuators, from the posterior of everything that is uncertain about it."""

from dataclasses import replace

import numpy as np

from reliab.assessment.coupled_error.coupled_error import CoupledError
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inferred_error import InferredError
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.recordings.coupled_recording import CoupledRecording


def channels_of_several(nominal_error: CoupledError, recording: CoupledRecording) -> ChannelSpectra:
    """Transform the channels of a test; `nominal_error`: with all as stated but the sensors' noise."""
    structure = nominal_error.structure
    carry = nominal_error.histories.carry_to_interface(np.eye(structure.degrees))
    stood = np.array([start.standing for start in nominal_error.starts])
    initial_displacement = np.linalg.solve(carry, structure.static_transfer @ carry @ stood)
    remaining = stood - initial_displacement  # which the command did not answer before the record
    channels = ChannelSpectra.from_channels(
        recording.command + initial_displacement[:, np.newaxis],
        _read(nominal_error, recording) - remaining[:, np.newaxis],
        nominal_error.time_step,
        structure,
        ground=recording.ground,
        interface_matrix=carry,
    )
    at_rest = all(start.at_rest for start in nominal_error.starts)
    return replace(
        channels,
        offset_size=np.array([start.offset_deviation for start in nominal_error.starts]),
        standing=carry @ remaining,
        initial_size=0.0 if at_rest else channels.initial_size,
    )


def take_from_posterior(
    nominal_error: CoupledError, inferred_error: InferredError, recording: CoupledRecording
) -> CoupledError:
    """Take the errors of all displacements from the posterior; what noise leaves open of each stays."""
    full = inferred_error.posterior.circumstances.channels.band.full_history
    references, errors = (
        full(inferred_error.errors.exact_spectrum),
        full(inferred_error.errors.error_spectrum),
    )
    raw = nominal_error.histories.carry_to_interface(_read(nominal_error, recording))
    displacements = []
    for place, degree in enumerate(nominal_error.displacements):
        displacement_errors = inferred_error.errors.displacements[place]
        displacements.append(
            replace(
                degree,
                error=raw[place] - references[place],
                smooth_error=errors[place],
                reference=references[place],
                rms=displacement_errors.estimate(Metric.RMS),
                mte=displacement_errors.estimate(Metric.MTE),
                draws=inferred_error.spread(place, errors[place]),
            )
        )
    return replace(nominal_error, displacements=tuple(displacements))


def _read(nominal_error: CoupledError, recording: CoupledRecording) -> Array:
    """Measured displacements without the sensors' offsets [m], shape (p, n)."""
    return np.asarray(recording.measured - np.array([[start.offset] for start in nominal_error.starts]))
