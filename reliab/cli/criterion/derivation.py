"""Criteria that `reliab criterion` derives from ellipses."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from reliab.cli.criterion.answer import check_one
from reliab.cli.criterion.demand import Demand
from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion, Derivation

_NINETY_FIVE = 0.95


@dataclass(frozen=True, kw_only=True)
class Derived:
    """Criteria with what they were derived from."""

    criteria: "list[Criterion]"  # One for each share of the stiffness, error and share of ground motions
    dataset: "xr.Dataset | None"  # The ellipses; None for a printed law without a source of them
    # What was learned, one for each share of the stiffness and error; none for a printed law
    derivations: "list[Derivation]"

    @property
    def posteriors(self) -> list[Mapping[str, Any]]:
        """Diagnostics of sampled posteriors, one for each error and side."""
        return [diagnostics for derivation in self.derivations for diagnostics in derivation.diagnostics]


def derived(demand: Demand) -> Derived:
    """Derive a criterion for each share of the stiffness, error and share of ground motions.

    What is learned at an error serves all shares.
    """
    from reliab.criterion import Derivation
    from reliab.criterion.laws import FITTED, known
    from reliab.criterion.methods import RECOMMENDED, method_of
    from reliab.sweep import at_share, shares_of

    law = known(FITTED, demand.law)
    method = method_of(demand.method or RECOMMENDED, **demand.settings)
    if demand.chains is not None and not method.samples_chains:
        raise InputError(
            "Only the hierarchical methods sample chains",
            value=f"--chains with {method.name}",
            remedy="Leave it out, or choose a hierarchical --method",
        )
    dataset = demand.dataset()
    errors = demand.threshold or _default_thresholds(dataset)
    promises = list(itertools.product(errors, demand.confidence or [_NINETY_FIVE]))
    shares = shares_of(dataset)
    _check_of_one_share(demand, shares)
    check_one(len(shares) * len(promises), demand.out)
    derivations: dict[tuple[float, float], Derivation] = {}
    for share, threshold in itertools.product(shares, dict.fromkeys(errors)):
        with progress_bar(f"Learning at {threshold:g}") as progress:
            derivations[share, threshold] = Derivation.of(
                at_share(dataset, share),
                method=method,
                law=law,
                threshold=threshold,
                metric=demand.metric,
                chains=demand.chains,
                progress=progress,
            )
    criteria = [
        derivations[share, error].criterion(confidence, joint=demand.joint)
        for share in shares
        for error, confidence in promises
    ]
    return Derived(criteria=criteria, dataset=dataset, derivations=list(derivations.values()))


def _check_of_one_share(demand: Demand, shares: tuple[float, ...]) -> None:
    """Refuse options that are of one share of the stiffness where there are several."""
    given = {"--figures": demand.figures, "--compare": demand.compare or None, "--chains": demand.chains}
    unserved = [name for name, value in given.items() if value is not None]
    if len(shares) > 1 and unserved:
        raise InputError(
            f"{' and '.join(unserved)} are of one share of the stiffness",
            value=f"α = {', '.join(f'{share:g}' for share in shares)}",
            remedy="Give one --alpha, or leave them out",
        )


def _default_thresholds(dataset: "xr.Dataset") -> list[float]:
    """Return 5 % where the ellipses hold it, else all their thresholds."""
    stored: list[float] = dataset["threshold"].values.tolist()
    return [FIVE_PERCENT] if FIVE_PERCENT in stored else stored
