"""Tolerable amplitude errors and delays of tests with nonlinear specimens, over those of linear ones.

From the perfect actuator, five straight lines lead into the plane of amplitude error and delay: a delay
alone, a gain above or below 1 alone, and both together. Along each line the error of the whole test is
computed at growing distances; the distance at which it first reaches the threshold is what the test
tolerates. The distance of the nonlinear specimen over that of the linear one, under the same ground motion,
says how the tolerance has grown or shrunk. One engine finds both, so that most of its own error cancels.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pandas as pd

from reliab.core.arrays import Array
from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.excitation import Excitation, peak_of_history
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.validation.counts import event_bootstrap

from .specimens import SPECIMENS, NonlinearSpecimen

DIRECTIONS: Final = ("late", "large", "small", "late_large", "late_small")
"""Lines from the perfect actuator: late (a delay alone), a gain above or below 1 alone, both together."""

FARTHEST: Final = 16.0
"""Distance up to which a tolerance is sought, in half axes of the first-order ellipse of the linear test."""

_UNIT: Final = np.array([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [0.5**0.5, 0.5**0.5], [-(0.5**0.5), 0.5**0.5]])
_DISTANCES: Final = (0.0625, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, FARTHEST)
_REFINEMENTS: Final = 3
_SMALLEST_GAIN: Final = 0.05


@dataclass(frozen=True, kw_only=True)
class _Plane:
    """Half axes of the plane of errors: of the gain [-] and of the delay [s]."""

    gain: float
    delay: float

    def actuators(self, directions: Array, distances: Array) -> tuple[Array, Array]:
        """Gains [-] and delays [s] at distances from the perfect actuator, shapes (n, 2) and (n,)."""
        along = directions * distances[:, np.newaxis]
        return np.maximum(1.0 + self.gain * along[:, 0], _SMALLEST_GAIN), self.delay * along[:, 1]


def tolerances(
    motions: Sequence[Motion],
    structures: Iterable[Structure],
    specimens: Sequence[NonlinearSpecimen] = SPECIMENS,
    *,
    threshold: float = 0.05,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Find what tests with nonlinear specimens tolerate, relative to those with linear ones.

    `threshold`: RMS^R that is tolerated [-], over the whole record and relative to the specimen's own exact
    response. Result: one row for each motion, structure and specimen: `motion`, `event`, `f` [Hz], `xi` [-],
    `specimen`, `level` [-], `ductility` (peak of the exact response over the yield displacement [-]; NaN
    where nothing yields), the tolerances of the linear test `linear_delay_ms` [ms] and `linear_large`,
    `linear_small` [-] (delay alone, gain above 1 and below 1 alone), and for each direction the tolerable
    distance over that of the linear test [-]: NaN where the exact response itself runs away, and a lower
    bound where the tolerance lies beyond `FARTHEST`.
    """
    rows: list[dict[str, Any]] = []
    structures = list(structures)
    for done, motion in enumerate(motions, start=1):
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        for structure in structures:
            about = {
                "motion": motion.name,
                "event": motion.event,
                "f": structure.frequency,
                "xi": structure.damping_ratio,
            }
            rows += [
                about | row
                for row in _rows_of_structure(excitation, structure, specimens, threshold=threshold)
            ]
        progress(done, len(motions))
    return pd.DataFrame(rows)


def _rows_of_structure(
    excitation: Excitation,
    structure: Structure,
    specimens: Sequence[NonlinearSpecimen],
    *,
    threshold: float,
) -> list[dict[str, Any]]:
    """Rows of one motion and structure."""
    a, b = first_order_ellipse(excitation, structure).parameters(threshold)
    plane = _Plane(gain=a**0.5, delay=1e-3 * b**0.5)
    linear = EffectLoop(excitation=excitation, test=HybridTest(structure=structure))
    peak, reached = peak_of_history(linear.exact), _find_distances(linear, plane, threshold)
    rows = []
    for specimen in specimens:
        test = HybridTest(structure=structure, effects=specimen.effects(structure, peak))
        loop = EffectLoop(excitation=excitation, test=test)
        sound = bool(np.isfinite(loop.exact).all())
        ratios = _find_distances(loop, plane, threshold) / reached if sound else np.full(reached.size, np.nan)
        ductility = peak_of_history(loop.exact) / (peak / specimen.level) if specimen.yields else np.nan
        rows.append(
            {
                "specimen": str(specimen.kind),
                "level": specimen.level,
                "ductility": ductility,
                "linear_delay_ms": 1e3 * plane.delay * reached[0],
                "linear_large": plane.gain * reached[1],
                "linear_small": plane.gain * reached[2],
                **dict(zip(DIRECTIONS, ratios.tolist(), strict=True)),
            }
        )
    return rows


def _find_distances(loop: EffectLoop, plane: _Plane, threshold: float) -> Array:
    """Distances at which the error first reaches the threshold, shape (directions,).

    The distance grows in steps until the error is above the threshold; between the last one below it and the
    first one above it the error is followed as a power of the distance.
    """
    count = len(DIRECTIONS)
    inner, at_inner = np.full(count, np.nan), np.full(count, np.nan)
    outer, at_outer = np.full(count, _DISTANCES[-1]), np.full(count, np.nan)
    sought = np.ones(count, dtype=bool)
    for distance in _DISTANCES:
        error = np.full(count, np.nan)
        error[sought] = _errors(loop, plane, _UNIT[sought], np.full(int(sought.sum()), distance))
        beyond, below = sought & (error > threshold), sought & (error <= threshold)
        outer[beyond], at_outer[beyond] = distance, error[beyond]
        inner[below], at_inner[below] = distance, error[below]
        sought = below
        if not sought.any():
            break
    between = np.isfinite(inner) & ~np.isnan(at_outer)
    for _ in range(_REFINEMENTS if between.any() else 0):
        middle = _power_between(inner, at_inner, outer, at_outer, threshold)
        error = np.full(count, np.nan)
        error[between] = _errors(loop, plane, _UNIT[between], middle[between])
        beyond, below = error > threshold, error <= threshold
        outer[beyond], at_outer[beyond] = middle[beyond], error[beyond]
        inner[below], at_inner[below] = middle[below], error[below]
    refined = _power_between(inner, at_inner, outer, at_outer, threshold)
    return np.asarray(np.where(between, refined, outer))


def _power_between(inner: Array, at_inner: Array, outer: Array, at_outer: Array, threshold: float) -> Array:
    """Distance at which a power of the distance through two errors reaches the threshold."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.log(threshold / at_inner) / np.log(at_outer / at_inner)
    share = np.clip(np.nan_to_num(share, nan=0.5), 0.02, 0.98)
    return np.asarray(inner * (outer / inner) ** share)


def _errors(loop: EffectLoop, plane: _Plane, directions: Array, distances: Array) -> Array:
    """RMS^R [-] at distances in directions, shape (n,); infinite where the test runs away."""
    gain, delay = plane.actuators(directions, distances)
    deviation = loop.deviation(loop.cells(gain=gain, delay=delay))
    with np.errstate(invalid="ignore", over="ignore"):
        errors = np.sqrt(deviation.mean_square) / deviation.ideal_peak
    return np.nan_to_num(errors, nan=np.inf, posinf=np.inf)


NARROWEST: Final = "narrowest"
"""The direction in which a test's tolerance has shrunk most, or grown least."""

QUANTILES: Final = {"q05": 0.05, "q25": 0.25, "q50": 0.5, "q75": 0.75, "q95": 0.95}
"""Columns of quantiles over tests."""

FEWEST_MOTIONS: Final = 20
"""Motions from which a limit that 95 % of them keep is stated."""

_CONFIDENCE = 0.95


def compare_levels(tests: pd.DataFrame) -> pd.DataFrame:
    """Quantiles of the tolerances over those of linear tests, for each specimen and direction.

    One row for each specimen, level, structure (`f` and `xi` NaN for all of them together) and direction, the
    narrowest one of a test included: `tests` counted, `lost` ones whose exact response runs away, `motions`,
    `events`, median `ductility` [-], quantiles `q05` … `q95` of the tolerance over that of the linear test
    [-], and `narrower`, the share of tests that tolerate less than the linear one, with `low` and `high` ends
    of its 95 % interval over earthquakes.
    """
    tests = tests.assign(**{NARROWEST: tests[list(DIRECTIONS)].min(axis=1, skipna=False)})
    rows = []
    everything = tests.assign(f=np.nan, xi=np.nan)
    for (kind, level, f, xi), group in [
        *everything.groupby(["specimen", "level", "f", "xi"], sort=False, dropna=False),
        *tests.groupby(["specimen", "level", "f", "xi"], sort=False),
    ]:
        about = {"specimen": kind, "level": level, "f": f, "xi": xi}
        rows += [about | _row(group, direction) for direction in (*DIRECTIONS, NARROWEST)]
    return pd.DataFrame(rows)


def _row(group: pd.DataFrame, direction: str) -> dict[str, Any]:
    """Statistics of one specimen in one direction."""
    sound = group[group[direction].notna()]
    below = np.asarray(sound[direction] < 1.0, dtype=np.float64)
    low, high = event_bootstrap(below, np.ones(below.size), sound["event"].to_numpy(dtype=np.str_))
    return {
        "direction": direction,
        "tests": len(sound),
        "lost": len(group) - len(sound),
        "motions": sound["motion"].nunique(),
        "events": sound["event"].nunique(),
        "ductility": sound["ductility"].median(),
        **{name: sound[direction].quantile(share) for name, share in QUANTILES.items()},
        "narrower": below.mean() if below.size else np.nan,
        "low": float(low),
        "high": float(high),
    }


def compare_limits(tests: pd.DataFrame) -> pd.DataFrame:
    """Compare what 95 % of the motions tolerate with nonlinear and with linear specimens.

    One row for each specimen, level and structure: the delay alone [ms] and the amplitude error alone [-],
    the smaller one of both signs, that 95 % of the motions tolerate: `delay_ms`, `amplitude`, and
    `linear_delay_ms`, `linear_amplitude` of the linear structure. NaN for fewer than `FEWEST_MOTIONS`
    motions.
    """
    tests = tests.assign(
        delay_ms=tests["linear_delay_ms"] * tests["late"],
        amplitude=np.minimum(tests["linear_large"] * tests["large"], tests["linear_small"] * tests["small"]),
        linear_amplitude=tests[["linear_large", "linear_small"]].min(axis=1),
    )
    names = ["delay_ms", "linear_delay_ms", "amplitude", "linear_amplitude"]
    rows = []
    for keys, group in tests.groupby(["specimen", "level", "f", "xi"], sort=False):
        about = dict(zip(("specimen", "level", "f", "xi"), keys, strict=True))
        enough = group["motion"].nunique() >= FEWEST_MOTIONS
        # A test whose exact response runs away tolerates nothing.
        limits = group[names].fillna(0.0).quantile(1.0 - _CONFIDENCE)
        rows.append(about | {name: limits[name] if enough else np.nan for name in names})
    return pd.DataFrame(rows)
