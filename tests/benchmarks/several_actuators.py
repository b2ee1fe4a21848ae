"""Errors of tests with several actuators, rebuilt from noisy channels, beside the true ones.

    python tests/benchmarks/several_actuators.py FOLDER --seed S --count N --decibels 40 30

Four structures that are nobody's benchmark (a corner that translates and rotates, two storeys, a node on
three actuators, a plate on four) under the real records of FOLDER, simulated by exact steps. Actuators lag
by up to 8 ms (less where the loop is unstable), have gains 3 % off and move each other by 3 %. Each sensor
has white noise, so many decibels below the RMS of its own displacement. Printed for each interface
displacement that is judged: rebuilt over true RMS^R, how often it is within 2 % and how often the 90 %
interval holds the true error.

`--imperfect`: structure and sensors are not as stated. Frequencies are off by ±2 %, damping ratios by ±15 %,
the specimen's share by ±1 % (standard deviations), each sensor's scale by ±0.6 % and its clock by up to a
sample of the converter (`--clock`, 1024 Hz) either way; the interval is that of ordinary equipment. Verdicts
against 5 % are counted.

`--stiffness 0.05`: instead, all stiffnesses are off by a factor of that standard deviation and nothing else
is; tests are judged with that stated beside ordinary equipment and alone, with ordinary equipment alone, and
as if all were exact. Counted is how many stiffnesses that are off by more than 3 % the recorded ground motion
contradicts, and how many of the others; with `--imperfect` by frequencies that are off by 1.5 %.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratories importable
from coupled_structures import coupled_response, described, node, plate, two_storeys
from laboratory_tests import THRESHOLD, argument_parser
from rebuilt_error.laboratory import read_at2
from scipy.interpolate import CubicSpline

from reliab.assessment.budget.sizes import ordinary_equipment, sizes_of_unknown, tolerances_of
from reliab.assessment.coupled_error.posterior_errors import channels_of_several
from reliab.assessment.coupled_error.rebuild import rebuild_coupled
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.recorded_ground import examine_ground
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferFunction
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

RATE = 512.0
CLOCK = 1024.0  # Hz, of the converters, whose recordings are thinned to RATE
LONGEST = 30.0  # s
LONGEST_LAG = 8e-3  # s, of actuators; shorter until the loop is stable
FAR_OFF = 0.015  # of the natural frequency


def structures() -> dict[str, tuple[Partition, np.ndarray]]:
    """Structures and their kinematics."""
    corner = read_structure(shipped("datasets", "frames/two_actuators.toml"))
    structures_by_name = {"corner": (corner.partition, corner.kinematics)}
    for make in (two_storeys, node, plate):
        partition, actuators = described(make)
        structures_by_name[make.__name__] = (partition, actuators.kinematics)
    return structures_by_name


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
    name: str,
    partition: Partition,
    kinematics: np.ndarray,
    seed: int,
    records: list[Path],
    options: argparse.Namespace,
) -> Iterator[dict[str, object]]:
    """Simulate a test and judge it at each level of noise."""
    rng = np.random.default_rng([seed, len(name)])
    longest = LONGEST_LAG
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        try:
            tested_partition = off_by_chance(partition, rng, options)
            run = coupled_response(
                tested_partition, draw_actuators(kinematics, longest, rng), ground, 1.0 / RATE
            )
            break
        except InputError:  # unstable
            longest *= 0.7
    error_history, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    true = np.sqrt(np.mean(error_history**2, axis=1)) / peak
    command, measured = kinematics @ run.command, kinematics @ run.measured
    read = read_by_chance(measured, rng, options.clock) if options.imperfect else measured
    white = rng.standard_normal(measured.shape) * measured.std(axis=1, keepdims=True)
    for level, (assumption, tolerances) in product(options.decibels, assumptions(partition, options).items()):
        recording = CoupledRecording(
            command=command,
            measured=read + 10.0 ** (-level / 20.0) * white,
            time_step=1.0 / RATE,
            ground=ground,
        )
        error = rebuild_coupled(
            recording.command,
            recording.measured,
            1.0 / RATE,
            partition,
            to_interface=np.linalg.inv(kinematics),
            tolerances=tolerances,
            draws=128,
        )
        channels = channels_of_several(error, recording)
        ground_check = examine_ground(recording, channels, partition, feedback_lag=0.0)
        lowest = tested_partition.natural_frequencies[0] / partition.natural_frequencies[0]
        probability = error.probability(THRESHOLD)
        bad = (
            max(true[place] for place, degree in enumerate(error.displacements) if degree.judged) > THRESHOLD
        )
        for place, degree in enumerate(error.displacements):
            yield {
                "structure": name,
                "decibels": level,
                "assumed": assumption,
                "degree": place + 1,
                "seed": seed,
                "true": true[place],
                "ratio": degree.rms.value / true[place],
                "held": degree.rms.low <= true[place] <= degree.rms.high,
                "judged": degree.judged,
                "false_safe": true[place] > THRESHOLD and degree.probability(THRESHOLD) > 0.95,
                "bad_accepted": bad and probability > 0.95,
                "good_refused": not bad and probability < 0.05,
                "off": abs(lowest - 1.0) > FAR_OFF,
                "told": abs(ground_check.frequency - 1.0) > 3.0 * ground_check.deviation,
                "undecided": 0.05 <= probability <= 0.95,
            }


def assumptions(partition: Partition, options: argparse.Namespace) -> dict[str, Tolerances]:
    """What intervals are to hold."""
    lowest = float(partition.natural_frequencies[0])
    mode = Structure(frequency=lowest, damping_ratio=0.05, experimental_fraction=0.5)
    ordinary = tolerances_of(sizes_of_unknown({}, mode, ordinary_equipment(), 1.0 / RATE))
    if options.imperfect:
        return {"ordinary": ordinary}
    if options.stiffness:
        stated_stiffness = Tolerances(frequency=0.5 * options.stiffness)
        combination = replace(ordinary, frequency=stated_stiffness.frequency)
        return {
            "stated": combination,
            "stated alone": stated_stiffness,
            "ordinary": ordinary,
            "exact": Tolerances(),
        }
    return {"exact": Tolerances()}


def off_by_chance(partition: Partition, rng: np.random.Generator, options: argparse.Namespace) -> Partition:
    """Draw the structure that is tested, where another one is stated."""
    if options.stiffness:
        frequency = np.sqrt(1.0 + options.stiffness * rng.standard_normal())
        return partition.scale(frequency=frequency, damping_ratio=1.0, share=1.0)
    if not options.imperfect:
        return partition
    frequency, ratio, share = 1.0 + rng.standard_normal(3) * [0.02, 0.15, 0.01]
    return partition.scale(frequency=frequency, damping_ratio=max(ratio, 0.3), share=share)


def read_by_chance(measured: np.ndarray, rng: np.random.Generator, clock: float) -> np.ndarray:
    """Readings of sensors whose scales and clocks are not as those of the commands; `clock` [Hz]."""
    times = np.arange(measured.shape[1], dtype=float)
    clock_offsets = rng.uniform(0.0, 1.0, len(measured)) - rng.uniform(0.0, 1.0, len(measured))
    skews = RATE / clock * clock_offsets  # samples
    scales = 1.0 + 0.006 * rng.standard_normal(len(measured))
    return np.stack(
        [
            scale * CubicSpline(times, row)(np.clip(times - skew, 0.0, times[-1]))
            for row, skew, scale in zip(measured, skews, scales, strict=True)
        ]
    )


def state(rows: pd.DataFrame) -> None:
    """Print a line for each displacement."""
    judged_rows = rows[rows["judged"]]
    keys = ["structure", "decibels", "assumed", "degree"]
    for (structure, level, assumption, place), group in judged_rows.groupby(keys, sort=False):
        low, middle, high = group["ratio"].quantile([0.05, 0.5, 0.95])
        near = ((group["ratio"] - 1.0).abs() < 0.02).mean()
        print(
            f"{structure:12} {level:3.0f} dB, {assumption}, displacement {place}: {len(group):3} tests, true "
            f"{group['true'].median():.2%}, ratio {middle:.3f} ({low:.3f} to {high:.3f}), "
            f"within 2 % {near:.0%}, held {group['held'].mean():.0%}, false-safe {group['false_safe'].sum()}"
        )
    for assumption in rows["assumed"].unique().tolist():
        group = rows[rows["assumed"] == assumption]
        counted = group[group["judged"]]
        print(f"{assumption}: judged {len(counted)} of {len(group)}, held {counted['held'].mean():.0%}")
        tests = group.groupby(["structure", "decibels", "seed"])
        verdicts = tests[["bad_accepted", "good_refused", "undecided", "off", "told"]].first()
        counts = verdicts[["bad_accepted", "good_refused", "undecided"]].sum()
        print(f"tests {len(verdicts)}: " + ", ".join(f"{name} {n}" for name, n in counts.items()))
        far = verdicts["off"].astype(bool)
        print(f"ground motion contradicts {verdicts['told'][far].sum()} of {far.sum()} far off, ", end="")
        print(f"{verdicts['told'][~far].sum()} of {(~far).sum()} others")


def main() -> None:
    parser = argument_parser(__doc__, count=20)
    parser.add_argument("--decibels", type=float, nargs="+", default=[40.0])
    parser.add_argument("--structures", nargs="+", choices=list(structures()), default=list(structures()))
    parser.add_argument("--imperfect", action="store_true")
    parser.add_argument("--clock", type=float, default=CLOCK)
    parser.add_argument("--stiffness", type=float, default=0.0)
    options = parser.parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    rows = []
    for name in options.structures:
        for seed in range(options.seed, options.seed + options.count):
            rows += tests(name, *structures()[name], seed, records, options)
        state(pd.DataFrame(row for row in rows if row["structure"] == name))
    if len(options.structures) > 1:
        state(pd.DataFrame(rows))


if __name__ == "__main__":
    main()
