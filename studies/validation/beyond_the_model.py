"""Verdicts by A and d on actuators that are not a constant gain and delay.

Each test is simulated with its actuator, A and d are evaluated from command and measured displacement as a
laboratory would, and the error of the whole test is known. The criterion's premise is that the error is that
of a constant gain A and delay d; the study reports how far this holds, and whether a verdict is wrong where
it does not.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from reliab_studies.laboratory.compensators.inverse import InverseCompensation

from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.effects.delay_drift import DelayDrift
from reliab.effects.effect import Effect
from reliab.effects.first_order_lag import FirstOrderLag
from reliab.effects.second_order_dynamics import SecondOrderDynamics
from reliab.motions.motion import Motion, resample
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import Compensator, run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error, response_error
from reliab.tracking.indices.tracking import frequency_evaluation

RATE_HZ = 1024.0

LEVELS = (0.8, 1.2)
"""Shares of a limit at which actuators are tried."""

TEST_COLUMNS = (
    *("motion", "event", "rig", "f", "xi", "alpha"),
    *("A", "d", "error", "predicted", "accepted", "good"),
)
"""Columns of the tests."""


@dataclass(frozen=True, kw_only=True)
class Rig:
    """An actuator with or without a compensator."""

    name: str  # What it is called in tables
    actuator: Actuator = field(default_factory=Actuator)  # Gain and delay
    effects: tuple[Effect, ...] = ()  # Further effects of the actuator
    compensator: Compensator | None = None  # Compensator that changes the command


def rigs_of_delay(delay: float) -> tuple[Rig, ...]:
    """Rigs of several kinds whose equivalent delay is about a given one.

    Parameters
    ----------
    delay : float
        Equivalent delay [s].

    Returns
    -------
    tuple of Rig
        A constant delay, a first-order lag, second-order dynamics, a delay that drifts from half to
        one and a half, and an actuator of three steps under inverse compensation with the wrong
        estimate.
    """
    damping = 0.7
    steps = delay * RATE_HZ
    return (
        Rig(name="constant delay", actuator=Actuator(delay=delay)),
        Rig(name="first-order lag", effects=(FirstOrderLag(time_constant_s=delay),)),
        Rig(
            name="second-order dynamics",
            effects=(
                SecondOrderDynamics(natural_frequency_hz=damping / (np.pi * delay), damping_ratio=damping),
            ),
        ),
        Rig(
            name="drifting delay",
            actuator=Actuator(delay=0.5 * delay),
            effects=(DelayDrift(delay_rate_s_per_s=delay / 40.0),),
        ),
        Rig(
            name="inverse compensation, wrong estimate",
            actuator=Actuator(delay=(3.0 + steps) / RATE_HZ),
            compensator=InverseCompensation(steps=4.0),
        ),
    )


def try_rigs(
    motions: Iterable[Motion],
    structures: Sequence[Structure],
    rigs: Callable[[float], Sequence[Rig]],
    criterion: Criterion,
    *,
    levels: Sequence[float] = LEVELS,
    count: int,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Simulate tests with given rigs and judge them by their indices.

    Parameters
    ----------
    motions : iterable of Motion
        Ground motions.
    structures : sequence of Structure
        Structures.
    rigs : callable
        Actuators of about an equivalent delay [s], such as :func:`rigs_of_delay`.
    criterion : Criterion
        The criterion by which a test is accepted, valid for the structures.
    levels : sequence of float, optional
        Delays as shares of two limits: of what the criterion allows without amplitude error, and of what
        the test's own motion tolerates; below and above one, so that tests are good or bad, and accepted or
        refused.
    count : int
        Number of motions, for the progress.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    pandas.DataFrame
        One row a test: motion, event, f, xi, alpha, rig, A [-], d [s], `error` [-], `predicted` error
        [-] of a constant gain A and delay d, `accepted` and `good`.
    """
    rows = []
    for done, motion in enumerate(motions, start=1):
        record = resample(motion, RATE_HZ)
        for structure in structures:
            exact = run_closed_loop(HybridTest(structure=structure), record.acceleration, record.time_step)
            ideal = exact.command.values[0]
            excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
            loop = Loop(excitation=excitation, structure=structure)
            for delay in _delays(loop, criterion, levels):
                for rig in rigs(delay):
                    row = _try(record, structure, rig, ideal, loop, criterion)
                    rows.append({"motion": motion.name, "event": motion.event, "rig": rig.name, **row})
        progress(done, count)
    return pd.DataFrame(rows)


def _delays(loop: Loop, criterion: Criterion, levels: Sequence[float]) -> list[float]:
    """Delays [s] below and above what the criterion allows and what the motion tolerates."""
    structure = loop.structure
    _, b = criterion.limits(structure.frequency, structure.damping_ratio)
    (contour,) = motion_contours(loop, (criterion.threshold,), Metric(criterion.metric))
    limits = [1e-3 * float(np.sqrt(b)), float(contour.delay.max(initial=0.0))]
    return [level * limit for limit in limits if limit > 0.0 for level in levels]


def _try(
    record: Motion, structure: Structure, rig: Rig, ideal: np.ndarray, loop: Loop, criterion: Criterion
) -> dict[str, object]:
    test = HybridTest(structure=structure, actuator=rig.actuator, effects=rig.effects)
    histories = run_closed_loop(test, record.acceleration, record.time_step, compensator=rig.compensator)
    index = frequency_evaluation(histories.command.values[0], histories.measured, record.time_step)
    delay = max(index.equivalent_delay, 0.0)
    error = response_error(histories.measured, ideal)
    predicted = relative_error(loop.deviation(loop.cells(gain=index.amplitude, delay=delay)), Metric.RMS)
    f, xi = structure.frequency, structure.damping_ratio
    accepted = float(criterion.index(index.amplitude, index.equivalent_delay, f, xi)) <= 1.0
    return {
        "f": f,
        "xi": xi,
        "alpha": structure.experimental_fraction,
        "A": index.amplitude,
        "d": index.equivalent_delay,
        "error": error,
        "predicted": float(predicted[0]),
        "accepted": accepted,
        "good": error <= criterion.threshold,
    }
