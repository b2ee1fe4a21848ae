"""A rig learned from recordings of its tests: what predictions of further earthquakes cover, restartable.

    python tests/benchmarks/rig_recordings.py FOLDER --seed S --count N [--earthquakes 4]

Tests are simulated by `tests/assessment/rebuilt_error/laboratory.py`, which shares no code with `reliab`,
under the real records of `../shared/motions` (`--records`). Each rig has an actuator of second order behind
a delay: its gain falls with the stroke, its delay is longer on the first tests of a day, and in the middle
something is changed, so that it is 1 ms longer from then on. Frequencies, damping ratios and scales of the
motions vary from test to test. Every recording is judged with nothing stated but f and ξ; indices of the
tests are kept in FOLDER. Then the tests of some earthquakes are predicted from those of all others: under an
unknown motion, and beside it whether amplitude and delay found lie in their intervals and the *true* error,
which nobody told, in that of the error.
"""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import paths
from benchmark_script import argument_parser
from laboratory_tests import THRESHOLD
from rebuilt_error import laboratory as lab
from rig_rows import rig_table, rig_test

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.errors import InputError
from reliab.criterion.derivation import published_criterion
from reliab.recordings.recording import Recording
from reliab.rig.memory import NextTest
from reliab.rig.prediction import predict_next
from reliab.rig.rig_folder import describe_test
from reliab.structures.structure import Structure

TESTS, TESTS_OF_DAY, RATE = 96, 6, 512.0
LATER_MS = 1.0


def simulate_tests(seed: int, records: pd.DataFrame, folder: Path) -> list[dict]:
    """Rows of a rig's tests, with their true errors."""
    rng = np.random.default_rng(seed)
    lag, gain = rng.uniform(0.2e-3, 1.2e-3), rng.normal(0.995, 0.003)
    softening, stroke = rng.uniform(0.0, 0.01), 0.06
    rows = []
    for number in range(TESTS):
        record = records.iloc[rng.integers(len(records))]
        ground = rng.uniform(0.3, 1.0) * strongest(lab.read_at2(folder / record["file"], RATE))
        structure = Structure(frequency=float(rng.choice([0.8, 1.0, 1.5])), damping_ratio=0.03)
        day, place = divmod(number, TESTS_OF_DAY)
        late = lag + 1e-3 * (0.8 / (1.0 + place) + 0.2 * rng.normal() + LATER_MS * (number >= TESTS // 2))
        rig = lab.Lab(structure.frequency, structure.damping_ratio)
        ideal = lab.run(rig, ground, RATE, ideal=ground).command
        peak = float(np.abs(ideal).max())
        test_gain = gain - softening * math.tanh(peak / stroke) + 0.001 * rng.normal()
        # a second order of damping 0.7 lags by 1.4/ω
        numbers = (test_gain, 1.4 / max(late, 4e-4), 0.7, 0.0)
        rig_of_test = replace(rig, kind=lab.SECOND_ORDER, numbers=numbers)
        outcome = lab.run(rig_of_test, ground, RATE, parts=8, ideal=ideal)
        if not outcome.rms < 0.5:
            continue
        level = 0.005 * float(np.sqrt(np.mean(outcome.measured**2)))
        measured = outcome.measured + lab.noise("white", outcome.measured.size, level, rng, RATE)
        labels = {
            "sha256": f"{number:064x}",
            "name": f"test_{number}",
            "file": f"test_{number}.csv",
            "added": f"2026-01-01T00:00:00.{number:06d}",
            "date": f"2026-{1 + day // 28:02d}-{1 + day % 28:02d}T{9 + place:02d}:00:00",
            "event": str(record["event"]),
        }
        try:
            assessment = assess(
                Recording(command=outcome.command, measured=measured, time_step=1.0 / RATE),
                structure,
                equipment=ordinary_equipment(),
                criterion=published_criterion("guo_2017_15"),  # of the index, which is not looked at
            )
        except InputError as error:
            print(f"refused: {error}")
            continue
        rows.append({**describe_test(assessment, labels, {}).to_dict(), "true": outcome.rms})
    return rows


def strongest(ground: np.ndarray) -> np.ndarray:
    """Thirty seconds of a record, from ten before its peak."""
    begin = max(int(np.abs(ground).argmax() - 10.0 * RATE), 0)
    return ground[begin : begin + int(30.0 * RATE)]


def predictions(rows: list[dict], earthquakes: int, seed: int) -> list[dict]:
    """Predict the tests of drawn earthquakes from the tests of all others."""
    table = rig_table([rig_test(0, **{k: v for k, v in row.items() if k != "true"}) for row in rows])
    true = {row["sha256"]: row["true"] for row in rows}
    events = np.unique(table.texts("event"))
    results = []
    for event in np.random.default_rng(seed).choice(events, size=earthquakes, replace=False):
        other_tests = [place for place, row in enumerate(table.rows) if row["event"] != event]
        for row in (row for row in table.rows if row["event"] == event):
            structure = Structure(frequency=row["f"], damping_ratio=row["xi"])
            prediction = predict_next(
                table.only(other_tests), structure, NextTest(date=str(row["date"])), threshold=THRESHOLD
            )
            actual = {"A": row["A"], "d_ms": row["d_ms"], "rms": true[row["sha256"]]}
            covers = {
                name: prediction.intervals[name]["low"] <= value <= prediction.intervals[name]["high"]
                for name, value in actual.items()
            }
            results.append(
                {
                    **covers,
                    "probability": prediction.probability,
                    "good": actual["rms"] < THRESHOLD,
                    **{f"score {name}": score for name, score in prediction.log_scores.items()},
                }
            )
    return results


def main() -> None:
    options = argument_parser(
        __doc__, "folder", seed=int, count=3, earthquakes=4, records=paths.MOTIONS
    ).parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    records = pd.read_csv(options.records / "catalog.csv").query("set != 'held_out'")
    tables = []
    for seed in range(options.seed, options.seed + options.count):
        answers = options.folder / f"rig_{seed}.json"
        if not answers.is_file():
            answers.write_text(json.dumps(simulate_tests(seed, records, options.records)), encoding="utf-8")
        tables.append(pd.DataFrame(predictions(json.loads(answers.read_text()), options.earthquakes, seed)))
        state(f"rig {seed}", tables[-1])
    table = pd.concat(tables)
    state("all", table)
    for low, high in ((0.0, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.8), (0.8, 1.0)):
        band = table[table["probability"].between(low, high)]
        if len(band):
            mean_probability, good = band["probability"].mean(), band["good"].mean()
            print(
                f"probability {low} to {high}: stated {mean_probability:.2f}, good {good:.2f}, of {len(band)}"
            )


def state(name: str, rows: pd.DataFrame) -> None:
    """Print what intervals hold, and log scores."""
    shares = ", ".join(f"{column} {rows[column].mean():.0%}" for column in ("A", "d_ms", "rms"))
    scores = ", ".join(
        f"{column.removeprefix('score ')} {rows[column].mean():.2f}"
        for column in map(str, rows)
        if column.startswith("score ")
    )
    print(f"{name}, {len(rows)} tests: {shares}; log score {scores}", flush=True)


if __name__ == "__main__":
    main()
