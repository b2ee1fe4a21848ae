"""Verdicts on tests of frames with one actuator whose structure and channels are not as stated.

    python tests/benchmarks/imperfect_frames.py FOLDER --seed S --count N

The frames that ship, under the real records of FOLDER, with an actuator of second order that lags by up to
16 ms and has a gain 3 % off. The structure that is tested differs from the stated one, the sensor's scale
and clock from those of the command, as in `several_actuators.py` (scales ±0.6 %): the clock by up to a
sample of the converter (`--clock`, 1024 Hz) either way. Noise is 45 dB below the displacement. Each test is
judged with what ordinary equipment leaves unknown, also with the force of its specimen (scale, clock and
noise as of the displacement), and as if all were exact.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratories importable
from benchmark_script import argument_parser
from coupled_structures import CoupledResponse, coupled_response
from laboratory_tests import DECIBELS, THRESHOLD, score_verdict
from rebuilt_error.laboratory import read_at2
from scipy.interpolate import CubicSpline
from several_actuators import (
    CLOCK,
    LONGEST,
    RATE,
    draw_actuators,
    off_by_chance,
    read_by_chance,
)
from uncertain_frames import LONGEST_LAG, frame_of

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording
from reliab.structures.partition import Partition

FRAMES = ("benchmark_case_1", "three_storeys")


def simulate_test(
    partition: Partition, ground: np.ndarray, rng: np.random.Generator
) -> tuple[CoupledResponse, np.ndarray]:
    """Test another structure than the stated one, with an actuator that leaves it stable, and its force."""
    longest = LONGEST_LAG
    while True:
        frame = off_by_chance(partition, rng)
        try:
            run = coupled_response(frame, draw_actuators(np.eye(1), longest, rng), ground, 1.0 / RATE)
            break
        except InputError:  # unstable
            longest *= 0.7
    path = CubicSpline(np.arange(ground.size) / RATE, run.measured, axis=1)
    specimen = frame.specimen_stiffness, frame.specimen_damping, frame.specimen_mass
    return run, np.sum([part @ path(path.x, order) for order, part in enumerate(specimen)], axis=0)


def judge_test(name: str, seed: int, records: list[Path], clock: float) -> Iterator[dict[str, object]]:
    """Simulate a test and judge it with ordinary equipment, and as if all were exact."""
    frame, rng = frame_of(name, dashpots=False), np.random.default_rng([seed, FRAMES.index(name)])
    ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
    run, force = simulate_test(frame.partition, ground, rng)
    error = run.measured - run.reference
    true = float(np.sqrt(np.mean(error**2)) / np.abs(run.reference).max())
    read = read_by_chance(run.measured, rng, clock)[0]
    read += 10.0 ** (-DECIBELS / 20.0) * read.std() * rng.standard_normal(read.size)
    read_force = read_by_chance(force, rng, clock)[0]
    read_force += 10.0 ** (-DECIBELS / 20.0) * read_force.std() * rng.standard_normal(read.size)
    recording = Recording(command=run.command[0], measured=read, time_step=1.0 / RATE, name=name)
    with_force = replace(recording, force=read_force)
    for known_as, test, equipment in (
        ("ordinary equipment", recording, ordinary_equipment()),
        ("with its force", with_force, ordinary_equipment()),
        ("all exact", recording, None),
    ):
        assessment = assess(test, frame, equipment=equipment)
        word = str(assessment.verdict)
        yield {
            "frame": name,
            "known": known_as,
            **score_verdict(assessment.error.estimate(Metric.RMS), true, word),
            "good_reliable": true < THRESHOLD and word == "reliable",
            "bad_refused": true > THRESHOLD and word == "not_reliable",
        }


def main() -> None:
    options = argument_parser(__doc__, "folder", seed=int, count=20, clock=CLOCK).parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    seeds = range(options.seed, options.seed + options.count)
    table = pd.DataFrame(
        row for name in FRAMES for seed in seeds for row in judge_test(name, seed, records, options.clock)
    )
    both = pd.concat([table, table.assign(frame="both")])
    for (name, known_as), group in both.groupby(["frame", "known"], sort=False):
        low, middle, high = group["ratio"].quantile([0.05, 0.5, 0.95])
        counts = ", ".join(
            f"{key} {group[key].sum()}" for key in group.columns[group.columns.get_loc("held") + 1 :]
        )
        bad = int((group["true"] > THRESHOLD).sum())
        print(
            f"{name:17} {known_as:19} {len(group):3} tests ({bad} bad), ratio {middle:.2f} ({low:.2f} to "
            f"{high:.2f}), width {group['width'].median():.2f}, held {group['held'].mean():.0%}, {counts}"
        )


if __name__ == "__main__":
    main()
