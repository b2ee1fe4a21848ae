"""Measure how good the rebuilt error is, on tests that share no code with the product.

`python tests/benchmarks/rebuilt_error.py PART [--count N] [--seed S] [--records FOLDER] [--out FILE.csv]`
with a part of

history        noise-free history against the simulation, every actuator
noise          40 dB white noise, structure known: error within 2 %, accepted and refused at 5 %
threshold      the same for true errors about the threshold: 3.5 to 7.5 %
coverage       90 % intervals and probabilities: random noise, wrong f (sd 1 %), ξ (10 %), scale (0.5 %)
levels         20 to 60 dB and quantised sensors, structure known
small          true errors of 0.1 to 0.6 %, structure known

Tests are simulated by `tests/assessment/rebuilt_error/laboratory.py` under the real records of FOLDER (a
folder with a catalog.csv, `../shared/motions` by default), each cut at random to 15 to 40 s.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import paths
from benchmark_script import argument_parser
from laboratory_tests import STEP, draw_test, noise_level, read_records
from rebuilt_error import laboratory as lab
from scipy.stats import beta

from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.structures.structure import Structure

EDGES = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)

Row = dict[str, object]
ACTUATORS = (lab.DELAY, lab.DELAY, lab.LAG, lab.RATE_LIMIT, lab.BACKLASH, lab.LEAD, lab.SECOND_ORDER)


@dataclass(frozen=True)
class Sample:
    """A simulated test."""

    lab: lab.Lab
    outcome: lab.Outcome

    @property
    def structure(self) -> Structure:
        """The structure as it is."""
        return Structure(
            frequency=self.lab.f, damping_ratio=self.lab.xi, experimental_fraction=self.lab.alpha
        )


@dataclass(frozen=True)
class Series:
    """Tests of random structures and actuators; each by its number, so that a series can be resumed."""

    records: list[Path]
    seed: int

    def rng(self, number: int) -> np.random.Generator:
        """Source of the random numbers of one test."""
        return np.random.default_rng([self.seed, number])

    def draw(self, number: int, low: float, high: float) -> tuple[Sample, np.random.Generator]:
        """Test whose RMS^R lies in a range, and the source of what is random about its reading."""
        rng = self.rng(number)
        return Sample(*draw_test(self.records, rng, (low, high), ACTUATORS)), rng


def read(outcome: lab.Outcome, kind: str, decibels: float, rng: np.random.Generator) -> np.ndarray:
    """Measured displacement with noise so many decibels below it."""
    level = noise_level(outcome.measured, decibels)
    if kind == "quantised":
        return lab.quantise(outcome.measured, level, rng)
    return outcome.measured + lab.noise(kind, outcome.measured.size, level, rng)


def share(values: list[bool] | np.ndarray) -> str:
    """Share of truths with its count and standard error."""
    if len(values) == 0:
        return "of none"
    rate = float(np.mean(values))
    return f"{rate:.1%} of {len(values)} (± {math.sqrt(max(rate * (1 - rate), 1e-9) / len(values)):.1%})"


def history(series: Series, number: int) -> Iterator[Row]:
    """Noise-free history."""
    test, _ = series.draw(number, 0.002, 1.0)
    o = test.outcome
    rebuilt = rebuild(o.command, o.measured, STEP, test.structure, draws=2)
    true = o.measured - o.ideal
    off = float(np.sqrt(np.mean((rebuilt.displacements[0].error - true) ** 2) / np.mean(true**2)))
    yield {"actuator": test.lab.kind, "off": off}


def state_history(rows: pd.DataFrame) -> None:
    """Largest distance of each actuator."""
    for kind, group in rows.groupby("actuator"):
        print(f"actuator {kind}: relative RMS at most {group['off'].max():.1e} over {len(group)} tests")


def compare_with_truth(test: Sample, rebuilt: RebuiltError) -> Row:
    """Truth, statement and probability of a test."""
    o, estimates = test.outcome, {"rms": rebuilt.rms, "mte": rebuilt.mte}
    row: Row = {"actuator": test.lab.kind, "f": test.lab.f, "xi": test.lab.xi, "alpha": test.lab.alpha}
    for name, true in (("rms", o.rms), ("mte", o.mte)):
        row |= {f"true_{name}": true, name: estimates[name].value}
        row |= {f"{name}_low": estimates[name].low, f"{name}_high": estimates[name].high}
    return row | {"probability": rebuilt.probability(0.05)}


def noise(series: Series, number: int) -> Iterator[Row]:
    """40 dB, structure known."""
    test, rng = series.draw(number, 0.01, 0.2)
    measured = read(test.outcome, "white", 40.0, rng)
    yield compare_with_truth(test, rebuild(test.outcome.command, measured, STEP, test.structure))


def threshold(series: Series, number: int) -> Iterator[Row]:
    """40 dB, structure known, true error about the threshold."""
    test, rng = series.draw(number, 0.035, 0.075)
    measured = read(test.outcome, "white", 40.0, rng)
    yield compare_with_truth(test, rebuild(test.outcome.command, measured, STEP, test.structure))


def state_noise(rows: pd.DataFrame) -> None:
    """How near, and how often rightly accepted."""
    for name in ("rms", "mte"):
        ratio = rows[name] / rows[f"true_{name}"]
        print(
            f"{name} within 2 %: {share(np.abs(ratio - 1.0) < 0.02)}, inside {share(is_inside(rows, name))}"
        )
    is_accepted = rows["rms"] < 0.05
    print(f"at 5 %: bad accepted {share(is_accepted[rows['true_rms'] > 0.05 * 1.03])}")
    print(f"at 5 %: good accepted {share(is_accepted[rows['true_rms'] < 0.05 * 0.97])}")


def is_inside(rows: pd.DataFrame, name: str) -> pd.Series:
    """Whether intervals hold the truth."""
    return (rows[f"{name}_low"] <= rows[f"true_{name}"]) & (rows[f"true_{name}"] <= rows[f"{name}_high"])


def coverage(series: Series, number: int) -> Iterator[Row]:
    """90 % intervals and probabilities under everything at once."""
    test, rng = series.draw(number, 0.01, 0.2)
    kind, decibels = str(rng.choice(["white", "slow", "quantised", "mains"])), rng.uniform(30.0, 60.0)
    measured = read(test.outcome, kind, decibels, rng) * (1.0 + 0.005 * rng.normal())
    wrong = Structure(
        frequency=test.lab.f * (1.0 + 0.01 * rng.normal()),
        damping_ratio=test.lab.xi * (1.0 + 0.1 * rng.normal()),
        experimental_fraction=test.lab.alpha,
    )
    tolerances = PriorKnowledge(tolerances={"frequency": 0.01, "damping_ratio": 0.1, "sensor_scale": 0.005})
    rebuilt = rebuild(test.outcome.command, measured, STEP, wrong, known=tolerances)
    yield {"noise": kind, "decibels": decibels, **compare_with_truth(test, rebuilt)}


def state_coverage(rows: pd.DataFrame) -> None:
    """Coverage by kind of noise, and how often tests of a stated probability are good."""
    for kind, group in [*rows.groupby("noise"), ("all", rows)]:
        print(f"{kind:10} RMS^R {share(is_inside(group, 'rms'))}, MTE^R {share(is_inside(group, 'mte'))}")
    good = rows["true_rms"] < 0.05
    for _, group in rows.groupby(pd.cut(rows["probability"], EDGES, include_lowest=True), observed=True):
        true = good[group.index].mean()
        print(f"stated {group['probability'].mean():.3f}, true {true:.3f} ({len(group)} tests)")


def draw_reliability(rows: pd.DataFrame, path: Path) -> None:
    """Stated probability against the share of good tests, with 90 % intervals of a binomial share."""
    good = rows["true_rms"] < 0.05
    figure, axes = plt.subplots(figsize=(4.2, 4.0), layout="constrained")
    axes.plot([0.0, 1.0], [0.0, 1.0], color="0.6", linewidth=1.0)
    for _, group in rows.groupby(pd.cut(rows["probability"], EDGES, include_lowest=True), observed=True):
        count, total = int(good[group.index].sum()), len(group)
        probability, share_of_good = float(group["probability"].mean()), count / total
        low, high = beta.ppf([0.05, 0.95], [count + 0.5, count + 0.5], [total - count + 0.5] * 2)
        axes.plot([probability, probability], [low, high], color="tab:blue", linewidth=1.2)
        axes.plot(probability, share_of_good, "o", color="tab:blue", markersize=4.0)
        axes.annotate(
            str(total), (probability, share_of_good), (5, -10), textcoords="offset points", fontsize=7.0
        )
    axes.set(xlabel="Stated probability of RMS$^R$ < 5 %", ylabel="Share of tests with RMS$^R$ < 5 %")
    axes.set(xlim=(-0.02, 1.06), ylim=(-0.02, 1.04))
    figure.savefig(path, dpi=150)


def levels(series: Series, number: int) -> Iterator[Row]:
    """Noise of 20 to 60 dB on the same test."""
    test, rng = series.draw(number, 0.01, 0.2)
    for kind in ("white", "quantised"):
        for decibels in (20.0, 30.0, 40.0, 50.0, 60.0):
            measured = read(test.outcome, kind, decibels, rng)
            rebuilt = rebuild(test.outcome.command, measured, STEP, test.structure)
            yield {"noise": kind, "decibels": decibels, **compare_with_truth(test, rebuilt)}


def state_levels(rows: pd.DataFrame) -> None:
    """Ratio and coverage by noise."""
    for (kind, decibels), group in rows.groupby(["noise", "decibels"]):
        ends = np.quantile(group["rms"] / group["true_rms"], [0.05, 0.5, 0.95])
        print(
            f"{kind} {decibels:.0f} dB: RMS^R ratio {ends.round(3).tolist()} (5, 50, 95 %), "
            f"inside RMS^R {share(is_inside(group, 'rms'))}, MTE^R {share(is_inside(group, 'mte'))}"
        )


def small(series: Series, number: int) -> Iterator[Row]:
    """Actuators that are nearly perfect: true errors of 0.1 to 0.6 %, noise of 40 to 60 dB."""
    test, rng = series.draw(number, 0.001, 0.006)
    for kind in ("white", "quantised"):
        decibels = rng.uniform(40.0, 60.0)
        measured = read(test.outcome, kind, decibels, rng)
        rebuilt = rebuild(test.outcome.command, measured, STEP, test.structure)
        yield {"noise": kind, "decibels": decibels, **compare_with_truth(test, rebuilt)}


def state_small(rows: pd.DataFrame) -> None:
    """Ratio and coverage by kind of noise."""
    state_levels(rows.assign(decibels=50.0))


PARTS = {
    "history": (history, state_history, 60),
    "noise": (noise, state_noise, 200),
    "threshold": (threshold, state_noise, 800),
    "coverage": (coverage, state_coverage, 1000),
    "levels": (levels, state_levels, 60),
    "small": (small, state_small, 100),
}
"""Rows of one test, what is said of all rows, and how many tests."""


def measure(part: str, series: Series, count: int, out: Path | None) -> pd.DataFrame:
    """Measure test by test; rows are appended to a file, and tests that it holds are not simulated again."""
    measure_test, state, _ = PARTS[part]
    rows = pd.read_csv(out) if out is not None and out.exists() else pd.DataFrame()
    tests_done = set(rows["test"]) if len(rows) else set()
    for number in range(count):
        if number in tests_done:
            continue
        new = pd.DataFrame([{"test": number, **row} for row in measure_test(series, number)])
        if out is not None:
            new.to_csv(out, mode="a", header=not out.exists(), index=False, float_format="%.6g")
        rows = pd.concat([rows, new], ignore_index=True)
    state(rows)
    return rows


def main() -> None:
    parser = argument_parser(__doc__, seed=0, records=paths.MOTIONS)
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--count", type=int)
    parser.add_argument("--out", type=Path, help="CSV with a row for each test, in which a run resumes")
    parser.add_argument("--figure", type=Path, help="PNG of the reliability diagram, for coverage")
    options = parser.parse_args()
    series = Series(read_records(options.records), options.seed)
    rows = measure(options.part, series, options.count or PARTS[options.part][2], options.out)
    if options.figure is not None and options.part == "coverage":
        draw_reliability(rows, options.figure)


if __name__ == "__main__":
    main()
