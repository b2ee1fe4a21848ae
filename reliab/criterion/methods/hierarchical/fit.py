"""From ellipses through the posterior of the hierarchical model to limits."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_sample import FEWEST_MOTIONS
from reliab.criterion.methods.hierarchical.further_motions import FurtherMotions
from reliab.criterion.methods.hierarchical.missing import filled
from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.joint import Scatter
from reliab.criterion.methods.method import Learned, checked_share
from reliab.criterion.population import Population
from reliab.criterion.sample_grid import SampleGrid
from reliab.criterion.scaling import scales
from reliab.errors import InputError
from reliab.progress import Progress, silent
from reliab.sampling import Ensembles, PosteriorSample, draw, width_of
from reliab.significant import percent
from reliab.vocabulary import Side

_DRAWS_OF_LIMITS = 2000
_MOTIONS = 40  # for each draw, each of an earthquake of its own
_POPULATIONS = 400  # draws of the posterior whose own quantile is found


def posterior_limits(
    posterior: PosteriorSample,
    model: Hierarchical,
    confidence: float,
    *,
    joint: bool,
    assurance: float | None = None,
    seed: int = 2017,
) -> NDArray[np.float64]:
    """Limits that the stated share of motions of further earthquakes exceeds.

    Returns (F, X, 2).
    """
    rng = np.random.default_rng(seed)
    drawn = model.draw_motions(posterior.spread_out(_DRAWS_OF_LIMITS), np.arange(_MOTIONS), rng)
    motions = drawn.reshape(-1, *drawn.shape[2:])
    scatter = Scatter.from_logarithms(motions)

    if assurance is None:
        standing = scatter.worse(motions)[..., None] if joint else scatter.standard(motions)
        depth = np.quantile(standing, 1.0 - confidence, axis=0)
    else:
        every = FurtherMotions.from_draws(model, posterior.spread_out(_POPULATIONS))
        depth = np.quantile(every.depth(confidence, scatter, joint=joint), 1.0 - assurance, axis=0)
    logarithms = scatter.centre + scatter.spread * depth
    scale = scales(model.frequencies[:, None], model.damping_ratios[None, :])
    return np.asarray(np.stack(scale, axis=-1) * np.exp(logarithms))


_THIN = 2
_DRAWS = 112_000  # steps of all walkers of an ensemble, for 1,000 effective draws of each parameter
_FEWEST_STEPS = 800
_LONGEST = 4  # times as many steps where these were too few


@dataclass(frozen=True, kw_only=True, eq=False)
class HierarchicalFit(Learned):
    """A posterior of the hierarchical model, and what it was fitted to."""

    grid: SampleGrid  # The motions
    method: str  # Name of the method
    assurance: float | None  # Posterior probability of the promise; predictive limits by default
    model: Hierarchical  # The model with its data
    posterior: PosteriorSample  # Its draws

    def limits(self, confidence: float, *, joint: bool) -> NDArray[np.float64]:
        """Limits of every structure, shape (F, X, 2)."""
        return posterior_limits(
            self.posterior,
            self.model,
            checked_share(confidence, "confidence"),
            joint=joint,
            assurance=self.assurance,
        )

    @property
    def sampled(self) -> PosteriorSample:
        """Draws of the posterior."""
        return self.posterior

    @property
    def diagnostics(self) -> Mapping[str, Any]:
        """Convergence of the run and of each parameter, ready for JSON."""
        diagnostics = self.posterior.diagnostics
        draws = self.posterior.draws
        return {
            "threshold": self.grid.threshold,
            "metric": self.grid.metric,
            "side": self.grid.side,
            "method": self.method,
            "converged": self.posterior.converged,
            "complaints": list(diagnostics.complaints),
            "ensembles": diagnostics.ensembles,
            "walkers": draws.shape[2],
            "steps": 2 * draws.shape[1] * self.posterior.thin,
            "thin": self.posterior.thin,
            "accepted": self.posterior.accepted,
            "parameters": [
                {str(key): _known(value) for key, value in row.items()}
                for row in self.posterior.table().reset_index().to_dict(orient="records")
            ],
        }

    @property
    def settings(self) -> Mapping[str, Any]:
        """Law inside, and whether the posterior can be relied on."""
        diagnostics = self.posterior.diagnostics
        return {
            "curved": self.model.curved,
            "converged": self.posterior.converged,
            "largest_r_hat": _known(diagnostics.r_hat.max()),
            "least_effective_size": _known(min(diagnostics.bulk_size.min(), diagnostics.tail_size.min())),
            "longest_autocorrelation_time": _known(diagnostics.autocorrelation_time.max()),
            "ensembles": diagnostics.ensembles,
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the posterior, and what motions lacked."""
        complaints = self.posterior.diagnostics.complaints
        unreliable = "THIS POSTERIOR HAS NOT CONVERGED and must not be relied on." if complaints else ""
        return tuple(sentence for sentence in (unreliable, *complaints, self._imputed) if sentence)

    @property
    def _imputed(self) -> str:
        values = _values(self.grid.population)
        known = np.asarray(np.isfinite(values).all(axis=-1)).reshape(len(values), -1)
        lacking, left_out = int((~known).any(axis=1).sum()), len(known) - len(self.model.values)
        if not lacking:
            return ""
        alone = f"; {left_out} with none at all were left out" if left_out else ""
        return (
            f"{lacking} of {len(known)} motions have no ellipse at some structure, "
            f"{percent((~known).mean(), decimals=1)} of "
            f"all values; these were drawn from the model given the motion's other structures{alone}."
        )


def fit_hierarchical(
    grid: SampleGrid,
    *,
    method: str,
    assurance: float | None = None,
    steps: int | None = None,
    curved: bool = True,
    robust: bool = False,
    chains: Path | None = None,
    progress: Progress = silent,
) -> HierarchicalFit:
    """Sample the posterior of the hierarchical model of ellipses."""
    model = hierarchical_model(grid.population, curved=curved, robust=robust)
    length = steps or _steps_for(model)
    ensembles = Ensembles(steps=length, thin=_THIN, longest=0 if steps else _LONGEST * length)
    side = "" if grid.side == Side.LAG else f"_{grid.side}"
    posterior = draw(
        model,
        ensembles,
        file=chains,
        group=f"{grid.metric}_{grid.threshold:g}{side}",
        progress=progress,
    )
    return HierarchicalFit(grid=grid, method=method, assurance=assurance, model=model, posterior=posterior)


def hierarchical_model(population: Population, *, curved: bool = True, robust: bool = False) -> Hierarchical:
    """Make the hierarchical model of motions."""
    values = _values(population)
    known = np.isfinite(values)
    complete = known.all(axis=(1, 2, 3))
    if complete.sum() < FEWEST_MOTIONS:
        raise InputError(
            f"The hierarchical model needs at least {FEWEST_MOTIONS} motions with an ellipse everywhere",
            value=int(complete.sum()),
            remedy="Give more motions, a smaller threshold or less damping",
        )
    model = Hierarchical(
        values=values[complete],
        events=population.events[complete],
        frequencies=population.frequencies,
        damping_ratios=population.damping_ratios,
        curved=curved,
        robust=robust,
    )
    partial = ~complete & known.any(axis=(1, 2, 3))
    return filled(model, values[partial], population.events[partial])


def _values(population: Population) -> NDArray[np.float64]:
    """Ln α and ln β, shape (motions, F, X, 2)."""
    return np.stack([population.log_alpha, population.log_beta], axis=-1)


def _known(value: object) -> object:
    """Take a number for JSON; None where too short a run has none."""
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value


def _steps_for(model: Hierarchical) -> int:
    """So many steps that small models, with few walkers, make as many draws as large ones."""
    unit = 2 * _THIN
    return max(_FEWEST_STEPS, -(-_DRAWS // width_of(model) // unit) * unit)
