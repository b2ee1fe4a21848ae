"""Criteria that are put to the test: derived anew in each fold, or printed once and for all."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import xarray as xr

from reliab.criterion import derive_criterion
from reliab.criterion.laws import FittedLaw, Law, Table
from reliab.criterion.methods import Method


@dataclass(frozen=True, kw_only=True)
class Candidate(ABC):
    """A way to arrive at the limits a and b.

    Parameters
    ----------
    name : str
        What it is called in tables.
    """

    name: str

    def promises(self, confidence: float) -> bool:
        """Whether it claims to hold for a share of the motions."""
        del confidence
        return True

    @abstractmethod
    def learn(self, ellipses: xr.Dataset, threshold: float, metric: str, confidence: float) -> Law:
        """Limits for structures.

        Parameters
        ----------
        ellipses : xarray.Dataset
            Ellipses that may be learned from.
        threshold : float
            Error on the boundary [-].
        metric : str
            Which error.
        confidence : float
            Nominal share of the motions.

        Returns
        -------
        Law
            Limits a [-] and b [ms²] of structures, with the range in which they hold.
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

    def learn(self, ellipses: xr.Dataset, threshold: float, metric: str, confidence: float) -> Law:
        """Derive the criterion of all structures."""
        return derive_criterion(
            ellipses,
            method=self.method,
            joint=self.joint,
            law=self.law,
            threshold=threshold,
            metric=metric,
            confidence=confidence,
        ).law


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

    def promises(self, confidence: float) -> bool:
        """Whether this is the stated share."""
        return math.isclose(confidence, self.confidence)

    def learn(self, ellipses: xr.Dataset, threshold: float, metric: str, confidence: float) -> Law:
        """Return the law."""
        del ellipses, threshold, metric, confidence
        return self.law
