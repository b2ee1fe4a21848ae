"""What `reliab criterion` is asked for, checked, and derived from ellipses."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion
    from reliab.criterion.derivation import Derivation
    from reliab.criterion.laws import FittedLaw
    from reliab.criterion.methods import Method

_NINETY_FIVE = 0.95


def check_files(method: "Method | None", chains: Path | None, figures: Path | None) -> None:
    """Refuse files that cannot be used, before anything long is begun.

    Parameters
    ----------
    method : Method or None
        What the confidence means; None for a printed law.
    chains, figures : pathlib.Path or None
        File of the chains and folder of the figures.

    Raises
    ------
    InputError
        If the method samples no chains, or the folder is a file.
    """
    if chains is not None and method is not None and not method.samples_chains:
        raise InputError(
            "Only the hierarchical methods sample chains",
            value=f"--chains with {method.name}",
            remedy="Leave it out, or choose --method hierarchical or hierarchical_robust",
        )
    if figures is not None and figures.exists() and not figures.is_dir():
        raise InputError("Figures go into a folder", value=figures, remedy="Name another folder")


def promises_of(
    dataset: "xr.Dataset", threshold: list[float] | None, confidence: list[float] | None
) -> list[tuple[float, float]]:
    """Pair errors with shares of ground motions.

    Parameters
    ----------
    dataset : xarray.Dataset
        The ellipses.
    threshold, confidence : list of float or None
        As given as options.

    Returns
    -------
    list of (float, float)
        Every error [-] with every share [-].
    """
    errors = threshold or _default_thresholds(dataset)
    return [(error, share) for error in errors for share in confidence or [_NINETY_FIVE]]


def derive(
    dataset: "xr.Dataset",
    promises: Sequence[tuple[float, float]],
    metric: str,
    method: "Method",
    law: "FittedLaw",
    chains: Path | None,
    *,
    joint: bool | None,
) -> "tuple[list[Criterion], list[Derivation]]":
    """Derive a criterion for each promise; what is learned at one error serves all its confidences.

    Parameters
    ----------
    dataset : xarray.Dataset
        The ellipses.
    promises : sequence of (float, float)
        Errors and shares of ground motions [-].
    metric : str
        Which error.
    method : Method
        What the confidence means.
    law : type of Law
        How limits depend on the structure.
    chains : pathlib.Path or None
        File of the chains.
    joint : bool or None
        Whether a and b hold together; None leaves it to the method.

    Returns
    -------
    criteria : list of Criterion
        One for each promise.
    derivations : list of Derivation
        One for each error.
    """
    from reliab.criterion.derivation import Derivation

    derivations: dict[float, Derivation] = {}
    for threshold, _ in promises:
        if threshold not in derivations:
            with progress_bar(f"Learning at {threshold:g}") as progress:
                derivations[threshold] = Derivation.of(
                    dataset,
                    method=method,
                    law=law,
                    threshold=threshold,
                    metric=metric,
                    chains=chains,
                    progress=progress,
                )
    criteria = [derivations[threshold].criterion(share, joint=joint) for threshold, share in promises]
    return criteria, list(derivations.values())


def printed_criterion(
    law: str,
    threshold: list[float] | None,
    confidence: list[float] | None,
    metric: str,
    method: str | None,
    settings: Mapping[str, object],
    *,
    joint: bool | None,
) -> "Criterion":
    """Take a printed law, which promises one thing only.

    Parameters
    ----------
    law : str
        Its name.
    threshold, confidence, metric, method, joint
        As given as options.
    settings : mapping
        Options of methods by their names, None where not given.

    Returns
    -------
    Criterion
        The law's.

    Raises
    ------
    InputError
        If something else is asked of it.
    """
    from reliab.criterion import published_criterion

    criterion = published_criterion(law)
    for error in threshold or [criterion.threshold]:
        criterion.law.validity.require_error(error, metric)
    strange = [f"--confidence {share:g}" for share in confidence or [] if share != criterion.confidence]
    strange += ["--joint"] if joint else []
    strange += [f"--method {method}"] if method not in {None, criterion.method} else []
    strange += [f"--{name} {value}" for name, value in settings.items() if value is not None]
    if strange:
        raise InputError(
            f"A printed law states {criterion.confidence:.0%} by the quantile of each limit, and "
            f"nothing else",
            value=", ".join(strange),
            remedy="Leave these out, or derive a criterion from ellipses",
        )
    return criterion


def check_printed_source(law: str, options: Mapping[str, object], *, given: bool, drawn: bool) -> None:
    """Refuse a source of motions, or options of one, that a printed law would not use.

    Parameters
    ----------
    law : str
        The law.
    options : mapping
        Options of sources by their names, None where not given.
    given : bool
        Whether a source is given.
    drawn : bool
        Whether figures or a comparison are asked for, which need one.

    Raises
    ------
    InputError
        If so.
    """
    if given and not drawn:
        raise InputError(
            "A printed law needs no motions",
            value=f"{law} with a source of ellipses",
            remedy="Leave the source out, or give --figures or --compare",
        )
    unused = [name for name, value in options.items() if value is not None]
    if unused and not given:
        raise InputError(
            "A printed law is for whole records and a wholly experimental structure, as in the paper",
            value=f"{law} with {', '.join(unused)}",
            remedy="Leave these out, or derive a criterion from ellipses",
        )


def check_room(dataset: "xr.Dataset") -> None:
    """Refuse motions under which a model's effects alone exceed the error.

    Parameters
    ----------
    dataset : xarray.Dataset
        The ellipses.

    Raises
    ------
    InputError
        If there are such motions.
    """
    full = (dataset["a"] == 0.0) & (dataset["b"] == 0.0)
    if full.any():
        motions = full.any([name for name in full.dims if name != "motion"])
        raise InputError(
            "The effects of the model must leave room for errors of the actuator",
            value=f"none under {int(motions.sum())} of {motions.size} motions, even for a perfect actuator",
            remedy="Remove or compensate the effects, or allow a larger error by --threshold",
        )


def _default_thresholds(dataset: "xr.Dataset") -> list[float]:
    """Take 5 % where it is there, or all that is."""
    stored: list[float] = dataset["threshold"].values.tolist()
    return [FIVE_PERCENT] if FIVE_PERCENT in stored else stored
