"""Criteria with what they were derived from, and their limits at each structure as plain numbers."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import xarray as xr

from reliab.core.columns import PLACE_COLUMNS, Columns, digits
from reliab.core.errors import IncompleteError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.plain_values import Keys, ResultWithRows
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation, exact_share
from reliab.criterion.distributions import Lognormal
from reliab.criterion.ellipse_table import Ellipses, EllipseTable
from reliab.criterion.population import sample_of
from reliab.criterion.scope import population_of
from reliab.sweep.ellipse_dataset import open_ellipses

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from reliab.sampling.posterior_sample import PosteriorSample


@dataclass(frozen=True, kw_only=True, eq=False)
class Criteria(ResultWithRows):
    """Criteria with what they were derived from."""

    rows_in = "criteria"
    keys: ClassVar[Keys] = {
        "criteria": "rows",
        "**row": "only_row",
        "posteriors?": "posteriors",
        "**": "additions",
    }
    table_columns: ClassVar[Columns] = {
        **PLACE_COLUMNS,
        "confidence [-]": ("confidence", lambda promise: "none" if promise is None else f"{promise:g}"),
        "a [-]": ("a", digits),
        "b [ms²]": ("b", digits),
        "|A − 1| alone ≤": ("amplitude_limit", digits),
        "lag alone ≤ [ms]": ("delay_limit_ms", digits),
        "lead alone ≤ [ms]": ("lead_limit_ms", digits),
    }
    plot_columns = ("f", "delay_limit_ms")

    # One for each share of the stiffness, error and share of the population's ground motions
    criteria: tuple[Criterion, ...]
    structures: tuple[tuple[float, float], ...]  # Natural frequencies [Hz] and damping ratios [-]
    ellipses: xr.Dataset | None = None  # None for a printed law without a source of them
    derivations: tuple[Derivation, ...] = ()  # One for each share of the stiffness and error
    # What else was asked for: `figures`; of frames `frame` and `rig`, of several actuators
    # `cross_coupling`
    additions: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Limits of each criterion at each structure, with the motions behind them."""
        return [
            _row(criterion, self._select_learned_ellipses(criterion), f, xi)
            for f, xi in self.structures
            for criterion in self.criteria
        ]

    def _select_learned_ellipses(self, criterion: Criterion) -> EllipseTable | None:
        """Ellipses from which a criterion was learned; None for a printed law."""
        provenance = criterion.provenance
        for derivation in self.derivations:
            ellipses = derivation.ellipses
            is_same_threshold = derivation.lag.grid.threshold == criterion.threshold
            if (
                is_same_threshold
                and ellipses.share == provenance.experimental_fraction
                and population_of(ellipses) == provenance.population
            ):
                return ellipses
        return None

    @property
    def structures_with_ellipses(self) -> list[tuple[float, float]]:
        """Structures of which there are ellipses."""
        if (ellipses := self.ellipses) is None:
            return []
        return [(f, xi) for f, xi in self.structures if f in ellipses["f"] and xi in ellipses["xi"]]

    @property
    def posteriors(self) -> list[Mapping[str, Any]]:
        """Diagnostics of sampled posteriors, one for each error and side."""
        return [diagnostics for derivation in self.derivations for diagnostics in derivation.diagnostics]

    @property
    def only_row(self) -> dict[str, Any]:
        """The row where there is only one."""
        return self.rows[0] if len(self.rows) == 1 else {}

    def require_converged(self, chains: str | Path | None = None) -> None:
        """Refuse criteria of posteriors that have not converged, and say how to go on.

        `chains`: the file that kept the chains.
        """
        failures = [posterior for posterior in self.posteriors if not posterior["converged"]]
        if failures:
            complaints = " ".join(sentence for posterior in failures for sentence in posterior["complaints"])
            longer_chain = f"`steps={2 * failures[0]['steps']}`"
            advice = f"Resume with `chains={chains}` {longer_chain}" if chains else f"Give {longer_chain}"
            message = "THE POSTERIOR HAS NOT CONVERGED, and no limit above may be relied on."
            raise IncompleteError(f"{message} {complaints} {advice}.")


def _row(criterion: Criterion, sample: EllipseTable | None, f: float, xi: float) -> dict[str, Any]:
    """Summarise a criterion at one structure, with its motions where the sample has it."""
    summary = summarise(criterion, f, xi)
    if criterion.population is None:
        summary.update(_describe_kept_share(criterion, summary))
    elif sample is not None and f in sample.coordinates["f"] and xi in sample.coordinates["xi"]:
        summary.update(describe_sample(sample, criterion, f, xi))
    return summary


def _describe_kept_share(criterion: Criterion, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Measure on the real motions that ship with the package how many keep a printed law."""
    real = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"), window=criterion.provenance.window)
    share = exact_share(criterion, real, summary["f"], summary["xi"])
    sentence = (
        f"Of {share['n_motions']} real motions, {percent(share['share'], decimals=0)} have a boundary "
        f"that contains this ellipse at f = {share['f']:g} Hz and ξ = {share['xi']:g}, where the paper "
        f"states {percent(criterion.confidence)}. This was measured on the ellipses of datasets/real_suite; "
        "`reliab run validation` measures it for all structures."
    )
    return {"kept_by": share, "warnings": [sentence, *summary["warnings"]]}


def draw_criteria(folder: Path, result: Criteria) -> list[str]:
    """Draw every structure and posterior into a folder, as SVG; keep posteriors for ArviZ."""
    from reliab.report.style import FigureWarning

    dataset, criteria, structures = result.ellipses, result.criteria, result.structures_with_ellipses
    if dataset is None:
        return []
    missing = [f"f = {f:g} Hz, ξ = {xi:g}" for f, xi in result.structures if (f, xi) not in structures]
    if missing:
        remainder = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        warnings.warn(
            f"No figure for {missing[0]}{remainder}: the motions have no ellipses there. Choose f among "
            f"{_list_values(dataset, 'f')} and ξ among {_list_values(dataset, 'xi')} for one.",
            FigureWarning,
            stacklevel=2,
        )
    errors = list(dict.fromkeys((criterion.threshold, str(criterion.metric)) for criterion in criteria))
    jobs = [(*structure, *error) for structure in structures for error in errors]
    names = []
    with show_task("Drawing") as progress:
        for count, (f, xi, threshold, metric) in enumerate(jobs, start=1):
            candidates = [
                criterion
                for criterion in criteria
                if (criterion.threshold, str(criterion.metric)) == (threshold, metric)
            ]
            figure = _plane(dataset, candidates, f, xi)
            names.append(_write(folder, f"criterion_f{f:g}_xi{xi:g}_{metric}{threshold:g}.svg", figure))
            progress(count, len(jobs))
    return names + _write_posteriors(folder, result.derivations)


def _write_posteriors(folder: Path, derivations: "Sequence[Derivation]") -> list[str]:
    """Draw traces, ranks and pairs of every posterior, and keep its draws."""
    names = []
    for side_limits in (part for derivation in derivations for part in derivation.side_limits):
        if side_limits.posterior_sample is None:
            continue
        side = "" if side_limits.grid.side == Side.LAG else f"_{side_limits.grid.side}"
        error = f"{side_limits.grid.metric}{side_limits.grid.threshold:g}{side}"
        for name, figure in _posterior_figures(side_limits.posterior_sample).items():
            names.append(_write(folder, f"{name}_{error}.svg", figure))
        names.append(f"posterior_{error}.nc")
        side_limits.posterior_sample.write_netcdf(folder / names[-1])
    return names


def _list_values(dataset: "xr.Dataset", name: str) -> str:
    return ", ".join(f"{value:g}" for value in dataset[name].values)


def _plane(dataset: "xr.Dataset", criteria: "Sequence[Criterion]", f: float, xi: float) -> "Figure":
    from reliab.report.figures.parameter_distributions import ellipses_and_criterion
    from reliab.report.style import VERMILION

    first = criteria[0]
    sample = sample_of(
        dataset,
        frequency=f,
        damping_ratio=xi,
        threshold=first.threshold,
        metric=str(first.metric),
        curve=first.provenance.curve,
    )
    parameters_by_label = {}
    for criterion in criteria:
        a, b = (float(limit) for limit in criterion.limits(f, xi))
        if a > 0.0 and b > 0.0:
            parameters_by_label[_share_in_words(criterion)] = (a, b)
    figure = ellipses_and_criterion(sample, parameters_by_label)
    if not first.provenance.settings.get("converged", True):
        figure.axes[0].set_title("POSTERIOR NOT CONVERGED: not to be relied on", color=VERMILION)
    return figure


def _share_in_words(criterion: "Criterion") -> str:
    if criterion.population is None:
        return f"{criterion.law.name}, stated for {percent(criterion.confidence)} of motions"
    if criterion.promise is None:
        return f"asked for at {percent(criterion.confidence)}, no share promised"
    return f"{percent(criterion.promise)} of motions"


def _posterior_figures(posterior: "PosteriorSample") -> Mapping[str, "Figure"]:
    from reliab.report.figures.parameter_distributions import pairs, ranks, traces

    chief = [
        *("a: constant", "b: constant", "event: log spread of a", "motion: log spread of a"),
        "log degrees of freedom",
    ]
    present = [name for name in chief if name in posterior.names]
    return {
        "traces": traces(posterior),
        "ranks": ranks(posterior),
        "pairs": pairs(posterior, present),
    }


def _write(folder: Path, name: str, figure: Any) -> str:  # noqa: ANN401 - matplotlib's figure
    from reliab.report.style import svg

    with refuse_unwritable("Cannot write to the folder of the figures", where=folder):
        folder.mkdir(parents=True, exist_ok=True)
        with written_whole(folder / name) as file:
            file.write_bytes(svg(figure))
    return name


def summarise(criterion: Criterion, frequency: float, damping_ratio: float) -> dict[str, Any]:
    """Summarise a criterion at one structure.

    `frequency`, `damping_ratio`: the structure [Hz, -]. Returns limits `a` [-] and `b` [ms²] of lags,
    `a_lead` and `b_lead` of leads (None where the criterion has none); `amplitude_limit` [-],
    `delay_limit_ms` and `lead_limit_ms` [ms], the largest amplitude error, lag and lead of a test that has no
    other error; the promise, and the data behind it; ready for JSON.

    >>> from reliab.criterion.derivation import published_criterion
    >>> summary = summarise(published_criterion("guo_2017_12"), 1.0, 0.02)
    >>> round(summary["amplitude_limit"], 4), round(summary["delay_limit_ms"], 2)
    (0.0073, 1.02)
    """
    a, b = (float(limit) for limit in criterion.limits(frequency, damping_ratio))
    lead = (None, None) if criterion.lead_law is None else criterion.lead_law.limits(frequency, damping_ratio)
    a_lead, b_lead = (None if limit is None else float(limit) for limit in lead)
    return {
        "a": a,
        "b": b,
        "a_lead": a_lead,
        "b_lead": b_lead,
        "f": frequency,
        "xi": damping_ratio,
        "threshold": criterion.threshold,
        "metric": criterion.metric,
        "confidence": criterion.promise,
        "method": criterion.method,
        "joint": criterion.joint,
        **criterion.provenance.settings,
        "law": criterion.law.name,
        "equation": criterion.law.equation,
        "amplitude_limit": float(np.sqrt(a)),
        "delay_limit_ms": float(np.sqrt(b)),
        "lead_limit_ms": None if b_lead is None else float(np.sqrt(b_lead)),
        "window": criterion.provenance.window,
        "alpha": criterion.provenance.experimental_fraction,
        "curve": criterion.provenance.curve,
        "motions": criterion.provenance.motions,
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "population": criterion.provenance.population,
        "scope": criterion.provenance.scope,
        "position": criterion.provenance.position,
        "warnings": list(criterion.provenance.warnings),
    }


def describe_sample(
    ellipses: Ellipses, criterion: Criterion, frequency: float, damping_ratio: float
) -> dict[str, Any]:
    """Describe the motions of one structure that a criterion was derived from.

    `frequency`, `damping_ratio`: the structure [Hz, -], one of the dataset's. Returns `correlation` of a and
    b, `n_motions` and `n_events` with an ellipse there, and the parameters of the lognormal distributions
    fitted to a and b.
    """
    sample = sample_of(
        ellipses,
        frequency=frequency,
        damping_ratio=damping_ratio,
        threshold=criterion.threshold,
        metric=criterion.metric,
        curve=criterion.provenance.curve,
    )
    fits = {"a": Lognormal.fit(sample.a), "b": Lognormal.fit(sample.b)}
    return {
        "correlation": sample.correlation,
        "n_motions": sample.n_motions,
        "n_events": sample.n_events,
        "lognormal": {name: {"mu": fit.mu, "sigma": fit.sigma} for name, fit in fits.items()},
    }
