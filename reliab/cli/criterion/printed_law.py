"""Criteria of printed laws, as `reliab criterion --law guo_2017_…` asks for them."""

from typing import TYPE_CHECKING

from reliab.cli.criterion.demand import Demand
from reliab.cli.criterion.derivation import Derived
from reliab.errors import InputError

if TYPE_CHECKING:
    from reliab.criterion import Criterion


def printed(demand: Demand) -> Derived:
    """Take the criterion of a printed law, with the ellipses beside which it is shown."""
    criterion = _criterion(demand)
    _check_source(demand)
    dataset = demand.dataset() if demand.has_source else None
    return Derived(criteria=[criterion], dataset=dataset, derivations=[])


def _criterion(demand: Demand) -> "Criterion":
    """Take the law, which promises one thing only."""
    from reliab.criterion import published_criterion

    criterion = published_criterion(demand.law)
    for error in demand.threshold or [criterion.threshold]:
        criterion.law.validity.require_error(error, demand.metric)
    strange = [
        f"--confidence {share:g}" for share in demand.confidence or [] if share != criterion.confidence
    ]
    strange += ["--joint"] if demand.joint else []
    strange += [f"--method {demand.method}"] if demand.method not in {None, criterion.method} else []
    settings = {**demand.settings, "chains": demand.chains}
    strange += [f"--{name} {value}" for name, value in settings.items() if value is not None]
    if strange:
        raise InputError(
            f"A printed law states only {criterion.confidence:.0%}, by the quantile of each limit",
            value=", ".join(strange),
            remedy="Leave these out, or derive a criterion from ellipses",
        )
    return criterion


def _check_source(demand: Demand) -> None:
    """Refuse a source of motions, or options of one, that the law would not use."""
    drawn = demand.figures is not None or demand.compare
    options = {
        "--sets": demand.sets,
        "--model": demand.model,
        "--window": demand.window,
        "--alpha": demand.alpha,
        "--structure": demand.structure,
    }
    if demand.has_source and not drawn:
        raise InputError(
            "A printed law needs no motions",
            value=f"{demand.law} with a source of ellipses",
            remedy="Leave the source out, or give --figures or --compare",
        )
    unused = [name for name, value in options.items() if value is not None]
    if unused and not demand.has_source:
        raise InputError(
            "A printed law is for whole records and a wholly experimental structure, as in the paper",
            value=f"{demand.law} with {', '.join(unused)}",
            remedy="Leave these out, or derive a criterion from ellipses",
        )
