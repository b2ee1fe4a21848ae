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


@takes(questions.TracingQuestion)
def ellipses(request: Request) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.tracing import trace_boundaries

    metric = request.metric or Metric.RMS
    request.answer(trace_boundaries, lambda ellipses: _show(ellipses, metric), show=progress_bar)


def _show(ellipses: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(ellipses)} boundaries of the {ERROR_NAMES[Metric(metric)]}"
    rows = ellipses.rows()
    while page := list(itertools.islice(rows, _PAGE)):
        show_rows(title, ellipses.table_columns, page)
        title = ""
    say(*(f"Note: {warning}" for warning in ellipses.warnings))
