"""Where ellipses come from: a file of them, stored results, or records that are simulated here and now."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.vocabulary import Metric

_RECORD, _WHOLE = "record", 1.0


def ellipse_dataset(
    *,
    motions: list[str] | None,
    sets: list[str] | None,
    results: Path | None,
    ellipses: Path | None = None,
    f: list[float] | None,
    xi: list[float] | None,
    threshold: list[float] | None,
    metric: str,
    window: str | None,
    alpha: float | None,
    model: Path | None = None,
    structure: Path | None = None,
    first_order: bool = False,
) -> "xr.Dataset":
    """Trace or look up the ellipses that a command is about.

    Parameters
    ----------
    motions, sets : list of str or None
        Sources of ground motions and sets of their catalogue.
    results : pathlib.Path or None
        Stored results instead.
    ellipses : pathlib.Path or None
        A file of ellipses instead, CSV or NetCDF.
    f, xi : list of float or None
        Natural frequencies [Hz] and damping ratios [-]; of stored results and ellipses all that they
        hold, by default and where one that is asked for is not among them.
    threshold : list of float or None
        Errors on the boundary [-].
    metric : str
        Error of the whole test.
    window : str or None
        Part of the record over which the error is computed; None leaves it to the source, which is the whole
        record for records.
    alpha : float or None
        Experimental fraction [-]; 1 for records unless given. Stored results and files must be of that
        fraction.
    model : pathlib.Path or None
        Model with effects instead of structures, for records.
    structure : pathlib.Path or None
        Description of a partitioned frame instead of structures, for records.
    first_order : bool
        Whether ellipses are predicted from the spectra of records instead of traced.

    Returns
    -------
    xarray.Dataset
        `a`, `b`, `sse`, `n` over (motion, f, xi, threshold, metric, curve, side).

    Raises
    ------
    InputError
        If not exactly one source is given, or an option that the source cannot serve.
    """
    from reliab import api
    from reliab.motions import load_motions
    from reliab.vocabulary import Metric

    given = [source for source in (motions, results, ellipses) if source is not None]
    if len(given) != 1:
        raise InputError(
            "Ellipses come from one source: ground motions, stored results or a file of ellipses",
            value=f"{len(given)} of them",
            remedy="Give --motions (records or 'synthetic'), or --results, or --ellipses where it is known",
        )
    if model is not None and motions is None:
        raise InputError(
            "A model is simulated under ground motions",
            value="--model without --motions",
            remedy="Give --motions; a store knows with which model it was simulated",
        )
    if first_order and motions is None:
        raise InputError(
            "Only the records themselves have spectra to predict from",
            value="--first-order without --motions",
            remedy="Give --motions, or leave --first-order out",
        )
    if sets is not None and motions is None:
        raise InputError(
            "Sets are those of a catalogue of ground motions",
            value=f"--sets {' '.join(sets)} without --motions",
            remedy="Give the folder of the catalogue with --motions",
        )
    if structure is not None and motions is None:
        raise InputError(
            "A frame is simulated under ground motions",
            value="--structure without --motions",
            remedy="Give --motions",
        )
    check_thresholds(threshold)
    if metric not in list(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    if ellipses is not None:
        return _of_fraction(_read(ellipses, f, xi, threshold, Metric(metric), window), alpha, ellipses)
    thresholds = tuple(threshold or (FIVE_PERCENT,))
    if results is not None:
        traced = _stored(results, f, xi, thresholds, Metric(metric), window or _RECORD)
        return _of_fraction(traced, alpha, results)
    if structure is not None:
        excluded: dict[str, object] = {"--f": f, "--xi": xi, "--alpha": alpha, "--model": model}
        return _of_frame(structure, motions or [], sets, thresholds, metric, window or _RECORD, excluded)
    suite = load_motions(*(motions or []), sets=sets)
    with progress_bar("Reading spectra" if first_order else "Tracing boundaries") as progress:
        return api.ellipses(
            suite,
            f=f,
            xi=xi,
            threshold=thresholds,
            metric=[metric],
            window=window or _RECORD,
            alpha=_WHOLE if alpha is None else alpha,
            model=model,
            first_order=first_order,
            progress=progress,
        )


def _of_frame(
    path: Path,
    motions: list[str],
    sets: list[str] | None,
    thresholds: tuple[float, ...],
    metric: str,
    window: str,
    excluded: dict[str, object],
) -> "xr.Dataset":
    """Trace the boundaries of a frame under records."""
    from reliab.indices.window import Window
    from reliab.loop.partition.frame_file import read_frame
    from reliab.motions import load_motions
    from reliab.sweep.frame_table import FrameRequest, trace_frame_ellipses
    from reliab.vocabulary import Metric

    given = [name for name, value in excluded.items() if value is not None]
    if given:
        raise InputError(
            "A description of a frame says its frequencies, damping ratios and shares itself",
            value=f"--structure with {', '.join(given)}",
            remedy="Leave them out",
        )
    request = FrameRequest(
        frame=read_frame(path), thresholds=thresholds, metrics=(Metric(metric),), window=Window.parse(window)
    )
    suite = load_motions(*motions, sets=sets)
    with progress_bar("Tracing boundaries") as progress:
        return trace_frame_ellipses(suite, request, progress=progress)


def check_thresholds(threshold: list[float] | None) -> None:
    """Refuse errors that are not positive and finite.

    Parameters
    ----------
    threshold : list of float or None
        Errors on the boundary [-].

    Raises
    ------
    InputError
        If one is zero, negative or not finite.
    """
    for error in threshold or []:
        if not 0.0 < error < math.inf:
            raise InputError(
                "The error threshold must be positive and finite",
                value=f"--threshold {error:g}",
                remedy="Give a fraction, 0.05 for 5 %",
            )


def _read(
    path: Path,
    f: list[float] | None,
    xi: list[float] | None,
    threshold: list[float] | None,
    metric: "Metric",
    window: str | None,
) -> "xr.Dataset":
    from reliab.criterion import read_ellipses
    from reliab.shipped import or_shipped
    from reliab.sweep import open_ellipses

    path = or_shipped(path, "datasets", "ellipses.nc")
    if path.suffix == ".nc":
        return _among(open_ellipses(path, window=window), f, xi)
    if window is not None:
        raise InputError(
            "A table of ellipses in CSV does not know over which window its errors were computed",
            value=f"--window {window}",
            remedy="Leave it out, or give --motions, --results or a file of ellipses in NetCDF",
        )
    dataset = read_ellipses(path)
    for name, wanted in (("f", f), ("xi", xi), ("threshold", threshold), ("metric", [str(metric)])):
        _require_column(dataset, name, wanted, path)
    return _among(dataset, f, xi)


def _require_column(
    dataset: "xr.Dataset", name: str, wanted: "list[float] | list[str] | None", path: Path
) -> None:
    """Refuse to relabel a table that is of one structure and error."""
    import numpy as np

    held = dataset[name].values
    numeric = held.dtype.kind == "f"
    for value in wanted or []:
        known = np.isclose(held, value, rtol=1e-9).any() if numeric else value in held.tolist()
        if not known and held.size == 1:
            raise InputError(
                f"A table of ellipses answers for the {name} for which they were traced, and for no other",
                value=f"{value} for {path.name}, whose {name} is {held[0]}",
                remedy=(
                    f"Leave --{name} out, or add the column {name} to the table if its "
                    f"ellipses are of another"
                ),
                where=str(path),
            )


def _of_fraction(dataset: "xr.Dataset", alpha: float | None, path: Path) -> "xr.Dataset":
    """Refuse another experimental fraction than that of the stored boundaries."""
    stored = float(dataset.attrs.get("experimental_fraction", _WHOLE))
    if alpha is not None and not math.isclose(alpha, stored, rel_tol=1e-9):
        raise InputError(
            "The experimental fraction is that with which the boundaries were computed",
            value=f"--alpha {alpha:g}, where it is {stored:g}",
            remedy="Leave --alpha out, or give --motions, whose boundaries are computed for any fraction",
            where=str(path),
        )
    return dataset


def _stored(
    path: Path,
    f: list[float] | None,
    xi: list[float] | None,
    thresholds: tuple[float, ...],
    metric: "Metric",
    window: str,
) -> "xr.Dataset":
    from reliab.shipped import or_shipped
    from reliab.sweep import open_results

    chosen = _among(open_results(or_shipped(path, "datasets", "results.nc"), window=window), f, xi)
    with progress_bar("Tracing boundaries") as progress:
        traced: xr.Dataset = chosen.reliab.ellipses(thresholds, (metric,), progress=progress)
    return traced


def _among(dataset: "xr.Dataset", f: list[float] | None, xi: list[float] | None) -> "xr.Dataset":
    """Keep the structures that are asked for, or all where one of them lies between those that are there."""
    import numpy as np

    for name, wanted in (("f", f), ("xi", xi)):
        held = dataset[name].values
        if wanted and all(np.isclose(held, value, rtol=1e-9).any() for value in wanted):
            dataset = dataset.sel({name: wanted}, method="nearest")
    return dataset
