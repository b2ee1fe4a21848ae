"""Criteria under test: derived anew in each fold, or fixed as printed."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import xarray as xr

from reliab.core.errors import InputError
from reliab.core.vocabulary import Side
from reliab.criterion.copies import without_copies
from reliab.criterion.derivation import Derivation
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import FittedLaw
from reliab.criterion.laws.table import Table
from reliab.criterion.methods.method import Method
from reliab.validation.cross_validation.cell import Cell, Region


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits that a candidate arrived at, for all structures."""

    law: Law  # Limits a [-] and b [ms²] of actuators that are late
    # The same of actuators that are early; None where the candidate has no limits for leads
    lead_law: Law | None = None

    def regions(self, cell: Cell) -> list[Region]:
        """List the accepted regions of a structure; empty where the law does not hold or has no limits."""
        regions = []
        for side, law in ((Side.LAG, self.law), (Side.LEAD, self.lead_law)):
            if law is None or not _holds(law, cell):
                continue
            a, b = (float(limit) for limit in law.limits(cell.frequency, cell.damping_ratio))
            if a > 0.0 and b > 0.0:
                regions.append(Region(a=a, b=b, side=side))
        return regions


def _holds(law: Law, cell: Cell) -> bool:
    try:
        law.validity.require(cell.frequency, cell.damping_ratio)
    except InputError:
        return False
    return True


@dataclass(frozen=True, kw_only=True)
class Candidate(ABC):
    """A way to derive the limits a and b."""

    name: str  # What it is called in tables

    @abstractmethod
    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Limits for structures.

        `threshold` [-].
        """


@dataclass(frozen=True, kw_only=True)
class Derived(Candidate):
    """Limits derived from ellipses."""

    method: Method  # The method, which defines the meaning of the confidence
    joint: bool | None = None  # Whether a and b hold together; by default as the method means it
    # The law that is fitted to the limits of the structures; by default they are kept as they are
    law: FittedLaw = Table

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Derive the criterion of all structures at each confidence that the motions carry."""
        derivation = Derivation.from_ellipses(
            without_copies(ellipses), method=self.method, law=self.law, threshold=threshold, metric=metric
        )
        learned: dict[float, Limits] = {}
        refusals: list[InputError] = []
        for confidence in confidences:
            try:
                criterion = derivation.criterion(confidence, joint=self.joint)
            except InputError as refusal:
                refusals.append(refusal)
            else:
                learned[confidence] = Limits(law=criterion.law, lead_law=criterion.lead_law)
        derivation.warn_unless_converged()
        if refusals and not learned:
            raise refusals[0]
        return learned


@dataclass(frozen=True, kw_only=True)
class Printed(Candidate):
    """Printed limits, independent of the motions."""

    law: Law  # The printed law
    lead_law: Law | None = None  # Its limits for leads, where it does not count them as lags
    confidence: float = 0.95  # The share of the motions for which it is said to hold

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Return the law at the confidence that it states."""
        del ellipses, threshold, metric
        stated = [confidence for confidence in confidences if self.promises(confidence)]
        return dict.fromkeys(
            stated,
            Limits(law=self.law, lead_law=self.law if self.law.counts_leads_as_lags else self.lead_law),
        )

    def promises(self, confidence: float) -> bool:
        """Whether this is the share of the motions that the law states."""
        return math.isclose(confidence, self.confidence)
