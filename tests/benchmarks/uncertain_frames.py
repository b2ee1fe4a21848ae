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

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from assessment.frames_by_matrices import Matrices, Outcome, run  # noqa: E402
from assessment.rebuilt_error.laboratory import read_at2  # noqa: E402
from blind_campaigns.scoring import wilson_interval  # noqa: E402

from reliab.assessment.assess import assess  # noqa: E402
from reliab.assessment.budget.sizes import ordinary_equipment  # noqa: E402
from reliab.core.shipped import shipped  # noqa: E402
from reliab.motions.motion import Motion  # noqa: E402
from reliab.recordings.recording import Recording  # noqa: E402
from reliab.simulation.frames.frame_file import FrameUnderTest, read_frame  # noqa: E402

RATE, LONGEST = 1024.0, 30.0
THRESHOLD, SMALLEST, LARGEST = 0.05, 0.01, 0.12
LONGEST_LAG, DECIBELS = 16e-3, 45.0
SHEAR = ("three_storeys",)
FRAMES = ("three_storeys", "benchmark_case_1")

Change = Callable[[Matrices, np.random.Generator], Matrices]


def stiffer(of: Matrices, factor: float) -> Matrices:
    """Frame and specimen stiffer by a factor."""
    k, c, m = of.specimen
    return replace(of, stiffness=of.stiffness * factor, specimen=(k * factor, c, m))


def by_factors(size: int, deviation: float, rng: np.random.Generator) -> np.ndarray:
    """Positive factors about one."""
    return np.exp(deviation * rng.standard_normal(size))


def in_modes(of: Matrices, rng: np.random.Generator) -> Matrices:
    """Frequencies of the modes 2 %, their damping ratios 20 % off, each by itself."""
    return of.with_modes(by_factors(of.influence.size, 0.02, rng), by_factors(of.influence.size, 0.2, rng))


def in_storeys(name: str, deviation: float) -> Change:
    """Storeys' springs or dashpots off, each by itself."""
    return lambda of, rng: of.with_storeys(name, by_factors(of.influence.size, deviation, rng))


def in_floors(of: Matrices, rng: np.random.Generator) -> Matrices:
    """Masses of the floors 5 % off, each by itself."""
    return replace(of, mass=of.mass * np.diag(by_factors(of.influence.size, 0.05, rng)))


def together(of: Matrices, rng: np.random.Generator) -> Matrices:
    """Storeys' springs 5 % off, half of whose variance they have in common."""
    common, own = (
        by_factors(1, 0.05 * np.sqrt(0.5), rng),
        by_factors(of.influence.size, 0.05 * np.sqrt(0.5), rng),
    )
    return of.with_storeys("stiffness", common * own)


def in_entry(of: Matrices, rng: np.random.Generator) -> Matrices:
    """Stiffness between the first two floors 5 % off, in its entry and the opposite one alone."""
    factors = np.ones_like(of.stiffness)
    factors[[0, 1], [1, 0]] = by_factors(1, 0.05, rng)
    return replace(of, stiffness=of.stiffness * factors)


ROWS: dict[str, tuple[Change, dict[str, object] | None]] = {
    "K +3 %, not stated": (lambda of, _: stiffer(of, 1.03), None),
    "K 3 %": (lambda of, rng: stiffer(of, by_factors(1, 0.03, rng)[0]), {"stiffness": 0.03}),
    "M 3 %": (lambda of, rng: replace(of, mass=of.mass * by_factors(1, 0.03, rng)), {"mass": 0.03}),
    "C 20 %": (lambda of, rng: replace(of, damping=of.damping * by_factors(1, 0.2, rng)), {"damping": 0.2}),
    "specimen 5 %": (
        lambda of, rng: of.with_specimen(by_factors(1, 0.05, rng)[0]),
        {"specimen_stiffness": 0.05, "specimen_changes_structure": True},
    ),
    "modes 2 and 20 %": (in_modes, {"mode_frequencies": 0.02, "mode_damping_ratios": 0.2}),
    "storeys' springs 5 %": (in_storeys("stiffness", 0.05), {"storey_stiffnesses": 0.05}),
    "half in common": (together, {"storey_stiffnesses": 0.05, "storey_correlation": 0.5}),
    "floors' masses 5 %": (in_floors, {"floor_masses": 0.05}),
    "storeys' dashpots 30 %": (in_storeys("damping", 0.3), {"storey_dampings": 0.3}),
    "entry of storeys 5 %": (
        in_entry,
        {"entries": [{"matrix": "stiffness", "places": [["1", "2"]], "deviation": 0.05}]},
    ),
}


def frame_of(name: str, *, dashpots: bool) -> FrameUnderTest:
    """Read a frame that ships, with the interface's error; of dashpots in its storeys where asked for."""
    frame = read_frame(shipped("datasets", f"frames/{name}.toml"))
    if dashpots:
        whole = frame.partition.frame
        omega = 2.0 * np.pi * float(whole.modes.frequency[0])
        damping = 2.0 * 0.02 / omega * whole.stiffness
        frame = replace(frame, partition=replace(frame.partition, damping=damping))
    return replace(frame, output=None, tolerances=type(frame.tolerances)())


def matrices(frame: FrameUnderTest) -> Matrices:
    """Matrices of a frame as stated."""
    whole, specimen = frame.partition.frame, frame.partition.specimen
    return Matrices(
        mass=np.array(whole.mass),
        damping=np.array(whole.damping),
        stiffness=np.array(whole.stiffness),
        interface=frame.partition.direction,
        influence=np.array(whole.influence),
        specimen=(specimen.stiffness, specimen.damping, specimen.mass),
    )


def simulated(tested: Matrices, records: list[Path], rng: np.random.Generator) -> tuple[Outcome, np.ndarray]:
    """Test whose true error lies between the limits, with its ground motion."""
    while True:
        ground = read_at2(records[rng.integers(len(records))], RATE)[: int(LONGEST * RATE)]
        lag = LONGEST_LAG * np.exp(rng.uniform(np.log(0.02), 0.0))
        found = run(tested, 1.0 + 0.03 * rng.standard_normal(), 1.4 / lag, ground, 1.0 / RATE)
        if found is not None and SMALLEST < found.rms < LARGEST:
            return found, ground


def judged(row: str, name: str, seed: int, records: list[Path], rate: float = RATE) -> dict[str, object]:
    """Simulate a test and judge it as it was recorded at a rate [Hz]."""
    change, stated = ROWS[row]
    frame = frame_of(name, dashpots="dashpots" in row)
    rng = np.random.default_rng([seed, list(ROWS).index(row), FRAMES.index(name)])
    outcome, ground = simulated(change(matrices(frame), rng), records, rng)
    read = outcome.measured + 10.0 ** (-DECIBELS / 20.0) * outcome.measured.std() * rng.standard_normal(
        outcome.measured.size
    )
    whole = frame.partition
    tolerances = type(frame.tolerances)(**(stated or {})).check_structure(
        whole.degrees_of_freedom, whole.mass, whole.damping, whole.stiffness
    )
    thinned = slice(None, None, round(RATE / rate))
    found = assess(
        Recording(command=outcome.command[thinned], measured=read[thinned], time_step=1.0 / rate, name=name),
        replace(frame, tolerances=tolerances),
        equipment=ordinary_equipment() if stated is None else None,
        motion=Motion(name=name, acceleration=ground, time_step=1.0 / RATE),
    )
    of_responses = true_errors(outcome)
    held = [one.rms.low <= of_responses[one.name] <= one.rms.high for one in found.responses.each]
    storeys = {key: value for key, value in of_responses.items() if key.startswith("storey")}
    size, word = found.error.rebuilt.rms, str(found.verdict)
    true = outcome.rms
    return {
        "row": row,
        "frame": name,
        "true": true,
        "ratio": size.value / true,
        "held": size.low <= true <= size.high,
        "width": (size.high - size.low) / true,
        "bad_accepted": true > THRESHOLD and word == "reliable",
        "good_refused": true < THRESHOLD and word == "not_reliable",
        "undecided": word == "undecided",
        "responses_held": np.mean(held),
        "governs": found.responses.governing_storey.name == max(storeys, key=storeys.get),
    }


def true_errors(outcome: Outcome) -> dict[str, float]:
    """RMS^R of floors and storeys, by the names of the product."""
    first = np.zeros((1, outcome.ideal.shape[1]))
    drifts, of_ideal = (np.diff(rows, axis=0, prepend=first) for rows in (outcome.floors, outcome.ideal))
    return {
        f"{kind} {place + 1}": outcome.error_of(history, ideal)
        for kind, rows, exact in (("floor", outcome.floors, outcome.ideal), ("storey", drifts, of_ideal))
        for place, (history, ideal) in enumerate(zip(rows, exact, strict=True))
    }


def main() -> None:
    """Judge tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--rows", nargs="+", choices=list(ROWS), default=list(ROWS))
    parser.add_argument("--rate", type=float, default=RATE)
    asked = parser.parse_args()
    records = sorted(asked.folder.rglob("*.AT2"))
    for row in asked.rows:
        frames = SHEAR if "storeys" in row or "common" in row else FRAMES
        seeds = range(asked.seed, asked.seed + asked.count)
        of = pd.DataFrame([judged(row, name, seed, records, asked.rate) for name in frames for seed in seeds])
        low, middle, high = of["ratio"].quantile([0.05, 0.5, 0.95])
        ends = wilson_interval(int(of["held"].sum()), len(of))
        bad = int((of["true"] > THRESHOLD).sum())
        print(
            f"{row:24} {len(of):3} tests ({bad} bad), ratio {middle:.2f} ({low:.2f} to {high:.2f}), held "
            f"{of['held'].mean():.0%} ({ends[0]:.0%} to {ends[1]:.0%}), width over true "
            f"{of['width'].median():.2f}, bad accepted {of['bad_accepted'].sum()}, good refused "
            f"{of['good_refused'].sum()}, undecided {of['undecided'].mean():.0%}; floors and storeys held "
            f"{of['responses_held'].mean():.0%}, the governing storey named in {of['governs'].mean():.0%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
