"""Criteria drawn over the motions' own ellipses, and posteriors."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.errors import InputError
from reliab.files import refuse_unwritable, written_whole
from reliab.progress import Show

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from reliab.criterion import Criterion, Derivation
    from reliab.sampling import PosteriorSample


def draw_criteria(
    folder: Path,
    dataset: "xr.Dataset | None",
    criteria: "Sequence[Criterion]",
    structures: Sequence[tuple[float, float]],
    derivations: "Sequence[Derivation]",
    show: Show,
) -> list[str]:
    """Draw every structure and posterior into a folder, as SVG; keep posteriors for ArviZ."""
    if dataset is None:
        raise InputError(
            "A criterion is drawn over ellipses of motions",
            value="`figures` without a source of ellipses",
            remedy="Give `motions`, `results` or `ellipses` too, real_suite for example",
        )
    held = [(f, xi) for f, xi in structures if f in dataset["f"] and xi in dataset["xi"]]
    if not held:
        raise InputError(
            "A criterion is drawn over ellipses of motions at the same structure",
            value="none of those that are asked for",
            remedy=f"Choose f among {_listed(dataset, 'f')} and ξ among {_listed(dataset, 'xi')}",
        )
    errors = list(dict.fromkeys((criterion.threshold, str(criterion.metric)) for criterion in criteria))
    jobs = [(*structure, *error) for structure in held for error in errors]
    names = []
    with show("Drawing") as progress:
        for done, (f, xi, threshold, metric) in enumerate(jobs, start=1):
            alike = [
                criterion
                for criterion in criteria
                if (criterion.threshold, str(criterion.metric)) == (threshold, metric)
            ]
            drawn = _plane(dataset, alike, f, xi)
            names.append(_write(folder, f"criterion_f{f:g}_xi{xi:g}_{metric}{threshold:g}.svg", drawn))
            progress(done, len(jobs))
    return names + _write_posteriors(folder, derivations)


def _write_posteriors(folder: Path, derivations: "Sequence[Derivation]") -> list[str]:
    """Draw traces, ranks and pairs of every posterior, and keep its draws."""
    from reliab.vocabulary import Side

    names = []
    for learned in (part for derivation in derivations for part in derivation.learned):
        if learned.sampled is None:
            continue
        side = "" if learned.grid.side == Side.LAG else f"_{learned.grid.side}"
        error = f"{learned.grid.metric}{learned.grid.threshold:g}{side}"
        for name, drawn in _posterior_figures(learned.sampled).items():
            names.append(_write(folder, f"{name}_{error}.svg", drawn))
        names.append(f"posterior_{error}.nc")
        learned.sampled.write_netcdf(folder / names[-1])
    return names


def _listed(dataset: "xr.Dataset", name: str) -> str:
    return ", ".join(f"{value:g}" for value in dataset[name].values)


def _plane(dataset: "xr.Dataset", alike: "Sequence[Criterion]", f: float, xi: float) -> "Figure":
    from reliab.criterion import sample_of
    from reliab.report import VERMILION
    from reliab.report.figures import ellipses_and_criterion

    first = alike[0]
    sample = sample_of(
        dataset,
        frequency=f,
        damping_ratio=xi,
        threshold=first.threshold,
        metric=str(first.metric),
        curve=first.provenance.curve,
    )
    named = {}
    for criterion in alike:
        a, b = (float(limit) for limit in criterion.limits(f, xi))
        if a > 0.0 and b > 0.0:
            named[_share_in_words(criterion)] = (a, b)
    drawn = ellipses_and_criterion(sample, named)
    if not first.provenance.settings.get("converged", True):
        drawn.axes[0].set_title("POSTERIOR NOT CONVERGED: not to be relied on", color=VERMILION)
    return drawn


def _share_in_words(criterion: "Criterion") -> str:
    from reliab.significant import percent

    if criterion.population is None:
        return f"{criterion.law.name}, stated for {percent(criterion.confidence)} of motions"
    if criterion.promise is None:
        return f"asked for at {percent(criterion.confidence)}, no share promised"
    return f"{percent(criterion.promise)} of motions"


def _posterior_figures(posterior: "PosteriorSample") -> Mapping[str, "Figure"]:
    from reliab.report.figures import pairs, ranks, traces

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


def _write(folder: Path, name: str, drawn: Any) -> str:  # noqa: ANN401 - matplotlib's figure
    from reliab.report import svg

    with refuse_unwritable("The folder of the figures must be writable", where=folder):
        folder.mkdir(parents=True, exist_ok=True)
        with written_whole(folder / name) as file:
            file.write_bytes(svg(drawn))
    return name
