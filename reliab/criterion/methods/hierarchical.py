"""All structures at once: limits from the posterior of the hierarchical model."""

from dataclasses import dataclass
from typing import Any, Final

from reliab.criterion.methods.method import checked_share
from reliab.errors import InputError

HIERARCHICAL: Final = {"hierarchical": False, "hierarchical_robust": True}
"""Names of the method, and whether motions are Student-t."""

_CURVED: Final = {"table": True, "dimensionless": True, "power": False}


@dataclass(frozen=True, kw_only=True)
class HierarchicalPosterior:
    """Limits from the posterior of the hierarchical model of all motions, earthquakes and structures.

    Definition, without an assurance: given all these motions at all structures, the probability that a motion
    of a further earthquake contains the ellipse is the stated confidence. The law with its uncertainty,
    events, motions and structures are all drawn anew.

    Definition, with an `assurance`: given the same, the probability is `assurance` that at least the stated
    share of all motions contains the ellipse. This is the Bayesian tolerance bound: the
    (1 − assurance) quantile, over draws of the posterior, of the population's own quantile.

    Unlike the other methods, which take each structure for itself, this one learns all of them together, with
    the law inside (`reliab.criterion.bayes.Hierarchical`): it is quadratic in ln f and ln ξ for the laws
    `table` and `dimensionless`, and linear for `power`.

    Parameters
    ----------
    robust : bool, optional
        Whether motions are Student-t about their earthquakes, and outlying records count less.
    assurance : float, optional
        Posterior probability of the promise, in (0, 1); predictive limits by default.
    steps : int, optional
        Steps of every walker, a multiple of 4; by default as many as a suite of 100 motions needs, doubled
        up to twice while the run has not converged.

    Examples
    --------
    >>> HierarchicalPosterior(robust=True).name
    'hierarchical_robust'
    """

    robust: bool = False
    assurance: float | None = None
    steps: int | None = None

    def __post_init__(self) -> None:
        if self.assurance is not None:
            checked_share(self.assurance, "assurance")

    @property
    def name(self) -> str:
        """How the method is called on the command line."""
        return next(name for name, robust in HIERARCHICAL.items() if robust is self.robust)

    @property
    def settings(self) -> dict[str, Any]:
        """What is promised, ready for JSON."""
        return {"robust": self.robust, "assurance": self.assurance}


def curved_of(law: str) -> bool:
    """Whether the hierarchical model has squares of ln f and ln ξ inside for a law.

    Parameters
    ----------
    law : str
        Name of the law that is asked for.

    Returns
    -------
    bool
        Whether it is curved.

    Raises
    ------
    InputError
        If the model cannot have the law inside.

    Examples
    --------
    >>> curved_of("dimensionless"), curved_of("power")
    (True, False)
    """
    if law not in _CURVED:
        raise InputError(
            "The hierarchical model has a law inside that is linear or quadratic in ln f and ln ξ",
            value=law,
            remedy=f"Choose among {', '.join(_CURVED)}",
        )
    return _CURVED[law]
