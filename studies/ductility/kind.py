"""The study of what tests with nonlinear specimens tolerate, against the linear case."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final

import pandas as pd
from pydantic import Field

from reliab.core.errors import InputError
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.core.shipped import or_shipped
from reliab.report.document import Document
from reliab.study.description import MotionsTable, RecordsStudy, StructuresTable, StudyKind, StudyTable
from reliab.study.stages import Stage, digest, software_provenance
from reliab.study.steps import Records

TESTS: Final = "tests.csv"
LEVELS: Final = "levels.csv"
LIMITS: Final = "limits.csv"

_DIGITS = 5


class DuctilityTable(StudyTable):
    """`[ductility]`: the error of the whole test up to which a test is tolerable."""

    threshold: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.05


class DuctilityStudy(RecordsStudy):
    """A study of nonlinear specimens."""

    motions: MotionsTable = MotionsTable()
    structures: StructuresTable = StructuresTable(f=(0.5, 1.0, 2.0), xi=(0.02, 0.05))
    ductility: DuctilityTable = DuctilityTable()


def stages(study: DuctilityStudy) -> Sequence[Stage]:
    """Simulate the tests, or take results that are stored."""
    if study.motions.results is not None:
        return (_taking(study, Path(study.motions.results)),)
    records = Records(study)

    def work(folder: Path) -> None:
        from reliab.structures.structure import Structure

        from .tolerances import compare_levels, compare_limits, tolerances

        table = study.structures
        structures = [
            Structure(frequency=f, damping_ratio=xi, experimental_fraction=table.experimental_fraction)
            for f in table.f
            for xi in table.xi
        ]
        threshold = study.ductility.threshold
        with show_task("Testing nonlinear specimens") as progress:
            tests = tolerances(list(records.motions), structures, threshold=threshold, progress=progress)
        limits = compare_limits(tests).assign(alpha=table.experimental_fraction, threshold=threshold)
        for name, content in ((TESTS, tests), (LEVELS, compare_levels(tests)), (LIMITS, limits)):
            write_table(content.round(_DIGITS), folder / name)

    inputs = {
        "motions": records.checksums,
        "structures": study.structures.model_dump(mode="json"),
        "ductility": study.ductility.model_dump(mode="json"),
    }
    return (Stage(name="tests", inputs=inputs, writes=(TESTS, LEVELS, LIMITS), work=work),)


def _taking(study: DuctilityStudy, results: Path) -> Stage:
    """Take results of an earlier run, or those that ship."""
    levels = or_shipped(results, "datasets", LEVELS)
    folder = levels if levels.is_dir() else levels.parent
    for name in (LEVELS, LIMITS):
        if not (folder / name).is_file():
            raise InputError(
                "Results of nonlinear specimens are a folder that an earlier run has written",
                value=f"no {name}",
                remedy="Name a run folder of this kind, or the results that ship: ductility",
                where=str(folder),
            )
    _check(study, read_table(folder / LIMITS))

    def work(into: Path) -> None:
        for name in (LEVELS, LIMITS):
            shutil.copyfile(folder / name, into / name)

    inputs = {name: digest(folder / name) for name in (LEVELS, LIMITS)}
    return Stage(name="stored results", inputs=inputs, writes=(LEVELS, LIMITS), work=work)


def _check(study: DuctilityStudy, limits: pd.DataFrame) -> None:
    """Refuse stored results of other structures or another error than the study asks for."""
    table = study.structures
    options = {
        "f": set(table.f),
        "xi": set(table.xi),
        "alpha": {table.experimental_fraction},
        "threshold": {study.ductility.threshold},
    }
    for name, values in options.items():
        stored = set(limits[name])
        if stored != values:
            raise InputError(
                "Stored results answer for the structures and the error of their own run",
                value=f"{name} = {sorted(values)}, stored is {sorted(stored)}",
                remedy="Ask for these, or give ground motions with `motions`",
            )


def report(study: DuctilityStudy, folder: Path) -> Document:
    """Report tolerances against those of linear tests."""
    from .report import ductility_report

    return ductility_report(
        title=study.title,
        levels=read_table(folder / LEVELS),
        limits=read_table(folder / LIMITS),
        provenance={**study.provenance, **software_provenance(folder)},
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="ductility", tables=DuctilityStudy, stages=stages, report=report)
"""How the tolerable amplitude error and delay grow or shrink when the specimen is not linear."""
