"""Processor time of a verdict: as a command, of its imports, of the first and of a later call in one process.

    python tests/benchmarks/verdict.py [--calls 5]

The test that ships (10,240 samples), then a simulated one of 40 s at 1024 Hz, without a force, with one, and
with one that alone says what the specimen is (`--specimen measured`). Of the later calls the shortest counts.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

RATE, SECONDS, MASS = 1024.0, 40.0, 1000.0
ONE_HERTZ = 2.0 * np.pi
IMPORTS = "import reliab.api.channels, reliab.api.channels, reliab.cli"
FIRST = "import reliab; reliab.assess('sample_test', f=1, xi=0.02)"


def write_test(path: Path) -> None:
    """Write a test of a specimen of 1 Hz, with an actuator that is 1 ms late and moves 1 % too little."""
    rng = np.random.default_rng(1)
    times = np.arange(0.0, SECONDS, 1.0 / RATE)

    def moved(instants: np.ndarray) -> np.ndarray:
        swing = np.sin(ONE_HERTZ * instants) + 0.5 * np.sin(0.9 * ONE_HERTZ * instants + 1.0)
        return np.asarray(0.01 * swing * np.sin(np.pi * instants / SECONDS) ** 2)

    command = moved(times)
    piston = 0.99 * moved(np.maximum(times - 1e-3, 0.0))
    measured = piston + 3e-5 * rng.standard_normal(times.size)
    force = MASS * ONE_HERTZ**2 * piston + rng.standard_normal(times.size)
    np.savetxt(
        path,
        np.column_stack([times, command, measured, force]),
        delimiter=",",
        header="time_s,command_m,measured_m,force_N",
        comments="",
    )


def of_process(*arguments: str) -> float:
    """Processor time [s] of a Python process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)  # noqa: S603
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def later(calls: int, test: object, **stated: object) -> float:
    """Shortest processor time [s] of calls after the first."""
    import reliab

    taken = []
    for _ in range(calls + 1):
        begun = time.process_time()
        reliab.assess(test, f=1, xi=0.02, **stated)
        taken.append(time.process_time() - begun)
    return min(taken[1:])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--calls", type=int, default=5, help="calls after the first")
    calls = parser.parse_args().calls
    command = ("-m", "reliab", "assess", "sample_test", "--f", "1", "--xi", "0.02")
    for label, arguments in (
        ("command", command),
        ("imports", ("-c", IMPORTS)),
        ("first call", ("-c", FIRST)),
    ):
        print(f"{label:40} {min(of_process(*arguments) for _ in range(calls)):6.2f} s", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "test.csv"
        write_test(path)
        print(f"{'later call, the test that ships':40} {later(calls, 'sample_test'):6.2f} s", flush=True)
        bare = Path(folder) / "bare.csv"
        rows = [line.rsplit(",", 1)[0] for line in path.read_text(encoding="utf-8").splitlines()]
        bare.write_text("\n".join(rows) + "\n", encoding="utf-8")
        cases = {
            "40 s at 1024 Hz": (bare, {}),
            "with a force": (path, {}),
            "the specimen known by its force": (path, {"specimen": "measured", "mass": MASS}),
        }
        for label, (file, stated) in cases.items():
            print(f"{label:40} {later(calls, file, **stated):6.2f} s", flush=True)


if __name__ == "__main__":
    main()
