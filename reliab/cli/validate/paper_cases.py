"""`reliab validate --case`: the paper's four cases, Tables 5 and 6."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table, write_json
from reliab.errors import InputError
from reliab.significant import significant

if TYPE_CHECKING:
    import pandas as pd

    from reliab.motions import Motion

_HEADINGS = (
    *("case", "f [Hz]", "ξ [-]", "A [-]", "d [ms]", "criterion", "index", "accepted"),
    *("probability", "RMS^R [%]", "error below"),
)


@dataclass(frozen=True, kw_only=True)
class PaperCases:
    """Options of the paper's four cases."""

    motions: list[str] | None  # motions, sets: Sources of ground motions and sets of their catalogue
    sets: list[str] | None
    case: str  # Name of the motion; it may be one that is held out
    # integrator, compensator: How the command is computed, and how the actuator's delay is compensated; the
    # paper's by default
    integrator: str | None
    compensator: str | None
    json_target: str | None  # File for JSON, or "-"

    def run(self) -> None:
        """Run the four cases under the ground motion and print the verdicts."""
        from reliab.study import study_module

        record_seconds = study_module("paper2017", "cases").RECORD_SECONDS
        integrator, compensator = self.integrator or "chen_ricles", self.compensator or "inverse"
        motion = _motion(self.motions, self.sets, self.case)
        event, verdicts = _verdicts(motion, integrator, compensator)
        content = {
            "motion": motion.name,
            "held_out": event,
            "window": f"{min(record_seconds, motion.duration):g}",
            "integrator": integrator,
            "compensator": compensator,
            "cases": verdicts.astype(object).where(verdicts.notna(), None).to_dict(orient="records"),
        }
        if not write_json(content, self.json_target):
            _show_cases(content, verdicts)


def _verdicts(motion: "Motion", integrator: str, compensator: str) -> "tuple[str | None, pd.DataFrame]":
    """Judge the cases by the printed and the recommended criterion; name the held-out earthquake."""
    from reliab.assessment import default_criterion
    from reliab.criterion import published_criterion
    from reliab.shipped import shipped
    from reliab.study import study_module
    from reliab.sweep import open_ellipses
    from reliab.validation import earthquakes_among

    printed = published_criterion("guo_2017_18")
    learned = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    (event,) = earthquakes_among([motion.event], [motion.checksum], learned)
    verdicts = study_module("paper2017", "case_verdicts").case_verdicts(
        motion,
        {
            "guo_2017_18": lambda f, xi: printed,  # noqa: ARG005 - one law for all structures
            "recommended": lambda f, xi: default_criterion(f, xi, without=event),
        },
        integrator=integrator,
        compensator=compensator,
    )
    return event, verdicts


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


def _show_cases(content: Mapping[str, Any], verdicts: "pd.DataFrame") -> None:
    shown = table(f"The paper's cases under {content['motion']}", dict.fromkeys(_HEADINGS, "right"))
    for row in verdicts.to_dict(orient="records"):
        shown.add_row(
            *(str(row["case"]), f"{row['f']:g}", f"{row['xi']:g}", f"{row['A']:.4f}", f"{row['d_ms']:.3f}"),
            *(row["criterion"], significant(row["index"]), "yes" if row["accepted"] else "no"),
            "" if row["probability"] != row["probability"] else f"{row['probability']:.3f}",
            *(f"{100.0 * row['rms']:.2f}", "yes" if row["good"] else "no"),
        )
    console().print(shown)
    event = content["held_out"]
    motions = f"without {event}" if event else "from all shipped motions"
    console().print(
        "RMS^R is the RMS of measured minus exact displacement over the peak of the exact one, in the first "
        f"{content['window']} s of the record. Integrator: {content['integrator']}; compensator: "
        f"{content['compensator']}. The recommended criterion was learned {motions}.",
        highlight=False,
    )
