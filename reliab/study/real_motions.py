"""How many of the real ground motions that ship contain a criterion that was derived from others."""

import json
from pathlib import Path
from typing import Final

import numpy as np

from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.shipped import shipped
from reliab.study.description import CriterionStudy
from reliab.study.digests import digest
from reliab.study.material import Material
from reliab.study.stages import Stage, read_result
from reliab.study.steps import CRITERIA, ELLIPSES, derivation_of
from reliab.sweep import REAL, open_ellipses, open_results, real_results
from reliab.validation import earthquakes_among
from reliab.validation.cross_validation import CrossValidation, Fold, Printed, StoredTruth, cross_validate

REAL_MOTIONS: Final = "real_motions.json"


def on_real_motions(study: CriterionStudy, material: Material) -> list[Stage]:
    """Judge the study's criterion on the real motions that ship, unless it was derived from them.

    Returns one stage, or none where the shipped results hold no such structure, error or window.
    """
    results = _results(study)
    alike = study.errors.window == "record" and study.structures.experimental_fraction == 1.0
    if material.is_real_suite or not alike:
        return []

    def work(folder: Path) -> None:
        criteria = derivation_of(folder).criteria
        judged = _judged(criteria[0], folder, results) if criteria else None
        content = None if judged is None else _content(judged)
        with written_whole(folder / REAL_MOTIONS) as file:
            file.write_text(json.dumps(content), encoding="utf-8")

    return [
        Stage(
            name="real motions",
            inputs={"real": digest(results)},
            reads=(CRITERIA, ELLIPSES),
            writes=(REAL_MOTIONS,),
            work=work,
        )
    ]


def real_share(path: Path) -> dict[str, float] | None:
    """Read how many real motions contain the criterion of a run.

    Returns [-].
    Returns `rate`, `low`, `high` [-] (95 % interval over earthquakes), `n_motions` and `n_events`; None where
    it was not judged.
    """
    return dict(read_result(path)) if path.exists() else None


def _results(study: CriterionStudy) -> Path:
    """Results that hold the study's structures, or those of six that every installation has."""
    try:
        return real_results(study.structures.f, study.structures.xi)
    except InputError:
        return real_results((), ())


def _judged(criterion: Criterion, folder: Path, results: Path) -> CrossValidation | None:
    """Judge a criterion on the real motions of earthquakes that it was not learned from."""
    simulated = open_results(results)
    learned = open_ellipses(folder / ELLIPSES)
    real = open_ellipses(shipped("datasets", f"{REAL}/ellipses.nc"))
    nodes = [np.intersect1d(np.round(learned[name], 9), np.round(simulated[name], 9)) for name in ("f", "xi")]
    known = {
        *earthquakes_among(learned["event"].values.tolist(), learned["checksum"].values.tolist(), real)
    } - {None}
    kept = ~np.isin(real["event"].values, [name for name in known if name])
    if not (nodes[0].size and nodes[1].size and kept.any()):
        return None
    thresholds = real["threshold"].values
    nearest = float(thresholds[np.argmin(np.abs(thresholds - criterion.threshold))])
    of_structures = real.sel(f=nodes[0], xi=nodes[1], method="nearest").sel(threshold=[nearest])
    try:
        return cross_validate(
            of_structures.assign_coords(threshold=[criterion.threshold]),
            [Fold(name="all", learned=np.zeros(kept.size, dtype=np.bool_), judged=kept)],
            [
                Printed(
                    name="criterion",
                    law=criterion.law,
                    lead_law=criterion.lead_law,
                    confidence=criterion.confidence,
                )
            ],
            scheme="real motions",
            confidences=(criterion.confidence,),
            threshold=criterion.threshold,
            metric=criterion.metric,
            truth=StoredTruth(simulated),
            trials=64,
        )
    except InputError:
        return None


def _content(validation: CrossValidation) -> dict[str, float] | None:
    """Rate with its interval, and how many motions it is of."""
    counts = validation.counts.sel(side="lag").sum(["f", "xi"]).squeeze(["candidate", "confidence"])
    judged = counts["judged"].values > 0
    if not judged.any():
        return None
    rate = validation.containment()
    return {
        **{name: float(rate[name].item()) for name in ("rate", "low", "high")},
        "n_motions": int(judged.sum()),
        "n_events": len(set(counts["event"].values[judged].tolist())),
    }
