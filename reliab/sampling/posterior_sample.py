"""The draws of a run, and whether they can be relied on."""

import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from reliab.arrays import Array
from reliab.files import written_whole
from reliab.sampling.diagnostics import ConvergenceWarning, Diagnostics, diagnose, walkers_in_turn

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


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
    def converged(self) -> bool:
        """Whether the draws can be relied on."""
        return self.diagnostics.converged

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
        if not self.converged:
            text = " ".join(("THIS POSTERIOR HAS NOT CONVERGED.", *self.diagnostics.complaints))
            warnings.warn(f"{text} Resume the run with more steps.", ConvergenceWarning, stacklevel=3)
