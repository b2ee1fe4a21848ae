"""Verdicts on tests of frames whose matrices are not as stated, simulated by code of its own.

    python tests/benchmarks/uncertain_frames.py RECORDS --seed S --count N [--rows NAME …] [--rate 512]

The frames that ship, under the real records of RECORDS, with an actuator of second order that lags by up to
16 ms and has a gain 3 % off, simulated by `tests/assessment/frames_by_matrices.py`. True errors of the
interface lie between 1 and 12 %, the rate is 1024 Hz (`--rate` thins it), noise 45 dB below the displacement.
In the row "K +3 %" the stiffness of frame and specimen is 3 % higher than stated, and nobody says so: the
interval is that of ordinary equipment. In all others `[tolerances]` state by how much the matrices may be
off, and all else is exact. Counted are intervals that hold the true error of the interface and, with the
ground motion, those of every floor and storey.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratories importable
from benchmark_script import argument_parser
from blind_campaigns.scoring import wilson_interval
from frames_by_matrices import Matrices, Outcome, run
from laboratory_tests import DECIBELS, LARGEST, SMALLEST, THRESHOLD, score_verdict
from rebuilt_error.laboratory import read_at2

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.shipped import shipped
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest, read_frame

RATE, LONGEST = 1024.0, 30.0
LONGEST_LAG = 16e-3  # s
SHEAR = ("three_storeys",)
FRAMES = ("three_storeys", "benchmark_case_1")

Change = Callable[[Matrices, np.random.Generator], Matrices]


def stiffer(frame: Matrices, factor: float) -> Matrices:
    """Frame and specimen stiffer by a factor."""
    k, c, m = frame.specimen
    return replace(frame, stiffness=frame.stiffness * factor, specimen=(k * factor, c, m))


def draw_factors(size: int, deviation: float, rng: np.random.Generator) -> np.ndarray:
    """Positive factors about one."""
    return np.exp(deviation * rng.standard_normal(size))


def vary_modes(frame: Matrices, rng: np.random.Generator) -> Matrices:
    """Frequencies of the modes 2 %, their damping ratios 20 % off, each by itself."""
    return frame.with_modes(
        draw_factors(frame.influence.size, 0.02, rng), draw_factors(frame.influence.size, 0.2, rng)
    )


def vary_storeys(name: str, deviation: float) -> Change:
    """Storeys' springs or dashpots off, each by itself."""
    return lambda frame, rng: frame.with_storeys(name, draw_factors(frame.influence.size, deviation, rng))


def vary_floors(frame: Matrices, rng: np.random.Generator) -> Matrices:
    """Masses of the floors 5 % off, each by itself."""
    return replace(frame, mass=frame.mass * np.diag(draw_factors(frame.influence.size, 0.05, rng)))


def vary_storeys_together(frame: Matrices, rng: np.random.Generator) -> Matrices:
    """Storeys' springs 5 % off, half of whose variance they have in common."""
    common, independent = (
        draw_factors(1, 0.05 * np.sqrt(0.5), rng),
        draw_factors(frame.influence.size, 0.05 * np.sqrt(0.5), rng),
    )
    return frame.with_storeys("stiffness", common * independent)


def vary_entry(frame: Matrices, rng: np.random.Generator) -> Matrices:
    """Stiffness between the first two floors 5 % off, in its entry and the opposite one alone."""
    factors = np.ones_like(frame.stiffness)
    factors[[0, 1], [1, 0]] = draw_factors(1, 0.05, rng)
    return replace(frame, stiffness=frame.stiffness * factors)


ROWS: dict[str, tuple[Change, dict[str, object] | None]] = {
    "K +3 %, not stated": (lambda frame, _: stiffer(frame, 1.03), None),
    "K 3 %": (lambda frame, rng: stiffer(frame, draw_factors(1, 0.03, rng)[0]), {"stiffness": 0.03}),
    "M 3 %": (
        lambda frame, rng: replace(frame, mass=frame.mass * draw_factors(1, 0.03, rng)),
        {"mass": 0.03},
    ),
    "C 20 %": (
        lambda frame, rng: replace(frame, damping=frame.damping * draw_factors(1, 0.2, rng)),
        {"damping": 0.2},
    ),
    "specimen 5 %": (
        lambda frame, rng: frame.with_specimen(draw_factors(1, 0.05, rng)[0]),
        {"specimen_stiffness": 0.05, "specimen_changes_structure": True},
    ),
    "modes 2 and 20 %": (vary_modes, {"mode_frequencies": 0.02, "mode_damping_ratios": 0.2}),
    "storeys' springs 5 %": (vary_storeys("stiffness", 0.05), {"storey_stiffnesses": 0.05}),
    "half in common": (vary_storeys_together, {"storey_stiffnesses": 0.05, "storey_correlation": 0.5}),
    "floors' masses 5 %": (vary_floors, {"floor_masses": 0.05}),
    "storeys' dashpots 30 %": (vary_storeys("damping", 0.3), {"storey_dampings": 0.3}),
    "entry of storeys 5 %": (
        vary_entry,
        {"entries": [{"matrix": "stiffness", "places": [["1", "2"]], "deviation": 0.05}]},
    ),
}


def frame_of(name: str, *, dashpots: bool) -> FrameUnderTest:
    """Read a frame that ships, with the interface's error; of dashpots in its storeys where asked for."""
    frame = read_frame(shipped("datasets", f"frames/{name}.toml"))
    if dashpots:
        structure = frame.partition.frame
        omega = 2.0 * np.pi * float(structure.modes.frequency[0])
        damping = 2.0 * 0.02 / omega * structure.stiffness
        frame = replace(frame, partition=replace(frame.partition, damping=damping))
    return replace(frame, output=None, tolerances=type(frame.tolerances)())


def matrices(frame: FrameUnderTest) -> Matrices:
    """Matrices of a frame as stated."""
    structure, specimen = frame.partition.frame, frame.partition.specimen
    return Matrices(
        mass=np.array(structure.mass),
        damping=np.array(structure.damping),
        stiffness=np.array(structure.stiffness),
        interface=frame.partition.direction,
        influence=np.array(structure.influence),
        specimen=(specimen.stiffness, specimen.damping, specimen.mass),
    )


def simulate_test(
    frame: Matrices, records: list[Path], rng: np.random.Generator
) -> tuple[Outcome, np.ndarray]:
    """Test whose true error lies between the limits, with its ground motion."""
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        lag = LONGEST_LAG * np.exp(rng.uniform(np.log(0.02), 0.0))
        outcome = run(frame, 1.0 + 0.03 * rng.standard_normal(), 1.4 / lag, ground, 1.0 / RATE)
        if outcome is not None and SMALLEST < outcome.rms < LARGEST:
            return outcome, ground


def judge_test(row: str, name: str, seed: int, records: list[Path], rate: float = RATE) -> dict[str, object]:
    """Simulate a test and judge it as it was recorded at a rate [Hz]."""
    change, tolerances_stated = ROWS[row]
    frame = frame_of(name, dashpots="dashpots" in row)
    rng = np.random.default_rng([seed, list(ROWS).index(row), FRAMES.index(name)])
    outcome, ground = simulate_test(change(matrices(frame), rng), records, rng)
    read = outcome.measured + 10.0 ** (-DECIBELS / 20.0) * outcome.measured.std() * rng.standard_normal(
        outcome.measured.size
    )
    partition = frame.partition
    tolerances = type(frame.tolerances)(**(tolerances_stated or {})).check_structure(
        partition.degrees_of_freedom, partition.mass, partition.damping, partition.stiffness
    )
    thinning = slice(None, None, round(RATE / rate))
    assessment = assess(
        Recording(
            command=outcome.command[thinning], measured=read[thinning], time_step=1.0 / rate, name=name
        ),
        replace(frame, tolerances=tolerances),
        equipment=ordinary_equipment() if tolerances_stated is None else None,
        motion=Motion(name=name, acceleration=ground, time_step=1.0 / RATE),
    )
    response_errors = true_errors(outcome)
    covers = [
        response.rms.low <= response_errors[response.name] <= response.rms.high
        for response in assessment.responses.each
    ]
    storeys = {key: value for key, value in response_errors.items() if key.startswith("storey")}
    return {
        "row": row,
        "frame": name,
        **score_verdict(assessment.error.rebuilt.rms, outcome.rms, str(assessment.verdict)),
        "responses_held": np.mean(covers),
        "governs": assessment.responses.governing_storey.name == max(storeys, key=storeys.get),
    }


def true_errors(outcome: Outcome) -> dict[str, float]:
    """RMS^R of floors and storeys, by the names of the product."""
    first = np.zeros((1, outcome.ideal.shape[1]))
    drifts, exact_drifts = (np.diff(rows, axis=0, prepend=first) for rows in (outcome.floors, outcome.ideal))
    return {
        f"{kind} {place + 1}": outcome.error_of(history, ideal)
        for kind, rows, exact in (("floor", outcome.floors, outcome.ideal), ("storey", drifts, exact_drifts))
        for place, (history, ideal) in enumerate(zip(rows, exact, strict=True))
    }


def main() -> None:
    parser = argument_parser(__doc__, "folder", seed=int, count=20, rate=RATE)
    parser.add_argument("--rows", nargs="+", choices=list(ROWS), default=list(ROWS))
    options = parser.parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    for row in options.rows:
        frames = SHEAR if "storeys" in row or "common" in row else FRAMES
        seeds = range(options.seed, options.seed + options.count)
        rows = pd.DataFrame(
            [judge_test(row, name, seed, records, options.rate) for name in frames for seed in seeds]
        )
        low, middle, high = rows["ratio"].quantile([0.05, 0.5, 0.95])
        ends = wilson_interval(int(rows["held"].sum()), len(rows))
        bad = int((rows["true"] > THRESHOLD).sum())
        print(
            f"{row:24} {len(rows):3} tests ({bad} bad), ratio {middle:.2f} ({low:.2f} to {high:.2f}), held "
            f"{rows['held'].mean():.0%} ({ends[0]:.0%} to {ends[1]:.0%}), width over true "
            f"{rows['width'].median():.2f}, bad accepted {rows['bad_accepted'].sum()}, good refused "
            f"{rows['good_refused'].sum()}, undecided {rows['undecided'].mean():.0%}; floors and storeys "
            f"held {rows['responses_held'].mean():.0%}, the governing storey named in "
            f"{rows['governs'].mean():.0%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
