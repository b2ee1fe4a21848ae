"""The draws of a run, and whether they can be relied on: R-hat, effective sample sizes, autocorrelation."""

import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.files import written_whole

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

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
    def has_converged(self) -> bool:
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
    >>> diagnose(draws, ("mean",), 1).has_converged
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


@dataclass(frozen=True, kw_only=True, eq=False)
class PosteriorSample:
    """Draws from a posterior, in independent ensembles."""

    names: tuple[str, ...]  # Parameters
    draws: Array  # Draws on the sampled scale, without the first half of the run
    thin: int  # Steps from one draw to the next
    accepted: float  # Share of proposed moves that were taken

    @cached_property
    def diagnostics(self) -> Diagnostics:
        """R-hat, effective sample sizes and autocorrelation time of every parameter."""
        return diagnose(self.draws, self.names, self.thin)

    @property
    def has_converged(self) -> bool:
        """Whether the draws can be relied on."""
        return self.diagnostics.has_converged

    @property
    def flat(self) -> Array:
        """All draws, shape (draws, parameters)."""
        return self.draws.reshape(-1, len(self.names))

    def spread_out(self, count: int) -> Array:
        """Take draws spread evenly over all of them, shape (count or fewer, parameters)."""
        flat = self.flat
        return np.asarray(flat[np.linspace(0, len(flat) - 1, min(count, len(flat))).astype(int)])

    def table(self) -> "pd.DataFrame":
        """Summarise each parameter: mean, spread, 5 %, 50 % and 95 % quantiles and diagnostics."""
        import pandas as pd

        diagnostics = self.diagnostics
        low, middle, high = np.quantile(self.flat, [0.05, 0.5, 0.95], axis=0)
        columns = {
            "mean": self.flat.mean(axis=0),
            "spread": self.flat.std(axis=0),
            "quantile_05": low,
            "median": middle,
            "quantile_95": high,
            "r_hat": diagnostics.r_hat,
            "bulk_size": diagnostics.bulk_size,
            "tail_size": diagnostics.tail_size,
            "autocorrelation_time": diagnostics.autocorrelation_time,
        }
        return pd.DataFrame(columns, index=pd.Index(self.names, name="parameter"))

    def to_datatree(self) -> "xr.DataTree":
        """Put the draws into a group `posterior` as ArviZ has it, a chain for each ensemble."""
        import xarray as xr

        chains = walkers_in_turn(self.draws)
        coordinates = dict(zip(("chain", "draw"), map(np.arange, chains.shape[:2]), strict=True))
        variables = {name: (tuple(coordinates), chains[..., k]) for k, name in enumerate(self.names)}
        return xr.DataTree.from_dict({"posterior": xr.Dataset(variables, coordinates)})

    def write_netcdf(self, path: Path) -> None:
        """Write the draws as `to_datatree` gives them.

        The file is made in memory, because HDF5 loses the error of a full disk when it closes one.
        """
        with written_whole(path) as file:
            file.write_bytes(self.to_datatree().to_netcdf(engine="h5netcdf"))

    def warn_unless_converged(self) -> None:
        """Issue a :class:`ConvergenceWarning` with every complaint."""
        if not self.has_converged:
            text = " ".join(("THIS POSTERIOR HAS NOT CONVERGED.", *self.diagnostics.complaints))
            warnings.warn(f"{text} Resume the run with more steps.", ConvergenceWarning, stacklevel=3)
