"""`reliab ellipses`: the boundary of each motion, as a and b."""

import itertools
from typing import TYPE_CHECKING, Any

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import progress_bar, say, show_table, write_json
from reliab.core.vocabulary import Metric

if TYPE_CHECKING:
    from reliab.app.api.tracing import Boundaries

_HEADINGS = {
    "motion": "left",
    "f [Hz]": "right",
    "ξ [-]": "right",
    "α [-]": "right",
    "error [-]": "right",
    "a [-]": "right",
    "b [ms²]": "right",
    "a, lead": "right",
    "b, lead": "right",
    "a, inscribed": "right",
    "b, inscribed": "right",
    "a, inscribed, lead": "right",
    "b, inscribed, lead": "right",
    "points": "right",
}
_PAGE = 1000  # rows


@takes(questions.Boundaries)
def ellipses(demand: Asked) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.tracing import trace_boundaries

    traced = demand.ask(trace_boundaries, "json_target", show=progress_bar)
    if demand.json_target is not None and write_json(traced.to_dict(), demand.json_target):
        return
    _show(traced, demand.metric or Metric.RMS)
    if traced.caution:
        say(f"Note: {traced.caution}")


def _show(traced: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(traced)} boundaries of {metric.upper()}^R"
    rows = traced.rows()
    while page := list(itertools.islice(rows, _PAGE)):
        show_table(title, _HEADINGS, map(_cells, page))
        title = ""


def _cells(row: dict[str, Any]) -> list[str]:
    where = [
        str(row["motion"]),
        f"{row['f']:g}",
        f"{row['xi']:g}",
        f"{row['alpha']:g}",
        f"{row['threshold']:g}",
    ]
    shown = [_parameters(row, suffix) for suffix in ("", "_lead", "_inscribed", "_lead_inscribed")]
    return [*where, *(cell for pair in shown for cell in pair), str(row["n"])]


def _parameters(row: dict[str, Any], suffix: str) -> tuple[str, str]:
    """Show a and b of one ellipse, or why there is none."""
    a, b, reason = (row.get(f"{name}{suffix}") for name in ("a", "b", "no_ellipse"))
    if reason is not None:
        return str(reason).replace("_", " "), ""
    return ("", "") if a is None or b is None else (f"{a:.3e}", f"{b:.4g}")
