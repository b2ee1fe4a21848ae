"""`reliab validate --case`: the paper's four cases, Tables 5 and 6."""

from contextlib import suppress
from typing import TYPE_CHECKING

from reliab.cli.output import console, table, write_json
from reliab.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

    from reliab.motions import Motion

_HEADINGS = (
    *("case", "f [Hz]", "ξ [-]", "A [-]", "d [ms]", "criterion", "index", "accepted"),
    *("probability", "RMS^R [%]", "error below"),
)


def judge_cases(
    motions: list[str] | None, sets: list[str] | None, case: str, json_target: str | None
) -> None:
    """Run the paper's four cases under a ground motion and print the verdicts.

    Parameters
    ----------
    motions, sets : list of str or None
        Sources of ground motions and sets of their catalogue.
    case : str
        Name of the motion; it may be one that is held out.
    json_target : str or None
        File for JSON, or "-".
    """
    from reliab.criterion import published_criterion
    from reliab.paper.case_verdicts import case_verdicts
    from reliab.validation.assessment import default_criterion

    motion = _motion(motions, sets, case)
    printed = published_criterion("guo_2017_18")
    found = case_verdicts(
        motion,
        {
            "guo_2017_18": lambda f, xi: printed,  # noqa: ARG005 - one law for all structures
            "recommended": lambda f, xi: default_criterion(f, xi, without=motion.event),
        },
    )
    rows = found.astype(object).where(found.notna(), None).to_dict(orient="records")
    if not write_json({"motion": motion.name, "cases": rows}, json_target):
        _show_cases(motion.name, found)


def _motion(motions: list[str] | None, sets: list[str] | None, name: str) -> "Motion":
    """Find a motion of a suite by its name, also among those that are held out."""
    if not motions:
        raise InputError(
            "The paper's cases need a ground motion",
            value="no --motions",
            remedy=f"Give the folder or file of {name} with --motions",
        )
    from reliab.motions import load_motions

    suite = load_motions(*motions, sets=sets)
    if name not in suite.names and sets is None:
        with suppress(InputError):  # where nothing is held out, the suite's own message is the better one
            suite = load_motions(*motions, sets=["held_out"])
    return suite.select(names=[name])[0]


def _show_cases(motion: str, found: "pd.DataFrame") -> None:
    shown = table(f"The paper's cases under {motion}", dict.fromkeys(_HEADINGS, "right"))
    for row in found.to_dict(orient="records"):
        shown.add_row(
            *(str(row["case"]), f"{row['f']:g}", f"{row['xi']:g}", f"{row['A']:.4f}", f"{row['d_ms']:.3f}"),
            *(row["criterion"], f"{row['index']:.3g}", "yes" if row["accepted"] else "no"),
            "" if row["probability"] != row["probability"] else f"{row['probability']:.3f}",
            *(f"{100.0 * row['rms']:.2f}", "yes" if row["good"] else "no"),
        )
    console().print(shown)
