"""The error of the rig that a frame's description states, beside the criterion of the frame."""

from typing import Any

from reliab.cli.criterion.demand import Demand
from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import console, progress_bar, table
from reliab.significant import significant


def rig_beside(demand: Demand) -> dict[str, Any]:
    """Compute the error of the described rig under the motions of the criterion.

    Returns `rig`, as :func:`reliab.sweep.frame_table.summary_of_rig` returns it; empty where no frame with a
    transfer system is given.
    """
    if demand.structure is None or not demand.motions:
        return {}
    from reliab.indices import Window
    from reliab.motions import load_motions
    from reliab.simulation.frames import read_frame
    from reliab.sweep import errors_of_rig, summary_of_rig

    frame = read_frame(demand.structure)
    if frame.transfer_system is None:
        return {}
    suite = load_motions(*demand.motions, sets=demand.sets)
    with progress_bar("Testing the rig") as progress:
        errors = errors_of_rig(
            frame, suite, window=Window.parse(demand.window or "record"), progress=progress
        )
    thresholds = demand.threshold or [FIVE_PERCENT]
    return {"rig": summary_of_rig(errors, demand.metric, thresholds[0])}


def show_rig(rig: dict[str, Any]) -> None:
    """Print the error of a rig."""
    terminal = console()
    if not rig["stable"]:
        terminal.print("The described rig leaves the test of this frame unstable.", style="yellow")
        return
    shown = table(f"Error of the described rig, {rig['metric']}", {"": "left", "value": "right"})
    shown.add_row("median of the motions", f"{rig['median']:.2%}")
    shown.add_row("largest", f"{rig['largest']:.2%}")
    shown.add_row(f"motions below {significant(rig['threshold'])}", f"{rig['share_below']:.0%}")
    for name, form in (("A", ".4f"), ("d_ms", ".3f")):
        values = sorted(motion[name] for motion in rig["motions"])
        shown.add_row(f"{name}, least to largest", f"{values[0]:{form}} to {values[-1]:{form}}")
    terminal.print(shown)
