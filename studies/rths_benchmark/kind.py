"""The study that runs the virtual hybrid-simulation benchmark."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

import pandas as pd
from pydantic import AfterValidator, Field

from reliab.core.errors import InputError
from reliab.core.files import written_whole
from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.report.document import Document
from reliab.study.description import Names, RecordsStudy, StudyKind, StudyTable
from reliab.study.stages import Stage, digest, read_result, software_provenance
from reliab.study.steps import Records

from .benchmark import benchmark_compensator
from .outcomes import STANDARD

TESTS: Final = "benchmark.json"
PUBLISHED: Final = "table3.csv"


def _require_compensators(names: tuple[str, ...]) -> tuple[str, ...]:
    for name in names:
        benchmark_compensator(name)
    return names


Case = Annotated[int, Field(ge=1, le=4)]


class BenchmarkTable(StudyTable):
    """`[benchmark]`: which cases, compensators and plants."""

    cases: Annotated[tuple[Case, ...], Field(min_length=1)] = (1, 2, 3, 4)
    compensators: Annotated[Names, AfterValidator(_require_compensators)] = STANDARD
    perturbed: Annotated[int, Field(ge=0, le=1000)] = 20
    seed: Annotated[int, Field(ge=0)] = 0
    noises: Annotated[int, Field(ge=1, le=64)] = 6
    threshold: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.05


class BenchmarkStudy(RecordsStudy):
    """A study of the benchmark."""

    benchmark: BenchmarkTable = BenchmarkTable()


_COLUMNS = ("case", "criterion", "variant", "published", "mean", "least", "most", "reached")


def _write_rows(rows: Sequence[Any], path: Path) -> None:
    with written_whole(path) as file:
        content = json.dumps({"tests": rows}, ensure_ascii=False, allow_nan=False, indent=1)
        file.write_text(content, encoding="utf-8")


def stages(study: BenchmarkStudy) -> Sequence[Stage]:
    """Run the benchmark, and its published table where El Centro is among the records."""
    if study.motions.sources is None:
        raise InputError(
            "The benchmark is run with its own records, which do not ship",
            value="no ground motions",
            remedy="Give the folder of elcentro.csv, kobe.csv and morgan.csv, unscaled, with `motions`",
        )
    records, table = Records(study), study.benchmark
    printed = shipped("datasets", f"rths_benchmark/{PUBLISHED}")

    def tests(folder: Path) -> None:
        from .outcomes import BenchmarkRequest, run_benchmark

        request = BenchmarkRequest(
            cases=table.cases,
            compensators=table.compensators,
            perturbed=table.perturbed,
            seed=table.seed,
            threshold=table.threshold,
        )
        with show_task("Running the benchmark") as progress:
            rows = run_benchmark(list(records.motions), request, progress=progress)
        _write_rows(rows, folder / TESTS)

    def published(folder: Path) -> None:
        from .outcomes import compare_with_published, find_published_motion, read_published

        motion = find_published_motion(list(records.motions))
        beside = pd.DataFrame(columns=list(_COLUMNS))
        if motion is not None:
            with show_task("Comparing with the published table"):
                beside = compare_with_published(motion, read_published(printed), seeds=table.noises)
        write_table(beside, folder / PUBLISHED)

    inputs: dict[str, Any] = {"motions": records.checksums, "benchmark": table.model_dump(mode="json")}
    return (
        Stage(
            name="published table",
            inputs={**inputs, "printed": digest(printed)},
            writes=(PUBLISHED,),
            work=published,
        ),
        Stage(name="benchmark", inputs=inputs, writes=(TESTS,), work=tests),
    )


def report(study: BenchmarkStudy, folder: Path) -> Document:
    """Report the benchmark."""
    from .report import rths_benchmark_report

    published = read_table(folder / PUBLISHED)
    return rths_benchmark_report(
        title=study.title,
        tests=read_result(folder / TESTS)["tests"],
        published=published if len(published) else None,
        threshold=study.benchmark.threshold,
        provenance={**study.provenance, **software_provenance(folder)},
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="rths_benchmark", tables=BenchmarkStudy, stages=stages, report=report)
"""The field's own yardstick, run through."""
