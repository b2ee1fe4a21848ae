"""Verdicts on tests of frames with one actuator whose structure and channels are not as stated.

    python tests/benchmarks/imperfect_frames.py FOLDER --seed S --count N

The frames that ship, under the real records of FOLDER, with an actuator of second order that lags by up to
16 ms and has a gain 3 % off. The structure that is tested differs from the stated one, the sensor's scale
and clock from those of the command, as in `several_actuators.py --imperfect`: the clock by up to a sample of
the converter (`--clock`, 1024 Hz) either way. Noise is 45 dB below the displacement. Each test is judged
twice: with what ordinary equipment leaves unknown, and as if all were exact.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from assessment.rebuilt_error.laboratory import read_at2  # noqa: E402
from benchmarks.several_actuators import (  # noqa: E402
    CLOCK,
    LONGEST,
    RATE,
    THRESHOLD,
    drawn_actuators,
    off_by_chance,
    read_by_chance,
)
from coupled_structures import CoupledResponse, coupled_response  # noqa: E402

from reliab.assessment.assess import assess  # noqa: E402
from reliab.assessment.budget.sizes import ordinary_equipment  # noqa: E402
from reliab.core.errors import InputError  # noqa: E402
from reliab.core.shipped import shipped  # noqa: E402
from reliab.core.vocabulary import Metric  # noqa: E402
from reliab.recordings.recording import Recording  # noqa: E402
from reliab.simulation.frames.frame_file import FrameUnderTest, read_frame  # noqa: E402
from reliab.structures.partition import Partition  # noqa: E402

FRAMES = ("benchmark_case_1", "three_storeys")
LONGEST_LAG = 16e-3  # s
DECIBELS = 45.0
_AS_SEVERAL_ACTUATORS = argparse.Namespace(imperfect=True, stiffness=0.0)


def frame_of(name: str) -> FrameUnderTest:
    """Read a frame that ships, with the interface's error and nothing stated of its tolerances."""
    frame = read_frame(shipped("datasets", f"frames/{name}.toml"))
    return replace(frame, output=None, tolerances=type(frame.tolerances)())


def simulated(partition: Partition, ground: np.ndarray, rng: np.random.Generator) -> CoupledResponse:
    """Test another structure than the stated one, with an actuator that leaves it stable."""
    longest = LONGEST_LAG
    while True:
        tested = off_by_chance(partition, rng, _AS_SEVERAL_ACTUATORS)
        try:
            return coupled_response(tested, drawn_actuators(np.eye(1), longest, rng), ground, 1.0 / RATE)
        except InputError:  # unstable
            longest *= 0.7


def judged(name: str, seed: int, records: list[Path], clock: float) -> Iterator[dict[str, object]]:
    """Simulate a test and judge it with ordinary equipment, and as if all were exact."""
    frame, rng = frame_of(name), np.random.default_rng([seed, FRAMES.index(name)])
    ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
    run = simulated(frame.partition, ground, rng)
    strayed = run.measured - run.reference
    true = float(np.sqrt(np.mean(strayed**2)) / np.abs(run.reference).max())
    read = read_by_chance(run.measured, rng, clock)[0]
    read += 10.0 ** (-DECIBELS / 20.0) * read.std() * rng.standard_normal(read.size)
    recording = Recording(command=run.command[0], measured=read, time_step=1.0 / RATE, name=name)
    for known, equipment in (("ordinary equipment", ordinary_equipment()), ("all exact", None)):
        found = assess(recording, frame, equipment=equipment)
        size, word = found.error.estimate(Metric.RMS), str(found.verdict)
        yield {
            "frame": name,
            "known": known,
            "true": true,
            "ratio": size.value / true,
            "held": size.low <= true <= size.high,
            "bad_accepted": true > THRESHOLD and word == "reliable",
            "good_refused": true < THRESHOLD and word == "not_reliable",
            "undecided": word == "undecided",
            "good_reliable": true < THRESHOLD and word == "reliable",
            "bad_refused": true > THRESHOLD and word == "not_reliable",
        }


def main() -> None:
    """Judge tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--clock", type=float, default=CLOCK)
    asked = parser.parse_args()
    records = sorted(asked.folder.rglob("*.AT2"))
    seeds = range(asked.seed, asked.seed + asked.count)
    table = pd.DataFrame(
        row for name in FRAMES for seed in seeds for row in judged(name, seed, records, asked.clock)
    )
    for (name, known), of in table.groupby(["frame", "known"], sort=False):
        low, middle, high = of["ratio"].quantile([0.05, 0.5, 0.95])
        counts = ", ".join(f"{key} {of[key].sum()}" for key in of.columns[of.columns.get_loc("held") + 1 :])
        bad = int((of["true"] > THRESHOLD).sum())
        print(
            f"{name:17} {known:19} {len(of):3} tests ({bad} bad), ratio {middle:.2f} ({low:.2f} to "
            f"{high:.2f}), held {of['held'].mean():.0%}, {counts}"
        )


if __name__ == "__main__":
    main()
