"""What `reliab validate` is asked to judge, by what, and against which errors."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.sources import ellipse_dataset
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.motions import MotionSuite
    from reliab.validation.cross_validation import Candidate, Fold, Truth

DEFAULT_SCHEME: Final = "leave_one_event_out"
"""How earthquakes are divided where nothing is said."""

_CONFIDENCES = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
_REAL = "real_suite"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """Options that choose between ways to judge; None where they are not given.

    Parameters
    ----------
    scheme, leave_out, learn, judge, method, joint, law, confidence, threshold, metric
        As on the command line.
    """

    scheme: str | None
    leave_out: str | None
    learn: list[str] | None
    judge: list[str] | None
    method: list[str] | None
    joint: bool | None
    law: list[str] | None
    confidence: list[float] | None
    threshold: float
    metric: str

    @property
    def confidences(self) -> list[float]:
        """Stated shares of the motions, each once."""
        return list(dict.fromkeys(self.confidence or _CONFIDENCES))


def truth_of(
    dataset: "xr.Dataset",
    motions: list[str] | None,
    sets: list[str] | None,
    results: Path | None,
    ellipses: Path | None,
) -> "Truth":
    """Choose where true errors come from: the loop, stored results, or ellipses where nothing else is there.

    Parameters
    ----------
    dataset : xarray.Dataset
        Ellipses of the motions that are judged.
    motions, sets : list of str or None
        Their sources and sets.
    results, ellipses : pathlib.Path or None
        Stored results or ellipses that were given instead.

    Returns
    -------
    Truth
        The errors.
    """
    from reliab.validation.cross_validation import EllipseTruth, SimulatedTruth, StoredTruth

    if motions is not None:
        from reliab.indices.window import Window as Stretch
        from reliab.motions import load_motions

        return SimulatedTruth(
            motions=list(load_motions(*motions, sets=sets)),
            window=Stretch.parse(str(dataset.attrs["window"])),
            experimental_fraction=float(dataset.attrs["experimental_fraction"]),
        )
    from reliab.shipped import or_shipped
    from reliab.sweep import open_results

    stored = results or (ellipses if str(ellipses) == _REAL else None)
    if stored is None:
        return EllipseTruth(dataset)
    window = str(dataset.attrs.get("window", "record"))
    return StoredTruth(open_results(or_shipped(stored, "datasets", "results.nc"), window=window))


def folds_of(
    dataset: "xr.Dataset", asked: Asked, motions: list[str] | None, sets: list[str] | None
) -> "tuple[list[Fold], str, xr.Dataset | None, int]":
    """Divide the motions into those that are learned from and those that are judged.

    Parameters
    ----------
    dataset : xarray.Dataset
        Ellipses of the motions.
    asked : Asked
        How they are to be divided.
    motions, sets : list of str or None
        Sources and sets of the motions.

    Returns
    -------
    folds : list of Fold
        The divisions.
    name : str
        What they are called.
    learn_from : xarray.Dataset or None
        Ellipses of another suite that is learned from.
    recognised : int
        Motions whose earthquake that suite holds too.
    """
    import numpy as np

    from reliab.validation.cross_validation import folds_of as folds_of_scheme
    from reliab.validation.cross_validation import from_another, leave_structures_out, transfer

    learn_from, recognised = None, 0
    if asked.learn == [_REAL]:
        from reliab.validation.earthquakes import earthquakes_among

        learn_from = _shipped_ellipses(dataset, asked)
        events, checksums = (dataset[name].values.tolist() for name in ("event", "checksum"))
        among = earthquakes_among(events, checksums, learn_from)
        recognised = sum(name is not None for name in among)
        folds, name = list(from_another(among, learn_from["event"].values)), f"learned from {_REAL}"
    elif asked.learn or asked.judge:
        suite = _suite_of_sets(motions, sets, asked)
        events = dataset["event"].values
        learned, judged = asked.learn or [], asked.judge or []
        folds = list(transfer(np.array(suite.set_names), events, learned=learned, judged=judged))
        name = f"learned from {', '.join(learned)}, judged on {', '.join(judged)}"
    else:
        name = asked.scheme or DEFAULT_SCHEME
        folds = folds_of_scheme(name, dataset["event"].values)
    if asked.leave_out is None:
        return folds, name, learn_from, recognised
    if asked.leave_out not in {"f", "xi"}:
        raise InputError("What is left out is f or xi", value=asked.leave_out, remedy="Choose one of these")
    values = dataset[asked.leave_out].values.tolist()
    left_out = list(leave_structures_out(folds, asked.leave_out, values))
    return left_out, f"{name}, each {asked.leave_out} left out", learn_from, recognised


def _suite_of_sets(motions: list[str] | None, sets: list[str] | None, asked: Asked) -> "MotionSuite":
    if not (asked.learn and asked.judge and motions):
        raise InputError(
            "To judge sets by others, --motions, --learn and --judge are needed",
            value="only some of them",
            remedy=f"Give all three, for example --learn far_field --judge near_field, or --learn {_REAL}",
        )
    from reliab.motions import load_motions

    return load_motions(*motions, sets=sets)


def _shipped_ellipses(dataset: "xr.Dataset", asked: Asked) -> "xr.Dataset":
    """Shipped ellipses of the structures and the error that are asked for."""
    if asked.judge:
        raise InputError(
            f"--learn {_REAL} judges all motions that are given",
            value=f"--judge {' '.join(asked.judge)}",
            remedy="Leave --judge out, or choose among the motions with --sets",
        )
    structures = {name: dataset[name].values.tolist() for name in ("f", "xi")}
    return ellipse_dataset(
        motions=None,
        sets=None,
        results=None,
        ellipses=Path(_REAL),
        **structures,
        threshold=[asked.threshold],
        metric=asked.metric,
        window=str(dataset.attrs["window"]),
        alpha=float(dataset.attrs["experimental_fraction"]),
    )


def candidates_of(asked: Asked) -> "list[Candidate]":
    """Make the criteria that are judged.

    Parameters
    ----------
    asked : Asked
        Methods, laws, and what they are asked to state.

    Returns
    -------
    list of Candidate
        The criteria.

    Raises
    ------
    InputError
        If a name is not known, or an option has no effect on the laws that are asked for.
    """
    from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, known
    from reliab.criterion.methods import RECOMMENDED, method_of
    from reliab.validation.cross_validation import Derived, Printed

    printed = (asked.threshold, asked.metric) == (FIVE_PERCENT, "rms")
    laws = asked.law or ["table", *(("guo_2017_15", "guo_2017_18") if printed else ())]
    candidates: list[Candidate] = []
    for name in laws:
        if name in OF_MANY_MOTIONS:
            law = OF_MANY_MOTIONS[name]
            law.validity.require_error(asked.threshold, asked.metric)
            candidate = Printed(name=name, law=law)
            if asked.law and not any(candidate.promises(confidence) for confidence in asked.confidences):
                raise InputError(
                    f"The law {name} states {candidate.confidence:.0%}",
                    value=", ".join(f"{confidence:g}" for confidence in asked.confidences),
                    remedy=f"Ask for --confidence {candidate.confidence:g}, or leave the law out",
                )
            candidates.append(candidate)
            continue
        fitted = known(FITTED, name)
        for method in asked.method or [RECOMMENDED]:
            label = method if name == "table" else f"{method}, {name}"
            candidates.append(Derived(name=label, method=method_of(method), joint=asked.joint, law=fitted))
    idle = "--method" if asked.method else "--joint/--each" if asked.joint is not None else ""
    if idle and not any(isinstance(candidate, Derived) for candidate in candidates):
        raise InputError(
            f"{idle} has no effect on laws that are printed", value=", ".join(laws), remedy="Leave it out"
        )
    return candidates
