"""Report of tests that are ranked by their errors."""

from reliab.assessment.comparison import Comparison
from reliab.core.significant_digits import percent, percent_with_interval, significant
from reliab.report.document import Document, Figure, Points, text_table
from reliab.report.figures.tests_by_error import ranked_tests


def comparison_report(comparison: Comparison) -> Document:
    """Report the ranking, and below it what limits it."""
    metric = str(comparison.metric)
    rows = [
        (
            test["file"],
            percent_with_interval(**test[metric]),
            percent_with_interval(**test["difference"]) if test["difference"] else "",
            significant(test["probability_larger"], 3) if test["difference"] else "",
            f"{test['A']:.4f}",
            f"{test['d_ms']:.3f}",
            test["verdict"].replace("_", " "),
        )
        for test in comparison.to_dict()["tests"]
    ]
    headings = {
        "Test": "left",
        f"{metric.upper()} error (90 % interval)": "right",
        "More than the first": "right",
        "Probability of that": "right",
        "A": "right",
        "d [ms]": "right",
        "Verdict": "left",
    }
    caption = f"Ranked by error; the threshold is {percent(comparison.threshold)}."
    faults = (f"{file}: {why}" for file, why in comparison.faults.items())
    return Document(
        kind="Comparison of tests",
        title=f"{len(comparison.tests)} tests",
        verdict=f"The error of {comparison.tests[0].file} is probably the smallest.",
        blocks=(
            text_table(rows, headings, caption=caption),
            Figure(drawing=ranked_tests(comparison), caption="Errors with their 90 % intervals."),
            Points(items=(comparison.assumed, *comparison.notes, *faults)),
        ),
        sheet=True,
    )
