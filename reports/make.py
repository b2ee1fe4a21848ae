"""Make the reports of this folder again, each into its file.

    python reports/make.py [--motions RECORDS] [NAME ...]

Without names, all of them: every study that ships, `assessment`, `verdict`, `sample_rig` and `criterion`.
Studies of the paper need its records and are skipped without them; where records are given, `validation`
runs the paper's cases too.
`rths_benchmark` and `marths_benchmark` need the records of their benchmarks, are made only when they are
named, and then take RECORDS. Their studies scale the records themselves: a factor that a header states
for the benchmark is left out.
`measured_specimen` is made of `measured_specimen.csv`, tests that were judged for most of an hour.
"""

import argparse
import datetime as dt
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from reliab import assess
from reliab.app.cli import run
from reliab.core.shipped import shipped
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.laws.guo_2017 import Equation18
from reliab.criterion.population import sample_of
from reliab.report.figures.parameter_distributions import ellipses_and_criterion
from reliab.report.kinds.assessment.report import histories_figure
from reliab.report.pdf import write_pdf
from reliab.report.style import svg
from reliab.study.description import folders_of_studies
from reliab.sweep.ellipse_dataset import open_ellipses

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = Path(__file__).resolve().parent
NEED_RECORDS = ("paper2017", "table2_audit")
OF_OTHER_RECORDS = ("rths_benchmark", "marths_benchmark")
USE_RECORDS = (*NEED_RECORDS, "validation", *OF_OTHER_RECORDS)
FREQUENCY, DAMPING_RATIO, RIG_DAMPING_RATIO = 1.0, 0.02, 0.03
DATED = ("--date", "2026-01-01")
GOOD, SEED = 0.05, 374300  # of `measured_specimen.csv`
_FACTOR = re.compile(r"multiply by [0-9.]+ for the benchmark; ")
"""In headers of a benchmark's records. Its study takes the samples as they stand and scales them itself."""


def copy_without_factor(records: Path, folder: Path) -> Path:
    """Copy the records of a benchmark without the words that state the factor of its tests."""
    folder.mkdir()
    for file in sorted(records.glob("*.csv")):
        (folder / file.name).write_text(_FACTOR.sub("", file.read_text(encoding="utf-8")), encoding="utf-8")
    return folder


def of_study(name: str, records: Path | None) -> bool:
    """Run a study in a temporary folder and keep its report; tell whether it was made."""
    if records is None and name in (*NEED_RECORDS, *OF_OTHER_RECORDS):
        print(f"{name}: skipped, it needs --motions RECORDS")
        return True
    with tempfile.TemporaryDirectory() as folder:
        if records and name in OF_OTHER_RECORDS:
            records = copy_without_factor(records, Path(folder) / "records")
        motions = ["--motions", str(records)] if records and name in USE_RECORDS else []
        done = run(["run", name, "--out", f"{folder}/run", *motions]) == 0
        if done:
            shutil.copyfile(f"{folder}/run/report.pdf", HERE / f"{name}.pdf")
    return done


def assessment() -> bool:
    """Assess the sample test that ships."""
    test = str(shipped("datasets", "sample_test/test.csv"))
    structure = ["--f", f"{FREQUENCY:g}", "--xi", f"{DAMPING_RATIO:g}"]
    return run(["assess", test, *structure, "--report", str(HERE / "assessment.pdf"), *DATED]) == 0


def verdict() -> bool:
    """Draw the histories of the sample test and its error, the first figure of the README."""
    judged = assess("sample_test", f=FREQUENCY, xi=DAMPING_RATIO)
    figure = histories_figure(judged.error.displacements[0], judged.error.parts, judged.recording)
    (HERE / "verdict.svg").write_bytes(svg(figure.drawing))
    return True


def sample_rig() -> bool:
    """Report the rig that ships."""
    rig = str(shipped("datasets", "sample_rig"))
    structure = ["--f", f"{FREQUENCY:g}", "--xi", f"{RIG_DAMPING_RATIO:g}"]
    return run(["rig", "report", rig, *structure, "--out", str(HERE / "sample_rig.pdf"), *DATED]) == 0


def criterion() -> bool:
    """Draw the figure of the README: the real motions, the criterion, and equation (18)."""
    ellipses = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    derived = derive_criterion(ellipses, f=FREQUENCY, xi=DAMPING_RATIO)
    sample = sample_of(
        ellipses,
        frequency=FREQUENCY,
        damping_ratio=DAMPING_RATIO,
        threshold=derived.threshold,
        metric=derived.metric,
        curve=derived.provenance.curve,
    )
    limits = {"95 % of motions like these": derived.limits(FREQUENCY, DAMPING_RATIO)}
    limits["equation (18) of the paper"] = Equation18().limits(FREQUENCY, DAMPING_RATIO)
    named = {name: (float(a), float(b)) for name, (a, b) in limits.items()}
    (HERE / "criterion.svg").write_bytes(svg(ellipses_and_criterion(sample, named)))
    return True


def measured_specimen() -> bool:
    """Report the judged tests of the table, as the study reports its own."""
    from reliab_studies.measured_specimen.judging import summarise
    from reliab_studies.measured_specimen.report import report_measured_specimen

    tests = pd.read_csv(HERE / "measured_specimen.csv")
    document = report_measured_specimen(
        title="Is a specimen learned from its own force well enough?",
        tests=tests,
        rates=summarise(tests, GOOD),
        threshold=GOOD,
        provenance={"study": "measured_specimen", "seed": SEED, "table": "reports/measured_specimen.csv"},
        purpose="Tests of the study measured_specimen with another seed and far-field records.",
    )
    write_pdf(document, HERE / "measured_specimen.pdf", date=dt.date(2026, 11, 26))
    return True


def main(arguments: list[str]) -> int:
    """Make the reports that are named, or all; return how many could not be made."""
    parser = argparse.ArgumentParser(description="Make the reports of this folder again.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="reports; all by default")
    parser.add_argument("--motions", type=Path, metavar="RECORDS", help="folder of the paper's records")
    asked = parser.parse_args(arguments)
    makers: dict[str, Callable[[], bool]] = {
        name: lambda name=name: of_study(name, asked.motions)  # type: ignore[misc]
        for name in folders_of_studies()
    }
    makers |= {
        "assessment": assessment,
        "verdict": verdict,
        "sample_rig": sample_rig,
        "criterion": criterion,
        "measured_specimen": measured_specimen,
    }
    unknown = set(asked.names) - set(makers)
    if unknown:
        parser.error(f"no report {', '.join(sorted(unknown))}; there are {', '.join(makers)}")
    names = asked.names or [name for name in makers if name not in OF_OTHER_RECORDS]
    failures = [name for name in names if not makers[name]()]
    if failures:
        print(f"not made: {', '.join(failures)}")
    return len(failures)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
