"""`reliab validate --rebuilt-error`: the rebuilt error beside criteria, on the same simulated tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, progress_bar, table, write_json
from reliab.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

    from reliab.validation.rebuilt_error_study import Design

TRIALS = 6
_JUDGES = {
    "judge": "left",
    "tests": "right",
    "bad tests accepted": "right",
    "good tests accepted": "right",
    "motions without a bad test accepted": "right",
    "stated / true error, 5 … 95 %": "right",
    "inside 90 % interval": "right",
}


def judge_by_rebuilt_error(
    motions: list[str] | None,
    sets: list[str] | None,
    *,
    frequencies: list[float],
    damping_ratios: list[float],
    experimental_fraction: float,
    threshold: float,
    metric: str,
    confidence: list[float] | None,
    trials: int,
    kept: Path | None,
    json_target: str | None,
) -> None:
    """Simulate tests, have them judged, and print how often each judge is right.

    Parameters
    ----------
    motions, sets : list of str or None
        Sources of ground motions and sets of their catalogue; the suite that is built in by default.
    frequencies, damping_ratios : list of float
        Structures [Hz, -].
    experimental_fraction : float
        Share of their stiffness in the laboratory [-].
    threshold : float
        Error up to which a test is good [-].
    metric : str
        Which error.
    confidence : list of float or None
        Share of ground motions that the criterion states; one, 0.95 by default.
    trials : int
        Tests of each kind of actuator and specimen, for each structure.
    kept : pathlib.Path or None
        CSV of all tests, with which an interrupted run goes on.
    json_target : str or None
        File for JSON, or "-".
    """
    from reliab.loop.structure import Structure
    from reliab.motions import load_motions
    from reliab.validation.rebuilt_error_study import Design, summarised, try_tests
    from reliab.vocabulary import Metric

    if confidence and len(confidence) > 1:
        raise InputError(
            "The criterion beside the rebuilt error states one --confidence",
            value=", ".join(f"{share:g}" for share in confidence),
            remedy="Give one",
        )
    if metric not in list(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    suite = list(load_motions(*(motions or ("synthetic",)), sets=sets))
    chosen = suite[:: max(1, len(suite) // trials)][:trials]
    design = Design.of(
        chosen,
        [
            Structure(frequency=f, damping_ratio=xi, experimental_fraction=experimental_fraction)
            for f in frequencies
            for xi in damping_ratios
        ],
        trials=trials,
        threshold=threshold,
        metric=Metric(metric),
        confidence=confidence[0] if confidence else 0.95,
    )
    with progress_bar("Simulating tests") as progress:
        tests = try_tests(design, kept=kept, progress=progress)
    content = _answer(design, summarised(tests))
    if not write_json(content, json_target):
        _show(content)


def _answer(design: "Design", tables: "dict[str, pd.DataFrame]") -> dict[str, Any]:
    return {
        "threshold": design.threshold,
        "metric": str(design.metric),
        "confidence": design.confidence,
        "structures": [
            {
                "f": structure.frequency,
                "xi": structure.damping_ratio,
                "alpha": structure.experimental_fraction,
            }
            for structure in design.structures
        ],
        "n_motions": len(design.motions),
        "trials": design.trials,
        **{
            name: table.astype(object).where(table.notna(), None).to_dict(orient="records")
            for name, table in tables.items()
        },
    }


def _show(content: dict[str, Any]) -> None:
    terminal = console()
    asked = f"{content['metric'].upper()}^R {content['threshold']:.3g}"
    terminal.print(_table(f"Linear specimens, sensor of 40 dB, {asked}", content["judges"], "judge"))
    rebuilt = [row for row in content["conditions"] if row["judge"] == content["judges"][0]["judge"]]
    named = [{**row, "label": _condition(row)} for row in rebuilt]
    terminal.print(_table("The rebuilt error by sensor and by what is stated wrongly", named, "label"))
    specimens = [{**row, "label": f"{row['specimen']}: {row['judge']}"} for row in content["specimens"]]
    terminal.print(_table("Nonlinear specimens", specimens, "label"))
    for row in content["looks"]:
        terminal.print(
            f"Specimen “{row['specimen']}” ({row['sensor']}): looks nonlinear in "
            f"{row['looks_nonlinear']:.0%} of {row['tests']} tests.",
            highlight=False,
        )


def _condition(row: dict[str, Any]) -> str:
    return row["sensor"] if row["stated"] == "right" else f"{row['sensor']}, {row['stated']}"


def _table(title: str, rows: list[dict[str, Any]], label: str) -> Any:  # noqa: ANN401 - of rich
    shown = table(title, _JUDGES)
    for row in rows:
        shown.add_row(
            row[label],
            str(row["tests"]),
            *(_rate(row, "bad"), _rate(row, "good")),
            f"{row['contained']:.0%}",
            "" if row["ratio_50"] is None else f"{row['ratio_05']:.3f} … {row['ratio_95']:.3f}",
            "" if row["covered"] is None else f"{row['covered']:.0%}",
        )
    return shown


def _rate(row: dict[str, Any], kind: str) -> str:
    rate = row[f"{kind}_accepted"]
    return "none tried" if rate is None else f"{rate:.1%} of {row[kind]}"
