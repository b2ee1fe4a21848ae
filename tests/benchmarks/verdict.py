"""Processor time of a verdict, and what passes on the clock: as a command, of its imports, of calls.

    python tests/benchmarks/verdict.py [--calls 5] [--before FOLDER]

The test that ships (10,240 samples), then a simulated one of 40 s at 1024 Hz, without a force, with one, with
one and the mass, and with one that alone says what the specimen is (`--specimen measured`); six tests with
a force as one command; later calls of a process; the reading of the file alone. The shortest of the calls
counts. With a checkout of before in FOLDER, processes run in turns with it, and ratios of medians follow.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from benchmark_script import argument_parser, shortest_time

from reliab.recordings.reading import read_recording

RATE, SECONDS, MASS = 1024.0, 40.0, 1000.0
ONE_HERTZ = 2.0 * np.pi
ROOT = Path(__file__).resolve().parents[2]
IMPORTS = "import reliab.app.api.assessment, reliab.app.api.arguments, reliab.app.cli.assess"
FIRST = "import reliab; reliab.assess('sample_test', f=1, xi=0.02)"
LATER = """
import time, reliab
for _ in range({calls} + 1):
    begun, passed = time.process_time(), time.perf_counter()
    reliab.assess({test!r}, f="1±0.01", xi=0.02, **{stated})
    print(time.process_time() - begun, time.perf_counter() - passed)
"""
STRUCTURE = ("--f", "1±0.01", "--xi", "0.02")


def write_test(path: Path, seed: int = 1) -> None:
    """Write a test of a specimen of 1 Hz, with an actuator that is 1 ms late and moves 1 % too little."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, SECONDS, 1.0 / RATE)

    def displacement_at(instants: np.ndarray) -> np.ndarray:
        swing = np.sin(ONE_HERTZ * instants) + 0.5 * np.sin(0.9 * ONE_HERTZ * instants + 1.0)
        return np.asarray(0.01 * swing * np.sin(np.pi * instants / SECONDS) ** 2)

    command = displacement_at(times)
    piston = 0.99 * displacement_at(np.maximum(times - 1e-3, 0.0))
    measured = piston + 3e-5 * rng.standard_normal(times.size)
    force = MASS * ONE_HERTZ**2 * piston + rng.standard_normal(times.size)
    np.savetxt(
        path,
        np.column_stack([times, command, measured, force]),
        delimiter=",",
        header="time_s,command_m,measured_m,force_N",
        comments="",
    )


def run_python(tree: Path, *arguments: str) -> str:
    """Run Python with the package of a checkout; return what it prints."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPATH": str(tree)}
    return subprocess.run(  # noqa: S603
        [sys.executable, *arguments], cwd=tree, env=environment, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


def measure_process(tree: Path, *arguments: str) -> tuple[float, float]:
    """Processor time and time on the clock [s] of a Python process with the package of a checkout."""
    start, clock_start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run_python(tree, *arguments)
    clock_time, end = time.perf_counter() - clock_start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime, clock_time


def measure_later_calls(
    tree: Path, calls: int, test: Path | str, options: dict[str, object]
) -> tuple[float, float]:
    """Shortest processor time and time on the clock [s] of verdicts after the first in a process."""
    lines = run_python(tree, "-c", LATER.format(calls=calls, test=str(test), stated=options)).splitlines()
    spent, clock_time = np.array([line.split() for line in lines[1:]], dtype=float).min(axis=0).tolist()
    return spent, clock_time


def compare(
    label: str, calls: int, measure: Callable[[Path], tuple[float, float]], trees: list[Path]
) -> None:
    """Print shortest times; beside a checkout of before the ratio of medians, in turns."""
    rounds = [[measure(tree) for tree in trees] for _ in range(calls + 1)][1:]
    times = np.array(rounds)  # shape (calls, trees, 2)
    spent, clock_time = times[:, 0].min(axis=0)
    ratio = ""
    if len(trees) > 1:
        now, former = np.median(times, axis=0)
        ratio = (
            f"  {now[0] / former[0]:.2f} of the processor time before, {now[1] / former[1]:.2f} on the clock"
        )
    print(f"{label:40} {spent:6.2f} s, {clock_time:6.2f} s on the clock{ratio}", flush=True)


def main() -> None:
    parser = argument_parser(__doc__)
    parser.add_argument("--calls", type=int, default=5, help="calls after the first")
    parser.add_argument("--before", type=Path, help="checkout with which commands are run in turns")
    options = parser.parse_args()
    calls, trees = options.calls, [ROOT, *([options.before.resolve()] if options.before else [])]
    with tempfile.TemporaryDirectory() as folder:
        path, bare = Path(folder) / "test.csv", Path(folder) / "bare.csv"
        write_test(path)
        rows = [line.rsplit(",", 1)[0] for line in path.read_text(encoding="utf-8").splitlines()]
        bare.write_text("\n".join(rows) + "\n", encoding="utf-8")
        six = [str(Path(folder) / f"test_{number}.csv") for number in range(6)]
        for number, name in enumerate(six):
            write_test(Path(name), seed=number)
        command = ("-m", "reliab", "assess")
        for label, arguments in {
            "command": (*command, "sample_test", *STRUCTURE),
            "imports": ("-c", IMPORTS),
            "first call": ("-c", FIRST),
            "command, 40 s at 1024 Hz": (*command, str(bare), *STRUCTURE),
            "command, with a force and the mass": (*command, str(path), *STRUCTURE, "--mass", str(MASS)),
            "command, six tests with a force": (*command, *six, *STRUCTURE, "--mass", str(MASS)),
        }.items():
            compare(label, calls, lambda tree, options=arguments: measure_process(tree, *options), trees)
        reading = shortest_time(lambda: read_recording(path), calls)[1]
        print(f"{'reading of 40 s at 1024 Hz':40} {reading:6.2f} s")
        cases: dict[str, tuple[Path | str, dict[str, object]]] = {
            "later call, the test that ships": ("sample_test", {}),
            "40 s at 1024 Hz": (bare, {}),
            "with a force": (path, {}),
            "with a force and the mass": (path, {"mass": MASS}),
            "the specimen known by its force": (path, {"specimen": "measured", "mass": MASS}),
        }
        for label, case in cases.items():
            compare(label, calls, lambda tree, case=case: measure_later_calls(tree, calls, *case), trees)


if __name__ == "__main__":
    main()
