"""Validity of a criterion for linear structures once the specimen yields.

Each test stands on a motion's own linear boundary: its actuator has the gain and the delay at which a linear
structure reaches the threshold exactly. The same actuator then drives an elastoplastic specimen, and the
error of that test is compared with the threshold. Yielding adds damping, but it also lets the displacement of
test and exact response drift apart for good, so that neither the linear nor the yielding test is always the
more demanding one.
"""

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reliab.core.compiled import compiled
from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.validation.counts import event_bootstrap
from reliab.validation.yielding import HARDENING

REDUCTIONS: Final = (2.0, 4.0)
"""Peak of the linear response over the yield displacement, R [-]."""

_STEPS_PER_PERIOD = 600.0
_POINTS = 5
_THRESHOLD = 0.05


def yielding_tests(
    motions: Sequence[Motion],
    structures: Iterable[Structure],
    *,
    reductions: Sequence[float] = REDUCTIONS,
    threshold: float = _THRESHOLD,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Simulate elastoplastic tests on the linear boundaries of ground motions.

    `threshold` [-].
    Returns one row for each test: `motion`, `event`, `f` [Hz], `xi` [-], `R` [-], `A` [-], `d` [s], `error`
    [-] of the yielding test (RMS^R over the record, relative to the yielding structure's own exact response),
    and `ratio` of the error to the threshold.
    """
    rows = []
    structures = list(structures)
    for done, motion in enumerate(motions, start=1):
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        for structure in structures:
            (contour,) = motion_contours(Loop(excitation=excitation, structure=structure), (threshold,))
            chosen = np.linspace(0, contour.amplitude.size - 1, _POINTS).round().astype(int)
            record, step = _fine(motion, structure)
            elastic = _response(record, step, structure, 1.0, 0.0, np.inf)
            for reduction in reductions:
                limit = float(np.abs(elastic).max()) / reduction
                exact = _response(record, step, structure, 1.0, 0.0, limit)
                for gain, delay in zip(contour.amplitude[chosen], contour.delay[chosen], strict=True):
                    error = _relative(_response(record, step, structure, gain, delay, limit), exact)
                    rows.append(
                        {
                            "motion": motion.name,
                            "event": motion.event,
                            "f": structure.frequency,
                            "xi": structure.damping_ratio,
                            "R": reduction,
                            "A": gain,
                            "d": delay,
                            "error": error,
                            "ratio": error / threshold,
                        }
                    )
        progress(done, len(motions))
    return pd.DataFrame(rows)


def summarise(tests: pd.DataFrame) -> pd.DataFrame:
    """Count yielding tests that exceed the error of the linear boundary on which they stand.

    Returns [-].
    Returns one row for each R and structure, and one for each R over all (`f` and `xi` NaN): `tests`,
    `motions`, `events`, `exceeding` [-] with `low` and `high` ends of its 95 % interval over earthquakes, and
    median, 95 % quantile and largest `ratio` of the error to the threshold.
    """
    over_all = tests.assign(f=np.nan, xi=np.nan).groupby(["R", "f", "xi"], dropna=False)
    parts = [*over_all, *tests.groupby(["R", "f", "xi"])]
    return pd.DataFrame([_summary(part) for _, part in parts])


def _summary(part: pd.DataFrame) -> dict[str, float]:
    """One row of the summary, of tests of one R, and of one structure or (`f` and `xi` NaN) of all."""
    above = np.asarray(part["ratio"] > 1.0, dtype=np.float64)
    low, high = event_bootstrap(above, np.ones(above.size), part["event"].to_numpy(dtype=np.str_))
    ratio = part["ratio"]
    return {
        **{name: float(part[name].iloc[0]) for name in ("R", "f", "xi")},
        "tests": len(part),
        "motions": part["motion"].nunique(),
        "events": part["event"].nunique(),
        "exceeding": above.mean(),
        "low": float(low),
        "high": float(high),
        "median_ratio": ratio.median(),
        "ratio_95": ratio.quantile(0.95),
        "largest_ratio": ratio.max(),
    }


def _relative(measured: NDArray[np.float64], exact: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean((measured - exact) ** 2)) / np.abs(exact).max())


def _fine(motion: Motion, structure: Structure) -> tuple[NDArray[np.float64], float]:
    """Ground acceleration [m/s²] between whose samples the record is linear, and its step [s]."""
    parts = int(np.ceil(motion.time_step * structure.frequency * _STEPS_PER_PERIOD))
    step = motion.time_step / parts
    times = step * np.arange((motion.acceleration.size - 1) * parts + 1)
    return np.interp(times, motion.times, motion.acceleration), step


def _response(
    record: NDArray[np.float64], step: float, structure: Structure, gain: float, delay: float, limit: float
) -> NDArray[np.float64]:
    """Measured displacement [m] at every step; the specimen yields at a displacement [m]."""
    return np.asarray(
        _step_through(
            record,
            step,
            structure.circular_frequency,
            structure.damping_ratio,
            float(gain),
            float(delay),
            limit,
            HARDENING,
        )
    )


@compiled
def _step_through(
    record: NDArray[np.float64],
    h: float,
    w0: float,
    xi: float,
    gain: float,
    delay: float,
    limit: float,
    hardening: float,
) -> NDArray[np.float64]:
    """Velocity Verlet; the delayed command is a cubic through displacements and velocities of two steps."""
    n = record.size
    x, v, measured = np.zeros(n), np.zeros(n), np.zeros(n)
    a = -record[0]
    plastic = 0.0
    whole = int(np.floor(delay / h))
    part = delay / h - whole
    for k in range(1, n):
        x[k] = x[k - 1] + h * v[k - 1] + 0.5 * h * h * a
        v[k] = v[k - 1] + h * a  # corrected below; good enough where the delay is shorter than a step
        late = k - whole
        if late < 1:
            command = 0.0
        elif part == 0.0:
            command = x[late]
        else:
            s = 1.0 - part
            command = (
                (1.0 + 2.0 * s) * (1.0 - s) ** 2 * x[late - 1]
                + s * (1.0 - s) ** 2 * h * v[late - 1]
                + s * s * (3.0 - 2.0 * s) * x[late]
                + s * s * (s - 1.0) * h * v[late]
            )
        measured[k] = gain * command
        # Kinematic hardening: hardening·x in parallel with an elastic part that slips at its limit.
        elastic = measured[k] - plastic
        if elastic > limit:
            plastic = measured[k] - limit
            elastic = limit
        elif elastic < -limit:
            plastic = measured[k] + limit
            elastic = -limit
        force = hardening * measured[k] + (1.0 - hardening) * elastic
        v[k] = (v[k - 1] + 0.5 * h * (a - record[k] - w0 * w0 * force)) / (1.0 + xi * w0 * h)
        a = -record[k] - 2.0 * xi * w0 * v[k] - w0 * w0 * force
    return measured
