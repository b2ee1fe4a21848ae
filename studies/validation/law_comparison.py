"""Comparison of laws on earthquakes that were held out."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
import scipy
import xarray as xr
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.vocabulary import CurveName
from reliab.criterion.laws.law import Law, scales
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, FittedLaw
from reliab.criterion.methods.method import Scatter
from reliab.criterion.population import Population


def leave_one_event_out(events: NDArray[np.str_]) -> Iterator[NDArray[np.bool_]]:
    """Masks of the motions of each earthquake in turn, shape (motions,)."""
    for event in np.unique(events):
        yield events == event


_PRINTED_CONFIDENCE = 0.95


@dataclass(frozen=True, kw_only=True, eq=False)
class _MotionLogarithms:
    """ln α and ln β of motions over structures, shape (motions, F, X, 2)."""

    values: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]

    @property
    def scale(self) -> NDArray[np.float64]:
        """Logarithms of what a and b are divided by, shape (F, X, 2)."""
        return np.log(np.stack(scales(self.frequencies[:, None], self.damping_ratios[None, :]), axis=-1))

    def location(self, law: FittedLaw | Law) -> NDArray[np.float64]:
        """Medians that a law expects, shape (F, X, 2).

        A law that is fitted is fitted to the geometric means; a printed one states the 5 % quantile, and the
        scatter of these motions leads from there to the median.
        """
        if isinstance(law, Law):
            log_limits = self.limits(law, _PRINTED_CONFIDENCE)
            return np.asarray(log_limits + scipy.special.ndtri(_PRINTED_CONFIDENCE) * self.values.std(axis=0))
        return self._fit_law(law, self.values.mean(axis=0))

    def limits(self, law: FittedLaw | Law, confidence: float) -> NDArray[np.float64]:
        """Limits that a law states, shape (F, X, 2).

        A law that is fitted is fitted, as a criterion is, to the limits of each structure that hold for a
        and b together (:class:`~reliab.criterion.methods.method.Scatter`).
        """
        if isinstance(law, Law):
            grid = self.frequencies[:, None], self.damping_ratios[None, :]
            return np.asarray(np.log(np.stack(law.limits(*grid), axis=-1)) - self.scale)
        scatter = Scatter.from_logarithms(self.values)
        depth = np.quantile(scatter.worse(self.values), 1.0 - confidence, axis=0)
        return self._fit_law(law, scatter.limits_at_depth(depth))

    def _fit_law(self, law: FittedLaw, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Fit a law to ln α and ln β of the grid and evaluate it there, shape (F, X, 2)."""
        a, b = np.moveaxis(np.exp(values + self.scale), -1, 0)
        law_fit = law.fit(self.frequencies, self.damping_ratios, a, b)
        grid = self.frequencies[:, None], self.damping_ratios[None, :]
        return np.asarray(np.log(np.stack(law_fit.limits(*grid), axis=-1)) - self.scale)

    def covariance(self, law: FittedLaw | Law, location: NDArray[np.float64]) -> NDArray[np.float64]:
        """Scatter of ln α and ln β about a law; about their own means for a printed one."""
        centre = self.values.mean(axis=0) if isinstance(law, Law) else location
        residual = (self.values - centre).reshape(-1, 2)
        return np.asarray(residual.T @ residual / len(residual))


def compare_laws(
    ellipses: xr.Dataset,
    *,
    threshold: float = 0.05,
    metric: str = "rms",
    confidence: float = 0.95,
    curve: str = CurveName.ELLIPSE,
    laws: Mapping[str, FittedLaw | Law] | None = None,
) -> pd.DataFrame:
    """Compare laws by held-out log score and by the region that they accept at equal coverage.

    Each earthquake is held out in turn. The *log score* of its motions is the mean log-density of
    (ln a, ln b) under a bivariate normal distribution about the law. The *region* is the geometric mean over
    ξ of √(ab)/√(a₀b₀), the area of the accepted ellipse in units of that with α = β = 1, once the law, fitted
    to limits that hold for a and b together, or as it is printed, has been scaled so that 95 % of the
    held-out motions contain its ellipse (in a and b together): by one factor for all structures (`region`,
    with `coverage` at each f), or by one for each f (`region_at_f`).

    `laws`: by default all that are fitted, and those printed for many motions that hold at all structures.

    >>> from reliab.criterion.laws.dimensionless import Dimensionless
    >>> from reliab.criterion.laws.exponential import Exponential
    >>> rng = np.random.default_rng(1)
    >>> f, xi, dims = np.array([0.5, 1.0, 2.0]), np.array([0.02, 0.1]), ("motion", "f", "xi")
    >>> a, b = (s * np.exp(rng.normal(-1.0, 0.5, (30, 3, 2))) for s in scales(f[:, None], xi[None, :]))
    >>> dataset = xr.Dataset(
    ...     {"a": (dims, a), "b": (dims, b)},
    ...     coords={"f": f, "xi": xi, "event": ("motion", np.repeat(np.arange(10), 3).astype(str))},
    ... ).expand_dims(threshold=[0.05], metric=["rms"], curve=["ellipse"], side=["lag"])
    >>> table = compare_laws(dataset, laws={"new": Dimensionless, "old": Exponential})
    >>> scores = table.pivot(index="f", columns="law", values="log_score")
    >>> bool((scores["new"] > scores["old"]).all())
    True
    """
    population = Population.from_ellipses(ellipses, threshold=threshold, metric=metric, curve=curve)
    values = np.stack([population.log_alpha, population.log_beta], axis=-1)
    if not np.isfinite(values).all():
        raise InputError(
            "Comparing laws needs an ellipse of every motion at every structure",
            value=f"{np.isnan(values).any(axis=(1, 2, 3)).sum()} motions without",
            remedy="Choose a smaller threshold or less damping",
        )
    structures = population.frequencies, population.damping_ratios
    tables = [
        _judge(name, law, values, population.events, *structures, confidence)
        for name, law in (laws or _applicable_laws(*structures)).items()
    ]
    return pd.concat(tables, ignore_index=True)


def _applicable_laws(
    frequencies: NDArray[np.float64], damping_ratios: NDArray[np.float64]
) -> dict[str, FittedLaw | Law]:
    laws: dict[str, FittedLaw | Law] = dict(FITTED_LAWS)
    for name, law in MANY_MOTION_LAWS.items():
        try:
            law.validity.require(frequencies, damping_ratios)
        except InputError:
            continue
        laws[name] = law
    return laws


def _judge(
    name: str,
    law: FittedLaw | Law,
    values: NDArray[np.float64],
    events: NDArray[np.str_],
    frequencies: NDArray[np.float64],
    damping_ratios: NDArray[np.float64],
    confidence: float,
) -> pd.DataFrame:
    """One law at every frequency."""
    score = np.empty(values.shape[:3])
    log_limits = np.empty(values.shape)
    for held_out in leave_one_event_out(events):
        training = _MotionLogarithms(
            values=values[~held_out], frequencies=frequencies, damping_ratios=damping_ratios
        )
        location = training.location(law)
        covariance = training.covariance(law, location)
        residual = values[held_out] - location
        score[held_out] = (
            scipy.stats.multivariate_normal([0.0, 0.0], covariance)
            .logpdf(residual)
            .reshape(residual.shape[:3])
        )
        log_limits[held_out] = training.limits(law, confidence)
    room = (values - log_limits).min(axis=-1)  # by which the limits could grow, in logarithms
    size = log_limits.mean(axis=-1)  # ln √(ab) of the stated limits
    factor = np.quantile(room, 1.0 - confidence, method="lower")
    factor_at_f = np.quantile(room, 1.0 - confidence, axis=(0, 2), method="lower")
    return pd.DataFrame(
        {
            "law": name,
            "f": frequencies,
            "log_score": score.mean(axis=(0, 2)),
            "region": np.exp(size.mean(axis=(0, 2)) + factor),
            "coverage": (room >= factor).mean(axis=(0, 2)),
            "region_at_f": np.exp(size.mean(axis=(0, 2)) + factor_at_f),
        }
    )
