"""What `reliab criterion` is asked for, checked, and derived from ellipses."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion
    from reliab.criterion.bayes.posterior_criterion import HierarchicalFit
    from reliab.criterion.laws import FittedLaw
    from reliab.criterion.methods import HierarchicalPosterior, Method

_NINETY_FIVE = 0.95


def check_files(method: "Method | HierarchicalPosterior", chains: Path | None, figures: Path | None) -> None:
    """Refuse files that cannot be used, before anything long is begun.

    Parameters
    ----------
    method : Method or HierarchicalPosterior
        What the confidence means.
    chains, figures : pathlib.Path or None
        File of the chains and folder of the figures.

    Raises
    ------
    InputError
        If the method samples no chains, or the folder is a file.
    """
    from reliab.criterion.derivation import require_no_chains
    from reliab.criterion.methods import HierarchicalPosterior

    if not isinstance(method, HierarchicalPosterior):
        require_no_chains(chains, method.name)
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
    method: "Method | HierarchicalPosterior",
    law: "FittedLaw",
    chains: Path | None,
    *,
    joint: bool,
) -> "tuple[list[Criterion], list[HierarchicalFit]]":
    """Derive a criterion for each promise; one posterior serves all that share an error.

    Parameters
    ----------
    dataset : xarray.Dataset
        The ellipses.
    promises : sequence of (float, float)
        Errors and shares of ground motions [-].
    metric : str
        Which error.
    method : Method or HierarchicalPosterior
        What the confidence means.
    law : type of Law
        How limits depend on the structure.
    chains : pathlib.Path or None
        File of the chains.
    joint : bool
        Whether a and b hold together.

    Returns
    -------
    criteria : list of Criterion
        One for each promise.
    fits : list of HierarchicalFit
        One for each error, for the hierarchical methods.
    """
    from reliab.criterion import derive_criterion
    from reliab.criterion.methods import HierarchicalPosterior

    if isinstance(method, HierarchicalPosterior):
        thresholds = list(dict.fromkeys(threshold for threshold, _ in promises))
        fits = dict(zip(thresholds, _fits(dataset, method, thresholds, metric, law, chains), strict=True))
        return [fits[error].criterion(share, joint=joint) for error, share in promises], list(fits.values())
    found = [
        derive_criterion(
            dataset,
            threshold=error,
            metric=metric,
            confidence=share,
            method=method,
            joint=joint,
            law=law,
        )
        for error, share in promises
    ]
    return found, []


def printed_criterion(
    law: str,
    threshold: list[float] | None,
    confidence: list[float] | None,
    metric: str,
    method: str,
    *,
    joint: bool,
) -> "Criterion":
    """Take a printed law, which promises one thing only.

    Parameters
    ----------
    law : str
        Its name.
    threshold, confidence, metric, method, joint
        As given as options.

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

    found = published_criterion(law)
    for each in threshold or [found.threshold]:
        found.law.validity.require_error(each, metric)
    others = [each for each in confidence or [] if each != found.confidence]
    if others or method != found.method or joint:
        raise InputError(
            f"A printed law states {found.confidence:.0%} by the quantile of each limit, and nothing else",
            value=f"confidence {others[0]:g}" if others else "--joint" if joint else f"method {method}",
            remedy="Leave these out, or derive a criterion from ellipses",
        )
    return found


def _fits(
    dataset: "xr.Dataset",
    method: "HierarchicalPosterior",
    thresholds: Sequence[float],
    metric: str,
    law: "FittedLaw",
    chains: Path | None,
) -> "list[HierarchicalFit]":
    """Sample one posterior for each error, which serves all confidences."""
    from reliab.criterion.bayes.posterior_criterion import fit_hierarchical

    found = []
    for each in thresholds:
        with progress_bar(f"Sampling the posterior at {each:g}") as progress:
            found.append(
                fit_hierarchical(
                    dataset,
                    method,
                    threshold=each,
                    metric=metric,
                    law=law,
                    chains=chains,
                    progress=progress,
                )
            )
    return found


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
    there: list[float] = dataset["threshold"].values.tolist()
    return [FIVE_PERCENT] if FIVE_PERCENT in there else there
