"""The study that audits the paper's Table 2: which rows are reproduced, and what differs in the others."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pandas as pd

from reliab.core.errors import InputError
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.report.document import Document
from reliab.study.description import RecordsStudy, StudyKind
from reliab.study.stages import Stage, digest, software_provenance
from reliab.study.steps import Records

ROWS: Final = "table2.csv"


def stages(study: RecordsStudy) -> Sequence[Stage]:
    """Audit the table row by row."""
    if study.motions.sources is None:
        raise InputError(
            "Table 2 is audited with its records",
            value="no ground motions",
            remedy="Give the folder of the records with `motions`",
        )
    records, table = Records(study), shipped("datasets", "paper/table2.csv")

    def work(folder: Path) -> None:
        from .audit import audit_table2

        with show_task("Auditing Table 2") as progress:
            rows = audit_table2(records.motions, pd.read_csv(table), progress=progress)
        write_table(rows, folder / ROWS)

    inputs = {"motions": records.checksums, "printed": digest(table)}
    return (Stage(name="audit", inputs=inputs, writes=(ROWS,), work=work),)


def report(study: RecordsStudy, folder: Path) -> Document:
    """Report the rows."""
    from .report import table_audit_report

    return table_audit_report(
        title=study.title,
        rows=read_table(folder / ROWS),
        provenance={**study.provenance, **software_provenance(folder)},
    )


KIND: Final = StudyKind(name="table_audit", tables=RecordsStudy, stages=stages, report=report)
"""Table 2 as measured data against our simulation of its records."""
