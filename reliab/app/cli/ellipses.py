"""`reliab ellipses`: the boundary of each motion, as a and b."""

import itertools
from typing import TYPE_CHECKING

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import progress_bar, say, show_rows
from reliab.core.vocabulary import ERROR_NAMES, Metric

if TYPE_CHECKING:
    from reliab.app.api.tracing import Boundaries

_PAGE = 1000  # rows


@takes(questions.Boundaries)
def ellipses(asked: Request) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.tracing import trace_boundaries

    metric = asked.metric or Metric.RMS
    asked.answer(trace_boundaries, lambda traced: _show(traced, metric), show=progress_bar)


def _show(traced: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(traced)} boundaries of the {ERROR_NAMES[Metric(metric)]}"
    rows = traced.rows()
    while page := list(itertools.islice(rows, _PAGE)):
        show_rows(title, traced.shown, page)
        title = ""
    if traced.caution:
        say(f"Note: {traced.caution}")
