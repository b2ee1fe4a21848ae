"""`reliab simulate`: simulate once and store the results for all later questions."""

from dataclasses import MISSING, dataclass
from pathlib import Path

from reliab.app.cli import options
from reliab.app.cli.demand import Demand, flag, option, takes
from reliab.app.cli.output import progress_bar, say, write_json


@dataclass(frozen=True, kw_only=True)
class SimulateDemand(Demand):
    """Options of `reliab simulate`, arguments of `reliab.simulate_suite`."""

    motions: list[str] | None = options.MOTIONS
    sets: list[str] | None = options.SETS
    f: list[float] | None = options.FREQUENCIES
    xi: list[float] | None = options.DAMPING_RATIOS
    out: Path = option("STORE", "The Zarr store to write.", default=MISSING)
    grid: str = option(
        "scaled|paper",
        "Gains and delays to simulate: scaled to each structure, or the paper's.",
        default="scaled",
    )
    window: list[str] | None = option(
        "record|SECONDS|arias...", "Part of the record over which errors are computed; several may be stored."
    )
    alpha: list[float] | None = options.FRACTIONS
    model: Path | None = options.MODEL_FILE
    engine: str = option(
        "automatic|pole|delay|spectral", "How the equation of motion is solved.", default="automatic"
    )
    resume: bool = flag("Continue the store of an interrupted run.")
    workers: int | None = option("", "Threads; all processors by default.", min=1)
    scheduler: str | None = option("ADDRESS", "Address of a dask scheduler whose workers solve the motions.")
    json_target: str | None = options.JSON_TARGET


@takes(SimulateDemand)
def simulate(demand: SimulateDemand) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.app.api.simulation import simulate_suite

    simulation = demand.ask(simulate_suite, "json_target", show=progress_bar)
    if not write_json(simulation.to_dict(), demand.json_target):
        structures = len(simulation.request.structures)
        say(f"{simulation.motions} motions × {structures} structures stored in {simulation.store}")
