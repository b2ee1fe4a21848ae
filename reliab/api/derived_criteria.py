"""Criteria with what they were derived from, and their limits at each structure."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import xarray as xr

from reliab.criterion import (
    Criterion,
    Derivation,
    EllipseTable,
    describe_sample,
    population_of,
    printed_share,
    summarise,
)
from reliab.errors import IncompleteError
from reliab.files import refuse_unwritable, require_ending, written_whole
from reliab.rows import ResultWithRows
from reliab.shipped import shipped
from reliab.significant import percent
from reliab.sweep import open_ellipses


@dataclass(frozen=True, kw_only=True, eq=False)
class Criteria(ResultWithRows):
    """Criteria with what they were derived from.

    Attributes
    ----------
    criteria : tuple of Criterion
        One for each share of the stiffness, error and share of the population's ground motions.
    structures : tuple of (float, float)
        Natural frequency [Hz] and damping ratio [-] of each structure that is asked for.
    ellipses : xarray.Dataset, optional
        Ellipses of the motions; none for a printed law without a source of them.
    derivations : tuple of Derivation
        What was learned, one for each share of the stiffness and error; none for a printed law.
    beside : dict
        What was asked for beside the criteria: `figures`, `comparison`; of frames `frame` and `rig`, of
        several actuators `cross_coupling`, of several shares of the stiffness `share_law`.
    """

    rows_in = "criteria"

    criteria: tuple[Criterion, ...]
    structures: tuple[tuple[float, float], ...]
    ellipses: xr.Dataset | None = None
    derivations: tuple[Derivation, ...] = ()
    beside: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Limits of each criterion at each structure, with the motions behind them."""
        return [
            _row(criterion, self._learned_from(criterion), f, xi)
            for f, xi in self.structures
            for criterion in self.criteria
        ]

    def _learned_from(self, criterion: Criterion) -> EllipseTable | None:
        """Ellipses from which a criterion was learned; None for a printed law."""
        provenance = criterion.provenance
        for derivation in self.derivations:
            ellipses = derivation.ellipses
            of_error = derivation.lag.grid.threshold == criterion.threshold
            if (
                of_error
                and ellipses.share == provenance.experimental_fraction
                and population_of(ellipses) == provenance.population
            ):
                return ellipses
        return None

    @property
    def posteriors(self) -> list[Mapping[str, Any]]:
        """Diagnostics of sampled posteriors, one for each error and side."""
        return [diagnostics for derivation in self.derivations for diagnostics in derivation.diagnostics]

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers with stable keys: `criteria`, the rows, and where there is only one its keys too."""
        posteriors = {"posteriors": self.posteriors} if self.posteriors else {}
        return {
            "criteria": self.rows,
            **(self.rows[0] if len(self.rows) == 1 else {}),
            **posteriors,
            **self.beside,
        }

    def require_converged(self, chains: str | Path | None = None) -> None:
        """Refuse criteria of posteriors that cannot be relied on.

        Parameters
        ----------
        chains : str or pathlib.Path, optional
            The file that kept the chains.

        Raises
        ------
        IncompleteError
            If a posterior has not converged; it says how to go on.
        """
        failed = [posterior for posterior in self.posteriors if not posterior["converged"]]
        if failed:
            complaints = " ".join(sentence for posterior in failed for sentence in posterior["complaints"])
            again = f"`steps={2 * failed[0]['steps']}`"
            how = f"Resume with `chains={chains}` {again}" if chains else f"Give {again}"
            message = (
                f"THE POSTERIOR HAS NOT CONVERGED, and no limit above may be relied on. {complaints} {how}."
            )
            raise IncompleteError(message)


def _row(criterion: Criterion, sample: EllipseTable | None, f: float, xi: float) -> dict[str, Any]:
    """Summarise a criterion at one structure, with its motions where the sample has it."""
    summary = summarise(criterion, f, xi)
    if criterion.population is None:
        summary.update(_kept_by(criterion, summary))
    elif sample is not None and f in sample.at["f"] and xi in sample.at["xi"]:
        summary.update(describe_sample(sample, criterion, f, xi))
    return summary


def _kept_by(criterion: Criterion, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Measure on the real motions that ship with the package how many keep a printed law."""
    real = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"), window=criterion.provenance.window)
    kept = printed_share(criterion, real, summary["f"], summary["xi"])
    sentence = (
        f"Of {kept['n_motions']} real motions, {percent(kept['share'], decimals=0)} have a boundary "
        f"that contains this ellipse at f = {kept['f']:g} Hz and ξ = {kept['xi']:g}, where the paper states "
        f"{percent(criterion.confidence)}. This was measured on the ellipses of datasets/real_suite; "
        "`reliab run validation` measures it for all structures."
    )
    return {"kept_by": kept, "warnings": [sentence, *summary["warnings"]]}


def write_criterion(criterion: Criterion, out: str | Path) -> None:
    """Write a criterion to a file, whole or not at all."""
    require_ending(out, ".json")
    with refuse_unwritable("The criterion's file must be writable", where=out), written_whole(out) as file:
        file.write_text(criterion.to_json(), encoding="utf-8")
