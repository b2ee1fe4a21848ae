"""The study of specimens that are known by their force only."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import AfterValidator, Field

from reliab.core.errors import InputError
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.report.document import Document
from reliab.study.description import MotionsTable, Names, RecordsStudy, StudyKind, StudyTable
from reliab.study.stages import Stage, software_provenance
from reliab.study.steps import Records

from .specimens import FAMILIES

TESTS: Final = "tests.csv"
RATES: Final = "rates.csv"

_DIGITS = 6


def _require_families(names: tuple[str, ...]) -> tuple[str, ...]:
    for name in names:
        if name not in FAMILIES:
            raise InputError(
                "Families of specimens are those that the study simulates",
                value=name,
                remedy="Choose among: " + ", ".join(FAMILIES),
            )
    return names


class SpecimensTable(StudyTable):
    """`[specimens]`: which families, how many tests of each, and the error up to which a test is good."""

    families: Annotated[Names, AfterValidator(_require_families)] = tuple(FAMILIES)
    tests: Annotated[int, Field(ge=1, le=10_000)] = 1
    seed: Annotated[int, Field(ge=0)] = 1
    threshold: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.05


class MeasuredSpecimenStudy(RecordsStudy):
    """A study of specimens that are learned from their own force."""

    motions: MotionsTable = MotionsTable()
    specimens: SpecimensTable = SpecimensTable()


def stages(study: MeasuredSpecimenStudy) -> Sequence[Stage]:
    """Simulate tests and judge them."""
    if study.motions.results is not None:
        raise InputError(
            "Tests of specimens are simulated, and take no stored results",
            value=study.motions.results,
            remedy="Leave `results` out",
        )
    records, table = Records(study), study.specimens

    def work(folder: Path) -> None:
        from .judging import judge_tests, summarise

        with show_task("Judging tests of nonlinear specimens") as progress:
            tests = judge_tests(
                list(records.motions),
                table.families,
                table.tests,
                seed=table.seed,
                threshold=table.threshold,
                progress=progress,
            )
        for name, content in ((TESTS, tests), (RATES, summarise(tests, table.threshold))):
            write_table(content.round(_DIGITS), folder / name)

    inputs: dict[str, Any] = {"motions": records.checksums, "specimens": table.model_dump(mode="json")}
    return (Stage(name="tests", inputs=inputs, writes=(TESTS, RATES), work=work),)


def report(study: MeasuredSpecimenStudy, folder: Path) -> Document:
    """Report how near the computed errors come to the true ones."""
    from .report import report_measured_specimen

    return report_measured_specimen(
        title=study.title,
        tests=read_table(folder / TESTS),
        rates=read_table(folder / RATES),
        threshold=study.specimens.threshold,
        provenance={**study.provenance, **software_provenance(folder)},
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="measured_specimen", tables=MeasuredSpecimenStudy, stages=stages, report=report)
"""Whether a specimen that nobody models is learned from its own force well enough to judge its test."""
