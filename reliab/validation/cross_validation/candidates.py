"""Criteria that are put to the test: derived anew in each fold, or printed once and for all."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import xarray as xr

from reliab.criterion import derive_criterion
from reliab.criterion.laws import Law
from reliab.criterion.methods import Method


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One structure and one error for which limits are wanted.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -].
    threshold : float
        Error on the boundary [-].
    metric : str
        Which error, "rms" or "mte".
    """

    frequency: float
    damping_ratio: float
    threshold: float
    metric: str


class Candidate(ABC):
    """A way to arrive at the limits a and b."""

    name: str

    @abstractmethod
    def limits(self, ellipses: xr.Dataset, cell: Cell, confidence: float) -> tuple[float, float]:
        """Limits a [-] and b [ms²].

        Parameters
        ----------
        ellipses : xarray.Dataset
            Ellipses of the motions that may be learned from.
        cell : Cell
            Structure and error.
        confidence : float
            Nominal share of the motions.

        Returns
        -------
        tuple of float
            a and b.
        """


@dataclass(frozen=True, kw_only=True)
class Derived(Candidate):
    """Limits derived from the ellipses of the structure itself.

    Parameters
    ----------
    name : str
        What it is called in tables.
    method : Method
        What the confidence means.
    joint : bool, optional
        Whether a and b hold together.
    """

    name: str
    method: Method
    joint: bool = True

    def limits(self, ellipses: xr.Dataset, cell: Cell, confidence: float) -> tuple[float, float]:
        """Derive the criterion of the structure."""
        criterion = derive_criterion(
            ellipses,
            frequency=cell.frequency,
            damping_ratio=cell.damping_ratio,
            threshold=cell.threshold,
            metric=cell.metric,
            confidence=confidence,
            method=self.method,
            joint=self.joint,
        )
        a, b = criterion.limits(cell.frequency, cell.damping_ratio)
        return float(a), float(b)


@dataclass(frozen=True, kw_only=True)
class Printed(Candidate):
    """Limits that are printed, whatever the motions and the confidence.

    Parameters
    ----------
    name : str
        What it is called in tables.
    law : Law
        The printed law.
    """

    name: str
    law: Law

    def limits(self, ellipses: xr.Dataset, cell: Cell, confidence: float) -> tuple[float, float]:
        """Read the law."""
        del ellipses, confidence
        a, b = self.law.limits(cell.frequency, cell.damping_ratio)
        return float(a), float(b)
