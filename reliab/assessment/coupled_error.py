"""The rebuilt error of a test with several actuators: by interface displacement, with what widens it.

Its parts are those of actuators and of causes. Each measured displacement is written by penalised least
squares as m_i = Σ_j (k_ij c_j − τ_ij c_j') + constant + rest. The error is linear in c − m, so that each part
is rebuilt by itself ::

    gain (1 − k_ii) c_i,   delay τ_ii c_i',   cross-coupling −Σ_{j≠i}(k_ij c_j − τ_ij c_j'),   the rest

Together with a force that was fed back late they add up to the error.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inferred_error import InferredError
from reliab.assessment.parts import Parts, parts_of, pieces_of
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.noise import LOST_IN_NOISE
from reliab.assessment.rebuilt_error.spread import DisplacementError, Estimate
from reliab.core.arrays import Array
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

CAUSES = ("gain", "delay", "cross_coupling", "rest")

_OWN_REMEDY, _OTHERS_REMEDY = (
    1e-3,
    3e-3,
)  # of a command: errors that large are as dear as what they leave unexplained


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledParts:
    """The error divided into parts."""

    tracking: tuple[Array, Array]  # Of `CoupledError`
    histories: dict[str, Array]  # Contribution of each part to x_m − x_I [m], shape (p, n)
    reference: Array  # x_I [m], shape (p, n)

    def parts_of_degree(self, place: int) -> Parts:
        """Parts of the error of one interface displacement, such as "actuator_1_gain"."""
        pieces = {name: history[place] for name, history in self.histories.items()}
        peak = max(float(np.abs(self.reference[place]).max()), np.finfo(float).tiny)
        return parts_of(*self.tracking, pieces, peak)


def divide(histories: Histories, structure: Partition, band: AnalysisBand) -> tuple[dict[str, Array], Array]:
    """Divide a rebuilt error into its parts [m]; returns also x_I [m], each shape (p, n)."""
    velocity = np.gradient(histories.command, histories.time_step, axis=1)
    gain, delay = fit_followers(histories.command, velocity, histories.measured)
    differences = _differences(histories, velocity, gain, delay)
    pieces = pieces_of(histories, structure, band, differences, remainder="actuator_1_rest")
    displacement = histories.carry_to_interface(histories.measured)
    return pieces, displacement - np.sum(list(pieces.values()), axis=0)


def fit_followers(command: Array, velocity: Array, measured_displacement: Array) -> tuple[Array, Array]:
    """Gains and delays of least squares, those of actuator i in row i.

    Commands that move alike do not tell whose error it is: the smallest errors are taken that explain the
    test, and an actuator's own before those that others cause.
    """
    rows = np.vstack([command, -velocity])
    rows = rows - rows.mean(axis=1, keepdims=True)
    scale = np.maximum(np.sqrt(np.mean(rows**2, axis=1)), np.finfo(float).tiny)
    scaled_rows = rows / scale[:, np.newaxis]
    normal = scaled_rows @ scaled_rows.T / rows.shape[1]
    size = command.shape[0]
    coefficients = np.empty((size, 2 * size))
    for place in range(size):
        diagonal = np.arange(2 * size) % size == place
        penalty = np.where(diagonal, _OWN_REMEDY, _OTHERS_REMEDY) ** 2
        residual = scaled_rows @ (measured_displacement[place] - command[place]) / rows.shape[1]
        coefficients[place] = np.linalg.solve(normal + np.diag(penalty), residual) / scale
    return np.eye(size) + coefficients[:, :size], coefficients[:, size:]


def _differences(histories: Histories, velocity: Array, gain: Array, delay: Array) -> dict[str, Array]:
    """Parts of τ at the interface [m], by name."""
    command, difference = histories.command, histories.command - histories.measured
    parts: dict[str, Array] = {}
    for place in range(command.shape[0]):
        is_other = np.arange(command.shape[0]) != place
        rows = {
            "gain": (1.0 - gain[place, place]) * command[place],
            "delay": delay[place, place] * velocity[place],
            "cross_coupling": delay[place, is_other] @ velocity[is_other]
            - gain[place, is_other] @ command[is_other],
        }
        rows["rest"] = difference[place] - np.sum(list(rows.values()), axis=0)
        parts |= {
            f"actuator_{place + 1}_{cause}": histories.carry_sensor(place, rows[cause]) for cause in CAUSES
        }
    return parts


@dataclass(frozen=True, kw_only=True, eq=False)
class DegreeError(DisplacementError):
    """Error of one interface displacement."""

    name: str
    noise: float  # Standard deviation of x_c − x_m that noise leaves open, over the largest ideal motion [-]

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return bool(self.noise < LOST_IN_NOISE)

    @property
    def refusal_reason(self) -> str:
        """Say why the displacement is not judged."""
        if np.isinf(self.noise):
            return f"{self.name} does not move, and its error is not judged."
        return (
            f"{self.name} moves too little for the noise of its sensors, which leaves "
            f"{percent(self.noise)} of its largest displacement open: its error is not judged."
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledError:
    """Error of a test with several actuators."""

    time_step: float  # s
    displacements: tuple[DegreeError, ...]  # In the order of the interface displacements
    structure: Partition  # The structure with which the parts are found
    starts: tuple[Start, ...]  # How each channel begins
    histories: Histories
    # k [-] and τ [s] of least squares as the sensors read, each shape (p, p)
    tracking: tuple[Array, Array]
    inferred: InferredError  # Draws of everything that is uncertain, and what they say of the errors

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (p, n)."""
        return self.histories.carry_to_interface(self.histories.command)

    @property
    def judged(self) -> tuple[DegreeError, ...]:
        """Displacements that move enough for their noise."""
        return tuple(degree for degree in self.displacements if degree.judged)

    def governing(self, metric: Metric) -> DegreeError | None:
        """Return the displacement with the largest error; None where all are lost in noise."""
        return max(self.judged, key=lambda degree: degree.estimate(metric).value, default=None)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the errors of all judged displacements are below a threshold."""
        governing = self.governing(metric)
        if governing is None:
            return 0.5
        largest = replace(governing.draws, rms=self.errors(Metric.RMS), mte=self.errors(Metric.MTE))
        return largest.probability_below(threshold, metric)

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R of the governing displacement with its interval; NaN where all are lost in noise."""
        governing = self.governing(metric)
        if governing is None:
            return Estimate(value=np.nan, low=np.nan, high=np.nan)
        return governing.estimate(metric)

    def errors(self, metric: Metric) -> Array:
        """RMS^R or MTE^R of the draws, the largest of the judged displacements [-], shape (draws,)."""
        return np.asarray(np.max([degree.draws.errors(metric) for degree in self.judged], axis=0))

    @cached_property
    def division(self) -> CoupledParts:
        """The errors of all displacements divided by actuator and by cause."""
        histories, reference = divide(self.histories, self.structure, self.inferred.band)
        return CoupledParts(tracking=self.tracking, histories=histories, reference=reference)
