"""Where the error comes from: amplitude, delay, neither, and a force that was fed back late.

Each of p measured displacements is written by least squares over the test as m_i = Σ_j (k_ij c_j − τ_ij c_j')
+ constant + rest. The error is linear in c − m, so that each part is rebuilt by itself ::

    amplitude (1 − k_ii) c_i,   delay τ_ii c_i',   cross-coupling −Σ_{j≠i}(k_ij c_j − τ_ij c_j'),   the rest
    fed-back force m(t) − m(t − lag)

and the parts add up to the error. The share of a part is its projection on the whole, ⟨part, whole⟩/⟨whole,
whole⟩; shares sum to one, and one that works against the others is negative. The error that would remain
without a part holds to first order only, because a better actuator also changes the command.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inference.rebuilt import error_of_command
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.core.arrays import Array
from reliab.core.plain_values import finite
from reliab.structures.partition import Partition

AMPLITUDE: Final = "amplitude"
DELAY: Final = "delay"
NEITHER: Final = "neither"
FED_BACK_FORCE: Final = "fed_back_force"

PART_NAMES: Final[Mapping[str, str]] = {
    AMPLITUDE: "amplitude",
    DELAY: "delay",
    NEITHER: "other tracking errors",
    FED_BACK_FORCE: "lag of the fed-back force",
}
"""Parts of the error in words."""

_CAUSES: Final[Mapping[str, str]] = {
    "gain": "gain of actuator {}",
    "delay": "delay of actuator {}",
    "cross_coupling": "motion of actuator {} that others cause",
    "rest": "other tracking errors of actuator {}",
}
_OF_AN_ONLY_ACTUATOR: Final = {"gain": AMPLITUDE, "delay": DELAY, "rest": NEITHER}
_REMAINDERS = (NEITHER, "_rest")
_ROUNDING = 1e-12
# Of a command: errors that large are as dear as what they leave unexplained
_OWN_PENALTY, _OTHERS_PENALTY = 1e-3, 3e-3


def part_in_words(name: str) -> str:
    """Name a part of the error, such as "delay" or "actuator_1_delay", in words."""
    for cause, words in _CAUSES.items():
        if name.startswith("actuator_") and name.endswith(f"_{cause}"):
            number = name.removeprefix("actuator_").removesuffix(f"_{cause}")
            return words.format(number)
    return PART_NAMES[name]


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


@dataclass(frozen=True, kw_only=True, eq=False)
class DividedError:
    """The errors of all interface displacements, divided by actuator and by cause."""

    pieces: Mapping[str, Array]  # Contribution of each part to x_m − x_I [m], shape (p, n)
    peaks: Array  # Largest exact responses [m], shape (p,)

    def parts(self, place: int = 0) -> Parts:
        """Parts of the error of one interface displacement."""
        pieces = {name: piece[place] for name, piece in self.pieces.items()}
        return parts_of(pieces, float(self.peaks[place]))


def divide(histories: Histories, structure: Partition, band: AnalysisBand) -> DividedError:
    """Divide a rebuilt error into its parts."""
    *_, differences = fit_followers(histories.command, histories.measured, histories.time_step)
    at_interface = {
        name: histories.carry[:, place, np.newaxis] * row
        for place, rows in enumerate(differences)
        for name, row in rows.items()
    }
    pieces = _pieces_of(histories, structure, band, at_interface, remainder=[*differences[0]][-1])
    return DividedError(pieces=pieces, peaks=_peaks_of_exact(histories, pieces))


def _pieces_of(
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
    standing = histories.standing[:, np.newaxis]
    pieces = {}
    for name, difference in differences.items():
        stood = standing if name == remainder else np.zeros_like(standing)
        answer = error_of_command(structure, band, difference - stood) + structure.static_transfer @ stood
        pieces[name] = answer - difference
    if np.abs(histories.late).max() > _ROUNDING * np.abs(histories.measured).max():
        pieces[FED_BACK_FORCE] = error_of_command(structure, band, histories.late)
    return pieces


def _peaks_of_exact(histories: Histories, pieces: Mapping[str, Array]) -> Array:
    exact = histories.carry @ histories.measured - np.sum(list(pieces.values()), axis=0)
    return np.asarray(np.maximum(np.abs(exact).max(axis=1), np.finfo(float).tiny))


def fit_followers(
    command: Array, measured_displacement: Array, time_step: float
) -> tuple[Array, Array, tuple[dict[str, Array], ...]]:
    """Fit gains [-] and delays [s], a row for each actuator, and divide each c_i − m_i by cause.

    Delays are negative where an actuator leads.

    `command`, `measured_displacement` [m], shape (n,) or (p, n).
    Commands that move alike do not tell whose error it is: the smallest errors are taken that explain the
    test, and an actuator's own before those that others cause.
    """
    command, measured_displacement = np.atleast_2d(command, measured_displacement)
    velocity = np.gradient(command, time_step, axis=1)
    rows = np.vstack([command, -velocity])
    rows = rows - rows.mean(axis=1, keepdims=True)  # an offset is neither gain nor delay
    scale = np.maximum(np.sqrt(np.mean(rows**2, axis=1)), np.finfo(float).tiny)
    scaled_rows = rows / scale[:, np.newaxis]
    normal = scaled_rows @ scaled_rows.T / rows.shape[1]
    size = command.shape[0]
    coefficients = np.empty((size, 2 * size))
    for place in range(size):
        is_own = np.arange(2 * size) % size == place
        penalty = np.where(is_own, _OWN_PENALTY, _OTHERS_PENALTY) ** 2
        residual = scaled_rows @ (measured_displacement[place] - command[place]) / rows.shape[1]
        coefficients[place] = np.linalg.solve(normal + np.diag(penalty), residual) / scale
    gain, delay = np.eye(size) + coefficients[:, :size], coefficients[:, size:]
    own_gain, own_delay = np.diag(gain)[:, np.newaxis], np.diag(delay)[:, np.newaxis]
    by_cause = {
        "gain": (1.0 - own_gain) * command,
        "delay": own_delay * velocity,
        "cross_coupling": (delay @ velocity - own_delay * velocity) - (gain @ command - own_gain * command),
    }
    by_cause["rest"] = command - measured_displacement - sum(by_cause.values())
    return gain, delay, tuple(_name_causes(by_cause, place) for place in range(size))


def _name_causes(by_cause: Mapping[str, Array], place: int) -> dict[str, Array]:
    """Rows of one actuator by the names of parts, such as "delay", or "actuator_1_delay" of several."""
    if len(by_cause["rest"]) == 1:
        return {name: by_cause[cause][0] for cause, name in _OF_AN_ONLY_ACTUATOR.items()}
    return {f"actuator_{place + 1}_{cause}": rows[place] for cause, rows in by_cause.items()}


def parts_of(pieces: Mapping[str, Array], ideal_peak: float) -> Parts:
    """Sizes of pieces [m] that add up to an error; `ideal_peak` of the exact response [m]."""
    error = np.sum(list(pieces.values()), axis=0)
    return Parts(
        by_name={name: part_of(piece, error, ideal_peak) for name, piece in pieces.items()},
        rms=float(np.sqrt(mean_square(error))) / ideal_peak,
    )


def part_of_tracking(
    histories: Histories, structure: Partition, band: AnalysisBand, followed_command: Array
) -> ErrorPart:
    """Part of a rebuilt error that a description of an only actuator accounts for.

    `followed_command` [m], shape (n,).
    Returns the error that x_c minus this displacement causes, and what would remain without it.
    """
    followed_difference = histories.command - followed_command
    differences = {DELAY: followed_difference, NEITHER: histories.difference - followed_difference}
    pieces = _pieces_of(histories, structure, band, differences, remainder=NEITHER)
    error = np.sum(list(pieces.values()), axis=0)
    return part_of(pieces[DELAY][0], error[0], float(_peaks_of_exact(histories, pieces)[0]))


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
