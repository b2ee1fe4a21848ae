"""`reliab validate --calibration`: stated probabilities of tests against how many of the tests are good."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, progress_bar, table, write_json
from reliab.cli.validate.answer import ELLIPSE_NOTE, interval
from reliab.cli.validate.judged_motions import DEFAULT_SCHEME, JudgedMotions

if TYPE_CHECKING:
    import pandas as pd

_HEADINGS = {
    "stated probability": "right",
    "good tests (95 % interval)": "right",
    "tests": "right",
}


@dataclass(frozen=True, kw_only=True)
class Probabilities(JudgedMotions):
    """Options of a comparison of stated probabilities with simulated tests."""

    def run(self) -> None:
        """Compare probabilities with tests; write and print how many are good for which probability."""
        from reliab.validation.probability_calibration import probability_calibration

        dataset = self.dataset()
        truth, scheme = self.truth(dataset), self.scheme or DEFAULT_SCHEME
        with progress_bar("Comparing probabilities") as progress:
            bins = probability_calibration(
                dataset,
                scheme=scheme,
                threshold=self.error,
                metric=self.metric,
                truth=truth,
                trials=self.tests_per_structure,
                progress=progress,
            )
        content = _answer(bins, scheme=scheme, truth=truth.name)
        if not write_json(content, self.json_target):
            _show(content)


def _answer(bins: "pd.DataFrame", *, scheme: str, truth: str) -> dict[str, Any]:
    """Put the calibration of probabilities into plain values."""
    return {"scheme": scheme, "truth": truth, "bins": bins.to_dict(orient="records")}


def _show(content: dict[str, Any]) -> None:
    """Print how many tests are good for which probability."""
    title = f"Probabilities of tests, {content['scheme'].replace('_', ' ')}"
    shown = table(title, _HEADINGS)
    for row in content["bins"]:
        rate = {"rate": row["observed"], "low": row["low"], "high": row["high"]}
        shown.add_row(f"{row['stated']:.1%}", interval(rate), str(row["tests"]))
    console().print(shown)
    if content["truth"] == "ellipse":
        console().print(ELLIPSE_NOTE)
