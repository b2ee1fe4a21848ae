"""`reliab assess --design`: what is tolerable before a test."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table, write_json
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.vocabulary import MILLI

if TYPE_CHECKING:
    from collections.abc import Sequence

    from reliab.api import Design
    from reliab.assessment import Tolerance

_NINETY_FIVE = 0.95
_BAR = 40


def answer_design(design: "Design", figure: Path | None, json_target: str | None) -> None:
    """Print, draw or write what is tolerable before a test."""
    if figure is not None:
        _draw(design.chart, figure)
    if not write_json(design.to_dict(), json_target):
        _show_design(design.tolerances, design.chart)


def _draw(chart: "Sequence[Tolerance]", path: Path) -> None:
    from reliab.report import picture
    from reliab.report.figures import tolerable_errors_over_frequency

    drawn = tolerable_errors_over_frequency(chart)
    try:
        with written_whole(path) as file:
            file.write_bytes(picture(drawn, path.suffix.lower()))
    except (OSError, ValueError) as error:
        raise InputError(
            "The figure's file must be writable and end in .svg, .png or .pdf",
            value=str(error),
            remedy="Name another file",
            where=str(path),
        ) from error


def _show_design(rows: "Sequence[Tolerance]", chart: "Sequence[Tolerance]") -> None:
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
            f"{MILLI * tolerance.delay:.3f}",
            f"{amplitude:.4f}",
            f"{MILLI * delay:.3f}",
        )
    terminal = console()
    terminal.print(shown)
    if any(tolerance.outside_validity for tolerance in rows):
        terminal.print(
            "Note: * lies outside of the criterion's validity and is carried over by dimensionless errors."
        )
    _show_chart(chart, terminal)


def _show_chart(chart: "Sequence[Tolerance]", terminal: Any) -> None:  # noqa: ANN401 - Rich's console
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
            f"{point.frequency:g}", f"{point.amplitude_error:.4f}", f"{MILLI * point.delay:.3f}", bar
        )
    terminal.print(shown)
