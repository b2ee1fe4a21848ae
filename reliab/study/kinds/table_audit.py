"""The study that audits the paper's Table 2: which rows come back, and what differs in the others."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pandas as pd

from reliab.errors import InputError
from reliab.report import Document
from reliab.shipped import shipped
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage, digest
from reliab.study.steps import Material, Show

ROWS: Final = "table2.csv"


class TableAuditStudy(Kind):
    """Table 2 as measured data against our simulation of its records."""

    name = "audit"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Audit the table row by row."""
        if material.study.motions.sources is None:
            raise InputError(
                "Table 2 is audited with its records",
                value="no ground motions",
                remedy="Give the folder of the records with --motions",
            )
        table = shipped("datasets", "paper/table2.csv")

        def work(folder: Path) -> None:
            from reliab.paper.table2_audit import audit_table2

            with show("Auditing Table 2") as progress:
                rows = audit_table2(material.motions, pd.read_csv(table), progress=progress)
            rows.to_csv(folder / ROWS, index=False)

        inputs = {"motions": material.checksums, "printed": digest(table)}
        return (Stage(name="audit", inputs=inputs, writes=(ROWS,), work=work),)

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report the rows."""
        from reliab.report.kinds.paper import table_2_report

        return table_2_report(
            title=study.title,
            rows=pd.read_csv(folder / ROWS),
            provenance=study.provenance,
            notes=(study.purpose,) if study.purpose else (),
        )
