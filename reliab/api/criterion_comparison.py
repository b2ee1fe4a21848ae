"""Distributions and laws of a criterion judged on earthquakes that they have not seen."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from reliab.errors import InputError
from reliab.progress import Show

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion


def compare_candidates(
    dataset: "xr.Dataset | None",
    structures: Sequence[tuple[float, float]],
    criteria: "Sequence[Criterion]",
    show: Show,
) -> dict[str, Any]:
    """Compare distributions of a and b at structures, and laws over all structures of the dataset.

    Returns `distributions`, a list with `f`, `xi`, `threshold`, `parameter`, p-values of `lognormality` and
    `scores` of each distribution; `laws`, a list over threshold, law and f, empty for one structure.
    """
    import numpy as np

    if dataset is None:
        raise InputError(
            "Distributions and laws are compared on ellipses of motions",
            value="`compare` without a source of ellipses",
            remedy="Give `motions`, `results` or `ellipses` too, real_suite for example",
        )
    thresholds = list(dict.fromkeys(criterion.threshold for criterion in criteria))
    metric, confidence = str(criteria[0].metric), criteria[0].confidence
    curve = criteria[0].provenance.curve
    if np.unique(dataset["event"]).size < 2:  # noqa: PLR2004 - one is held out
        raise InputError(
            "Earthquakes are held out in turn, so at least two are needed",
            value=1,
            remedy="Give motions of more earthquakes, or leave `compare` out",
        )
    held = [(f, xi) for f, xi in structures if f in dataset["f"] and xi in dataset["xi"]]
    jobs = [(f, xi, threshold) for f, xi in held for threshold in thresholds]
    distributions: list[dict[str, Any]] = []
    with show("Comparing distributions") as progress:
        for done, (f, xi, threshold) in enumerate(jobs, start=1):
            distributions += _distributions(dataset, f, xi, threshold, metric, curve)
            progress(done, len(jobs))
    several = dataset.sizes["f"] * dataset.sizes["xi"] > 1
    laws = (
        [row for threshold in thresholds for row in _laws(dataset, threshold, metric, confidence, curve)]
        if several
        else []
    )
    return {"distributions": distributions, "laws": laws}


def _distributions(
    dataset: "xr.Dataset", f: float, xi: float, threshold: float, metric: str, curve: str
) -> list[dict[str, Any]]:
    from dataclasses import asdict

    from reliab.criterion import lognormality, sample_of
    from reliab.validation import compare_distributions

    sample = sample_of(
        dataset, frequency=f, damping_ratio=xi, threshold=threshold, metric=metric, curve=curve
    )
    where = {"f": f, "xi": xi, "threshold": threshold}
    return [
        {
            **where,
            "parameter": name,
            "lognormality": asdict(lognormality(values)),
            "scores": compare_distributions(values, sample.events)
            .rename_axis("distribution")
            .reset_index()
            .to_dict(orient="records"),
        }
        for name, values in (("a", sample.a), ("b", sample.b))
    ]


def _laws(
    dataset: "xr.Dataset", threshold: float, metric: str, confidence: float, curve: str
) -> list[dict[str, Any]]:
    from reliab.validation import compare_laws

    scores = compare_laws(dataset, threshold=threshold, metric=metric, confidence=confidence, curve=curve)
    return [
        {"threshold": threshold, **{str(k): v for k, v in row.items()}} for row in scores.to_dict("records")
    ]
