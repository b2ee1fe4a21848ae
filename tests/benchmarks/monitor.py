"""Alarms of a running test: how often they are false, and how early a loop that diverges is caught.

python tests/benchmarks/monitor.py [stable tests of a kind] [seed] [--motions FOLDER] [--skew] [--rest S]

The package's own loop runs tests of every kind under synthetic ground motions (or those of a folder), with
white noise on the sensor; `Monitor` follows them in steps of half a second, as `reliab monitor` does. With
`--skew` the measured channel is recorded up to half a sample early or late, which the monitor is told; with
`--rest` the recording begins before the motion. A false
alarm of the energy is one in a loop that is stable in large motions; a false alarm of the error one in a test
whose error at the end, by the exact response, is below the threshold.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
from benchmark_script import argument_parser

from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.monitor import Monitor
from reliab.effects.effect import Effect
from reliab.effects.registry import find_effect
from reliab.motions.loading import load_motions
from reliab.motions.motion import resample
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure

RATE = 256.0
LOOK = 128  # samples between two looks
THRESHOLD = 0.05
LARGE = 2.0  # times the exact peak before which a diverging loop should be caught
SKEW = 0.29  # standard deviation of one within half a sample [samples]
SWITCH_OFF = 3.0  # times the exact peak at which a rig switches off
STABLE = ("gain and delay", "backlash", "backlash and delay", "series play", "lag", "second order", "offset")
DIVERGING = ("delay", "delay and backlash", "lag")


@dataclass(frozen=True, kw_only=True)
class Case:
    """One simulated test."""

    kind: str
    diverges: bool
    structure: Structure
    command: np.ndarray
    measured: np.ndarray
    ideal: np.ndarray
    facts: dict[str, float] = field(default_factory=dict)


def effect(name: str, **parameters: float) -> Effect:
    return find_effect(name)(**parameters)


def rig(kind: str, structure: Structure, peak: float, share: float, rng: np.random.Generator) -> dict:
    """Actuator and effects; `share` of the delay that uses the damping up."""
    w0 = 2.0 * np.pi * structure.frequency
    late = share * 2.0 * structure.damping_ratio / (structure.experimental_fraction * w0)
    gain = 1.0 + structure.damping_ratio * rng.uniform(-0.3, 0.3)
    width = peak * np.exp(rng.uniform(np.log(0.002), np.log(0.05)))
    plain = {"actuator": Actuator(gain=gain, delay=late)}
    if kind in ("gain and delay", "delay", "offset"):
        return plain
    if kind == "backlash":
        return {"actuator": Actuator(gain=gain), "effects": (effect("backlash", width_m=width),)}
    if kind in ("backlash and delay", "delay and backlash"):
        return plain | {"effects": (effect("backlash", width_m=width),)}
    if kind == "series play":
        return plain | {"effects": (effect("series_play", width_m=width),)}
    if kind == "lag":
        return {
            "actuator": Actuator(gain=gain),
            "effects": (effect("first_order_lag", time_constant_s=late),),
        }
    natural = 2.0 / max(late * 2.0 * np.pi, 1e-4)  # a second-order system with ζ = 1 is late by 2/ω
    return {
        "actuator": Actuator(gain=gain),
        "effects": (effect("second_order_dynamics", natural_frequency_hz=natural, damping_ratio=1.0),),
    }


def cases(suite: MotionSuite, count: int, seed: int, diverging: int | None = None) -> Iterator[Case]:
    """Tests of every kind, so many of each; `diverging`: of each kind that diverges, where it differs."""
    motions = list(suite)
    kinds = [(kind, False) for kind in STABLE] + [(kind, True) for kind in DIVERGING]
    for k, (kind, diverges) in enumerate(kinds):
        count_of_kind, target = 0, diverging if diverges and diverging is not None else count
        for number in range(3 * target):
            rng = np.random.default_rng((seed, k, number))
            motion = resample(motions[int(rng.integers(len(motions)))], RATE)
            structure = Structure(
                frequency=float(np.exp(rng.uniform(np.log(0.4), np.log(4.0)))),
                damping_ratio=float(rng.uniform(0.01, 0.06)),
                experimental_fraction=float(rng.choice([1.0, rng.uniform(0.3, 1.0)])),
            )
            ideal = run_closed_loop(HybridTest(structure=structure), motion.acceleration, 1.0 / RATE).command
            ideal = ideal.values[0]
            peak = float(np.abs(ideal).max())
            share = rng.uniform(1.1, 3.0) if diverges else np.exp(rng.uniform(np.log(0.005), np.log(0.9)))
            test = HybridTest(structure=structure, **rig(kind, structure, peak, share, rng))
            with np.errstate(over="ignore", invalid="ignore"):
                histories = run_closed_loop(test, motion.acceleration, 1.0 / RATE)
            command, measured = histories.command.values[0], histories.measured.copy()
            if kind == "offset":
                measured += rng.uniform(-0.1, 0.1) * peak
            level = peak * np.exp(rng.uniform(np.log(1e-4), np.log(3e-3)))
            large = ~(np.abs(command) < SWITCH_OFF * peak)
            if diverges and not large.any():
                continue
            end = int(np.argmax(large)) if diverges else command.size
            noise = level * rng.standard_normal(end)
            count_of_kind += 1
            yield Case(
                kind=kind,
                diverges=diverges,
                structure=structure,
                command=command[:end],
                measured=measured[:end] + noise,
                ideal=ideal[:end],
                facts={"share": share, "peak": peak, "offset": kind == "offset", "level": level},
            )
            if count_of_kind == target:
                break


def add_faults(case: Case, rng: np.random.Generator, *, skew: bool, rest_duration: float) -> Case:
    """Record the measured displacement early or late, and a rest [s] before the motion."""
    size, rest_samples = case.command.size, round(rest_duration * RATE)
    late = rng.uniform(-0.5, 0.5) if skew else 0.0
    measured = np.interp(np.arange(size) - late, np.arange(size), case.measured)
    noise = case.facts["level"] * rng.standard_normal(rest_samples)
    still = np.zeros(rest_samples)
    return replace(
        case,
        command=np.concatenate([still, case.command]),
        measured=np.concatenate([measured[0] + noise, measured]),
        ideal=np.concatenate([still, case.ideal]),
    )


def judge_case(case: Case, *, skew: bool) -> dict[str, object]:
    """Alarms of one test with their times [s]."""
    tolerances = PriorKnowledge(tolerances={"time_shift": SKEW / RATE if skew else 0.0})
    monitor = Monitor(case.structure, 1.0 / RATE, known=tolerances)
    energy = error = None
    for begin in range(0, case.command.size, LOOK):
        stretch = slice(begin, begin + LOOK)
        monitor.feed(case.command[stretch], case.measured[stretch])
        if monitor.due:
            monitor.ask()
        energy = monitor.gains_energy_since
        if error is None and monitor.exceeds(THRESHOLD):
            error = monitor.now.time
    peak = case.facts["peak"]
    error_history = case.measured - case.ideal
    error_history = error_history - (np.mean(error_history[:20]) if case.facts["offset"] else 0.0)
    large = np.abs(case.command) > LARGE * peak
    return {
        "kind": case.kind,
        "diverges": case.diverges,
        "share": case.facts["share"],
        "f": case.structure.frequency,
        "seconds": case.command.size / RATE,
        "rms": float(np.sqrt(np.mean(error_history**2)) / peak),
        "final": monitor.ask().rms.value,
        "energy": energy,
        "error": error,
        "doubled": float(np.argmax(large)) / RATE if large.any() else None,
    }


def main() -> None:
    parser = argument_parser(__doc__, motions=Path, out=Path, skew=False, rest=0.0)
    parser.add_argument("count", nargs="?", type=int, default=12)
    parser.add_argument("seed", nargs="?", type=int, default=1)
    options = parser.parse_args()
    suite = load_motions(options.motions) if options.motions else synthetic_suite(count=40, seed=options.seed)
    rng = np.random.default_rng((options.seed, 1))
    table = pd.DataFrame(
        [
            judge_case(
                add_faults(case, rng, skew=options.skew, rest_duration=options.rest), skew=options.skew
            )
            for case in cases(suite, options.count, options.seed)
        ]
    )
    if options.out:
        table.to_csv(options.out, index=False)
    stable, diverging = table[~table.diverges], table[table.diverges]
    good = stable[stable.rms < THRESHOLD]
    bad = table[table.rms > THRESHOLD]
    for name, part in stable.groupby("kind"):
        print(f"{name:20} {len(part):4} stable, {part.energy.notna().sum():3} false alarms of the energy")
    for name, part in diverging.groupby("kind"):
        is_early = part.energy.notna() & (part.energy <= part.doubled.fillna(np.inf))
        margin = (part.doubled - part.energy).median()
        print(
            f"{name:20} {len(part):4} diverge, {part.energy.isna().sum():3} missed, {is_early.sum():3} "
            f"caught before twice the exact peak, half of them {margin:.1f} s or more"
        )
    print(f"error, good tests: {len(good)}, false alarms {good.error.notna().sum()}")
    print(f"error, bad tests: {len(bad)}, with an alarm {bad.error.notna().sum()}")
    false_refusals, bad_accepted = (good.final > THRESHOLD).sum(), (bad.final < THRESHOLD).sum()
    print(f"at the end: {false_refusals} good ones refused, {bad_accepted} bad ones accepted")


if __name__ == "__main__":
    main()
