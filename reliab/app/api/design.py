"""`reliab.design_test` and `reliab.write_explorer`: what is tolerable before a test, and its page."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Unpack

from reliab.app import questions
from reliab.app.api.arguments import exact_quantities, parse_threshold, refuse_stated
from reliab.app.declaration import asks
from reliab.assessment.design import CONFIDENCES, TolerableErrors, chart_frequencies, tolerable_errors
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult, ResultWithRows
from reliab.core.shipped import or_shipped
from reliab.core.significant_digits import percent
from reliab.core.stated_value import StatedValue, as_names
from reliab.core.vocabulary import Metric
from reliab.sweep.ellipse_dataset import open_windows
from reliab.sweep.results import REAL


@dataclass(frozen=True, kw_only=True)
class Design(ResultWithRows):
    """Tolerable errors of a rig before a test."""

    rows_in = "design"
    keys: ClassVar[Mapping[str, str]] = {"design": "tolerances", "chart": "chart"}
    table_columns: ClassVar[Columns] = {
        "f [Hz]": ("", lambda row: f"{row['f']:g}{'*' if row['outside_validity'] else ''}"),
        "confidence": ("confidence", lambda share: "none" if share is None else percent(share, decimals=0)),
        "|A − 1| alone": ("amplitude_limit", ".4f"),
        "d alone [ms]": ("delay_limit_ms", ".3f"),
        "|A − 1| and": ("amplitude_limit_of_both", ".4f"),
        "d together [ms]": ("delay_limit_of_both_ms", ".3f"),
    }
    plot_columns = ("f", "delay_limit_ms")

    # Of the structures that were asked for, by frequency, then by confidence
    tolerances: tuple[TolerableErrors, ...]
    chart: tuple[TolerableErrors, ...]  # The same over all frequencies for which the criterion is valid


@asks(questions.DesignQuestion)
def design_test(**request: Unpack[questions.DesignQuestion]) -> Design:
    """State how much delay and amplitude error a rig may have, before a test.

    Limits of structures with all stiffness in the laboratory are transferred to a smaller share `alpha` by a
    law for springs, which holds from ten times the damping ratio on. A criterion of one's own is for its own
    share. Without a `confidence`, those of 0.80, 0.90, 0.95 and 0.99 are stated.

    Raises
    ------
    InputError
        If a value is not allowed, has a tolerance, or the criterion cannot be read.

    Examples
    --------
    >>> design = design_test(f=1, xi=0.02, confidence=0.95)
    >>> [(tolerance.frequency, tolerance.confidence) for tolerance in design.tolerances]
    [(1.0, 0.95)]
    """
    if request["structure"] is not None:
        raise InputError(
            "Tolerable errors before a test are computed for structures of one mass, not for frames",
            value=f"`structure={request['structure']}`",
            remedy="Judge a trial test of the frame with `reliab assess TEST --structure FRAME`, or predict "
            "the next one from earlier tests of it with `reliab rig predict RIG --structure FRAME`",
        )
    question: dict[str, Any] = {**request}
    criterion, confidence = question["criterion"], request["confidence"]
    values = exact_quantities(question)
    share = values.get("alpha", 1.0)
    if criterion is not None:
        options = {**question, "alpha": None if share == 1.0 else share}
        reason = "together with `criterion`, which states its own"
        refuse_stated(options, "threshold", "confidence", "metric", "alpha", reason=reason)

    def tolerances(frequencies: list[float]) -> tuple[TolerableErrors, ...]:
        return tuple(
            tolerable_errors(
                frequencies,
                values.get("xi", 0.02),
                threshold=parse_threshold(request["threshold"]),
                confidences=CONFIDENCES if confidence is None else as_names(confidence),
                metric=str(request["metric"] or Metric.RMS),
                criterion=criterion,
                experimental_fraction=share,
            )
        )

    several_f = question["f"] or [StatedValue(1.0)]
    frequencies = [exact_quantities({"f": frequency})["f"] for frequency in several_f]
    return Design(tolerances=tolerances(frequencies), chart=tolerances(chart_frequencies(criterion)))


_NINETY_FIVE = 0.95


@dataclass(frozen=True, kw_only=True)
class ExplorerPage(PlainResult):
    """A page that was written."""

    keys: ClassVar[Mapping[str, str]] = {
        "page": "page",
        "bytes": "size",
        "ellipses": "ellipses",
        "windows": "windows",
    }

    page: Path
    ellipses: str
    windows: tuple[str, ...]

    @property
    def size(self) -> int:
        """Size of the file [bytes]."""
        return self.page.stat().st_size


@asks(questions.ExplorerQuestion)
def write_explorer(**request: Unpack[questions.ExplorerQuestion]) -> ExplorerPage:
    """Write a web page, for use without a network, of tolerable errors before a test.

    Raises
    ------
    InputError
        If the ellipses cannot be read, a value is not allowed or the file cannot be written.
    """
    from reliab.explore.page import Settings, sort_by_length, write_page

    out, ellipses = Path(request["out"]), Path(request["ellipses"] or REAL)
    windows = open_windows(or_shipped(ellipses, "datasets", "ellipses.nc"))
    lengths = sort_by_length(windows)
    values = exact_quantities(request)
    settings = Settings(
        frequency=values.get("f"),
        damping_ratio=values.get("xi"),
        experimental_fraction=values.get("alpha", 1.0),
        threshold=request["threshold"],
        confidence=_NINETY_FIVE if request["confidence"] is None else request["confidence"],
        metric=request["metric"],
    )
    name = ellipses.name
    write_page(out, lengths, settings, source=f"the ellipses of {name}")
    return ExplorerPage(page=out, ellipses=name, windows=tuple(lengths))
