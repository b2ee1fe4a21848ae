"""From ellipses through the posterior of the hierarchical model to a criterion."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.bayes.hierarchical import Hierarchical
from reliab.criterion.bayes.missing import filled
from reliab.criterion.bayes.posterior_limits import posterior_limits
from reliab.criterion.bayes.posterior_sample import PosteriorSample
from reliab.criterion.bayes.sampling import Ensembles, draw, width_of
from reliab.criterion.cautions import caution_of, few_events
from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_sample import FEWEST_MOTIONS
from reliab.criterion.laws import FittedLaw, Law, Table
from reliab.criterion.methods.hierarchical import HierarchicalPosterior, curved_of
from reliab.criterion.methods.method import checked_share
from reliab.criterion.population import Population
from reliab.criterion.provenance import Provenance, records_checksum
from reliab.errors import InputError
from reliab.progress import Progress, silent

_THIN = 2
_DRAWS = 112_000  # steps of all walkers of an ensemble, for 1,000 effective draws of each parameter
_FEWEST_STEPS = 800
_LONGEST = 4  # times as many steps where these were too few


@dataclass(frozen=True, kw_only=True, eq=False)
class HierarchicalFit:
    """A posterior of the hierarchical model, and what it was fitted to.

    Parameters
    ----------
    ellipses : xarray.Dataset
        The ellipses.
    threshold : float
        Error on the boundaries [-].
    metric : str
        Which error.
    method : HierarchicalPosterior
        What is to be promised.
    law : type of Law
        How limits depend on the structure.
    model : Hierarchical
        The model with its data.
    posterior : PosteriorSample
        Its draws.
    """

    ellipses: xr.Dataset
    threshold: float
    metric: str
    method: HierarchicalPosterior
    law: FittedLaw
    model: Hierarchical
    posterior: PosteriorSample

    @property
    def diagnostics(self) -> dict[str, Any]:
        """Convergence of the run and of each parameter, ready for JSON."""
        found = self.posterior.diagnostics
        draws = self.posterior.draws
        return {
            "threshold": self.threshold,
            "metric": self.metric,
            "method": self.method.name,
            "converged": self.posterior.converged,
            "complaints": list(found.complaints),
            "ensembles": found.ensembles,
            "walkers": draws.shape[2],
            "steps": 2 * draws.shape[1] * self.posterior.thin,
            "thin": self.posterior.thin,
            "accepted": self.posterior.accepted,
            "parameters": [
                {str(key): _known(value) for key, value in row.items()}
                for row in self.posterior.table().reset_index().to_dict(orient="records")
            ],
        }

    def criterion(
        self, confidence: float, *, joint: bool = True, source: str = "ellipses of ground motions"
    ) -> Criterion:
        """Derive a criterion.

        Parameters
        ----------
        confidence : float
            Share of ground motions, in (0, 1).
        joint : bool, optional
            Whether a and b hold together.
        source : str, optional
            Where the ellipses came from, in words.

        Returns
        -------
        Criterion
            With the diagnostics in its provenance, and a warning there if the posterior has not converged.
        """
        model = self.model
        a, b = posterior_limits(
            self.posterior,
            model,
            checked_share(confidence, "confidence"),
            joint=joint,
            assurance=self.method.assurance,
        )
        fitted: Law = self.law.fit(model.frequencies, model.damping_ratios, a, b)
        return Criterion(
            law=fitted,
            threshold=self.threshold,
            metric=self.metric,
            confidence=confidence,
            method=self.method.name,
            joint=joint,
            population=Population.of(self.ellipses, threshold=self.threshold, metric=self.metric),
            provenance=Provenance(
                source=source,
                n_motions=len(model.values),
                n_events=np.unique(model.events).size,
                records_checksum=records_checksum(self.ellipses),
                window=str(self.ellipses.attrs.get("window", "unknown")),
                settings={**self.method.settings, "curved": model.curved, **self._convergence},
                warnings=self._warnings,
            ),
        )

    @property
    def _convergence(self) -> Mapping[str, Any]:
        found = self.posterior.diagnostics
        return {
            "converged": self.posterior.converged,
            "largest_r_hat": _known(found.r_hat.max()),
            "least_effective_size": _known(min(found.bulk_size.min(), found.tail_size.min())),
            "longest_autocorrelation_time": _known(found.autocorrelation_time.max()),
            "ensembles": found.ensembles,
        }

    @property
    def _warnings(self) -> tuple[str, ...]:
        complaints = self.posterior.diagnostics.complaints
        unreliable = "THIS POSTERIOR HAS NOT CONVERGED and must not be relied on." if complaints else ""
        own = caution_of(self.ellipses)
        found = (unreliable, *complaints, *own, self._imputed, few_events(np.unique(self.model.events).size))
        return tuple(sentence for sentence in found if sentence)

    @property
    def _imputed(self) -> str:
        values = _values(self.ellipses, self.threshold, self.metric)
        known = np.asarray(np.isfinite(values).all(axis=-1)).reshape(len(values), -1)
        lacking, left_out = int((~known).any(axis=1).sum()), len(known) - len(self.model.values)
        if not lacking:
            return ""
        alone = f"; {left_out} with none at all were left out" if left_out else ""
        return (
            f"{lacking} of {len(known)} motions have no ellipse at some structure, {(~known).mean():.1%} of "
            f"all values; these were drawn from the model given the motion's other structures{alone}."
        )


def fit_hierarchical(
    ellipses: xr.Dataset,
    method: HierarchicalPosterior,
    *,
    threshold: float,
    metric: str,
    law: FittedLaw = Table,
    chains: str | Path | None = None,
    progress: Progress = silent,
) -> HierarchicalFit:
    """Sample the posterior of the hierarchical model of ellipses.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over motions, f and ξ.
    method : HierarchicalPosterior
        What is to be promised, and how long is sampled.
    threshold, metric
        Which error.
    law : type of Law, optional
        How limits are to depend on the structure; see :class:`HierarchicalPosterior`.
    chains : str or pathlib.Path, optional
        HDF5 file of the chains, which a run that stopped, or was too short, goes on with.
    progress : callable, optional
        Called with finished and all steps.

    Returns
    -------
    HierarchicalFit
        The posterior; `posterior.converged` says whether it can be relied on.

    Raises
    ------
    InputError
        If the model cannot have the law inside, or the file holds another run.
    """
    model = hierarchical_model(
        ellipses, threshold=threshold, metric=metric, curved=curved_of(law.name), robust=method.robust
    )
    steps = method.steps or _steps_for(model)
    ensembles = Ensembles(steps=steps, thin=_THIN, longest=0 if method.steps else _LONGEST * steps)
    posterior = draw(
        model,
        ensembles,
        file=None if chains is None else Path(chains),
        group=f"{metric}_{threshold:g}",
        progress=progress,
    )
    return HierarchicalFit(
        ellipses=ellipses,
        threshold=threshold,
        metric=metric,
        method=method,
        law=law,
        model=model,
        posterior=posterior,
    )


def hierarchical_model(
    ellipses: xr.Dataset, *, threshold: float, metric: str, curved: bool = True, robust: bool = False
) -> Hierarchical:
    """Make the hierarchical model of a dataset of ellipses.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over motions, f and ξ; see :func:`reliab.criterion.bayes.missing.filled` for motions that
        lack one at some structure. Those that have none at all are left out.
    threshold, metric
        Which error.
    curved, robust : bool, optional
        See :class:`reliab.criterion.bayes.Hierarchical`.

    Returns
    -------
    Hierarchical
        The model with its data.

    Raises
    ------
    InputError
        If fewer than three motions have an ellipse at every structure.
    """
    population = Population.of(ellipses, threshold=threshold, metric=metric)
    values = _values(ellipses, threshold, metric)
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


def _values(ellipses: xr.Dataset, threshold: float, metric: str) -> NDArray[np.float64]:
    population = Population.of(ellipses, threshold=threshold, metric=metric)
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
