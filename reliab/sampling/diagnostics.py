"""Whether a run has converged: R-hat, effective sample sizes, autocorrelation time."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.arrays import Array

LARGEST_R_HAT: Final = 1.01
LEAST_EFFECTIVE_SIZE: Final = 1000
FEWEST_ENSEMBLES: Final = 4
_TAIL: Final = (0.05, 0.95)


class ConvergenceWarning(UserWarning):
    """A posterior was sampled too briefly to be relied on."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnostics:
    """Convergence of each parameter."""

    names: tuple[str, ...]  # Parameters
    r_hat: Array  # Rank-normalised split R-hat over both halves of all ensembles
    # bulk_size, tail_size: Effective number of independent draws for the centre and for the 5 % and 95 %
    # quantiles
    bulk_size: Array
    tail_size: Array
    autocorrelation_time: Array  # Integrated autocorrelation time [steps]
    ensembles: int  # Number of independent ensembles

    @property
    def complaints(self) -> tuple[str, ...]:
        """Reasons against convergence, in plain sentences; none where the run has converged."""
        smallest = np.minimum(self.bulk_size, self.tail_size)
        worst, least = int(np.argmax(self.r_hat)), int(np.argmin(smallest))
        sentences = (
            (
                not self.r_hat.max() < LARGEST_R_HAT,
                f"R-hat of {self.names[worst]} is {self.r_hat[worst]:.3f}, not below {LARGEST_R_HAT}.",
            ),
            (
                not smallest.min() > LEAST_EFFECTIVE_SIZE,
                f"{self.names[least]} has {smallest[least]:.0f} effective draws, not {LEAST_EFFECTIVE_SIZE}.",
            ),
            (
                self.ensembles < FEWEST_ENSEMBLES,
                f"Only {self.ensembles} independent ensembles were run, not {FEWEST_ENSEMBLES}.",
            ),
        )
        return tuple(sentence for wrong, sentence in sentences if wrong)

    @property
    def converged(self) -> bool:
        """Whether R-hat < 1.01 and both effective sizes > 1,000 for every parameter."""
        return not self.complaints


def diagnose(draws: Array, names: tuple[str, ...], thin: int) -> Diagnostics:
    """Diagnose the kept draws of several ensembles.

    Walkers of one ensemble learn from each other, so that R-hat compares ensembles and not walkers: the
    earlier and the later half of each ensemble count as one chain each, which shows an ensemble that has
    settled elsewhere and one that still drifts. In the effective sizes every walker counts as a chain, so
    that walkers that are stuck show too.

    `draws`: without the beginning that is left out; `thin`: steps from one draw to the next.

    >>> draws = np.random.default_rng(1).normal(size=(4, 500, 8, 1))
    >>> diagnose(draws, ("mean",), 1).converged
    True
    """
    from arviz_stats.base import array_stats
    from emcee.autocorr import integrated_time

    ensembles, count, walkers, dimensions = draws.shape
    half = count // 2
    halves = draws[:, : 2 * half].reshape(2 * ensembles, half, walkers, dimensions)
    chains = draws.transpose(0, 2, 1, 3).reshape(ensembles * walkers, count, dimensions)
    axes = {"chain_axis": 0, "draw_axis": 1}
    with np.errstate(all="ignore"):
        r_hat = array_stats.rhat(walkers_in_turn(halves), **axes)
        bulk_size = array_stats.ess(chains, **axes)
        tail_size = array_stats.ess(chains, **axes, method="tail", prob=_TAIL)
        times = [integrated_time(ensemble, tol=0, quiet=True) for ensemble in draws]
    return Diagnostics(
        names=names,
        r_hat=r_hat,
        bulk_size=bulk_size,
        tail_size=tail_size,
        autocorrelation_time=thin * np.mean(times, axis=0),
        ensembles=ensembles,
    )


def walkers_in_turn(draws: Array) -> Array:
    """Put the walkers of each ensemble one after the other.

    Returns one chain for each ensemble.
    """
    return draws.transpose(0, 2, 1, 3).reshape(draws.shape[0], -1, draws.shape[-1])
