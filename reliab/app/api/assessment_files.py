"""Files that an assessment leaves: the report that is filed with a test, the table of verdicts, the chart."""

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.assessment.assessment import Assessment
from reliab.core.files import refuse_unwritable, require_ending, written_whole
from reliab.core.plain_values import write_table
from reliab.core.shipped import checksum_of, or_shipped

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from reliab.app.api.design import Design
    from reliab.assessment.assess import AnyAssessment
    from reliab.assessment.comparison import Comparison
    from reliab.report.document import Document
    from reliab.report.setting import ReportSetting


def file_report(
    assessment: "AnyAssessment",
    report: str | Path,
    *,
    test: str | Path,
    structure: str | Path | None = None,
    setting: "ReportSetting | None" = None,
) -> None:
    """Write the report that is filed with a test, with the checksums of the files from which it was made.

    `test`, `structure`: the test's file, and that of the frame where there is one; `setting`: paper, title,
    date (today by default), and name and logo of the laboratory.
    """
    require_ending(report, ".pdf")
    from reliab.report.pdf import write_pdf

    document = document_of_test(assessment, test=test, structure=structure)
    write_pdf(document, Path(report), date=datetime.now(tz=UTC).date(), setting=setting)


def document_of_test(
    assessment: "AnyAssessment",
    *,
    test: str | Path,
    structure: str | Path | None = None,
) -> "Document":
    """Make the document that :func:`file_report` sets as a PDF; arguments are the same."""
    from reliab.report.kinds.assessment.frame import frame_assessment_report
    from reliab.report.kinds.assessment.report import assessment_report

    files = {"file": or_shipped(Path(test), "datasets", "test.csv")}
    if structure is not None:
        files["structure"] = Path(structure)
    checksums: dict[str, object] = {}
    for name, path in files.items():
        checksums |= {name: path.name, f"{name}, SHA-256": checksum_of(path)}
    if isinstance(assessment, Assessment):
        return assessment_report(assessment, provenance=checksums)
    return frame_assessment_report(assessment, provenance=checksums)


def write_tests(tests: "Comparison | Iterable[Mapping[str, Any]]", out: str | Path) -> None:
    """Write the table of ranked tests or of verdicts, one row for each test.

    `tests`: what :func:`reliab.compare` answered; or what was found about each test, as `to_dict` of its
    assessment, with its `file`; or `file` and `fault`.
    """
    from reliab.assessment.comparison import Comparison
    from reliab.assessment.judged_test import verdict_table

    rows = tests.to_dataframe() if isinstance(tests, Comparison) else verdict_table(tests)
    require_ending(out, ".csv")
    write_table(rows, out)


def draw_chart(answer: "Design | Comparison", figure: str | Path) -> None:
    """Draw the chart of tolerable errors over the frequency, or of ranked tests.

    `figure`: the file, which ends in .svg, .png or .pdf.
    """
    from reliab.app.api.design import Design
    from reliab.report.figures.tests_by_error import draw_ranked_tests, tolerable_errors_over_frequency
    from reliab.report.style import picture

    chart = (
        tolerable_errors_over_frequency(answer.chart)
        if isinstance(answer, Design)
        else draw_ranked_tests(answer)
    )
    require_ending(figure, ".svg", ".png", ".pdf")
    with refuse_unwritable("Cannot write the figure", where=figure), written_whole(figure) as file:
        file.write_bytes(picture(chart, Path(figure).suffix.lower()))


def write_corrected(assessment: "AnyAssessment", out: str | Path) -> str:
    """Write the response that a perfect actuator would have produced.

    `out`: the file: CSV, or NetCDF with the attributes of `reliab.assessment.corrected_response`. Returns how
    large the correction is, where it is no longer small, and what is not known.
    """
    require_ending(out, ".csv", ".nc")
    from reliab.assessment.corrected_response import correct_response

    response = correct_response(assessment)
    if Path(out).suffix.lower() == ".csv":
        write_table(response.to_dataframe(), out, index=True)
        return str(response.attrs["note"])
    rule = "Cannot write the file of the corrected response"
    with refuse_unwritable(rule, where=out), written_whole(out) as file:
        file.write_bytes(response.to_netcdf(engine="h5netcdf"))
    return str(response.attrs["note"])
