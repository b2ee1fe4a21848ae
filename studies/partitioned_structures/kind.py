"""The study of what predicts the error of partitioned tests."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final

from pydantic import Field

from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.report.document import Document
from reliab.study.description import RecordsStudy, StudyKind, StudyTable
from reliab.study.stages import Stage, software_provenance
from reliab.study.steps import Records

TESTS: Final = "tests.csv"
SHARES: Final = "shares.csv"


class PartitionedTable(StudyTable):
    """`[partitioned]`: how many tests, and the seed of their draws."""

    tests: Annotated[int, Field(ge=1, le=10_000)] = 270
    seed: Annotated[int, Field(ge=0)] = 0


class PartitionedStudy(RecordsStudy):
    """A study of partitioned tests."""

    partitioned: PartitionedTable = PartitionedTable()


def stages(study: PartitionedStudy) -> Sequence[Stage]:
    """Draw the tests, run them, and predict their errors."""
    records, table = Records(study), study.partitioned

    def work(folder: Path) -> None:
        from .running import draw_tests, run_tests, shares_of_structures

        with show_task("Running partitioned tests") as progress:
            tests = run_tests(draw_tests(list(records.motions), table.tests, table.seed), progress=progress)
        write_table(tests, folder / TESTS)
        write_table(shares_of_structures(), folder / SHARES)

    inputs = {"motions": records.checksums, "partitioned": table.model_dump(mode="json")}
    return (Stage(name="tests", inputs=inputs, writes=(TESTS, SHARES), work=work),)


def report(study: PartitionedStudy, folder: Path) -> Document:
    """Report predictions against simulated errors."""
    from .report import report_partitioned_structures

    return report_partitioned_structures(
        title=study.title,
        tests=read_table(folder / TESTS),
        shares=read_table(folder / SHARES),
        provenance={**study.provenance, **software_provenance(folder)},
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="partitioned_structures", tables=PartitionedStudy, stages=stages, report=report)
"""What A and d can see of a partitioned structure, and what they cannot."""
