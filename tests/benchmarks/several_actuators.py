"""Tests with several actuators, judged by `assess` without and with their ground acceleration and forces.

    python tests/benchmarks/several_actuators.py FOLDER --seed S --count N --decibels 40 30

Four structures that are nobody's benchmark (a corner that translates and rotates, two storeys, a node on
three actuators, a plate on four) under the real records of FOLDER, simulated by exact steps. Actuators lag
by up to 8 ms (less where the loop is unstable), have gains 3 % off and move each other by 3 %. Each sensor
has white noise, so many decibels below the RMS of its own displacement. Structure and sensors are not as
stated: frequencies are off by ±2 %, damping ratios by ±15 %, the specimen's share by ±1 %, each sensor's
scale by ±0.3 % (standard deviations), and its clock by up to a sample of the converter (`--clock`, 1024 Hz)
either way. Intervals are those of ordinary equipment, and verdicts those against 5 %.

`--exact`: structure and sensors are as stated, and judged so.
"""

import argparse
import time
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratories importable
from benchmark_script import argument_parser
from coupled_structures import coupled_response, described, node, plate, two_storeys
from laboratory_tests import THRESHOLD
from rebuilt_error.laboratory import read_at2
from scipy.interpolate import CubicSpline

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import exact_equipment, ordinary_equipment
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferFunction
from reliab.structures.partition import Partition

RATE = 512.0
CLOCK = 1024.0  # Hz, of the converters, whose recordings are thinned to RATE
LONGEST = 30.0  # s
RECORDED = {  # whether the ground acceleration and the forces are
    "displacements": (False, False),
    "with ground": (True, False),
    "with forces": (False, True),
    "with ground and forces": (True, True),
}
LONGEST_LAG = 8e-3  # s, of actuators; shorter until the loop is stable


def structures() -> dict[str, FrameUnderTest]:
    """Structures with their kinematics."""
    found = {"corner": read_structure(shipped("datasets", "frames/two_actuators.toml"))}
    for one in (two_storeys, node, plate):
        partition, actuators = described(one)
        found[one.__name__] = FrameUnderTest(
            name=one.__name__,
            partition=partition,
            output=None,
            error_of="interface",
            has_several=True,
            kinematics=actuators.kinematics,
            channels_at_interface=False,
        )
    return found


def draw_actuators(kinematics: np.ndarray, longest: float, rng: np.random.Generator) -> ActuatorMatrix:
    """Second-order lags up to the longest [s], alike but not equal, that move each other."""
    lag, size = longest * rng.uniform(0.2, 1.0), len(kinematics)
    corners = 1.4 / (lag * rng.uniform(0.8, 1.25, size))

    def entry(i: int, j: int) -> TransferFunction:
        gain = float(i == j) + 0.03 * rng.standard_normal()
        corner = float(corners[j])
        return TransferFunction(numerator=(gain * corner**2,), denominator=(1.0, 1.4 * corner, corner**2))

    return ActuatorMatrix(
        kinematics=kinematics, transfer=tuple(tuple(entry(i, j) for j in range(size)) for i in range(size))
    )


def tests(
    name: str, frame: FrameUnderTest, seed: int, records: list[Path], options: argparse.Namespace
) -> Iterator[dict[str, object]]:
    """Simulate a test and judge it at each level of noise, with more and more of what was recorded."""
    rng = np.random.default_rng([seed, len(name)])
    partition, kinematics, longest = frame.partition, frame.kinematics, LONGEST_LAG
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        try:
            tested = partition if options.exact else off_by_chance(partition, rng)
            run = coupled_response(tested, draw_actuators(kinematics, longest, rng), ground, 1.0 / RATE)
            break
        except InputError:  # unstable
            longest *= 0.7
    strayed, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    true = np.sqrt(np.mean(strayed**2, axis=1)) / peak
    command, measured = kinematics @ run.command, kinematics @ run.measured
    read = measured if options.exact else read_by_chance(measured, rng, options.clock, scale=0.003)
    white = rng.standard_normal(measured.shape) * measured.std(axis=1, keepdims=True)
    force = np.linalg.solve(kinematics.T, specimen_force(tested, run.measured))
    felt = force if options.exact else read_by_chance(force, rng, options.clock, scale=0.005)
    felt_noise = rng.standard_normal(force.shape) * force.std(axis=1, keepdims=True)
    for level, (recorded, (has_ground, has_force)) in product(options.decibels, RECORDED.items()):
        size = 10.0 ** (-level / 20.0)
        recording = Recording(
            command=command,
            measured=read + size * white,
            time_step=1.0 / RATE,
            ground=ground if has_ground else None,
            force=felt + size * felt_noise if has_force else None,
        )
        begin = time.process_time()
        equipment = exact_equipment() if options.exact else ordinary_equipment()
        error = assess(recording, frame, threshold=THRESHOLD, equipment=equipment).error
        took, probability = time.process_time() - begin, error.probability
        judged = [place for place, degree in enumerate(error.displacements) if degree.judged]
        bad = max(true[place] for place in judged) > THRESHOLD
        for place in judged:
            rms = error.displacements[place].rms
            yield {
                "structure": name,
                "decibels": level,
                "recorded": recorded,
                "seed": seed,
                "true": true[place],
                "ratio": rms.value / true[place],
                "width": (rms.high - rms.low) / true[place],
                "held": rms.low <= true[place] <= rms.high,
                "undecided": 0.05 <= probability <= 0.95,
                "false": probability > 0.95 if bad else probability < 0.05,
                "seconds": took,
            }


def specimen_force(tested: Partition, displacement: np.ndarray) -> np.ndarray:
    """Force of the specimen along the motion of the interface [N]."""
    velocity = np.gradient(displacement, 1.0 / RATE, axis=1)
    return (
        tested.specimen_stiffness @ displacement
        + tested.specimen_damping @ velocity
        + tested.specimen_mass @ np.gradient(velocity, 1.0 / RATE, axis=1)
    )


def off_by_chance(partition: Partition, rng: np.random.Generator) -> Partition:
    """Draw the structure that is tested, where another one is stated."""
    frequency, ratio, share = 1.0 + rng.standard_normal(3) * [0.02, 0.15, 0.01]
    return partition.scale(frequency=frequency, damping_ratio=max(ratio, 0.3), share=share)


def read_by_chance(
    measured: np.ndarray, rng: np.random.Generator, clock: float, scale: float = 0.006
) -> np.ndarray:
    """Readings of sensors whose scales and clocks are not as those of the commands.

    `clock` [Hz]; `scale`: standard deviation of the scales [-].
    """
    times = np.arange(measured.shape[1], dtype=float)
    spaced = rng.uniform(0.0, 1.0, len(measured)) - rng.uniform(0.0, 1.0, len(measured))
    skews = RATE / clock * spaced  # samples
    scales = 1.0 + scale * rng.standard_normal(len(measured))
    return np.stack(
        [
            factor * CubicSpline(times, row)(np.clip(times - skew, 0.0, times[-1]))
            for row, skew, factor in zip(measured, skews, scales, strict=True)
        ]
    )


def state(rows: pd.DataFrame, by: list[str]) -> None:
    """Print a line for each group of displacements."""
    for names, of in rows.groupby(by, sort=False):
        verdicts = of.groupby(["structure", "decibels", "seed"])[["undecided", "false"]].first()
        low, middle, high = of["ratio"].quantile([0.05, 0.5, 0.95])
        print(
            f"{', '.join(map(str, names))}: {len(of)} displacements, held {of['held'].mean():.0%}, width "
            f"{of['width'].median():.2f}, ratio {middle:.3f} ({low:.3f} to {high:.3f}); {len(verdicts)} "
            f"tests, undecided {verdicts['undecided'].mean():.0%}, false {verdicts['false'].sum()}, "
            f"{of['seconds'].median():.1f} s",
            flush=True,
        )


def main() -> None:
    parser = argument_parser(__doc__, "folder", seed=int, count=20, exact=False, clock=CLOCK)
    parser.add_argument("--decibels", type=float, nargs="+", default=[40.0])
    options = parser.parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    rows = []
    for name, frame in structures().items():
        for seed in range(options.seed, options.seed + options.count):
            rows += tests(name, frame, seed, records, options)
        state(pd.DataFrame(row for row in rows if row["structure"] == name), ["structure", "recorded"])
    state(pd.DataFrame(rows), ["recorded", "decibels"])


if __name__ == "__main__":
    main()
