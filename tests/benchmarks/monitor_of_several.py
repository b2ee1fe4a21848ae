"""Alarms of Python's monitor on tests with several actuators: false ones, and loops that diverge.

    python tests/benchmarks/monitor_of_several.py COUNT SEED [--table FILE.csv]

COUNT stable and as many diverging tests of frames of three to five storeys with two or three actuators (those
of `in_loop_alarms.py`), and COUNT tests of the multi-axial benchmark with an uncertain plant and each
controller in turn, all under synthetic motions. No delay makes the benchmark diverge: its specimen has 6 % of
the stiffness of the lowest mode, whose damping is larger than half of that. A loop that diverges is cut off
at three times the exact peak of any displacement. An alarm is in time when it is raised before one passes
twice its peak.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pandas as pd
from in_loop_alarms import LARGE, RATE, STOPPED, THRESHOLD, frame_case

from reliab.assessment.monitor import Monitor
from reliab.core.arrays import Array
from reliab.motions.motion import Motion, resample
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.study.folders import PACKAGE

controllers, loop, plants, outcomes, structure = (
    import_module(f"{PACKAGE}.marths_benchmark.{name}")
    for name in ("controllers", "loop", "plant", "outcomes", "structure")
)
RATE_OF_BENCHMARK = structure.RATE
LONGEST = 40.0  # s of the benchmark
LOOK = 0.5  # s between two looks


@dataclass(frozen=True, kw_only=True)
class Followed:
    """A test at the interface, and its monitor."""

    kind: str
    diverges: bool
    monitor: Monitor
    command: Array
    measured: Array
    ideal: Array
    peaks: Array


def of_benchmark(number: int, diverges: bool, motion: Motion, rng: np.random.Generator) -> Followed | None:  # noqa: FBT001
    ground = resample(motion, RATE_OF_BENCHMARK).acceleration[: round(LONGEST * RATE_OF_BENCHMARK)]
    ground = np.ascontiguousarray(structure.SCALE * ground)
    plant = plants.drawn_plants(1, int(rng.integers(1 << 31)))[0]
    name = controllers.CONTROLLERS[number % len(controllers.CONTROLLERS)]
    run = loop.run_test(ground, plant, controllers.find_controller(name), seed=number)
    ideal = structure.to_node(loop.run_perfect(ground).target)
    return cut(
        Followed(
            kind="multi-axial benchmark",
            diverges=diverges,
            monitor=Monitor(
                structure.benchmark_partition(),
                1.0 / RATE_OF_BENCHMARK,
                recursion=outcomes.own_recursion(),
            ),
            command=structure.to_node(run.target),
            measured=structure.to_node(run.measured),
            ideal=ideal,
            peaks=np.abs(ideal).max(axis=1),
        )
    )


def cut(test: Followed) -> Followed | None:
    """End a test where its rig switches off; None where it does not do what was drawn."""
    beyond = ~(np.abs(test.command) < STOPPED * test.peaks[:, np.newaxis]).all(axis=0)
    if beyond.any() != test.diverges:
        return None
    end = int(np.argmax(beyond)) if test.diverges else test.command.shape[1]
    return replace(
        test, command=test.command[:, :end], measured=test.measured[:, :end], ideal=test.ideal[:, :end]
    )


def of_frame(number: int, diverges: bool, motion: Motion, rng: np.random.Generator) -> Followed | None:  # noqa: ARG001, FBT001
    case = frame_case("several actuators", diverges, motion, rng)
    if case is None:
        return None
    return Followed(
        kind="frame",
        diverges=diverges,
        monitor=Monitor(case.monitor.linear, 1.0 / RATE),
        command=case.command,
        measured=case.measured,
        ideal=case.ideal,
        peaks=case.peaks,
    )


def tests(count: int, seed: int) -> Iterator[tuple[str, Followed]]:
    """Yield tests with their names, one that was drawn in vain after the other."""
    suite = list(synthetic_suite(count=40, seed=seed))
    for place, (make, diverges) in enumerate(((of_frame, False), (of_frame, True), (of_benchmark, False))):
        made, number = 0, 0
        while made < count:
            rng = np.random.default_rng((seed, place, number))
            test = make(number, diverges, suite[int(rng.integers(len(suite)))], rng)
            number += 1
            if test is not None:
                made += 1
                yield f"{place} {number}", test


def judged(test: Followed) -> dict[str, object]:
    """Alarms of a test with their times [s], and what is true of it."""
    monitor, step = test.monitor, test.monitor.time_step
    size, error = round(LOOK / step), None
    for begin in range(0, test.command.shape[1], size):
        until = slice(begin, begin + size)
        monitor.feed(test.command[:, until], test.measured[:, until])
        if monitor.due:
            monitor.ask()
        if error is None and monitor.exceeds(THRESHOLD):
            error = monitor.now.time
    large = (np.abs(test.command) > LARGE * test.peaks[:, np.newaxis]).any(axis=0)
    strayed = np.sqrt(np.mean((test.measured - test.ideal) ** 2, axis=1)) / test.peaks
    return {
        "kind": test.kind,
        "diverges": test.diverges,
        "energy": monitor.gains_energy_since,
        "error": error,
        "doubled": float(np.argmax(large)) * step if large.any() else None,
        "rms": float(strayed.max()),
    }


def say(table: pd.DataFrame) -> None:
    for (kind, diverges), part in table.groupby(["kind", "diverges"]):
        if diverges:
            passed = part[part["doubled"].notna()]
            first = passed[["energy", "error"]].astype(float).min(axis=1)
            in_time = (first < passed["doubled"].astype(float)).sum()
            print(
                f"{kind}: {len(passed)} that diverge, {in_time} in time, {int(first.isna().sum())} not at all"
            )
            continue
        good, bad = part[part["rms"] < THRESHOLD], part[part["rms"] > 2.0 * THRESHOLD]
        print(
            f"{kind}: {len(part)} stable, {part['energy'].notna().sum()} false alarms of the energy; of "
            f"{len(good)} below the threshold {good['error'].notna().sum()} false alarms of the error; "
            f"of {len(bad)} above twice of it {bad['error'].notna().sum()} with the alarm"
        )


def main() -> None:
    """Follow tests and print the alarms."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int)
    parser.add_argument("--table", type=Path)
    asked = parser.parse_args()
    known = pd.read_csv(asked.table) if asked.table is not None and asked.table.exists() else pd.DataFrame()
    rows = known.to_dict("records")
    names = {row["name"] for row in rows}
    for name, test in tests(asked.count, asked.seed):
        if name not in names:
            rows.append({"name": name, **judged(test)})
            if asked.table is not None:
                pd.DataFrame(rows).to_csv(asked.table, index=False)
    say(pd.DataFrame(rows))


if __name__ == "__main__":
    main()
