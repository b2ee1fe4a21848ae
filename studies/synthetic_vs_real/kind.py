"""Studies that compare a suite with the real one, and judge what was learned from it on real motions."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.criterion.scope import records_checksum
from reliab.report.document import Document
from reliab.study.description import CriterionTable, SimulatedStudy, StudyKind, TransferValidationTable
from reliab.study.stages import Stage, digest, software_provenance
from reliab.study.steps import (
    CRITERIA,
    ELLIPSES,
    SYNTHETIC,
    Material,
    candidates,
    derivation,
    derivation_of,
    read_run_dataset,
    simulation,
    tracing,
)
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.netcdf import write_netcdf
from reliab.sweep.results import REAL, open_results, real_results
from reliab.validation.counts import CrossValidation
from reliab.validation.folds import earthquakes_among, from_another
from reliab.validation.judge import cross_validate
from reliab.validation.truth import StoredTruth

MEASURES: Final = "measures.csv"
SPECTRA: Final = "spectra.nc"
TRANSFER: Final = "transfer.nc"

_NAME = "real"


class SuitesStudy(SimulatedStudy):
    """A suite beside the real one: measures, spectra, ellipses, criteria, and their transfer."""

    criterion: CriterionTable = CriterionTable()
    validation: TransferValidationTable = TransferValidationTable()


def stages(study: SuitesStudy) -> Sequence[Stage]:
    """Measure, simulate, trace, derive; then judge on the real motions."""
    material = Material(study)
    return (
        _measuring(material),
        *simulation(study, material),
        tracing(study, material),
        derivation(study.errors, study.criterion),
        _transfer(study),
    )


def report(study: SuitesStudy, folder: Path) -> Document:
    """Compare the suites."""
    from reliab.report.sections import rates_table

    from .report import suites_report

    real, compared = _reference(study), open_ellipses(folder / ELLIPSES)
    names = (_NAME, (study.motions.sources or (SYNTHETIC,))[0])
    transfer = CrossValidation(
        counts=read_run_dataset(folder / TRANSFER),
        scheme=f"{names[1]} to {names[0]}",
        threshold=study.errors.thresholds[0],
        metric=study.errors.metrics[0],
        truth="simulated",
    )
    return suites_report(
        title=study.full_title(Material(study).population),
        measures={
            names[0]: _add_ellipses(pd.read_csv(_find_shipped(MEASURES)), real, study),
            names[1]: _add_ellipses(read_table(folder / MEASURES), compared, study),
        },
        spectra={
            names[0]: read_run_dataset(_find_shipped(SPECTRA))["spectral_acceleration"],
            names[1]: read_run_dataset(folder / SPECTRA)["spectral_acceleration"],
        },
        limits=_limits(study, folder, real, names),
        coverage=rates_table(transfer),
        confidence=study.criterion.confidences[0],
        provenance={
            **study.provenance,
            f"records of {names[0]}, SHA-256": records_checksum(real),
            f"records of {names[1]}, SHA-256": records_checksum(compared),
            **software_provenance(folder),
        },
        purpose=study.purpose,
    )


def _measuring(material: Material) -> Stage:
    def work(folder: Path) -> None:
        from .comparison import response_spectra, suite_measures

        with show_task("Measuring the motions"):
            write_table(suite_measures(material.motions), folder / MEASURES)
            write_netcdf(response_spectra(material.motions), folder / SPECTRA)

    inputs = {"motions": material.checksums}
    return Stage(name="measure", inputs=inputs, writes=(MEASURES, SPECTRA), work=work)


def _transfer(study: SuitesStudy) -> Stage:
    """Learn from the suite, judge on the real motions, never by motions of the same earthquake."""
    results = real_results(study.structures.f, study.structures.xi)

    def work(folder: Path) -> None:
        real, learned = _reference(study), open_ellipses(folder / ELLIPSES)
        events, checksums = (learned[name].values.tolist() for name in ("event", "checksum"))
        among = np.array([name or "" for name in earthquakes_among(events, checksums, real)], dtype=np.str_)
        shared = [name if name in among else None for name in real["event"].values.tolist()]
        with show_task("Judging on the real motions") as progress:
            validation = cross_validate(
                real,
                from_another(shared, among),
                candidates(study.errors, study.criterion)[:1],
                scheme="transfer",
                confidences=study.validation.confidences,
                threshold=study.errors.thresholds[0],
                metric=study.errors.metrics[0],
                truth=StoredTruth(open_results(results)),
                trials=study.validation.trials,
                learn_from=learned,
                progress=progress,
            )
        write_netcdf(validation.counts, folder / TRANSFER)

    inputs = {
        **study.model_dump(include={"structures", "errors", "criterion", "validation"}),
        "real": [digest(_find_shipped(ELLIPSES)), digest(results)],
    }
    return Stage(name="transfer", inputs=inputs, reads=(ELLIPSES, CRITERIA), writes=(TRANSFER,), work=work)


def _reference(study: SuitesStudy) -> xr.Dataset:
    structures = study.structures
    try:
        return open_ellipses(_find_shipped(ELLIPSES)).sel(
            f=list(structures.f), xi=list(structures.xi), method="nearest", tolerance=1e-9
        )
    except KeyError:
        raise InputError(
            "A suite is compared at structures that the results of the real suite hold",
            value=f"f = {list(structures.f)}, xi = {list(structures.xi)}",
            remedy="Choose among 0.25, 0.5, … 2 Hz and 0.02, 0.03, … 0.1",
        ) from None


def _add_ellipses(measures: pd.DataFrame, ellipses: xr.Dataset, study: SuitesStudy) -> pd.DataFrame:
    """Add a and b of the study's first structure and error."""
    at = ellipses.sel(
        f=study.structures.f[0],
        xi=study.structures.xi[0],
        threshold=study.errors.thresholds[0],
        metric=study.errors.metrics[0],
        curve="ellipse",
        side="lag",
    )
    fitted = pd.DataFrame({"motion": at["motion"].values, "a": at["a"].values, "b": at["b"].values})
    return measures.merge(fitted, on="motion", validate="one_to_one")


def _limits(study: SuitesStudy, folder: Path, real: xr.Dataset, names: tuple[str, str]) -> pd.DataFrame:
    """Limits of both suites' criteria at every structure."""
    candidate, derived = candidates(study.errors, study.criterion)[0], derivation_of(folder).criteria[0]
    learned = candidate.learn(real, derived.threshold, derived.metric, [derived.confidence])
    laws = (learned[derived.confidence].law.limits, derived.limits)
    rows = []
    for suite, limits in zip(names, laws, strict=True):
        for f in study.structures.f:
            for xi in study.structures.xi:
                a, b = limits(f, xi)
                rows.append({"suite": suite, "f": f, "xi": xi, "a": float(a), "b": float(b)})
    return pd.DataFrame(rows)


def _find_shipped(file: str) -> Path:
    return shipped("datasets", f"{REAL}/{file}")


KIND: Final = StudyKind(name="suites", tables=SuitesStudy, stages=stages, report=report)
"""Whether a suite may stand in for real motions."""
