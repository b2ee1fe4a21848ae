"""All structures at once: limits from the posterior of the hierarchical model."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.criterion.methods.method import Method, validate_share
from reliab.criterion.population import SampleGrid

if TYPE_CHECKING:
    from reliab.criterion.methods.hierarchical.fit import HierarchicalFit

_HAS_CURVATURE: Final = {"table": True, "dimensionless": True, "power": False}


@dataclass(frozen=True, kw_only=True)
class HierarchicalMethod(Method):
    """Limits from the posterior of the hierarchical model of all motions, earthquakes and structures.

    Definition, without an assurance: given all these motions at all structures, the probability that a motion
    of a further earthquake contains the ellipse is the stated confidence. The law with its uncertainty,
    events, motions and structures are all drawn anew.

    Definition, with an `assurance`: given the same, the probability is `assurance` that at least the stated
    share of all motions contains the ellipse. This is the Bayesian tolerance bound: the
    (1 − assurance) quantile, over draws of the posterior, of the population's own quantile.

    Unlike the other methods, which take each structure for itself, this one learns all of them together, with
    the law inside (:class:`~reliab.criterion.methods.hierarchical.model.Hierarchical`): it is quadratic in
    ln f and ln ξ for the laws `table` and `dimensionless`, and linear for `power`.
    """

    samples_chains: ClassVar[bool] = True
    robust: ClassVar[bool]

    # Posterior probability of the promise, in (0, 1); predictive limits by default
    assurance: float | None = None
    # Steps of every walker, a multiple of 4; by default as many as a suite of 100 motions needs, doubled up
    # to twice while the run has not converged
    steps: int | None = None

    def __post_init__(self) -> None:
        if self.assurance is not None:
            validate_share(self.assurance, "assurance")

    @property
    def settings(self) -> dict[str, object]:
        """What is promised, ready for JSON."""
        return {"robust": self.robust, "assurance": self.assurance}

    def learn(
        self, grid: SampleGrid, *, law: str, chains: Path | None = None, progress: Progress = silent
    ) -> "HierarchicalFit":
        """Sample the posterior; see :meth:`Method.learn`."""
        from reliab.criterion.methods.hierarchical.fit import fit_hierarchical

        if law not in _HAS_CURVATURE:
            raise InputError(
                "The hierarchical methods do not take this law",
                value=law,
                remedy=f"Choose among {', '.join(_HAS_CURVATURE)}",
            )
        return fit_hierarchical(
            grid,
            method=self.name,
            assurance=self.assurance,
            steps=self.steps,
            has_curvature=_HAS_CURVATURE[law],
            robust=self.robust,
            chains=chains,
            progress=progress,
        )


@dataclass(frozen=True, kw_only=True)
class HierarchicalNormal(HierarchicalMethod):
    """Motions are normal about their earthquakes; see :class:`HierarchicalMethod`.

    >>> HierarchicalNormal(assurance=0.9).settings
    {'robust': False, 'assurance': 0.9}
    """

    name: ClassVar[str] = "hierarchical"
    meaning: ClassVar[str] = (
        "the posterior of a hierarchical model of earthquakes, motions and structures together: "
        "predictive, or with the stated assurance"
    )
    robust: ClassVar[bool] = False
    lognormal: ClassVar[bool] = True


@dataclass(frozen=True, kw_only=True)
class HierarchicalRobust(HierarchicalMethod):
    """Motions are Student-t about their earthquakes, so that outlying records count less.

    See :class:`HierarchicalMethod`.
    """

    name: ClassVar[str] = "hierarchical_robust"
    meaning: ClassVar[str] = (
        "the posterior of a hierarchical model of earthquakes, motions and structures together, in which "
        "outlying motions count less: predictive, or with the stated assurance"
    )
    robust: ClassVar[bool] = True
