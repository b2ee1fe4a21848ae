"""`reliab validate --rebuilt-error`: the rebuilt error beside criteria, on the same simulated tests."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.options import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.errors import InputError
from reliab.significant import significant
from reliab.vocabulary import Metric

if TYPE_CHECKING:
    import pandas as pd

    from reliab.validation.rebuilt_error_study import Design

_TRIALS, _NINETY_FIVE = 6, 0.95
_JUDGES = {
    "judge": "left",
    "tests": "right",
    "bad tests accepted": "right",
    "good tests accepted": "right",
    "motions without a bad test accepted": "right",
    "stated / true error, 5 … 95 %": "right",
    "inside 90 % interval": "right",
}


@dataclass(frozen=True, kw_only=True)
class RebuiltErrors:
    """Options of a comparison of rebuilt errors with criteria."""

    # motions, sets: Sources of ground motions and sets of their catalogue; the suite that is built in by
    # default
    motions: list[str] | None
    sets: list[str] | None
    f: list[float] | None  # f, xi: Structures [Hz, -]; the paper's by default
    xi: list[float] | None
    alpha: list[float] | None  # Shares of their stiffness in the laboratory [-]; 1 by default
    threshold: float | None  # Error up to which a test is good [-]; 0.05 by default
    metric: str  # Which error
    confidence: list[float] | None  # Share of ground motions that the criterion states; 0.95 by default
    trials: int | None  # Tests of each kind of actuator and specimen, for each structure; 6 by default
    tests: Path | None  # CSV of all tests, from which an interrupted run resumes
    json_target: str | None  # File for JSON, or "-"

    def run(self) -> None:
        """Simulate tests, have them judged, and print how often each judge is right."""
        from reliab.validation.rebuilt_error_study import summarised, try_tests

        design = self._design()
        with progress_bar("Simulating tests") as progress:
            tests = try_tests(design, kept=self.tests, progress=progress)
        content = _answer(design, summarised(tests))
        if not write_json(content, self.json_target):
            _show(content)

    def _design(self) -> "Design":
        """Choose the motions and structures of the tests."""
        from reliab.motions import load_motions
        from reliab.structures import Structure
        from reliab.validation.rebuilt_error_study import Design

        metric, trials = Metric.parse(self.metric), self.trials or _TRIALS
        if self.confidence and len(self.confidence) > 1:
            raise InputError(
                "The criterion beside the rebuilt error states one --confidence",
                value=", ".join(f"{share:g}" for share in self.confidence),
                remedy="Give one",
            )
        suite = list(load_motions(*(self.motions or ("synthetic",)), sets=self.sets))
        return Design.of(
            suite[:: max(1, len(suite) // trials)][:trials],
            [
                Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
                for f in self.f or [ONE_HERTZ]
                for xi in self.xi or [TWO_PERCENT]
                for share in self.alpha or [1.0]
            ],
            trials=trials,
            threshold=FIVE_PERCENT if self.threshold is None else self.threshold,
            metric=metric,
            confidence=self.confidence[0] if self.confidence else _NINETY_FIVE,
        )


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
    asked = f"{content['metric'].upper()}^R {significant(content['threshold'])}"
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
