"""`reliab design` and `explore`: what is tolerable before a test, on the screen and as a page."""

from typing import TYPE_CHECKING

from reliab.app import options, questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, say_population, show_rows
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from collections.abc import Sequence

    from reliab.app.api.design import Design
    from reliab.assessment.design import TolerableErrors


@takes(questions.DesignQuestion, options.Chart, options.Details)
def design(request: Request) -> None:
    """Print how much amplitude error and delay are tolerable, before a test."""
    from reliab.app.api.assessment import draw_chart
    from reliab.app.api.design import design_test

    result = request.answer(
        design_test,
        lambda design: show_design(design, details=request.details, chosen=request.confidence is not None),
        "figure",
        "details",
    )
    if request.figure is not None:
        draw_chart(result, request.figure)


_NINETY_FIVE = 0.95
_BAR = 40


def show_design(design: "Design", *, details: bool, chosen: bool = False) -> None:
    """Print tolerable errors at 95 % or the `chosen` confidences; with `details` all of them, and a chart."""
    from reliab.app.api.design import Design
    from reliab.app.cli.criterion import limits_in_words

    rows = design.tolerances if details or chosen else _at_ninety_five(design.tolerances)
    first = rows[0]
    say(limits_in_words(first.to_dict()), style="bold")
    share = "" if first.experimental_fraction == 1.0 else f" and α = {first.experimental_fraction:g}"
    title = f"Tolerable errors at ξ = {first.damping_ratio:g}{share}, error {percent(first.threshold)}"
    show_rows(title if details else "", Design.table_columns, (row.to_dict() for row in rows))
    say_population(((row.promise, row.population) for row in rows), first.position)
    if any(tolerance.outside_validity for tolerance in rows):
        say("Note: the criterion does not cover *; these limits are scaled from the nearest structure.")
    if details:
        _show_chart(design.chart)
    else:
        say("Other confidences and frequencies: run with --details.")
    structure = f"--f {first.frequency:g} --xi {first.damping_ratio:g}"
    say(f"Next step: judge a test with `reliab assess TEST {structure}`, of a frame with --structure FRAME.")


def _at_ninety_five(tolerances: "Sequence[TolerableErrors]") -> "list[TolerableErrors]":
    """Select the confidence nearest to 95 %."""
    confidence = min((one.confidence for one in tolerances), key=lambda value: abs(value - _NINETY_FIVE))
    return [one for one in tolerances if one.confidence == confidence]


def _show_chart(chart: "Sequence[TolerableErrors]") -> None:
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    from reliab.app.api.design import Design

    points = _at_ninety_five(chart)
    promise, longest = points[0].promise, max(MILLI * point.delay for point in points)
    share = "no share promised" if promise is None else f"at {percent(promise, decimals=0)}"
    columns = {name: Design.table_columns[name] for name in ("f [Hz]", "|A − 1| alone", "d alone [ms]")} | {
        "d": ("delay_limit_ms", lambda late: "█" * max(round(_BAR * late / longest), 1), "left")
    }
    show_rows(f"Over the frequency, {share}", columns, (point.to_dict() for point in points))


_MEGABYTE = 1e6


@takes(questions.ExplorerQuestion)
def explore(request: Request) -> None:
    """Write an offline web page with sliders that show tolerable errors before a test."""
    from reliab.app.api.design import ExplorerPage, write_explorer

    def show(result: ExplorerPage) -> None:
        say(f"{result.page}: {result.size / _MEGABYTE:.1f} MB, open it in any browser.")

    request.answer(write_explorer, show)
