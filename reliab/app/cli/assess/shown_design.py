"""What `reliab design` prints: what is tolerable before a test."""

from typing import TYPE_CHECKING, Any

from reliab.app.cli.output import console, say_for_which_motions, table
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from collections.abc import Sequence

    from reliab.app.api.design import Design
    from reliab.assessment.design import Tolerance

_NINETY_FIVE = 0.95
_BAR = 40


def show_design(design: "Design") -> None:
    """Print tolerable errors, and those over the frequency as bars."""
    rows, first = design.tolerances, design.tolerances[0]
    shown = table(
        f"Tolerable errors at ξ = {first.damping_ratio:g}{_share(first)} for an error of "
        f"{percent(first.threshold)}",
        dict.fromkeys(
            ("f [Hz]", "confidence", "|A − 1| alone", "d alone [ms]", "|A − 1| and", "d together [ms]"),
            "right",
        ),
    )
    for tolerance in rows:
        amplitude, delay = tolerance.both
        shown.add_row(
            f"{tolerance.frequency:g}{'*' if tolerance.outside_validity else ''}",
            _in_words(tolerance.promise),
            f"{tolerance.amplitude_error:.4f}",
            f"{MILLI * tolerance.delay:.3f}",
            f"{amplitude:.4f}",
            f"{MILLI * delay:.3f}",
        )
    terminal = console()
    say_for_which_motions(((row.promise, row.population) for row in rows), first.position)
    terminal.print(shown)
    if any(tolerance.outside_validity for tolerance in rows):
        terminal.print(
            "Note: the criterion does not cover *; these limits are scaled from the nearest structure."
        )
    _show_chart(design.chart, terminal)


def _in_words(promise: float | None) -> str:
    return "none" if promise is None else percent(promise, decimals=0)


def _at(promise: float | None) -> str:
    return "no share promised" if promise is None else f"at {percent(promise, decimals=0)}"


def _share(tolerance: "Tolerance") -> str:
    """Name the share in the laboratory where it is not the whole."""
    whole = tolerance.experimental_fraction == 1.0
    return "" if whole else f" and α = {tolerance.experimental_fraction:g}"


def _show_chart(chart: "Sequence[Tolerance]", terminal: Any) -> None:  # noqa: ANN401 - Rich's console
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    confidence = min((point.confidence for point in chart), key=lambda value: abs(value - _NINETY_FIVE))
    chosen = [point for point in chart if point.confidence == confidence]
    longest = max(point.delay for point in chosen)
    shown = table(
        f"Over the frequency, {_at(chosen[0].promise)}",
        {"f [Hz]": "right", "|A − 1| alone": "right", "d alone [ms]": "right", "d": "left"},
    )
    for point in chosen:
        bar = "█" * max(round(_BAR * point.delay / longest), 1)
        shown.add_row(
            f"{point.frequency:g}", f"{point.amplitude_error:.4f}", f"{MILLI * point.delay:.3f}", bar
        )
    terminal.print(shown)
