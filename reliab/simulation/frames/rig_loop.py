"""A partitioned frame before a transfer system that is known over frequency, under one ground motion.

With Z the specimen's impedance, D the dynamic stiffness of the undivided frame and σ the transfer system ::

    x = (D + Z(σ − 1)γγᵀ)⁻¹ M ι (−a_g),   x_m = σ γᵀx

The frame alone is stable, so that the test is stable where 1 + Z(σ − 1)γᵀD⁻¹γ does not turn around zero
while s runs up the imaginary axis (criterion of Nyquist).
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array, Spectrum
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.spectral import respond
from reliab.simulation.transfer_systems import TransferSystem
from reliab.structures import Partition

_FREQUENCIES = 6000
_AROUND_A_MODE = 400
_LOWEST, _HIGHEST = 1e-3, 1e4  # of the lowest and the highest natural frequency
_WIDEST = 30.0  # bandwidths of a mode


@dataclass(frozen=True, kw_only=True, eq=False)
class RigResponse:
    """Histories of a test with a known transfer system, inside the window."""

    command: Array  # command, measured: γᵀx and σγᵀx [m], shape (n,)
    measured: Array
    # response, ideal: The response whose error counts, and that of the undivided frame [m], shape (n,)
    response: Array
    ideal: Array
    step: float  # Step [s]


def rig_response(
    excitation: Excitation, partition: Partition, transfer_system: TransferSystem, output: Array | None = None
) -> RigResponse:
    """Solve a test with a transfer system exactly, in the frequency domain."""
    interface = partition.direction

    def command(s: Spectrum) -> Spectrum:
        return over_frequency(partition, s, transfer_system.transfer(s, partition.specimen), interface)

    def measured(s: Spectrum) -> Spectrum:
        return over_frequency(partition, s, transfer_system.transfer(s, partition.specimen))

    def counted(s: Spectrum) -> Spectrum:
        return over_frequency(partition, s, transfer_system.transfer(s, partition.specimen), output)

    def ideal(s: Spectrum) -> Spectrum:
        return over_frequency(partition, s, np.ones_like(s), output)

    sent, step = respond(excitation, command)
    moved = respond(excitation, measured)[0]
    return RigResponse(
        command=sent,
        measured=moved,
        response=moved if output is None else respond(excitation, counted)[0],
        ideal=respond(excitation, ideal)[0],
        step=step,
    )


def over_frequency(
    partition: Partition, s: Spectrum, actuator: Spectrum, output: Array | None = None
) -> Spectrum:
    """Response of a test over −a_g [s²] at s [rad/s], by solving its equations at every s.

    `actuator`: σ at s; `output`: weights of the degrees of freedom, shape (degrees of freedom,), by default
    those of the measured interface displacement, σγ.
    """
    gamma = partition.direction
    extra = (partition.impedance(s)[..., 0, 0] * (actuator - 1.0))[:, np.newaxis, np.newaxis]
    load = (partition.mass @ partition.influence).astype(complex)
    dynamic = partition.frame.dynamic_stiffness(s) + extra * np.outer(gamma, gamma)
    moved = np.linalg.solve(dynamic, load[:, np.newaxis])[..., 0]
    return np.asarray(actuator * (moved @ gamma) if output is None else moved @ output)


def stable_with(partition: Partition, transfer_system: TransferSystem) -> bool:
    """Whether a test with a transfer system is stable.

    >>> from reliab.shipped import shipped
    >>> from reliab.simulation.frames.frame_file import read_frame
    >>> from reliab.simulation.transfer_systems import gain_and_delay
    >>> partition = read_frame(shipped("datasets", "frames/benchmark_case_1.toml")).partition
    >>> [stable_with(partition, gain_and_delay(delay=delay)) for delay in (0.0146, 0.0147)]
    [True, False]
    """
    s = (2j * np.pi * _frequencies(partition)).astype(np.complex128)
    strayed = partition.impedance(s)[..., 0, 0] * (transfer_system.transfer(s, partition.specimen) - 1.0)
    interface = np.broadcast_to(
        partition.direction.astype(complex)[:, np.newaxis], (s.size, partition.frame.size, 1)
    )
    flexibility = (
        np.linalg.solve(partition.frame.dynamic_stiffness(s), interface)[..., 0] @ partition.direction
    )
    turned = np.unwrap(np.angle(1.0 + strayed * flexibility))
    return bool(abs(turned[-1] - turned[0]) < np.pi)


def _frequencies(partition: Partition) -> Array:
    """Frequencies [Hz] up the axis, close to each other where a mode turns the phase."""
    modes = partition.frame.modes.frequency
    span = np.geomspace(_LOWEST * modes[0], _HIGHEST * modes[-1], _FREQUENCIES)
    reach = np.linspace(-_WIDEST, _WIDEST, _AROUND_A_MODE)
    ratios = np.maximum(partition.frame.damping_ratios, 1e-6)
    near = modes[:, np.newaxis] * (1.0 + ratios[:, np.newaxis] * np.sinh(reach / 6.0) * 0.5)
    return np.unique(np.concatenate([span, near[near > 0.0].ravel()]))
