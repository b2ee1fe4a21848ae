"""Alarms of Python's monitor on tests with several actuators: false ones, and loops that diverge.

    python tests/benchmarks/monitor_of_several.py COUNT SEED [--table FILE.csv]

COUNT stable and as many diverging tests of frames of three to five storeys with two or three actuators (those
of `in_loop_alarms.py`), and COUNT tests of the multi-axial benchmark with an uncertain plant and each
controller in turn, all under synthetic motions. No delay makes the benchmark diverge: its specimen has 6 % of
the stiffness of the lowest mode, whose damping is larger than half of that. A loop that diverges is cut off
at three times the exact peak of any displacement. An alarm is in time when it is raised before one passes
twice its peak.
"""

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pandas as pd
from benchmark_script import argument_parser
from in_loop_alarms import RATE, THRESHOLD, LoopCase, end_at_switch_off, frame_case

from reliab.assessment.monitor import Monitor
from reliab.motions.motion import Motion, resample
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.study.description import PACKAGE

controllers, loop, plants, outcomes, structure = (
    import_module(f"{PACKAGE}.marths_benchmark.{name}")
    for name in ("controllers", "loop", "plant", "outcomes", "structure")
)
RATE_OF_BENCHMARK = structure.RATE
LONGEST = 40.0  # s of the benchmark
LOOK = 0.5  # s between two looks


def benchmark_case(number: int, diverges: bool, motion: Motion, rng: np.random.Generator) -> LoopCase | None:  # noqa: FBT001
    ground = resample(motion, RATE_OF_BENCHMARK).acceleration[: round(LONGEST * RATE_OF_BENCHMARK)]
    ground = np.ascontiguousarray(structure.SCALE * ground)
    plant = plants.draw_plants(1, int(rng.integers(1 << 31)))[0]
    name = controllers.CONTROLLERS[number % len(controllers.CONTROLLERS)]
    run = loop.run_test(ground, plant, controllers.find_controller(name), seed=number)
    ideal = structure.to_node(loop.run_perfect(ground).target)
    return end_at_switch_off(
        LoopCase(
            kind="multi-axial benchmark",
            diverges=diverges,
            monitor=Monitor(structure.benchmark_partition(), 1.0 / RATE_OF_BENCHMARK),
            command=structure.to_node(run.target),
            measured=structure.to_node(run.measured),
            ideal=ideal,
        )
    )


def frame_test(number: int, diverges: bool, motion: Motion, rng: np.random.Generator) -> LoopCase | None:  # noqa: ARG001, FBT001
    case = frame_case("several actuators", diverges, motion, rng)
    monitor = case and Monitor(case.monitor.linear, 1.0 / RATE)
    return case and replace(case, kind="frame", monitor=monitor)


def tests(count: int, seed: int) -> Iterator[tuple[str, LoopCase]]:
    """Yield tests with their names, one that was drawn in vain after the other."""
    suite = list(synthetic_suite(count=40, seed=seed))
    for place, (make, diverges) in enumerate(
        ((frame_test, False), (frame_test, True), (benchmark_case, False))
    ):
        tests_of_kind, number = 0, 0
        while tests_of_kind < count:
            rng = np.random.default_rng((seed, place, number))
            test = make(number, diverges, suite[int(rng.integers(len(suite)))], rng)
            number += 1
            if test is not None:
                tests_of_kind += 1
                yield f"{place} {number}", test


def judge_test(test: LoopCase) -> dict[str, object]:
    """Alarms of a test with their times [s], and what is true of it."""
    monitor, step = test.monitor, test.monitor.time_step
    size, error = round(LOOK / step), None
    for begin in range(0, test.command.shape[1], size):
        stretch = slice(begin, begin + size)
        monitor.feed(test.command[:, stretch], test.measured[:, stretch])
        if monitor.due:
            monitor.ask()
        if error is None and monitor.exceeds(THRESHOLD):
            error = monitor.now.time
    return {
        "kind": test.kind,
        "diverges": test.diverges,
        "energy": monitor.gains_energy_since,
        "error": error,
        "doubled": test.time_of_doubling,
        "rms": test.rms,
    }


def say(table: pd.DataFrame) -> None:
    for (kind, diverges), part in table.groupby(["kind", "diverges"]):
        if diverges:
            unstable = part[part["doubled"].notna()]
            first = unstable[["energy", "error"]].astype(float).min(axis=1)
            early = (first < unstable["doubled"].astype(float)).sum()
            print(
                f"{kind}: {len(unstable)} that diverge, {early} in time, {int(first.isna().sum())} not at all"
            )
            continue
        good, bad = part[part["rms"] < THRESHOLD], part[part["rms"] > 2.0 * THRESHOLD]
        print(
            f"{kind}: {len(part)} stable, {part['energy'].notna().sum()} false alarms of the energy; of "
            f"{len(good)} below the threshold {good['error'].notna().sum()} false alarms of the error; "
            f"of {len(bad)} above twice of it {bad['error'].notna().sum()} with the alarm"
        )


def main() -> None:
    parser = argument_parser(__doc__, table=Path)
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int)
    options = parser.parse_args()
    table = (
        pd.read_csv(options.table) if options.table is not None and options.table.exists() else pd.DataFrame()
    )
    rows = table.to_dict("records")
    names = {row["name"] for row in rows}
    for name, test in tests(options.count, options.seed):
        if name not in names:
            rows.append({"name": name, **judge_test(test)})
            if options.table is not None:
                pd.DataFrame(rows).to_csv(options.table, index=False)
    say(pd.DataFrame(rows))


if __name__ == "__main__":
    main()
