"""`reliab assess --design`: what is tolerable before a test."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.options import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT
from reliab.cli.output import console, table, write_json
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from reliab.cli.assess.demand import Demand
    from reliab.validation.assessment import Tolerance

_NINETY_FIVE = 0.95
_BAR = 40
_MILLISECONDS = 1e3


def state_tolerances(demand: "Demand") -> None:
    """Print, draw or write what is tolerable before a test.

    Parameters
    ----------
    demand : Demand
        What is asked.
    """
    from reliab.validation.assessment.design import CONFIDENCES, chart_frequencies, tolerable_errors

    criterion = demand.own_criterion

    def tolerances(frequencies: list[float]) -> "list[Tolerance]":
        return tolerable_errors(
            frequencies,
            _exact(demand.xi, "xi") if demand.xi else TWO_PERCENT,
            threshold=FIVE_PERCENT if demand.threshold is None else demand.threshold,
            confidences=demand.confidence or CONFIDENCES,
            metric=demand.metric or "rms",
            criterion=criterion,
        )

    rows = tolerances([_exact(frequency, "f") for frequency in demand.f or [StatedValue(ONE_HERTZ)]])
    chart = tolerances(chart_frequencies(criterion))
    if demand.figure is not None:
        _draw(chart, demand.figure)
    content = {"design": [row.to_dict() for row in rows], "chart": [row.to_dict() for row in chart]}
    if not write_json(content, demand.json_target):
        _show_design(rows, chart)


def _exact(stated: StatedValue, name: str) -> float:
    if stated.deviation:
        raise InputError(
            "Tolerable errors before a test are those of an exact structure",
            value=f"--{name} {stated}",
            remedy="Leave the tolerance out, or give two values",
        )
    return stated.value


def _draw(chart: "list[Tolerance]", path: Path) -> None:
    from reliab.report.figures.tolerable_errors import tolerable_errors_over_frequency

    drawn = tolerable_errors_over_frequency(chart)
    try:
        with written_whole(path) as file:
            drawn.savefig(file)
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
    for tolerance in rows:
        amplitude, delay = tolerance.both
        shown.add_row(
            f"{tolerance.frequency:g}{'*' if tolerance.outside_validity else ''}",
            f"{tolerance.confidence:.0%}",
            f"{tolerance.amplitude_error:.4f}",
            f"{_MILLISECONDS * tolerance.delay:.3f}",
            f"{amplitude:.4f}",
            f"{_MILLISECONDS * delay:.3f}",
        )
    terminal = console()
    terminal.print(shown)
    if any(tolerance.outside_validity for tolerance in rows):
        terminal.print(
            "Note: * lies outside of the criterion's validity and is carried over by dimensionless errors."
        )
    _show_chart(chart, terminal)


def _show_chart(chart: "list[Tolerance]", terminal: Any) -> None:  # noqa: ANN401 - Rich's console
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    confidence = min((point.confidence for point in chart), key=lambda value: abs(value - _NINETY_FIVE))
    chosen = [point for point in chart if point.confidence == confidence]
    longest = max(point.delay for point in chosen)
    shown = table(
        f"Over the frequency, at {confidence:.0%}",
        {"f [Hz]": "right", "|A − 1| alone": "right", "d alone [ms]": "right", "d": "left"},
    )
    for point in chosen:
        bar = "█" * max(round(_BAR * point.delay / longest), 1)
        shown.add_row(
            f"{point.frequency:g}", f"{point.amplitude_error:.4f}", f"{_MILLISECONDS * point.delay:.3f}", bar
        )
    terminal.print(shown)
