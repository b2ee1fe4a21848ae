"""From a dataset of ellipses, or a published law, to a criterion."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import CurveName, Metric, Side
from reliab.criterion.carrying import protect_over_lengths
from reliab.criterion.cautions import cautions_of, few_leads, not_lognormal
from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_table import Ellipses, EllipseTable, as_table, drop_copies, names_along
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, FittedLaw, find_law
from reliab.criterion.laws.table import TabulatedLimits
from reliab.criterion.methods.method import LearnedLimits, Method, validate_share
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.criterion.population import EllipseSample, SampleGrid, position, position_of_name, sample_of
from reliab.criterion.scope import Provenance, kind_of_motions, population_of, records_checksum, scope_of

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion.ellipse_reading import EllipseSource


def shrink_to_containment(kind: FittedLaw, law: Law, grid: SampleGrid, limits: Array) -> Law:
    """Scale a law so that it contains as many motions as the limits that it was fitted to.

    Limits that all motions contain are compared at the depth of the least motion, so that they keep their
    distance from it.

    `limits` (F, X, 2).
    """
    a, b = law.limits(grid.frequencies[:, None], grid.damping_ratios[None, :])
    rooms, rooms_of_law = (
        np.concatenate(
            [room(sample, *pair) for sample, pair in zip(grid.cells, pairs.reshape(-1, 2), strict=True)]
        )
        for pairs in (limits, np.stack([a, b], axis=-1))
    )
    excluded_share = float(np.mean(rooms < 1.0))
    depth, depth_of_law = (
        float(np.quantile(values, excluded_share, method="lower")) for values in (rooms, rooms_of_law)
    )
    factor = depth_of_law if excluded_share > 0.0 else depth_of_law / depth
    return kind.fit(grid.frequencies, grid.damping_ratios, factor * a, factor * b)


def room(sample: EllipseSample, a: float, b: float) -> Array:
    """Factor by which limits could grow before a motion's own ellipse no longer contains theirs.

    Returns (motions,).
    Returns factors on a and b; a motion contains the limits where its factor is at least 1.
    """
    return np.minimum(sample.a / a, sample.b / b)


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedSide:
    """One side of the boundaries: its motions, and what a method learned from them."""

    grid: SampleGrid
    learned: LearnedLimits

    def law(self, kind: FittedLaw, method: Method, confidence: float, *, joint: bool) -> tuple[Law, int]:
        """Fit a law to the limits; return it with the number of structures at which they are zero."""
        limits = self.learned.limits(confidence, joint=joint)
        for row, column in np.ndindex(limits.shape[:2]):
            sample = self.grid.samples[row][column]
            if not method.carries(confidence, sample.n_motions, sample.n_events):
                limits[row, column] = 0.0
        empty = int((limits <= 0.0).any(axis=-1).sum())
        if empty and kind is not TabulatedLimits:
            raise InputError(
                "At a structure the limits are zero, which no law can follow",
                value=(
                    f"too few motions or earthquakes for {method.name} at {confidence:g} at "
                    f"{empty} structures"
                ),
                remedy="Give more motions or a lower confidence, or keep the limits as a table",
            )
        grid = self.grid.frequencies, self.grid.damping_ratios
        law: Law = kind.fit(*grid, limits[..., 0], limits[..., 1])
        return (
            law if kind is TabulatedLimits else shrink_to_containment(kind, law, self.grid, limits)
        ), empty


MOST_AT_REST = 0.05
"""Largest share of motions under which an actuator at rest may keep the threshold."""


def share_at_rest(errors: Array, threshold: float) -> Array:
    """Share of motions under which an actuator at rest keeps a threshold.

    `errors` (motions, ...) [-]; `threshold` [-].
    Returns shares of the motions with a known error, in the trailing shape; 0 where none is known.

    >>> share_at_rest(np.array([[0.15, 0.3], [0.25, np.nan], [0.4, 0.2]]), 0.2).round(2).tolist()
    [0.33, 0.5]
    """
    is_finite = np.isfinite(errors)
    within_threshold = (is_finite & (errors <= threshold)).sum(axis=0)
    return np.asarray(within_threshold / np.maximum(is_finite.sum(axis=0), 1))


def require_meaning(ellipses: Ellipses, *, threshold: float, metric: str) -> None:
    """Refuse a threshold that an actuator at rest keeps under more than one motion in twenty.

    The amplitude and the delay of a test that hardly moves do not show its error. Ellipses without
    `error_at_rest` (older files, tables in CSV) cannot be checked.

    `ellipses`: ellipses of the structures that are asked for; `threshold`: error [-].
    """
    table = as_table(ellipses).interpolate_threshold(threshold)
    if table.error_at_rest is None:
        return
    errors = table.error_at_rest[..., position_of_name(table, "metric", metric)]
    shares = share_at_rest(errors.astype(np.float64), threshold)
    if shares.max() <= MOST_AT_REST:
        return
    row, column = np.unravel_index(int(shares.argmax()), shares.shape)
    f, xi = float(table.coordinates["f"][row]), float(table.coordinates["xi"][column])
    raise InputError(
        "At this threshold even an actuator that does not move would pass",
        value=(
            f"{percent(shares.max(), decimals=0)} of the motions under which it stays below "
            f"{threshold:g} at f = {f:g} Hz and "
            f"ξ = {xi:g}"
        ),
        remedy="Give a smaller threshold, at which amplitude and delay still separate good tests from "
        "bad ones",
    )


def derive_criterion(
    ellipses: "EllipseSource | EllipseTable",
    *,
    method: Method | str = RECOMMENDED_METHOD,
    assurance: float | None = None,
    distribution: str | None = None,
    steps: int | None = None,
    chains: str | Path | None = None,
    f: float | None = None,
    xi: float | None = None,
    joint: bool | None = None,
    law: FittedLaw | str = TabulatedLimits,
    threshold: float = 0.05,
    metric: str = Metric.RMS,
    confidence: float = 0.95,
    source: str = "ellipses of ground motions",
    progress: Progress = silent,
) -> Criterion:
    """Derive a criterion from the ellipses of many ground motions.

    Limits are derived for every structure of the dataset, for lags and, where the dataset has them, for
    leads, and a law is fitted to them. A fitted law misses some of them a little; all its limits are
    therefore scaled by one factor, so that on average over the structures as many of the motions are
    contained as by the limits themselves.

    Where the ellipses of at least thirty motions of ten earthquakes say how their records can be cut, the
    criterion protects short, middle and long records alike; see :func:`protect_over_lengths`.

    Parameters
    ----------
    ellipses : xarray.Dataset, pandas.DataFrame, EllipseTable, str or pathlib.Path
        Ellipses, or whatever :func:`reliab.read_ellipses` takes: a file, a store of results, a table with the
        columns a and b, or "real_suite".
    method : Method or str, optional
        What the confidence means, or its name; the recommended one by default. The paper's is "quantile";
        it rests on ellipses fitted to the boundaries, every other method on
        ellipses inscribed in them where the dataset has those.
    assurance, distribution, steps : optional
        Settings of a method that is given by its name, where it has them.
    chains : str or pathlib.Path, optional
        For the hierarchical methods, the HDF5 file of the chains; with it an interrupted run resumes, and a
        run that was too short is lengthened.
    f, xi : float, optional
        The only natural frequency [Hz] and damping ratio [-] to derive it for; between those of the dataset
        all are taken, and by default as well.
    joint : bool, optional
        Whether a and b hold together, or each for itself; by default together, and for the paper's
        "quantile" each for itself.
    law : type of Law or str, optional
        How the limits depend on the structure, or its name; by default they are kept as a table.
    threshold : float, optional
        Error on the boundaries [-], as :meth:`EllipseTable.interpolate_threshold` takes it.
    metric : str, optional
        Which error.
    confidence : float, optional
        Share of the population's ground motions, in (0, 1).
    source : str, optional
        Where the ellipses came from, in words.
    progress : callable, optional
        Called with finished and all steps of the hierarchical methods.

    Returns
    -------
    Criterion
        Valid for the structures of the dataset and between them. Its limits are zero, with a reason among its
        warnings, where the motions and earthquakes are too few for the confidence.

    Warns
    -----
    ConvergenceWarning
        If the posterior of a hierarchical method has not converged.

    Raises
    ------
    InputError
        If the dataset has no such threshold or metric, or too few motions, an actuator that does not move
        would pass at the threshold, the method has no such setting, or limits are zero, so that no law can
        be fitted to them.

    Examples
    --------
    The paper's criterion, from its printed table:

    >>> from reliab.core.shipped import shipped
    >>> criterion = derive_criterion(shipped("datasets", "paper/table2.csv"), method="quantile")
    >>> a, b = criterion.limits(1.0, 0.02)
    >>> print(f"{a:.2e} {b:.3f}")
    5.29e-05 1.048
    """
    settings = {"assurance": assurance, "distribution": distribution, "steps": steps}
    known_method = method_of(method, **settings) if isinstance(method, str) else method
    derivation = Derivation.from_ellipses(
        drop_copies(_read(ellipses, f, xi, threshold, str(metric))),
        method=known_method,
        law=find_law(FITTED_LAWS, law) if isinstance(law, str) else law,
        frequency=f,
        damping_ratio=xi,
        threshold=threshold,
        metric=str(metric),
        chains=None if chains is None else Path(chains),
        progress=progress,
    )
    criterion = derivation.criterion(confidence, joint=joint, source=source)
    derivation.warn_unless_converged()
    return criterion


def _read(
    ellipses: "EllipseSource | EllipseTable", f: float | None, xi: float | None, threshold: float, metric: str
) -> EllipseTable:
    if isinstance(ellipses, EllipseTable):
        return ellipses
    from reliab.criterion.ellipse_reading import read_ellipses

    structure_place = {"f": 1.0 if f is None else f, "xi": 0.02 if xi is None else xi}
    return as_table(read_ellipses(ellipses, **structure_place, threshold=threshold, metric=metric))


@dataclass(frozen=True, kw_only=True, eq=False)
class Derivation:
    """What was learned from ellipses, from which criteria follow at any confidence."""

    ellipses: EllipseTable  # The ellipses of the structures that are asked for
    method: Method  # What the confidence means
    law: FittedLaw  # How the limits depend on the structure
    lag: LearnedSide  # What was learned of actuators that are late
    lead: LearnedSide | None  # The same of actuators that are early, where the ellipses have that side

    @classmethod
    def from_ellipses(
        cls,
        ellipses: Ellipses,
        *,
        method: Method,
        law: FittedLaw = TabulatedLimits,
        frequency: float | None = None,
        damping_ratio: float | None = None,
        threshold: float,
        metric: str,
        chains: Path | None = None,
        progress: Progress = silent,
    ) -> Self:
        """Learn from ellipses, of which every length is protected.

        The parameters are those of :func:`derive_criterion`.
        """
        population = protect_over_lengths(as_table(ellipses), metric=metric, curve=method.curve)
        threshold_ellipses = population.interpolate_threshold(threshold)
        selected_ellipses = _only(_only(threshold_ellipses, "f", frequency), "xi", damping_ratio)
        require_meaning(selected_ellipses, threshold=threshold, metric=metric)
        curves = names_along(selected_ellipses, "curve")
        error = {
            "threshold": threshold,
            "metric": metric,
            "curve": method.curve if method.curve in curves else str(CurveName.ELLIPSE),
        }
        sides = {}
        for side in names_along(selected_ellipses, "side"):
            try:
                grid = SampleGrid.from_ellipses(selected_ellipses, side=side, **error)  # type: ignore[arg-type]
            except InputError:
                if side == Side.LAG:
                    raise
                continue  # too few motions have a boundary on this side; the criterion then says so
            learned_limits = method.learn(grid, law=law.name, chains=chains, progress=progress)
            sides[side] = LearnedSide(grid=grid, learned=learned_limits)
        if Side.LAG not in sides:
            raise InputError(
                "A criterion needs the boundaries of late actuators",
                value=f"ellipses of {', '.join(names_along(selected_ellipses, 'side'))} alone",
                remedy="Trace the boundaries of both sides",
            )
        return cls(
            ellipses=selected_ellipses,
            method=method,
            law=law,
            lag=sides[Side.LAG],
            lead=sides.get(str(Side.LEAD)),
        )

    @property
    def diagnostics(self) -> list[Mapping[str, Any]]:
        """Convergence of sampled posteriors, one for each side; empty for methods that sample none."""
        return [side.learned.diagnostics for side in self._sides if side.learned.diagnostics is not None]

    @property
    def side_limits(self) -> list[LearnedLimits]:
        """What was learned of each side, lags first."""
        return [side.learned for side in self._sides]

    @property
    def _sides(self) -> list[LearnedSide]:
        return [self.lag] if self.lead is None else [self.lag, self.lead]

    def criterion(
        self,
        confidence: float,
        *,
        joint: bool | None = None,
        source: str = "ellipses of ground motions",
    ) -> Criterion:
        """Derive a criterion.

        `confidence`: share of the population's ground motions, in (0, 1); `joint`: whether a and b hold
        together; by default as the method defines it. Its warnings hold what a user should
        know of it.
        """
        validate_share(confidence, "confidence")
        joint = self.method.joint_by_default if joint is None else joint
        laws = [side.law(self.law, self.method, confidence, joint=joint) for side in self._sides]
        grid = self.lag.grid
        return Criterion(
            law=laws[0][0],
            lead_law=None if self.lead is None else laws[1][0],
            threshold=grid.threshold,
            metric=grid.metric,
            confidence=confidence,
            method=self.method.name,
            joint=joint,
            population=grid.population,
            lead_population=None if self.lead is None else self.lead.grid.population,
            provenance=self._provenance(confidence, laws[0][1], source),
        )

    def _provenance(self, confidence: float, empty: int, source: str) -> Provenance:
        grid, method = self.lag.grid, self.method
        achievable_confidence = method.achievable_confidence(grid.fewest_motions, grid.fewest_events)
        settings = method.settings
        if settings.get("assurance") is not None and not_lognormal(grid, method):
            settings["assurance"] = None
        return Provenance(
            source=source,
            motions=kind_of_motions(self.ellipses.events.tolist()),
            n_motions=self.ellipses.n_motions,
            n_events=int(np.unique(self.ellipses.events).size),
            records_checksum=records_checksum(self.ellipses),
            window=str(self.ellipses.attrs.get("window", "unknown")),
            experimental_fraction=self.ellipses.share,
            curve=self.lag.grid.curve,
            population=population_of(self.ellipses),
            scope=self.ellipses.attrs.get("scope", scope_of(self.ellipses)),
            position=self.ellipses.attrs.get("position", "inside"),
            promised_from=float(self.ellipses.attrs.get("promised_from", 0.0)),
            settings={
                **settings,
                **self.lag.learned.settings,
                "carried_confidence": achievable_confidence,
                **({"converged": self.has_converged} if self.diagnostics else {}),
            },
            warnings=(
                *(sentence for side in self._sides for sentence in side.learned.warnings),
                *cautions_of(self.ellipses, self.lag.grid, self.method, confidence, empty),
                *few_leads(self.ellipses, leads=self.lead is not None),
            ),
        )

    @property
    def has_converged(self) -> bool:
        """Whether every posterior that was sampled can be relied on."""
        return all(bool(side["converged"]) for side in self.diagnostics)

    def warn_unless_converged(self) -> None:
        """Warn by a `ConvergenceWarning` if a posterior cannot be relied on."""
        for side in self.side_limits:
            side.warn_unless_converged()


def _only(ellipses: EllipseTable, name: str, value: float | None) -> EllipseTable:
    """Keep one value of a dimension; all, increasing, for one between them or for none."""
    stored_values = ellipses.coordinates[name]
    if value is None or (
        stored_values.min() < value < stored_values.max()
        and not np.isclose(stored_values, value, rtol=1e-9).any()
    ):
        return ellipses.sort(name)
    return ellipses.take(**{name: [position(ellipses, name, value)]})


def published_criterion(name: str) -> Criterion:
    """Make the criterion of a published or corrected law.

    Parameters
    ----------
    name : str
        A law that promises a confidence over motions, such as "guo_2017_18".

    Returns
    -------
    Criterion
        At 5 % RMS^R and the 95 % that the paper states.

    Raises
    ------
    InputError
        If there is no such law.

    Examples
    --------
    Case 1 of Table 6:

    >>> criterion = published_criterion("guo_2017_18")
    >>> round(float(criterion.index(1.0039, 0.39e-3, 1.0, 0.02)), 3)
    0.956
    """
    law = find_law(MANY_MOTION_LAWS, name)
    return Criterion(
        law=law,
        threshold=0.05,
        metric=str(Metric.RMS),
        confidence=0.95,
        method="quantile",
        joint=False,
        provenance=Provenance(source=f"Guo and others (2017), {law.equation}", n_motions=100, n_events=19),
    )


def exact_share(
    criterion: Criterion, ellipses: "xr.Dataset", frequency: float, damping_ratio: float
) -> dict[str, float]:
    """Count the motions whose own ellipse contains that of a printed law.

    `frequency`, `damping_ratio`: the structure [Hz, -]; the nearest one of the ellipses is taken. Returns
    `share` of the motions [-], `n_motions`, and the structure, `f` [Hz] and `xi` [-].
    """
    f, xi = (
        float(values[np.argmin(np.abs(np.log(values / target)))])
        for values, target in (
            (ellipses["f"].values, frequency),
            (ellipses["xi"].values, damping_ratio),
        )
    )
    sample = sample_of(
        ellipses,
        frequency=f,
        damping_ratio=xi,
        threshold=criterion.threshold,
        metric=criterion.metric,
        curve=CurveName.ELLIPSE,
    )
    a, b = (float(limit) for limit in criterion.limits(f, xi))
    return {
        "share": float(np.mean(room(sample, a, b) >= 1.0)),
        "n_motions": sample.n_motions,
        "f": f,
        "xi": xi,
    }
