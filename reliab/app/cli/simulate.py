"""`reliab simulate` and `ellipses`: ground motions simulated once, and their boundaries as a and b."""

import itertools
from typing import TYPE_CHECKING

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, show_rows
from reliab.core.significant_digits import counted
from reliab.core.vocabulary import ERROR_NAMES, Metric

if TYPE_CHECKING:
    from reliab.app.api.simulation import Boundaries


@takes(questions.SimulationQuestion, questions.NewStore)
def simulate(request: Request) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.app.api.simulation import Simulation, simulate_suite

    def show(simulation: Simulation) -> None:
        structures = counted(len(simulation.request.structures), "structure")
        say(f"{counted(simulation.motions, 'motion')} × {structures} stored in {simulation.store}")

    request.answer(simulate_suite, show)


_PAGE = 1000  # rows


@takes(questions.TracingQuestion)
def ellipses(request: Request) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.simulation import trace_boundaries

    metric = request.metric or Metric.RMS
    request.answer(trace_boundaries, lambda ellipses: _show(ellipses, metric))


def _show(ellipses: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(ellipses)} boundaries of the {ERROR_NAMES[Metric(metric)]}"
    rows = ellipses.rows()
    while page := list(itertools.islice(rows, _PAGE)):
        show_rows(title, ellipses.table_columns, page)
        title = ""
    say(*(f"Note: {warning}" for warning in ellipses.warnings))
