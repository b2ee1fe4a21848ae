"""Where the error comes from: amplitude, delay, neither, and a force that was fed back late.

The measured displacement is written as x_m = k x_c − τ x_c' + rest, with k and τ of least squares over the
test. The error is linear in x_c − x_m, so that each part is rebuilt by itself ::

    amplitude (1 − k) x_c,   delay τ x_c',   neither: the rest,   fed-back force x_m(t) − x_m(t − lag)

and the parts add up to the error. The share of a part is its projection on the whole, ⟨part, whole⟩/⟨whole,
whole⟩; shares sum to one, and one that works against the others is negative. The error that would remain
without a part holds to first order only, because a better actuator also changes the command.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inference.rebuilt import error_of_command
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.core.arrays import Array
from reliab.core.plain_values import finite
from reliab.structures.partition import Partition

AMPLITUDE = "amplitude"
DELAY = "delay"
NEITHER = "neither"
FED_BACK_FORCE = "fed_back_force"

_REMAINDERS = (NEITHER, "_rest")
_ROUNDING = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorPart:
    """One part of the error."""

    history: Array  # Its contribution to x_m − x_I [m], shape (n,)
    rms: float  # RMS^R of the part alone [-]
    share: float  # Projection on the whole error [-]; the shares of all parts sum to one
    # remaining_rms, remaining_mte: RMS^R and MTE^R [-] that would remain without it, to first order
    remaining_rms: float
    remaining_mte: float

    def to_dict(self) -> dict[str, float | None]:
        """Put it into plain values, without its history."""
        return {name: finite(value) for name, value in vars(self).items() if name != "history"}

    def subtract_noise(self, noise_square: float) -> "ErrorPart":
        """Take off a mean square [-] that noise adds to the error that remains; its peak in proportion."""
        remaining = float(np.sqrt(max(self.remaining_rms**2 - noise_square, 0.0)))
        share = remaining / self.remaining_rms if self.remaining_rms > 0.0 else 1.0
        return replace(self, remaining_rms=remaining, remaining_mte=share * self.remaining_mte)


@dataclass(frozen=True, kw_only=True, eq=False)
class Parts:
    """The error divided into parts."""

    # gain, delay: k [-] and τ [s] of least squares, negative where the actuator leads; of several actuators
    # those of each for the commands of all, shape (p, p)
    gain: float | Array
    delay: float | Array
    # "amplitude", "delay", "neither" or, of several actuators, "actuator_1_gain" and so on;
    # "fed_back_force" where a lag of it is known
    by_name: dict[str, ErrorPart]
    rms: float  # RMS^R of all parts together [-]

    @property
    def first(self) -> str | None:
        """The part to improve first: the one whose removal leaves the smallest error.

        None where there are no parts, or where they cancel each other so that without any one of them the
        error would be larger.
        """
        first = min(self.by_name, key=lambda name: self.by_name[name].remaining_rms, default=None)
        return first if first is not None and self.by_name[first].remaining_rms < self.rms else None

    def subtract_noise(self, rms: float) -> "Parts":
        """Take off what noise of the sensors adds to the errors that would remain, down to an RMS^R [-].

        The noise is in what is neither gain nor delay, and no more than that; of several actuators in
        proportion to its mean square.
        """
        noisy = {name: part.rms**2 for name, part in self.by_name.items() if name.endswith(_REMAINDERS)}
        noise_limit = sum(noisy.values())
        noise_square = min(max(self.rms**2 - rms**2, 0.0), noise_limit)
        return replace(
            self,
            rms=float(np.sqrt(self.rms**2 - noise_square)),
            by_name={
                name: part.subtract_noise(noise_square * (1.0 - noisy.get(name, 0.0) / (noise_limit or 1.0)))
                for name, part in self.by_name.items()
            },
        )

    def rms_over_time(self, time_step: float, length: float) -> dict[str, Array]:
        """RMS of each part in consecutive stretches of the test.

        `time_step`, `length` [s]; returns [m].
        """
        width = max(round(length / time_step), 1)
        return {name: _rms_of_stretches(part.history, width) for name, part in self.by_name.items()}


def divide(histories: Histories, structure: Partition, band: AnalysisBand) -> Parts:
    """Divide a rebuilt error into its parts."""
    measured_displacement = histories.measured
    gain, delay, differences = follow(histories.command, measured_displacement, histories.time_step)
    interface_differences = {name: row[np.newaxis] for name, row in differences.items()}
    interface_pieces = pieces_of(histories, structure, band, interface_differences, remainder=NEITHER)
    pieces = {name: piece[0] for name, piece in interface_pieces.items()}
    error = np.sum(list(pieces.values()), axis=0)
    return parts_of(gain, delay, pieces, float(np.abs(measured_displacement - error).max()))


def pieces_of(
    histories: Histories,
    structure: Partition,
    band: AnalysisBand,
    differences: Mapping[str, Array],
    *,
    remainder: str,
) -> dict[str, Array]:
    """Pieces of x_m − x_I that pieces of x_c − x_m [m] cause, shape (p, n), and one of a late force.

    The answer to x_c − x_m before the first sample belongs to the `remainder`.
    """
    standing = np.reshape(histories.standing, (-1, 1))
    pieces = {}
    for name, difference in differences.items():
        stood = standing if name == remainder else np.zeros_like(standing)
        answer = error_of_command(structure, band, difference - stood) + structure.static_transfer @ stood
        pieces[name] = answer - difference
    if np.abs(histories.late).max() > _ROUNDING * np.abs(histories.measured).max():
        pieces[FED_BACK_FORCE] = error_of_command(structure, band, histories.late)
    return pieces


def follow(
    command: Array, measured_displacement: Array, step: float
) -> tuple[float, float, dict[str, Array]]:
    """Fit gain [-] and delay [s] to command and measured displacement [m], and divide their difference."""
    velocity = np.gradient(command, step)
    basis = np.stack([command, -velocity, np.ones(command.size)])  # an offset is neither gain nor delay
    scale = np.abs(basis).max(axis=1)
    rows = basis / scale[:, np.newaxis]
    gain, delay, _ = np.linalg.lstsq(rows @ rows.T, rows @ measured_displacement, rcond=None)[0] / scale
    differences = {
        AMPLITUDE: (1.0 - gain) * command,
        DELAY: delay * velocity,
        NEITHER: gain * command - delay * velocity - measured_displacement,
    }
    return float(gain), float(delay), differences


def parts_of(gain: float | Array, delay: float | Array, pieces: dict[str, Array], ideal_peak: float) -> Parts:
    """Sizes of pieces [m] that add up to an error; `delay` [s], `ideal_peak` of the exact response [m]."""
    error = np.sum(list(pieces.values()), axis=0)
    return Parts(
        gain=gain,
        delay=delay,
        by_name={name: part_of(piece, error, ideal_peak) for name, piece in pieces.items()},
        rms=float(np.sqrt(mean_square(error))) / ideal_peak,
    )


def part_of_tracking(
    histories: Histories, structure: Partition, band: AnalysisBand, followed_command: Array
) -> ErrorPart:
    """Part of a rebuilt error that a description of the actuator accounts for.

    `followed_command` [m].
    Returns the error that x_c minus this displacement causes, and what would remain without it.
    """
    followed_difference = (histories.command - followed_command)[np.newaxis]
    differences = {
        DELAY: followed_difference,
        NEITHER: histories.difference[np.newaxis] - followed_difference,
    }
    pieces = pieces_of(histories, structure, band, differences, remainder=NEITHER)
    error = np.sum(list(pieces.values()), axis=0)[0]
    return part_of(pieces[DELAY][0], error, float(np.abs(histories.measured - error).max()))


def part_of(piece: Array, error: Array, ideal_peak: float) -> ErrorPart:
    """Size of a piece [m] of an error [m], and what would remain without it."""
    total = float(error @ error)
    remaining = error - piece
    return ErrorPart(
        history=piece,
        rms=float(np.sqrt(mean_square(piece))) / ideal_peak,
        share=float(piece @ error) / total if total > 0.0 else 0.0,
        remaining_rms=float(np.sqrt(mean_square(remaining))) / ideal_peak,
        remaining_mte=float(np.abs(remaining).max()) / ideal_peak,
    )


def _rms_of_stretches(values: Array, width: int) -> Array:
    starts = np.arange(0, values.size, width)
    sizes = np.diff(np.append(starts, values.size))
    return np.asarray(np.sqrt(np.add.reduceat(values**2, starts) / sizes))
