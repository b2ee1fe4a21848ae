"""Predictions of a partitioned test's error: by laws, by tracking over frequency, from the test itself."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error import rebuild
from reliab.criterion import growth
from reliab.criterion.laws import Dimensionless, Equation18
from reliab.errors import InputError
from reliab.indices.tracking_over_frequency import tracking_over_frequency
from reliab.motions import Motion
from reliab.shipped import shipped
from reliab.simulation import Excitation
from reliab.simulation.frames import place_of_governing_mode
from reliab.simulation.laboratory import Run
from reliab.simulation.linear_loop import respond
from reliab.structures import Partition, Structure
from reliab.sweep import open_ellipses

from .drawing import RATE

PREDICTIONS: Final = ("law_18", "law_with_share", "resolved", "rebuilt")
"""Columns of the predictions, from the coarsest to the finest."""

_THRESHOLD: Final = 0.05

_HIGHEST: Final = 2.0  # Hz, of the structures from which the law with the share is learned

_SPRING: Final = 0.9  # least part of the specimen's share that its spring has, so that it counts as one
_FORCE_LAG: Final = 1.5 / RATE

_THINNED: Final = 16

_DRAWS: Final = 16  # of the rebuilt error, whose value alone counts here


def mean_law() -> Dimensionless:
    """Dimensionless law through the geometric means of the ellipses that ship, at 5 % RMS^R."""
    ellipses = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    selected = ellipses.sel(threshold=_THRESHOLD, metric="rms", curve="ellipse")
    if "side" in selected.dims:
        selected = selected.sel(side="lag")
    order = ("motion", "f", "xi")
    a, b = (np.exp(np.log(selected[name].transpose(*order).values).mean(axis=0)) for name in ("a", "b"))
    return Dimensionless.fit(selected["f"].values, selected["xi"].values, a, b)


def _by_index(a: float, b: float, amplitude: float, delay: float) -> float:
    """Error that an ellipse at 5 % gives to A [-] and d [ms], taking the error as proportional."""
    return _THRESHOLD * math.sqrt((amplitude - 1.0) ** 2 / a + delay**2 / b)


def by_law_18(mode: Structure, amplitude: float, delay: float) -> float:
    """Predict RMS^R by equation (18).

    `amplitude`, `delay`: A [-] and d [ms]. Result: RMS^R [-]; NaN where the equation is not valid.
    """
    try:
        a, b = Equation18().limits(mode.frequency, mode.damping_ratio)
    except InputError:
        return math.nan
    return _by_index(float(a), float(b), amplitude, delay)


def by_law_with_share(
    law: Dimensionless, mode: Structure, partition: Partition, amplitude: float, delay: float
) -> float:
    """Predict RMS^R by the mean law and the growth of a and b with a smaller share α.

    `amplitude`, `delay`: A [-] and d [ms]. Result: RMS^R [-]; NaN where the specimen is no spring in that
    mode, or α too small beside ξ, so that the law of the share does not hold.
    """
    place = place_of_governing_mode(partition)
    if partition.stiffness_shares[place] < _SPRING * abs(partition.impedance_shares[place]):
        return math.nan
    try:
        factor = float(growth(mode.experimental_fraction, mode.damping_ratio))
    except InputError:
        return math.nan
    frequency = min(mode.frequency, _HIGHEST)
    a, b = law.limits(frequency, mode.damping_ratio)
    slower = (frequency / mode.frequency) ** 2
    return _by_index(float(a) * factor, float(b) * slower * factor, amplitude, delay)


def resolved(run: Run, partition: Partition, motion: Motion) -> float:
    """Predict the RMS error from A and d over frequency, with the lag of the force.

    Gain and phase of the measured over the command displacement are estimated where the two are coherent, and
    kept beyond; the loop is then solved anew under the ground motion.

    RMS of the measured minus the exact displacement [m].
    """
    tracking = tracking_over_frequency(run.command, run.measured, run.step)

    load = (partition.mass @ partition.influence).astype(complex)[:, np.newaxis]

    def stray(s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        # The force is that of the measured displacement, late by the laboratory's own lag.
        tracked = tracking.transfer(s)
        late = tracked * np.exp(-s * _FORCE_LAG)
        ideal = np.linalg.solve(partition.frame.dynamic_stiffness(s), load)[..., 0] @ partition.direction
        command = ideal / (1.0 + partition.error_transfer(s)[..., 0, 0] * (late - 1.0))
        return np.asarray(tracked * command - ideal)

    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    strayed = respond(excitation, stray)[0]
    return float(np.sqrt(np.mean(strayed**2)))


def rebuilt(run: Run, partition: Partition) -> float:
    """Rebuild RMS^R [-] from the displacements of a test, at a sixteenth of its sampling rate."""
    thinned = slice(None, None, _THINNED)
    error = rebuild(
        run.command[thinned].copy(),
        run.measured[thinned].copy(),
        _THINNED * run.step,
        partition,
        feedback_lag=_FORCE_LAG,
        draws=_DRAWS,
    )
    return error.rms.value
