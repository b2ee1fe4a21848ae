"""The posterior distribution of a model's parameters, sampled by independent ensembles of walkers."""

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.adding.likelihood_surface import LikelihoodSurface, log_density, simulated
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.progress import Progress, silent
from reliab.sampling import Ensembles, PosteriorSample, sample
from reliab.significant import percent

SMALLEST_AGREEMENT = 0.7
"""Share of simulated draws that importance weights leave in effect, from which the surface is trusted."""

_THIN = 8  # steps to a kept draw, of which a file takes milliseconds each
_CHECKED = 48  # draws at which the surface is compared with simulations
_DRAWS = 4000
_INTERVAL = (0.05, 0.95)


@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """Posterior of a model's parameters."""

    names: tuple[str, ...]  # names, units: Parameters, those of effects as "effect.parameter"
    units: tuple[str, ...]
    draws: Array  # Values in SI units, shape (draws, parameters)
    sample: PosteriorSample = field(repr=False)  # The chains with their diagnostics
    # Share of simulated draws that their importance weights leave in effect [-]; 1 where the surface on which
    # walkers moved is exact
    agreement: float

    @property
    def mean(self) -> Array:
        """Means in SI units, shape (parameters,)."""
        return np.asarray(self.draws.mean(axis=0))

    @property
    def sd(self) -> Array:
        """Standard deviations in SI units, shape (parameters,)."""
        return np.asarray(self.draws.std(axis=0, ddof=1))

    @property
    def interval(self) -> Array:
        """Ends of the central 90 % intervals in SI units, shape (2, parameters)."""
        return np.asarray(np.quantile(self.draws, _INTERVAL, axis=0))

    @property
    def converged(self) -> bool:
        """Whether walkers mixed and the surface agrees with simulations."""
        return self.sample.converged and self.agreement >= SMALLEST_AGREEMENT

    @property
    def statement(self) -> str:
        """One sentence on convergence."""
        diagnostics = self.sample.diagnostics
        smallest = min(diagnostics.bulk_size.min(), diagnostics.tail_size.min())
        verdict = "Converged" if self.converged else "Not converged"
        return (
            f"{verdict}: {diagnostics.ensembles} independent ensembles, R-hat at most "
            f"{diagnostics.r_hat.max():.3f}, "
            f"effective sample size at least {smallest:.0f}; simulations at {_CHECKED} draws "
            f"confirm the surface that was sampled to {percent(self.agreement, decimals=0)}."
        )

    def parameters_of(self, effect: str) -> dict[str, dict[str, Any]]:
        """Return means, standard deviations, 90 % intervals and units of an effect's parameters by name."""
        low, high = self.interval.tolist()
        rows = zip(self.names, self.units, self.mean.tolist(), self.sd.tolist(), low, high, strict=True)
        return {
            name.removeprefix(f"{effect}."): {
                "value": mean,
                "sd": sd,
                "interval_90": [low, high],
                "units": units,
            }
            for name, units, mean, sd, low, high in rows
            if name.startswith(f"{effect}.")
        }


def sample_posterior(
    problem: Problem,
    fitted: Fit,
    *,
    out: Path | None = None,
    steps: int = 800,
    seed: int = 2017,
    progress: Progress = silent,
) -> Posterior:
    """Sample the posterior distribution of a fitted model.

    Calibrations and offsets are sampled along with the effects; the noise is as fitted. Walkers move on a
    surface that a few simulations determine, see :mod:`reliab.discrepancy.adding.likelihood_surface`, and
    simulations at draws check it.
    """
    surface = LikelihoodSurface.around(problem, fitted)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # convergence is said in the statement
        sampled = sample(surface, Ensembles(steps=steps, thin=_THIN, seed=seed), file=out, progress=progress)
    coordinates = surface.coordinates(sampled.spread_out(_DRAWS))
    return Posterior(
        names=_names(fitted.space),
        units=tuple(parameter.units for parameter in fitted.space.parameters),
        draws=_values(fitted.space, coordinates, seed),
        sample=sampled,
        agreement=_agreement(problem, fitted, surface, sampled.spread_out(_CHECKED)),
    )


def _values(space: ModelSpace, coordinates: Array, seed: int) -> Array:
    """SI values with the error of the model, shape (draws, parameters)."""
    exact = np.stack([space.values(point) for point in coordinates])
    strayed = np.random.default_rng(seed).standard_normal(exact.shape)
    return exact + space.model_errors(exact) * strayed


def _names(space: ModelSpace) -> tuple[str, ...]:
    calibrated = (calibration.parameter.name for calibration in space.block.calibrations)
    effects = (*space.block.offsets, *space.effects)
    return (
        *calibrated,
        *(f"{effect.name}.{parameter.name}" for effect in effects for parameter in effect.parameters),
    )


def _agreement(problem: Problem, fitted: Fit, surface: LikelihoodSurface, drawn: Array) -> float:
    """Effective share of draws under importance weights from surface to simulation."""
    coordinates = surface.coordinates(drawn)
    exact = log_density(simulated(problem, fitted, coordinates), coordinates)
    ratios = exact - surface.log_posterior(drawn)
    weights = np.exp(ratios - ratios.max())
    return float(weights.sum() ** 2 / (weights**2).sum() / len(drawn))
