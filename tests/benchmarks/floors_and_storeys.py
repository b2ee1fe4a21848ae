"""Errors of floors and storeys as `assess` states them, beside the true ones, by what the specimen is.

    python tests/benchmarks/floors_and_storeys.py RECORDS --seed S --count N [--kinds NAME …]

Shear frames of three storeys, 0.7 to 2 Hz and 2 to 5 %, whose lowest storey's spring stands partly in the
laboratory, under the real records of RECORDS, simulated by `tests/assessment/frames_by_matrices.py`: a linear
specimen; one that yields at a ductility of 1.5 to 3, its force not recorded or recorded with 45 dB of noise;
and two actuators, on the two lower floors. Frequencies (2 %), damping ratios (15 %), scale (0.6 %) and clock
(up to a sample) of the sensors are not as stated, where the specimen is learned from its force as stated but
for the noise of 45 dB. Ordinary equipment is assumed, the ground acceleration is recorded. Counted are
intervals that hold, of the interface and of floors and storeys, and tests whose worst storey is named.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from assessment.frames_by_matrices import Matrices, Outcome, run, run_yielding, shear  # noqa: E402
from assessment.rebuilt_error.laboratory import read_at2  # noqa: E402
from benchmarks.several_actuators import read_by_chance  # noqa: E402
from benchmarks.uncertain_frames import true_errors  # noqa: E402

from reliab.assessment.assess import assess  # noqa: E402
from reliab.assessment.budget.sizes import ordinary_equipment  # noqa: E402
from reliab.recordings.coupled_recording import CoupledRecording  # noqa: E402
from reliab.recordings.recording import Recording  # noqa: E402
from reliab.simulation.frames.frame_file import FrameUnderTest  # noqa: E402
from reliab.structures.partition import Partition  # noqa: E402

RATE, LONGEST, DECIBELS = 512.0, 25.0, 45.0
SMALLEST, LARGEST = 0.01, 0.12
KINDS = ("linear", "yields, no force", "yields, by its force", "two actuators")
NAMES = ("1", "2", "3")


def drawn(kind: str, rng: np.random.Generator) -> Matrices:
    """Frame as stated."""
    springs = shear(rng.uniform(0.8, 1.2, 3))
    squares = np.linalg.eigvalsh(springs)
    omega = 2.0 * np.pi * rng.uniform(0.7, 2.0)
    stiffness = 1000.0 * omega**2 / squares[0] * springs
    share = rng.uniform(0.3, 0.9) * float(stiffness[0, 0] + stiffness[0, 1])
    return Matrices(
        mass=1000.0 * np.eye(3),
        damping=2.0 * rng.uniform(0.02, 0.05) / omega * stiffness,
        stiffness=stiffness,
        interface=np.eye(3)[:, :2] if kind == "two actuators" else np.eye(3)[0],
        influence=np.ones(3),
        specimen=(0.3 * share if kind == "two actuators" else share, 0.0, 0.0),
    )


def simulated(
    kind: str, stated: Matrices, records: list[Path], rng: np.random.Generator
) -> tuple[Outcome, np.ndarray]:
    """Test of another structure than stated, whose true error lies between the limits; its ground motion."""
    f, ratio = (1.0, 1.0) if kind == "yields, by its force" else 1.0 + rng.standard_normal(2) * [0.02, 0.15]
    k = stated.specimen[0] * f**2
    tested = replace(
        stated,
        stiffness=stated.stiffness * f**2,
        damping=stated.damping * f * max(ratio, 0.3),
        specimen=(k, 0.0, 0.0),
    )
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        size = 2 if kind == "two actuators" else 1
        gain, corner = 1.0 + 0.02 * rng.standard_normal(size), 1.4 / (0.016 * rng.uniform(0.05, 1.0, size))
        if kind.startswith("yields"):
            found = run_yielding(
                tested, float(gain[0]), float(corner[0]), ground, 1.0 / RATE, rng.uniform(1.5, 3.0)
            )
        else:
            found = run(tested, gain, corner, ground, 1.0 / RATE)
        if found is not None and all(SMALLEST < error < LARGEST for error in at_interface(found)):
            return found, ground


def at_interface(outcome: Outcome) -> list[float]:
    """RMS^R of the measured interface displacements."""
    ideal = np.atleast_2d(outcome.interface.T @ outcome.ideal)
    return [outcome.error_of(*pair) for pair in zip(np.atleast_2d(outcome.measured), ideal, strict=True)]


def noisy(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Add the noise of a sensor."""
    level = 10.0 ** (-DECIBELS / 20.0) * values.std(axis=-1, keepdims=True)
    return values + level * rng.standard_normal(values.shape)


def judged(kind: str, seed: int, records: list[Path]) -> dict[str, object]:
    """Simulate a test and judge it."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    stated = drawn(kind, rng)
    outcome, ground = simulated(kind, stated, records, rng)
    by_force, several = kind == "yields, by its force", kind == "two actuators"
    read = np.atleast_2d(outcome.measured)
    read = noisy(read if by_force else read_by_chance(read, rng, RATE), rng)
    k, gamma = stated.specimen[0], stated.interface.reshape(3, -1)
    size = gamma.shape[1]
    partition = Partition(
        mass=stated.mass,
        damping=stated.damping,
        stiffness=stated.stiffness,
        interface=gamma,
        influence=stated.influence,
        specimen_stiffness=k * np.eye(size),
        names=NAMES[:size],
        degrees_of_freedom=NAMES,
    )
    if several:
        frame = FrameUnderTest(name=kind, partition=partition, has_several=True)
        recording = CoupledRecording(
            command=outcome.command, measured=read, time_step=1.0 / RATE, ground=ground
        )
        found = assess(recording, frame, equipment=ordinary_equipment())
        sizes, of = [degree.rms for degree in found.error.displacements], found.responses
    else:
        alone = assess(
            Recording(
                command=outcome.command,
                measured=read[0],
                time_step=1.0 / RATE,
                ground=ground,
                force=noisy(outcome.force, rng) if by_force else None,
            ),
            FrameUnderTest(name=kind, partition=partition, output=None, error_of="interface"),
            equipment=ordinary_equipment(),
            measured_specimen=by_force,
        )
        sizes, of = [alone.error.rebuilt.rms], alone.responses
    true, over_peaks = true_errors(outcome), of.each if of.over_peaks else ()
    storeys = {name: error for name, error in true.items() if name.startswith("storey")}
    return {
        "kind": kind,
        "held": np.mean(
            [one.low <= error <= one.high for one, error in zip(sizes, at_interface(outcome), strict=True)]
        ),
        "responses": [one.rms.low <= true[one.name] <= one.rms.high for one in over_peaks],
        "ratio": [one.rms.value / true[one.name] for one in over_peaks],
        "width": [(one.rms.high - one.rms.low) / true[one.name] for one in over_peaks],
        "in_millimetres": not of.over_peaks,
        "governs": of.governing_storey.name == max(storeys, key=storeys.get),
    }


def main() -> None:
    """Judge tests and print a line for each kind."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    asked = parser.parse_args()
    records = sorted(asked.folder.rglob("*.AT2"))
    for kind in asked.kinds:
        of = pd.DataFrame(judged(kind, seed, records) for seed in range(asked.seed, asked.seed + asked.count))
        held, ratio, width = (np.concatenate(of[name]) for name in ("responses", "ratio", "width"))
        low, middle, high = np.quantile(ratio, [0.05, 0.5, 0.95])
        print(
            f"{kind:21} {len(of):3} tests: interface held {of['held'].mean():.0%}, floors and "
            f"storeys {held.mean():.0%} of {held.size}, ratio {middle:.2f} ({low:.2f} to {high:.2f}), "
            f"width over true {np.median(width):.2f}, worst storey named in {of['governs'].sum()}, "
            f"in millimetres alone {of['in_millimetres'].sum()}",
            flush=True,
        )


if __name__ == "__main__":
    main()
