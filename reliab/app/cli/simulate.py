"""`reliab simulate`: simulate once and store the results for all later questions."""

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import progress_bar, say
from reliab.core.significant_digits import counted


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

    request.answer(simulate_suite, show, show=progress_bar)
