"""Ellipses of many ground motions without a stored grid, and what exact responses say of boundaries."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product

import numpy as np
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import SHARE_ATTRIBUTE, Metric, Side
from reliab.motions.motion import Motion
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.engine import Engine, Loop
from reliab.structures.structure import Structure
from reliab.sweep.cut_records import measure_cut_records
from reliab.sweep.ellipse_dataset import COLUMNS, CURVES, curve_table, ellipse_dataset
from reliab.sweep.labels import concatenate_shares, join_coordinates, motion_coordinates, outlines_of
from reliab.sweep.request import StructureGrid, excitation_of, loop_of
from reliab.tracking.boundary.curves import Curve, Ellipse
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours, suite_contours
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window


def measure_responses(
    motions: Sequence[Motion],
    frequencies: Sequence[float],
    damping_ratios: Sequence[float],
    *,
    progress: Progress = silent,
) -> xr.Dataset:
    """Measure what the exact responses of structures say of the boundaries under ground motions.

    `motions`: the ground motions; read one at a time; `frequencies`, `damping_ratios`: the structures [Hz,
    -], wholly in the laboratory. Returns `a_first` [-] and `b_first` [ms²], the ellipse per squared RMS^R of
    the whole record in the limit of small errors, and `effective_duration` [s] = ∫x²dt/max x² of the
    response, over (motion, f, xi), with the coordinates of the motions.

    >>> from reliab.motions.loading import load_motions
    >>> measured = measure_responses(load_motions("synthetic")[:1], [1.0], [0.02, 0.05])
    >>> bool(measured["effective_duration"].max() < measured["duration"].max())
    True
    """
    rows, headers = [], []
    for count, motion in enumerate(motions, start=1):
        excitation = excitation_of(motion, Window())
        ellipses = [
            first_order_ellipse(excitation, Structure(frequency=f, damping_ratio=xi))
            for f, xi in product(frequencies, damping_ratios)
        ]
        rows.append([(ellipse.amplitude, ellipse.delay, ellipse.effective_duration) for ellipse in ellipses])
        headers.append(motion_coordinates([motion]))
        progress(count, len(motions))
    table = np.reshape(rows, (len(rows), len(frequencies), len(damping_ratios), 3))
    names = "a_first", "b_first", "effective_duration"
    return xr.Dataset(
        {name: (("motion", "f", "xi"), table[..., column]) for column, name in enumerate(names)},
        coords={**join_coordinates(headers), "f": list(frequencies), "xi": list(damping_ratios)},
    )


_MOTIONS_AT_A_TIME = 64
"""Number of motions that are traced together; limits the memory."""


@dataclass(frozen=True, kw_only=True)
class EllipseRequest(StructureGrid):
    """Structures, errors and curves for which boundaries are traced.

    Raises InputError if the model has another structure, or leads are requested together with a model.
    """

    thresholds: tuple[float, ...] = (0.05,)  # Errors on the boundary [-]
    metrics: tuple[Metric, ...] = (Metric.RMS,)  # RMS^R, MTE^R or both
    # Curves fitted to the boundary; the least-squares ellipse and the inscribed ellipse by default
    curves: tuple[type[Curve], ...] = CURVES
    # Sides of the boundary: actuators that are late, early, or both, which is the default
    sides: tuple[Side, ...] = tuple(Side)
    window: Window = field(default_factory=Window)  # Part of the record over which the error is computed
    engine: Engine = Engine.AUTOMATIC  # How the loop is solved

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.model is not None and Side.LEAD in self.sides:
            raise InputError(
                "With effects, boundaries exist for late actuators only",
                remedy="Ask for the side lag",
            )

    def each_share(
        self, compute: Callable[["EllipseRequest", Progress], xr.Dataset], progress: Progress
    ) -> xr.Dataset:
        """Answer the request for each share of the stiffness and join the answers.

        `compute`: takes a request of one share and a progress, returns the ellipses; `progress`: called with
        the steps done for all shares and their number. Returns with the dimension `alpha` where there are
        several shares.
        """

        def compute_share(share: float, advance: Progress) -> xr.Dataset:
            return compute(replace(self, experimental_fractions=(share,)), advance)

        return concatenate_shares(self.experimental_fractions, compute_share, progress)


def trace_ellipses(
    motions: Sequence[Motion], request: EllipseRequest, *, progress: Progress = silent
) -> xr.Dataset:
    """Trace the boundaries of many ground motions and fit curves to them.

    `motions`: the ground motions; read a batch at a time; `progress`: called after each structure of a batch
    of motions, with motions times structures as the total. Returns `a` [-], `b` [ms²], `sse` [ms⁴], `n` and
    `no_ellipse` over (motion, f, xi, threshold, metric, curve, side); a and b are NaN where a side has no
    ellipse and zero where the model's effects alone exceed the threshold, for the reason in `no_ellipse`.
    `error_at_rest` [-] over (motion, f, xi, metric) is the error of an actuator that does not move. Of whole
    records and actuators without effects `a_cut` and `b_cut` [-] over (motion, f, xi, length) are the ratios
    by which a and b change when a record is cut to a length [s]. Of several shares of the stiffness all have
    the dimension `alpha` after `xi`; of one it is the attribute `experimental_fraction`.
    """
    return request.each_share(lambda part, advance: _trace_share(motions, part, advance), progress)


def _trace_share(motions: Sequence[Motion], request: EllipseRequest, progress: Progress) -> xr.Dataset:
    """Trace the boundaries of structures of one share."""
    tables, errors_at_rest, headers = [], [], []
    for begin in range(0, len(motions), _MOTIONS_AT_A_TIME):
        batch = [motions[place] for place in range(begin, min(begin + _MOTIONS_AT_A_TIME, len(motions)))]
        table, errors = _tables(batch, request, partial(_advance, progress, begin, len(batch), len(motions)))
        tables.append(table)
        errors_at_rest.append(errors)
        headers.append(motion_coordinates(batch))
    ellipses = label_curves(
        np.concatenate(tables), headers, request, error_at_rest=np.concatenate(errors_at_rest)
    )
    return _add_cut_records(ellipses, motions, request)


def _add_cut_records(ellipses: xr.Dataset, motions: Sequence[Motion], request: EllipseRequest) -> xr.Dataset:
    """Add how a and b of whole records change when these are cut; a model's effects are not linear."""
    ellipses = ellipses.assign_coords(outline=outlines_of(motions))
    if request.window != Window() or request.model is not None:
        return ellipses
    structures = request.frequencies, request.damping_ratios, request.experimental_fractions[0]
    return ellipses.merge(measure_cut_records(motions, *structures))


def _advance(
    progress: Progress, begin: int, batch: int, motions: int, solved_structures: int, structures: int
) -> None:
    """Report structures that are solved for a batch of motions, as pieces of all motions and structures."""
    progress(begin * structures + batch * solved_structures, motions * structures)


def _tables(motions: Sequence[Motion], request: EllipseRequest, progress: Progress) -> tuple[Array, Array]:
    """Curves and errors at rest of several motions; `progress` is called after each structure.

    Shapes (motion, f, xi, threshold, metric, curve, side, columns) and (motion, f, xi, metric).
    """
    excitations = [excitation_of(motion, request.window) for motion in motions]
    rows, errors_at_rest = [], []
    structures = request.structures
    for solved_structures, structure in enumerate(structures, start=1):
        loops = [loop_of(request.model, excitation, structure, request.engine) for excitation in excitations]
        errors_at_rest.append(
            [
                [relative_error(loop.rest_deviation(), metric)[0] for metric in request.metrics]
                for loop in loops
            ]
        )
        rows.append([_rows(loops, metric, request) for metric in request.metrics])
        progress(solved_structures, len(structures))
    sizes = len(request.frequencies), len(request.damping_ratios)
    table = np.array(rows, dtype=np.float64)  # over (structure, metric, motion, threshold, side, curve, …)
    table = table.reshape(*sizes, *table.shape[1:]).transpose(3, 0, 1, 4, 2, 6, 5, 7)
    rest_errors = np.array(errors_at_rest, dtype=np.float64).reshape(*sizes, len(motions), -1)
    return table, np.moveaxis(rest_errors, 2, 0)


def _rows(loops: Sequence[Loop | EffectLoop], metric: Metric, request: EllipseRequest) -> Array:
    """Curves of one structure and metric, shape (motion, threshold, side, curve, columns)."""
    pairs = [(threshold, side) for threshold in request.thresholds for side in request.sides]
    levels, sides = zip(*pairs, strict=True)
    linear = [loop for loop in loops if isinstance(loop, Loop)]
    if metric is Metric.RMS and len(linear) == len(loops):
        contours = suite_contours(linear, levels, sides)
    else:
        contours = [motion_contours(loop, levels, metric, side=sides) for loop in loops]
    sizes = len(request.thresholds), len(request.sides), len(request.curves), len(COLUMNS)
    return curve_table(contours, request.curves).reshape(len(loops), *sizes)


def label_curves(
    table: Array,
    headers: Sequence[dict[str, xr.Variable]],
    request: EllipseRequest,
    *,
    error_at_rest: Array | None = None,
) -> xr.Dataset:
    """Label the tables of all motions.

    `error_at_rest` [-].
    """
    return ellipse_dataset(
        table,
        {**join_coordinates(headers), "f": list(request.frequencies), "xi": list(request.damping_ratios)},
        thresholds=request.thresholds,
        metrics=request.metrics,
        curves=request.curves,
        sides=request.sides,
        attributes={
            "window": request.window.label,
            SHARE_ATTRIBUTE: request.experimental_fractions[0],
        },
        error_at_rest=error_at_rest,
    )


CAUTION = (
    "These ellipses are predicted to first order from the records' spectra and are too generous: of 100 real "
    "records at an error of 5 %, the simulated a is 5 % smaller and the simulated b 16 to 44 % smaller."
)
"""Warning in the attribute `caution` of such a dataset, repeated by every criterion derived from it."""


def predict_ellipses(
    motions: Sequence[Motion], request: EllipseRequest, *, progress: Progress = silent
) -> xr.Dataset:
    """Predict the ellipses of many ground motions in closed form.

    Exact for small errors only. Over 100 real records at 5 % RMS^R, f of 0.25 to 2 Hz and ξ of 0.02 and 0.10,
    the true a is 5 % smaller and the true b 16 to 44 % smaller, because a delay also takes damping away.

    `motions`: the ground motions; read one at a time; `request`: structures, thresholds and window; only
    RMS^R and ellipses are allowed, and no model. Returns what `trace_ellipses` does, with `sse` NaN and
    `n` zero, since there are no points, and with the attribute `caution`.

    >>> from reliab.motions.loading import load_motions
    >>> request = EllipseRequest(frequencies=(1.0,), damping_ratios=(0.02,), thresholds=(0.01, 0.02))
    >>> predicted = predict_ellipses(load_motions("synthetic")[:2], request)
    >>> np.unique((predicted["a"].sel(threshold=0.02) / predicted["a"].sel(threshold=0.01)).values.round(6))
    array([4.])
    """
    wrong = [str(metric) for metric in request.metrics if metric != Metric.RMS]
    wrong += [curve.name for curve in request.curves if not issubclass(curve, Ellipse)]
    wrong += ["a model with effects"] if request.model is not None else []
    if wrong:
        raise InputError(
            "The closed form is for the RMS error of an actuator with gain and delay alone",
            value=", ".join(wrong),
            remedy="Leave it out, or trace the boundaries by simulation",
        )
    return request.each_share(lambda part, advance: _predict_share(motions, part, advance), progress)


def _predict_share(motions: Sequence[Motion], request: EllipseRequest, progress: Progress) -> xr.Dataset:
    """Predict the ellipses of structures of one share."""
    tables, headers = [], []
    for step, motion in enumerate(motions, start=1):
        excitation = excitation_of(motion, request.window)
        fits = [first_order_ellipse(excitation, structure) for structure in request.structures]
        rows = [
            [(*fit.parameters(threshold), np.nan, 0.0, 0.0) for threshold in request.thresholds]
            for fit in fits
        ]
        structures = len(request.frequencies), len(request.damping_ratios)
        table = np.reshape(rows, (*structures, len(request.thresholds), 1, 1, 1, len(COLUMNS)))
        # To first order a lead causes the same error as a lag, and the boundary itself is an ellipse.
        tables.append(np.tile(table, (len(request.curves), len(request.sides), 1)))
        headers.append(motion_coordinates([motion]))
        progress(step, len(motions))
    ellipses = label_curves(np.stack(tables), headers, request).assign_attrs(caution=CAUTION)
    return _add_cut_records(ellipses, motions, request)
