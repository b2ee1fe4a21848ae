"""`reliab assess --design`: what is tolerable before a test."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table, write_json
from reliab.errors import InputError

if TYPE_CHECKING:
    from reliab.criterion import Criterion
    from reliab.validation.assessment import Tolerance

_NINETY_FIVE = 0.95
_BAR = 40
_MILLISECONDS = 1e3


def state_tolerances(
    f: list[float],
    xi: float,
    threshold: float,
    confidence: list[float] | None,
    metric: str,
    criterion: "Criterion | None",
    figure: Path | None,
    json_target: str | None,
) -> None:
    """Print, draw or write what is tolerable before a test.

    Parameters
    ----------
    f : list of float
        Natural frequencies [Hz].
    xi : float
        Damping ratio [-].
    threshold : float
        Error of the whole test [-].
    confidence : list of float or None
        Shares of ground motions.
    metric : str
        Which error.
    criterion : Criterion or None
        A criterion of one's own.
    figure : pathlib.Path or None
        File for the chart.
    json_target : str or None
        File for JSON, or "-".
    """
    from reliab.validation.assessment.design import CONFIDENCES, chart_frequencies, tolerable_errors

    def tolerances(frequencies: list[float]) -> "list[Tolerance]":
        return tolerable_errors(
            frequencies,
            xi,
            threshold=threshold,
            confidences=confidence or CONFIDENCES,
            metric=metric,
            criterion=criterion,
        )

    rows, chart = tolerances(f), tolerances(chart_frequencies(criterion))
    if figure is not None:
        _draw(chart, figure)
    content = {"design": [each.to_dict() for each in rows], "chart": [each.to_dict() for each in chart]}
    if not write_json(content, json_target):
        _show_design(rows, chart)


def _draw(chart: "list[Tolerance]", path: Path) -> None:
    from reliab.report.figures.tolerable_errors import tolerable_errors_over_frequency

    drawn = tolerable_errors_over_frequency(chart)
    try:
        drawn.savefig(path)
    except (OSError, ValueError) as error:
        raise InputError(
            "The figure's file must be writable and end in .svg, .png or .pdf",
            value=str(error),
            remedy="Name another file",
            where=str(path),
        ) from error


def _show_design(rows: "list[Tolerance]", chart: "list[Tolerance]") -> None:
    first = rows[0]
    shown = table(
        f"Tolerable errors at ξ = {first.damping_ratio:g} for an error of {first.threshold:.0%}",
        dict.fromkeys(
            ("f [Hz]", "confidence", "|A − 1| alone", "d alone [ms]", "|A − 1| and", "d together [ms]"),
            "right",
        ),
    )
    for each in rows:
        amplitude, delay = each.both
        shown.add_row(
            f"{each.frequency:g}{'*' if each.outside_validity else ''}",
            f"{each.confidence:.0%}",
            f"{each.amplitude_error:.4f}",
            f"{_MILLISECONDS * each.delay:.3f}",
            f"{amplitude:.4f}",
            f"{_MILLISECONDS * delay:.3f}",
        )
    terminal = console()
    terminal.print(shown)
    if any(each.outside_validity for each in rows):
        terminal.print(
            "Note: * lies outside of the criterion's validity and is carried over by dimensionless errors."
        )
    _show_chart(chart, terminal)


def _show_chart(chart: "list[Tolerance]", terminal: Any) -> None:  # noqa: ANN401 - Rich's console
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    confidence = min((each.confidence for each in chart), key=lambda value: abs(value - _NINETY_FIVE))
    chosen = [each for each in chart if each.confidence == confidence]
    longest = max(each.delay for each in chosen)
    shown = table(
        f"Over the frequency, at {confidence:.0%}",
        {"f [Hz]": "right", "|A − 1| alone": "right", "d alone [ms]": "right", "d": "left"},
    )
    for each in chosen:
        bar = "█" * max(round(_BAR * each.delay / longest), 1)
        shown.add_row(
            f"{each.frequency:g}", f"{each.amplitude_error:.4f}", f"{_MILLISECONDS * each.delay:.3f}", bar
        )
    terminal.print(shown)
