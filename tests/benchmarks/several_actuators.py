"""Errors of tests with several actuators, rebuilt from noisy channels, beside the true ones.

    python tests/benchmarks/several_actuators.py FOLDER --seed S --count N --decibels 40 30

Four structures that are nobody's benchmark (a corner that translates and rotates, two storeys, a node on
three actuators, a plate on four) under the real records of FOLDER, simulated by exact steps. Actuators lag
by up to 8 ms (less where the loop is unstable), have gains 3 % off and move each other by 3 %. Each sensor
has white noise, so many decibels below the RMS of its own displacement. Printed for each interface
displacement that is judged: rebuilt over true RMS^R, how often it is within 2 % and how often the 90 %
interval holds the true error.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

sys.path[:0] = [str(Path(__file__).resolve().parents[1])]

from assessment.rebuilt_error.laboratory import read_at2  # noqa: E402
from coupled_structures import described, node, plate, two_storeys  # noqa: E402

from reliab.assessment.coupled_error import rebuild_coupled  # noqa: E402
from reliab.errors import InputError  # noqa: E402
from reliab.shipped import shipped  # noqa: E402
from reliab.simulation.frames import coupled_response, read_structure  # noqa: E402
from reliab.simulation.transfer_systems import ActuatorMatrix, TransferFunction  # noqa: E402
from reliab.structures import CoupledPartition  # noqa: E402

RATE = 512.0
LONGEST = 30.0  # s
LONGEST_LAG = 8e-3  # s, of actuators; shorter until the loop is stable
THRESHOLD = 0.05


def structures() -> dict[str, tuple[CoupledPartition, np.ndarray]]:
    """Structures and their kinematics."""
    corner = read_structure(shipped("datasets", "frames/two_actuators.toml"))
    found = {"corner": (corner.partition, corner.kinematics)}
    for one in (two_storeys, node, plate):
        partition, actuators = described(one)
        found[one.__name__] = (partition, actuators.kinematics)
    return found


def drawn_actuators(kinematics: np.ndarray, longest: float, rng: np.random.Generator) -> ActuatorMatrix:
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
    partition: CoupledPartition,
    kinematics: np.ndarray,
    seed: int,
    records: list[Path],
    levels: list[float],
) -> Iterator[dict[str, object]]:
    """Simulate a test and judge it at each level of noise."""
    rng = np.random.default_rng([seed, len(name)])
    longest = LONGEST_LAG
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        try:
            run = coupled_response(partition, drawn_actuators(kinematics, longest, rng), ground, 1.0 / RATE)
            break
        except InputError:  # unstable
            longest *= 0.7
    strayed, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    true = np.sqrt(np.mean(strayed**2, axis=1)) / peak
    command, measured = kinematics @ run.command, kinematics @ run.measured
    white = rng.standard_normal(measured.shape) * measured.std(axis=1, keepdims=True)
    for level in levels:
        error = rebuild_coupled(
            command,
            measured + 10.0 ** (-level / 20.0) * white,
            1.0 / RATE,
            partition,
            to_interface=np.linalg.inv(kinematics),
            draws=128,
        )
        for place, degree in enumerate(error.degrees):
            yield {
                "structure": name,
                "decibels": level,
                "degree": place + 1,
                "seed": seed,
                "true": true[place],
                "ratio": degree.rms.value / true[place],
                "held": degree.rms.low <= true[place] <= degree.rms.high,
                "judged": degree.judged,
                "false_safe": true[place] > THRESHOLD and degree.probability(THRESHOLD) > 0.95,
            }


def state(rows: pd.DataFrame) -> None:
    """Print a line for each displacement."""
    judged = rows[rows["judged"]]
    for (structure, level, place), of in judged.groupby(["structure", "decibels", "degree"], sort=False):
        low, middle, high = of["ratio"].quantile([0.05, 0.5, 0.95])
        near = ((of["ratio"] - 1.0).abs() < 0.02).mean()
        print(
            f"{structure:12} {level:3.0f} dB, displacement {place}: {len(of):3} tests, true "
            f"{of['true'].median():.2%}, ratio {middle:.3f} ({low:.3f} to {high:.3f}), "
            f"within 2 % {near:.0%}, held {of['held'].mean():.0%}, false-safe {of['false_safe'].sum()}"
        )
    print(f"judged {len(judged)} of {len(rows)}, held {judged['held'].mean():.0%}")


def main() -> None:
    """Judge tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--decibels", type=float, nargs="+", default=[40.0])
    parser.add_argument("--structures", nargs="+", choices=list(structures()), default=list(structures()))
    asked = parser.parse_args()
    records = sorted(asked.folder.rglob("*.AT2"))
    rows = []
    for name in asked.structures:
        for seed in range(asked.seed, asked.seed + asked.count):
            rows += tests(name, *structures()[name], seed, records, asked.decibels)
        state(pd.DataFrame(row for row in rows if row["structure"] == name))
    if len(asked.structures) > 1:
        state(pd.DataFrame(rows))


if __name__ == "__main__":
    main()
