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

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratories importable
from benchmark_script import argument_parser
from frames_by_matrices import Matrices, Outcome, run, run_yielding, shear
from laboratory_tests import DECIBELS, LARGEST, SMALLEST
from rebuilt_error.laboratory import read_at2
from several_actuators import read_by_chance
from uncertain_frames import true_errors

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.partition import Partition

RATE, LONGEST = 512.0, 25.0
KINDS = ("linear", "yields, no force", "yields, by its force", "two actuators")
NAMES = ("1", "2", "3")


def draw_frame(kind: str, rng: np.random.Generator) -> Matrices:
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


def simulate_test(
    kind: str, frame: Matrices, records: list[Path], rng: np.random.Generator
) -> tuple[Outcome, np.ndarray]:
    """Test of another structure than stated, whose true error lies between the limits; its ground motion."""
    f, ratio = (1.0, 1.0) if kind == "yields, by its force" else 1.0 + rng.standard_normal(2) * [0.02, 0.15]
    k = frame.specimen[0] * f**2
    tested_frame = replace(
        frame,
        stiffness=frame.stiffness * f**2,
        damping=frame.damping * f * max(ratio, 0.3),
        specimen=(k, 0.0, 0.0),
    )
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        size = 2 if kind == "two actuators" else 1
        gain, corner = 1.0 + 0.02 * rng.standard_normal(size), 1.4 / (0.016 * rng.uniform(0.05, 1.0, size))
        if kind.startswith("yields"):
            outcome = run_yielding(
                tested_frame, float(gain[0]), float(corner[0]), ground, 1.0 / RATE, rng.uniform(1.5, 3.0)
            )
        else:
            outcome = run(tested_frame, gain, corner, ground, 1.0 / RATE)
        if outcome is not None and all(SMALLEST < error < LARGEST for error in interface_errors(outcome)):
            return outcome, ground


def interface_errors(outcome: Outcome) -> list[float]:
    """RMS^R of the measured interface displacements."""
    ideal = np.atleast_2d(outcome.interface.T @ outcome.ideal)
    return [outcome.error_of(*pair) for pair in zip(np.atleast_2d(outcome.measured), ideal, strict=True)]


def noisy(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Add the noise of a sensor."""
    level = 10.0 ** (-DECIBELS / 20.0) * values.std(axis=-1, keepdims=True)
    return values + level * rng.standard_normal(values.shape)


def judge_test(kind: str, seed: int, records: list[Path]) -> dict[str, object]:
    """Simulate a test and judge it."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    matrices = draw_frame(kind, rng)
    outcome, ground = simulate_test(kind, matrices, records, rng)
    has_force, has_two_actuators = kind == "yields, by its force", kind == "two actuators"
    read = np.atleast_2d(outcome.measured)
    read = noisy(read if has_force else read_by_chance(read, rng, RATE), rng)
    k, gamma = matrices.specimen[0], matrices.interface.reshape(3, -1)
    size = gamma.shape[1]
    partition = Partition(
        mass=matrices.mass,
        damping=matrices.damping,
        stiffness=matrices.stiffness,
        interface=gamma,
        influence=matrices.influence,
        specimen_stiffness=k * np.eye(size),
        names=NAMES[:size],
        degrees_of_freedom=NAMES,
    )
    if has_two_actuators:
        frame = FrameUnderTest(name=kind, partition=partition, has_several=True)
        recording = Recording(command=outcome.command, measured=read, time_step=1.0 / RATE, ground=ground)
        assessment = assess(recording, frame, equipment=ordinary_equipment())
        sizes, responses = [degree.rms for degree in assessment.error.displacements], assessment.responses
    else:
        assessment = assess(
            Recording(
                command=outcome.command,
                measured=read[0],
                time_step=1.0 / RATE,
                ground=ground,
                force=noisy(outcome.force, rng) if has_force else None,
            ),
            FrameUnderTest(name=kind, partition=partition, output=None, error_of="interface"),
            equipment=ordinary_equipment(),
            measured_specimen=has_force,
        )
        sizes, responses = [assessment.error.rebuilt.rms], assessment.responses
    true, relative_errors = true_errors(outcome), responses.each if responses.over_peaks else ()
    storeys = {name: error for name, error in true.items() if name.startswith("storey")}
    return {
        "kind": kind,
        "held": np.mean(
            [
                size.low <= error <= size.high
                for size, error in zip(sizes, interface_errors(outcome), strict=True)
            ]
        ),
        "responses": [size.rms.low <= true[size.name] <= size.rms.high for size in relative_errors],
        "ratio": [size.rms.value / true[size.name] for size in relative_errors],
        "width": [(size.rms.high - size.rms.low) / true[size.name] for size in relative_errors],
        "in_millimetres": not responses.over_peaks,
        "governs": responses.governing_storey.name == max(storeys, key=storeys.get),
    }


def main() -> None:
    parser = argument_parser(__doc__, "folder", seed=int, count=10)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    options = parser.parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    for kind in options.kinds:
        tests = pd.DataFrame(
            judge_test(kind, seed, records) for seed in range(options.seed, options.seed + options.count)
        )
        shares, ratio, width = (np.concatenate(tests[name]) for name in ("responses", "ratio", "width"))
        low, middle, high = np.quantile(ratio, [0.05, 0.5, 0.95])
        print(
            f"{kind:21} {len(tests):3} tests: interface held {tests['held'].mean():.0%}, floors and "
            f"storeys {shares.mean():.0%} of {shares.size}, ratio {middle:.2f} ({low:.2f} to {high:.2f}), "
            f"width over true {np.median(width):.2f}, worst storey named in {tests['governs'].sum()}, "
            f"in millimetres alone {tests['in_millimetres'].sum()}",
            flush=True,
        )


if __name__ == "__main__":
    main()
