"""The mode of a structure that suffers most from errors of its actuators, which sets the scale of these."""

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

_LEAST_SHARE, _LEAST_RATIO, _LARGEST_RATIO = 1e-3, 1e-4, 0.5


def place_of_governing_mode(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> int:
    """Place of the mode whose share of the response suffers most.

    `output`: weights of the degrees of freedom in the response whose error counts, shape (n,); by default it
    is the measured interface displacements. `erring`: what actuators that err add to the interface per
    command, shape (p, p); by default all err alike.
    """
    frame = partition.nonsingular_form.frame
    shapes = frame.modes.shapes
    output_rows = partition.nonsingular_form.interface.T if output is None else output[np.newaxis]
    participation = np.abs(output_rows @ shapes).max(axis=0) * np.abs(shapes.T @ frame.mass @ frame.influence)
    # The response of a mode to a given ground acceleration goes with 1/ω², its sensitivity with α/ξ.
    lightly = np.abs(_shares(partition, erring)) / np.maximum(frame.damping_ratios, _LEAST_RATIO)
    return int(np.argmax(lightly * participation / frame.modes.circular_frequency**2))


def governing_mode(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> Structure:
    """Frequency, damping ratio and share of the specimen of the mode that suffers most."""
    frame, place = partition.nonsingular_form.frame, place_of_governing_mode(partition, output, erring)
    share = abs(float(_shares(partition, erring)[place].real))
    return Structure(
        frequency=float(frame.modes.frequency[place]),
        damping_ratio=float(frame.damping_ratios[place]),
        experimental_fraction=float(np.clip(share, 1e-6, 1.0)),
    )


def scale_of_errors(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> Structure:
    """One-mode structure that sets the scale of gains and delays.

    Its frequency is that of the mode and its damping ratio ξ/α with the specimen's share α in the mode, so
    that errors of an actuator matter as much as in the frame.
    """
    frame, place = partition.nonsingular_form.frame, place_of_governing_mode(partition, output, erring)
    share = min(float(np.abs(_shares(partition, erring)[place])), 1.0)
    # Amplitude errors count as far as the specimen's share of the mode; ξ/α is their scale.
    scale = float(frame.damping_ratios[place]) / max(share, _LEAST_SHARE)
    return Structure(
        frequency=float(frame.modes.frequency[place]),
        damping_ratio=float(np.clip(scale, _LEAST_RATIO, _LARGEST_RATIO)),
    )


def _shares(partition: Partition, erring: Array | None) -> Spectrum:
    """Force by which errors of the actuators move each mode, over that of its spring [-], shape (modes,)."""
    if erring is None:
        return partition.impedance_shares
    frequency, _, interface_shapes = partition.modes
    omega = 2.0 * np.pi * frequency
    forces = partition.impedance((1j * omega).astype(np.complex128)) @ erring
    return np.asarray(np.einsum("pi,ipq,qi->i", interface_shapes, forces, interface_shapes) / omega**2)
