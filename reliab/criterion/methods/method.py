"""What a stated confidence can mean: the interface of every method."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar, cast

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import CurveName
from reliab.criterion.population import SampleGrid
from reliab.sampling.posterior_sample import PosteriorSample


class Learned(ABC):
    """What a method has learned from the motions of a grid of structures."""

    grid: SampleGrid  # The motions

    @abstractmethod
    def limits(self, confidence: float, *, joint: bool) -> Array:
        """Limits of every structure.

        Returns (F, X, 2).
        """

    @property
    def sampled(self) -> PosteriorSample | None:
        """Draws of a posterior; None for a method that samples none."""
        return None

    @property
    def diagnostics(self) -> Mapping[str, Any] | None:
        """Convergence of a sampled posterior, ready for JSON; None for a method that samples none."""
        return None

    @property
    def settings(self) -> Mapping[str, Any]:
        """What was learned with, beside the method's own settings."""
        return {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Plain sentences that a user should know."""
        return ()

    def warn_unless_converged(self) -> None:
        """Warn by a `ConvergenceWarning` if a posterior cannot be relied on."""
        if self.sampled is not None:
            self.sampled.warn_unless_converged()


class Method(ABC):
    """What a confidence over ground motions means, and how limits follow from the motions.

    A criterion is safe when it is small: at a confidence of 95 % it is a bound that 95 % of the
    motions exceed, the paper's 5 % quantile. How this is meant is the method's definition.
    """

    name: ClassVar[str]  # How the method is called on the command line
    meaning: ClassVar[str]  # What a confidence stated by the method means, as the end of a sentence
    exchangeable: ClassVar[str]  # What has to be interchangeable for the method to keep its promise
    # Which ellipses it rests on: those inscribed in the boundaries, or the paper's, fitted to them
    curve: ClassVar[str] = CurveName.INSCRIBED
    # Whether a and b hold together unless one says otherwise; in the paper each holds for itself
    joint_by_default: ClassVar[bool] = True
    # Whether the promise needs no shape of the distribution over motions, or needs the lognormal one
    distribution_free: ClassVar[bool] = False
    lognormal: ClassVar[bool] = False
    # Whether it samples a posterior whose chains can be kept in a file
    samples_chains: ClassVar[bool] = False

    @property
    def assumes_lognormality(self) -> bool:
        """Whether the promise needs lognormal motions."""
        return self.lognormal

    @property
    def settings(self) -> dict[str, Any]:
        """Parameters of the method, ready for JSON."""
        return asdict(cast("Any", self))

    def carried_confidence(self, n_motions: int, n_events: int) -> float:
        """Highest confidence that so many motions can support; beyond it a criterion accepts nothing.

        The lowest value under K earthquakes is exceeded with the probability K/(K + 1), whatever the
        distribution. Beyond that a fitted distribution has to describe the tail. It does so down to an
        exceedance of
        about (2/(K + 1))²: in simulations with normal, skewed and heavy-tailed motions (one to three from
        each earthquake, a and b together) the true exceedance there is about 1.1 to 2.5 times the stated
        one, and the ratio grows further beyond it. One earthquake supports no confidence, since it does not
        show how earthquakes differ.

        >>> from reliab.criterion.methods.dirichlet import Dirichlet
        >>> [round(Dirichlet().carried_confidence(3 * events, events), 3) for events in (1, 3, 8, 19)]
        [0.0, 0.75, 0.951, 0.99]
        """
        del n_motions
        return 1.0 - (2.0 / (n_events + 1.0)) ** 2

    def carries(self, confidence: float, n_motions: int, n_events: int) -> bool:
        """Whether so many motions and earthquakes support a confidence."""
        return confidence <= self.carried_confidence(n_motions, n_events) * (1.0 + 1e-12)

    def mean_share(self, confidence: float, n_motions: int) -> float:
        """Share of further motions that really exceed the bound, on average, where it falls short by design.

        Returns the stated share, for every method that allows for how few motions there are.
        """
        del n_motions
        return confidence

    @abstractmethod
    def learn(
        self, grid: SampleGrid, *, law: str, chains: Path | None = None, progress: Progress = silent
    ) -> Learned:
        """Learn from the motions of a grid of structures."""


def checked_share(share: float, what: str) -> float:
    """Return a share between 0 and 1 (both excluded), or say what is wrong with it."""
    if not 0.0 < share < 1.0:
        raise InputError(
            f"The {what} must lie between 0 and 1",
            value=share,
            remedy="Give a fraction, 0.95 for 95 %",
        )
    return float(share)
