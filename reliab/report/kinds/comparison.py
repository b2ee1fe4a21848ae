"""Report of tests that are ranked by their errors."""

from reliab.assessment.comparison import Comparison
from reliab.core.columns import side, write_cells
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.report.document import Document, Figure, Points, text_table


def comparison_report(comparison: Comparison, *, has_figure: bool = True) -> Document:
    """Report the ranking, drawn or as a table alone, and below it what limits it."""
    other_metric = Metric.MTE if comparison.metric is Metric.RMS else Metric.RMS
    columns = {
        heading: column for heading, column in comparison.table_columns.items() if column[0] != other_metric
    }
    rows = write_cells(columns, comparison.plain_rows())
    headings = {heading: side(column) for heading, column in columns.items()}
    caption = f"Ranked by error; the threshold is {percent(comparison.threshold)}."
    faults = (f"{file}: {reason}" for file, reason in comparison.faults.items())
    return Document(
        kind="Comparison of tests",
        title=f"{len(comparison.tests)} tests",
        verdict=f"The error of {comparison.tests[0].file} is probably the smallest.",
        blocks=(
            text_table(rows, headings, caption=caption),
            *([_figure(comparison)] if has_figure else []),
            Points(items=(comparison.assumed, *comparison.notes, *faults)),
        ),
        sheet=True,
    )


def _figure(comparison: Comparison) -> Figure:
    from reliab.report.figures.tests_by_error import draw_ranked_tests

    return Figure(drawing=draw_ranked_tests(comparison), caption="Errors with their 90 % intervals.")
