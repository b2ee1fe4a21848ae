"""`reliab ellipses`: the boundary of each motion, as a and b."""

import itertools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import Columns, progress_bar, say, show_rows
from reliab.core.vocabulary import Metric

if TYPE_CHECKING:
    from reliab.app.api.tracing import Boundaries

_ELLIPSES = {"": "", "_lead": ", lead", "_inscribed": ", inscribed", "_lead_inscribed": ", inscribed, lead"}
"""Headings of the ellipses by the ending of their keys."""
_PAGE = 1000  # rows


@takes(questions.Boundaries)
def ellipses(asked: Asked) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.tracing import trace_boundaries

    metric = asked.metric or Metric.RMS
    asked.answer(trace_boundaries, lambda traced: _show(traced, metric), show=progress_bar)


def _show(traced: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(traced)} boundaries of {metric.upper()}^R"
    rows = map(_with_reasons, traced.rows())
    while page := list(itertools.islice(rows, _PAGE)):
        show_rows(title, _COLUMNS, page)
        title = ""
    if traced.caution:
        say(f"Note: {traced.caution}")


def _with_reasons(row: dict[str, Any]) -> dict[str, Any]:
    """Put why there is no ellipse in place of a and b."""
    shown = dict(row)
    for ending in _ELLIPSES:
        reason = row.get(f"no_ellipse{ending}")
        if reason is not None:
            shown |= {f"a{ending}": reason.replace("_", " "), f"b{ending}": None}
    return shown


def _number(form: str) -> Callable[[float | str | None], str]:
    """Write numbers; leave texts, and nothing, as they are."""
    return lambda value: format(value, form) if isinstance(value, float) else value or ""


_COLUMNS: Columns = {
    "motion": ("motion", ""),
    "f [Hz]": ("f", "g"),
    "ξ [-]": ("xi", "g"),
    "α [-]": ("alpha", "g"),
    "error [-]": ("threshold", "g"),
    "a [-]": ("a", _number(".3e")),
    "b [ms²]": ("b", _number(".4g")),
    **{
        f"{name}{heading}": (f"{name}{ending}", _number(form))
        for ending, heading in _ELLIPSES.items()
        if ending
        for name, form in (("a", ".3e"), ("b", ".4g"))
    },
    "points": ("n", "d"),
}
