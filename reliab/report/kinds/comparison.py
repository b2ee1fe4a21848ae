"""Report of tests that are ranked by their errors."""

from reliab.assessment.comparison import Comparison
from reliab.core.columns import side, write_cells
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.report.document import Document, Figure, Points, text_table

_SURE = 0.95  # probability from which an order is taken for settled


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
        verdict=_describe_order(comparison),
        blocks=(
            text_table(rows, headings, caption=caption),
            *([_figure(comparison)] if has_figure else []),
            Points(items=(comparison.assumed, *comparison.notes, *faults)),
        ),
        sheet=True,
    )


def _describe_order(comparison: Comparison) -> str:
    """Say which test is the best, and how certain that is."""
    first, second = comparison.tests[:2]
    best = f"{first.file} probably has the smallest error, {percent(first.error.value, 2)}"
    probability = second.probability_larger
    if probability is None:
        return f"{best}."
    return f"{best}; it is smaller than that of {second.file} with probability {probability:.2f}."


def next_step(comparison: Comparison) -> str:
    """Advise what to do with the ranking."""
    probability = comparison.tests[1].probability_larger
    if probability is not None and probability < _SURE:
        return "state skew and scale of the channels, or repeat the tests, to tell the first two apart."
    return f"use what {comparison.tests[0].file} was run with, and judge it with `reliab assess`."


def _figure(comparison: Comparison) -> Figure:
    from reliab.report.figures.measured_test import draw_ranked_tests

    return Figure(drawing=draw_ranked_tests(comparison), caption="Errors with their 90 % intervals.")
