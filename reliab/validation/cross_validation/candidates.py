"""Criteria that are put to the test: derived anew in each fold, or printed once and for all."""

import math
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from reliab.criterion import derive_criterion
from reliab.criterion.laws import FittedLaw, Law, Table
from reliab.criterion.methods import Method
from reliab.errors import InputError
from reliab.validation.cross_validation.cell import Cell
from reliab.validation.cross_validation.region import Region


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits that a candidate arrived at, for all structures.

    Parameters
    ----------
    law : Law
        Limits a [-] and b [ms²] of delays.
    """

    law: Law

    def regions(self, cell: Cell) -> list[Region]:
        """List what is accepted of a structure; empty where the law does not hold or promises nothing.

        Parameters
        ----------
        cell : Cell
            The structure.

        Returns
        -------
        list of Region
            One for delays.
        """
        try:
            self.law.validity.require(cell.frequency, cell.damping_ratio)
        except InputError:
            return []
        a, b = (float(limit) for limit in self.law.limits(cell.frequency, cell.damping_ratio))
        return [Region(a=a, b=b)] if a > 0.0 and b > 0.0 else []


@dataclass(frozen=True, kw_only=True)
class Candidate(ABC):
    """A way to arrive at the limits a and b.

    Parameters
    ----------
    name : str
        What it is called in tables.
    """

    name: str

    @abstractmethod
    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Limits for structures.

        Parameters
        ----------
        ellipses : xarray.Dataset
            Ellipses that may be learned from.
        threshold : float
            Error on the boundary [-].
        metric : str
            Which error.
        confidences : sequence of float
            Stated shares of the motions.

        Returns
        -------
        mapping of float to Limits
            Limits by the confidences at which the candidate promises something.
        """


@dataclass(frozen=True, kw_only=True)
class Derived(Candidate):
    """Limits derived from ellipses.

    Parameters
    ----------
    method : Method
        What the confidence means.
    joint : bool, optional
        Whether a and b hold together.
    law : type, optional
        The law that is fitted to the limits of the structures; by default they are kept as they are.
    """

    method: Method
    joint: bool = True
    law: FittedLaw = Table

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Derive the criterion of all structures at each confidence that the motions carry.

        A posterior is sampled once for all confidences.

        Raises
        ------
        InputError
            If the motions carry none of the confidences; the reason at the first.
        """
        learned: dict[float, Limits] = {}
        refusals: list[InputError] = []
        with tempfile.TemporaryDirectory() as folder:
            chains = Path(folder) / "chains.h5" if self.method.samples_chains else None
            for confidence in confidences:
                try:
                    criterion = derive_criterion(
                        ellipses,
                        method=self.method,
                        chains=chains,
                        joint=self.joint,
                        law=self.law,
                        threshold=threshold,
                        metric=metric,
                        confidence=confidence,
                    )
                except InputError as refusal:
                    refusals.append(refusal)
                else:
                    learned[confidence] = Limits(law=criterion.law)
        if refusals and not learned:
            raise refusals[0]
        return learned


@dataclass(frozen=True, kw_only=True)
class Printed(Candidate):
    """Limits that are printed, whatever the motions.

    Parameters
    ----------
    law : Law
        The printed law.
    confidence : float, optional
        The share of the motions for which it is said to hold.
    """

    law: Law
    confidence: float = 0.95

    def learn(
        self, ellipses: xr.Dataset, threshold: float, metric: str, confidences: Sequence[float]
    ) -> Mapping[float, Limits]:
        """Return the law at the confidence that it states."""
        del ellipses, threshold, metric
        stated = [confidence for confidence in confidences if self.promises(confidence)]
        return dict.fromkeys(stated, Limits(law=self.law))

    def promises(self, confidence: float) -> bool:
        """Whether this is the share of the motions that the law states."""
        return math.isclose(confidence, self.confidence)
