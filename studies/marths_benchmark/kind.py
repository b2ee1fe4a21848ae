"""The study that runs the virtual multi-axial benchmark."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import AfterValidator, Field

from reliab.core.errors import InputError
from reliab.core.files import written_whole
from reliab.core.progress import show_task
from reliab.report.document import Document
from reliab.study.description import Names, RecordsStudy, StudyKind, StudyTable
from reliab.study.stages import Stage, read_result, software_provenance
from reliab.study.steps import Records

from .controllers import CONTROLLERS, find_controller

TESTS: Final = "marths.json"


def _require_controllers(names: tuple[str, ...]) -> tuple[str, ...]:
    for name in names:
        find_controller(name)
    return names


class MultiAxialTable(StudyTable):
    """`[marths]`: which controllers, and how many uncertain plants."""

    controllers: Annotated[Names, AfterValidator(_require_controllers)] = CONTROLLERS
    perturbed: Annotated[int, Field(ge=0, le=10_000)] = 102
    seed: Annotated[int, Field(ge=0)] = 0
    threshold: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.05


class MultiAxialStudy(RecordsStudy):
    """A study of the multi-axial benchmark."""

    marths: MultiAxialTable = MultiAxialTable()


def stages(study: MultiAxialStudy) -> Sequence[Stage]:
    """Run the benchmark."""
    if study.motions.sources is None:
        raise InputError(
            "The multi-axial benchmark is run with its own records, which do not ship",
            value="no ground motions",
            remedy="Give the folder of ElCentro.csv, Kobe.csv and Morgan.csv with `motions`",
        )
    records, table = Records(study), study.marths

    def tests(folder: Path) -> None:
        from .outcomes import MultiAxialRequest, run_benchmark

        request = MultiAxialRequest(controllers=table.controllers, perturbed=table.perturbed, seed=table.seed)
        with show_task("Running the multi-axial benchmark") as progress:
            rows = run_benchmark(list(records.motions), request, progress=progress)
        with written_whole(folder / TESTS) as file:
            content = json.dumps({"tests": rows}, ensure_ascii=False, allow_nan=False, indent=1)
            file.write_text(content, encoding="utf-8")

    inputs: dict[str, Any] = {"motions": records.checksums, "marths": table.model_dump(mode="json")}
    return (Stage(name="multi-axial benchmark", inputs=inputs, writes=(TESTS,), work=tests),)


def report(study: MultiAxialStudy, folder: Path) -> Document:
    """Report the benchmark."""
    from .report import marths_report

    return marths_report(
        title=study.title,
        tests=read_result(folder / TESTS)["tests"],
        threshold=study.marths.threshold,
        provenance={**study.provenance, **software_provenance(folder)},
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="marths_benchmark", tables=MultiAxialStudy, stages=stages, report=report)
"""The field's multi-axial yardstick, run through."""
