"""`reliab simulate`: simulate once and store the results for all later questions."""

from pathlib import Path
from typing import Annotated, TypedDict

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import progress_bar, say, write_json
from reliab.app.options import OUTPUT
from reliab.core.significant_digits import counted


class _Store(TypedDict):
    out: Annotated[Path, OUTPUT.option("STORE", "The Zarr store to write.", is_required=True)]


@takes(questions.Simulation, _Store)
def simulate(asked: Asked) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.app.api.simulation import simulate_suite

    simulation = asked.ask(simulate_suite, "json_target", show=progress_bar)
    if not write_json(simulation.to_dict(), asked.json_target):
        structures = len(simulation.request.structures)
        done = f"{counted(simulation.motions, 'motion')} × {counted(structures, 'structure')}"
        say(f"{done} stored in {simulation.store}")
