"""Studies that compare a suite with the real one, and judge what was learned from it on real motions."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
import xarray as xr

from reliab.criterion.provenance import records_checksum
from reliab.report import Document
from reliab.shipped import shipped
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage, digest
from reliab.study.steps import (
    CRITERIA,
    ELLIPSES,
    Material,
    Show,
    candidates,
    criteria_of,
    derivation,
    opened,
    simulation,
    tracing,
)
from reliab.sweep import open_ellipses
from reliab.validation.cross_validation import CrossValidation, Fold, cross_validate

MEASURES: Final = "measures.csv"
SPECTRA: Final = "spectra.nc"
TRANSFER: Final = "transfer.nc"

_REFERENCE = "real_suite"
_NAMES = ("real", "compared")


class SuitesStudy(Kind):
    """A suite beside the real one: measures, spectra, ellipses, criteria, and their transfer."""

    name = "suites"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Measure, simulate, trace, derive; then judge on the real motions."""
        return (
            _measuring(material, show),
            *simulation(material, show),
            tracing(material, show),
            derivation(material.study),
            _transfer(material.study, show),
        )

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Compare the suites."""
        from reliab.report.kinds.rates import rates_table
        from reliab.report.kinds.suites import suites_report

        real, own = _reference(study), open_ellipses(folder / ELLIPSES)
        names = (_NAMES[0], study.motions.sources[0] if study.motions.sources else _NAMES[1])
        transfer = CrossValidation(
            counts=opened(folder / TRANSFER),
            scheme=f"{names[1]} to {names[0]}",
            threshold=study.errors.thresholds[0],
            metric=study.errors.metrics[0],
        )
        return suites_report(
            title=study.title,
            measures={
                names[0]: _with_ellipses(pd.read_csv(_shipped(MEASURES)), real, study),
                names[1]: _with_ellipses(pd.read_csv(folder / MEASURES), own, study),
            },
            spectra={
                names[0]: opened(_shipped(SPECTRA))["spectral_acceleration"],
                names[1]: opened(folder / SPECTRA)["spectral_acceleration"],
            },
            limits=_limits(study, folder, real, names),
            coverage=rates_table(transfer),
            confidence=study.criterion.confidences[0],
            provenance={
                **study.provenance,
                f"records of {names[0]}, SHA-256": records_checksum(real),
                f"records of {names[1]}, SHA-256": records_checksum(own),
            },
            purpose=study.purpose,
        )


def _measuring(material: Material, show: Show) -> Stage:
    def work(folder: Path) -> None:
        from reliab.validation.suite_comparison import response_spectra, suite_measures

        with show("Measuring the motions"):
            suite_measures(material.motions).to_csv(folder / MEASURES, index=False)
            response_spectra(material.motions).to_netcdf(folder / SPECTRA, engine="h5netcdf")

    inputs = {"motions": material.checksums}
    return Stage(name="measure", inputs=inputs, writes=(MEASURES, SPECTRA), work=work)


def _transfer(study: Study, show: Show) -> Stage:
    """Learn from the suite, judge on the real motions."""

    def work(folder: Path) -> None:
        real = _reference(study)
        everything = np.ones(real.sizes["motion"], dtype=np.bool_)
        with show("Judging on the real motions") as progress:
            found = cross_validate(
                real,
                [Fold(name="all", learned=~everything, judged=everything)],
                candidates(study)[:1],
                scheme="transfer",
                confidences=study.validation.confidences,
                threshold=study.errors.thresholds[0],
                metric=study.errors.metrics[0],
                trials=study.validation.trials,
                learn_from=open_ellipses(folder / ELLIPSES),
                progress=progress,
            )
        found.counts.to_netcdf(folder / TRANSFER, engine="h5netcdf")

    inputs = {
        **study.model_dump(include={"structures", "errors", "criterion", "validation"}),
        "real": digest(_shipped(ELLIPSES)),
    }
    return Stage(name="transfer", inputs=inputs, reads=(ELLIPSES, CRITERIA), writes=(TRANSFER,), work=work)


def _reference(study: Study) -> xr.Dataset:
    structures = study.structures
    return open_ellipses(_shipped(ELLIPSES)).sel(f=list(structures.f), xi=list(structures.xi))


def _with_ellipses(measures: pd.DataFrame, ellipses: xr.Dataset, study: Study) -> pd.DataFrame:
    """Add a and b of the study's first structure and error."""
    at = ellipses.sel(
        f=study.structures.f[0],
        xi=study.structures.xi[0],
        threshold=study.errors.thresholds[0],
        metric=study.errors.metrics[0],
        curve="ellipse",
    )
    own = pd.DataFrame({"motion": at["motion"].values, "a": at["a"].values, "b": at["b"].values})
    return measures.merge(own, on="motion", validate="one_to_one")


def _limits(study: Study, folder: Path, real: xr.Dataset, names: tuple[str, str]) -> pd.DataFrame:
    """Limits of both suites' criteria at every structure."""
    (candidate, *_), own = candidates(study), criteria_of(folder)[0]
    law = candidate.learn(real, own.threshold, own.metric, own.confidence)
    rows = []
    for suite, limits in zip(names, (law.limits, own.limits), strict=True):
        for f in study.structures.f:
            for xi in study.structures.xi:
                a, b = limits(f, xi)
                rows.append({"suite": suite, "f": f, "xi": xi, "a": float(a), "b": float(b)})
    return pd.DataFrame(rows)


def _shipped(file: str) -> Path:
    return shipped("datasets", f"{_REFERENCE}/{file}")
