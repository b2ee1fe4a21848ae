"""What `reliab validate --case` prints: the paper's four cases, Tables 5 and 6."""

from collections.abc import Mapping
from typing import Any

from reliab.cli.output import console, say, table
from reliab.significant import significant

_HEADINGS = (
    *("case", "f [Hz]", "ξ [-]", "A [-]", "d [ms]", "criterion", "index", "accepted"),
    *("probability", "RMS^R [%]", "error below"),
)


def show_cases(content: Mapping[str, Any]) -> None:
    """Print the verdicts."""
    shown = table(f"The paper's cases under {content['motion']}", dict.fromkeys(_HEADINGS, "right"))
    for row in content["cases"]:
        shown.add_row(
            *(str(row["case"]), f"{row['f']:g}", f"{row['xi']:g}", f"{row['A']:.4f}", f"{row['d_ms']:.3f}"),
            *(row["criterion"], significant(row["index"]), "yes" if row["accepted"] else "no"),
            "" if row["probability"] is None else f"{row['probability']:.3f}",
            *(f"{100.0 * row['rms']:.2f}", "yes" if row["good"] else "no"),
        )
    console().print(shown)
    event = content["held_out"]
    motions = f"without {event}" if event else "from all shipped motions"
    say(
        "RMS^R is the RMS of measured minus exact displacement over the peak of the exact one, in the first "
        f"{content['window']} s of the record. Integrator: {content['integrator']}; compensator: "
        f"{content['compensator']}. The recommended criterion was learned {motions}."
    )
