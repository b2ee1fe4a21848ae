"""Where ellipses come from: a file of them, stored results, or ground motions that are simulated."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self, Unpack

import numpy as np
import xarray as xr

from reliab.app import questions
from reliab.app.api.arguments import parse_threshold
from reliab.app.declaration import Files, asks
from reliab.core.errors import InputError
from reliab.core.progress import Progress, show_task, silent
from reliab.core.shipped import or_shipped
from reliab.core.stated_value import Names, Numbers, as_names
from reliab.core.vocabulary import SHARE_ATTRIBUTE, Metric, Side
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.experimental_share import carry_to_share
from reliab.motions.loading import load_motions
from reliab.motions.suite import MotionSuite
from reliab.sweep.ellipse_dataset import CURVES, open_ellipses
from reliab.sweep.ellipse_table import EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.labels import concatenate_shares, select_share, shares_of
from reliab.sweep.request import WHOLLY_EXPERIMENTAL, Motions, one_of, structure_grid, suite_of
from reliab.sweep.results import REAL, find_results, open_results
from reliab.tracking.boundary.curves import Curve
from reliab.tracking.indices.window import Window


@asks(questions.EllipsesQuestion)
def ellipses(
    source: Motions | xr.Dataset,
    *,
    metric: Names = ("rms",),
    curves: Sequence[type[Curve]] = CURVES,
    progress: Progress = silent,
    **question: Unpack[questions.EllipsesQuestion],
) -> xr.Dataset:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    Stored results are taken with all their structures and in their own window; of ground motions the
    structure is one of 1 Hz and 0.02 by default. Ellipses that are predicted (`first_order`) are exact for
    small errors, but at 5 % RMS^R the traced a is 5 % smaller and b 16 to 44 % smaller. The boundary of a
    model has delays only.

    Parameters
    ----------
    source : MotionSuite, Motion, xarray.Dataset, str or pathlib.Path
        Ground motions, which are simulated along the boundary, or stored results; either also by the name or
        path that `load_motions` or `open_results` takes.
    metric : {"rms", "mte"} or sequence of these, optional
        Which errors.
    curves : sequence of type, optional
        Curves that stand for a boundary; the ellipse of least squares (the paper's) and the largest ellipse
        inside the boundary by default.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over (motion, f, xi, threshold, metric, curve, side), with
        `alpha` after `xi` where there are several fractions; the side is "lag" for actuators that are late
        and "lead" for those that are early, which a model with effects does not have. `no_ellipse` says why
        a and b are NaN or zero, and `error_at_rest` is the error of an actuator that does not move.

    Raises
    ------
    InputError
        If a value is not allowed or a record is bad.

    Examples
    --------
    >>> import reliab
    >>> motions = reliab.load_motions("synthetic")[:2]
    >>> found = reliab.ellipses(motions, threshold=[0.05, 0.10])
    >>> bool((found["a"].sel(threshold=0.10) > found["a"].sel(threshold=0.05)).all())
    True
    """
    metrics = tuple(
        one_of(name, {str(choice): choice for choice in Metric}, "metric") for name in as_names(metric)
    )
    thresholds = as_names((0.05,) if question["threshold"] is None else question["threshold"])
    if isinstance(source, str | Path) and (str(source) == REAL or Path(source).suffix in (".zarr", ".nc")):
        source = open_results(source)
    if isinstance(source, xr.Dataset):
        if question["first_order"]:
            raise InputError(
                "A prediction of ellipses needs ground motions",
                value="stored results",
                remedy="Give the ground motions, or leave the prediction out",
            )
        stored_ellipses: xr.Dataset = source.reliab.ellipses(thresholds, metrics, curves, progress=progress)
        return stored_ellipses
    structures = structure_grid(
        f=question["f"],
        xi=question["xi"],
        alpha=WHOLLY_EXPERIMENTAL if question["alpha"] is None else question["alpha"],
        model=question["model"],
    )
    request = EllipseRequest(
        **vars(structures),
        thresholds=thresholds,
        metrics=metrics,
        curves=tuple(curves),
        window=Window.parse(question["window"] or "record"),
        sides=tuple(Side) if structures.model is None else (Side.LAG,),
    )
    trace = predict_ellipses if question["first_order"] else trace_ellipses
    return trace(suite_of(source), request, progress=progress)


ONE_HERTZ, TWO_PERCENT, FIVE_PERCENT = 1.0, 0.02, 0.05
"""The paper's structure and threshold, which hold where nothing else is stated."""

_SOURCE = "Choose `motions` (records or synthetic), `results` or `ellipses`, such as real_suite"
_FRAME_SOURCE = "A frame is simulated: give `motions`, your records or synthetic"
_RECORD, _WHOLE_STIFFNESS = "record", 1.0


def paths(files: Files) -> tuple[str | Path, ...]:
    """Take one file, folder or name, or several."""
    return (files,) if isinstance(files, str | Path) else tuple(files)


def as_list(values: Any) -> list[Any] | None:  # noqa: ANN401 - numbers or names
    """List one value or several; None where none is stated."""
    return None if values is None else list(as_names(values))


@dataclass(frozen=True, kw_only=True)
class EllipseSource:
    """Where the ellipses that a question is about come from; `reliab.app.options` describes the fields.

    Stored results and files are taken with all structures that they hold, unless all that are asked for are
    among them; they must be of the fractions `alpha`, or of 1, from which a law carries them.
    """

    motions: Files | None = None
    sets: Sequence[str] | None = None
    results: str | Path | None = None
    ellipses: str | Path | None = None
    f: Numbers | None = None
    xi: Numbers | None = None
    threshold: Numbers | None = None
    metric: str = Metric.RMS
    window: str | None = None
    alpha: Numbers | None = None
    model: str | Path | None = None
    structure: str | Path | None = None
    actuator: int | None = None
    first_order: bool = False

    @classmethod
    def from_question(cls, question: Mapping[str, Any], **changes: Any) -> Self:  # noqa: ANN401 - values of many types
        """Take what a question says of its source, with changes."""
        names = {item.name for item in fields(cls)}
        values = {name: value for name, value in question.items() if name in names and value is not None}
        return cls(**{**values, "sets": as_list(question["sets"]), **changes})

    def __post_init__(self) -> None:
        sources = [source for source in (self.motions, self.results, self.ellipses) if source is not None]
        if len(sources) != 1:
            raise InputError(
                "Give one source of ellipses" if sources else "No source of ellipses",
                value=f"{len(sources)} of them" if sources else None,
                remedy=_FRAME_SOURCE if self.structure else _SOURCE,
            )
        if self.motions is None:
            self._refuse_options_of_motions()
        if self.actuator is not None and self.structure is None:
            raise InputError(
                "`actuator` needs the `structure` of a frame",
                remedy="Describe the frame, or leave it out",
            )
        require_thresholds(self.threshold)
        Metric.parse(self.metric)

    def _refuse_options_of_motions(self) -> None:
        """Refuse what only ground motions can serve."""
        for name, rule, remedy in (
            (
                "model",
                "A model needs ground motions to be simulated under",
                "Give `motions`; a results store names the model that it was simulated with",
            ),
            (
                "first_order",
                "A prediction of ellipses needs ground motions",
                "Give `motions`, or leave `first_order` out",
            ),
            (
                "sets",
                "Sets can be chosen only from a catalogue of ground motions",
                "Give the folder of the catalogue with `motions`",
            ),
            ("structure", "A frame needs ground motions to be simulated under", "Give `motions`"),
        ):
            if value := getattr(self, name):
                option = f"`sets={' '.join(as_names(value))}`" if name == "sets" else f"`{name}`"
                raise InputError(rule, value=f"{option} without `motions`", remedy=remedy)

    @property
    def _thresholds(self) -> tuple[float, ...]:
        return as_names(FIVE_PERCENT if self.threshold is None else self.threshold)

    def suite(self) -> MotionSuite:
        """Find the ground motions."""
        return load_motions(*paths(self.motions or ()), sets=self.sets)

    def dataset(self) -> xr.Dataset:
        """Trace the ellipses, or look them up."""
        if self.ellipses is not None:
            path = Path(self.ellipses)
            return _select_shares(self._read(path), self.alpha, path)
        if self.results is not None:
            path = Path(self.results)
            return _select_shares(self._read_traced(path), self.alpha, path)
        if self.structure is not None:
            return self._trace_frame(self.structure)

        suite = self.suite()
        with show_task("Reading spectra" if self.first_order else "Tracing boundaries") as progress:
            question = questions.select_stated(questions.EllipsesQuestion, vars(self))
            return ellipses(suite, metric=[self.metric], progress=progress, **question)

    def _read(self, path: Path) -> xr.Dataset:
        """Read a file of ellipses."""
        path = or_shipped(path, "datasets", "ellipses.nc")
        if path.suffix == ".nc":
            return select_structures(open_ellipses(path, window=self.window), self.f, self.xi)
        if self.window is not None:
            raise InputError(
                "A CSV table of ellipses does not say to which window it belongs",
                value=f"`window={self.window}`",
                remedy="Leave it out, or give `motions`, `results` or a file of ellipses in NetCDF",
            )
        dataset = read_ellipses(path)
        for name in ("f", "xi", "threshold", "metric"):
            _require_column(dataset, name, getattr(self, name), path)
        return select_structures(dataset, self.f, self.xi)

    def _read_traced(self, path: Path) -> xr.Dataset:
        """Trace the boundaries in stored results."""
        stored_results = open_results(
            find_results(path, as_list(self.f), as_list(self.xi)), window=self.window or _RECORD
        )
        with show_task("Tracing boundaries") as progress:
            ellipses: xr.Dataset = select_structures(stored_results, self.f, self.xi).reliab.ellipses(
                self._thresholds, (Metric(self.metric),), progress=progress
            )
        return ellipses

    def _trace_frame(self, path: str | Path) -> xr.Dataset:
        """Trace the boundaries of a frame under records."""
        from reliab.simulation.frames.frame_file import read_structure
        from reliab.sweep.frame_table import FrameRequest, trace_frame_ellipses

        idle_options = [
            f"`{name}`" for name in ("f", "xi", "alpha", "model") if getattr(self, name) is not None
        ]
        if idle_options:
            raise InputError(
                "The file of a frame already states frequencies, damping ratios and shares",
                value=f"`structure` with {', '.join(idle_options)}",
                remedy="Leave them out",
            )
        request = FrameRequest(
            frame=read_structure(path),
            actuator=self.actuator,
            thresholds=self._thresholds,
            metrics=(Metric(self.metric),),
            window=Window.parse(self.window or _RECORD),
        )
        suite = self.suite()
        with show_task("Tracing boundaries") as progress:
            return trace_frame_ellipses(suite, request, progress=progress)


def require_thresholds(threshold: Numbers | None) -> None:
    """Refuse errors that are no shares of a peak.

    `threshold` [-].
    """
    for error in () if threshold is None else as_names(threshold):
        parse_threshold(error)


def _require_column(dataset: xr.Dataset, name: str, requested_values: Any, path: Path) -> None:  # noqa: ANN401
    """Refuse to relabel a table that is of one structure and error."""
    values = dataset[name].values
    numeric = values.dtype.kind == "f"
    for value in () if requested_values is None else as_names(requested_values):
        is_present = np.isclose(values, value, rtol=1e-9).any() if numeric else value in values.tolist()
        if not is_present and values.size == 1:
            raise InputError(
                f"These ellipses were traced for another {name}",
                value=f"{value} instead of {values[0]}",
                remedy=(
                    f"Leave `{name}` out, or add the column {name} to the table if its "
                    f"ellipses are of another"
                ),
                where=str(path),
            )


def _select_shares(dataset: xr.Dataset, alpha: Numbers | None, path: Path) -> xr.Dataset:
    """Choose shares of the stiffness among stored boundaries, or carry those of α = 1 to a smaller share.

    `alpha` [-].
    """
    if alpha is None:
        return dataset
    shares = sorted(set(as_names(alpha)))
    return concatenate_shares(shares, lambda share, _: _select_share(dataset, share, path), silent)


def _select_share(dataset: xr.Dataset, alpha: float, path: Path) -> xr.Dataset:
    """Choose one share, or carry the boundaries of α = 1 to it."""
    shares = shares_of(dataset)
    if _near(alpha, shares):
        return select_share(dataset, alpha)
    states_share = "alpha" in dataset.coords or SHARE_ATTRIBUTE in dataset.attrs
    if not states_share or not _near(_WHOLE_STIFFNESS, shares):
        raise InputError(
            "The boundaries are of another share of the stiffness",
            value=f"`alpha={alpha:g}`, where it is {', '.join(f'{share:g}' for share in shares)}",
            remedy="Leave `alpha` out, or give `motions`, whose boundaries are computed for any fraction",
            where=str(path),
        )
    return carry_to_share(select_share(dataset, _WHOLE_STIFFNESS), alpha)


def _near(alpha: float, shares: tuple[float, ...]) -> bool:
    return any(math.isclose(alpha, share, rel_tol=1e-9) for share in shares)


def select_structures(dataset: xr.Dataset, f: Numbers | None, xi: Numbers | None) -> xr.Dataset:
    """Keep the structures that are asked for, or all where one of them lies between the stored ones.

    `f`, `xi` [Hz, -].
    """
    for name, values in (("f", as_list(f)), ("xi", as_list(xi))):
        stored_values = dataset[name].values
        if values and all(np.isclose(stored_values, value, rtol=1e-9).any() for value in values):
            dataset = dataset.sel({name: values}, method="nearest")
    return dataset


def select_rows_with_room(dataset: xr.Dataset) -> xr.Dataset:
    """Refuse boundaries that leave no room, since the effects of a model fill it."""
    full = (dataset["a"] == 0.0) & (dataset["b"] == 0.0)
    if full.any():
        motions = full.any([name for name in full.dims if name != "motion"])
        raise InputError(
            "The effects of the model alone exceed the threshold",
            value=f"{int(motions.sum())} of {motions.size} motions above it even with a perfect actuator",
            remedy="Remove or compensate the effects, or allow a larger error by `threshold`",
        )
    return dataset
