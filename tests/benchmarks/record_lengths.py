"""Processor time and memory of a verdict over length and sampling rate of a record.

    python tests/benchmarks/record_lengths.py

The test that ships, interpolated to a rate, repeated to a length and judged as a linear one.
"""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from reliab.core.shipped import shipped
from reliab.recordings.reading import read_recording

CASES = ((40, 256), (40, 1024), (40, 4096), (400, 1024))  # seconds and samples in a second
NOISE = 1e-5  # m


def write_test(path: Path, seconds: int, rate: int) -> None:
    """Write the shipped test at another rate, repeated."""
    test = read_recording(shipped("datasets", "sample_test/test.csv"))
    original = np.arange(test.command.size) * test.time_step
    times = np.arange(seconds * rate) / rate
    command, measured = (
        np.interp(times % original[-1], original, values) for values in (test.command, test.measured)
    )
    measured += NOISE * np.random.default_rng(1).standard_normal(times.size)
    columns = np.column_stack([times, command, measured])
    np.savetxt(path, columns, delimiter=",", header="time_s,command_m,measured_m", comments="", fmt="%.9g")


def main() -> None:
    with TemporaryDirectory() as folder:
        for seconds, rate in CASES:
            path = Path(folder) / "test.csv"
            write_test(path, seconds, rate)
            options = ("--f", "1", "--xi", "0.02", "--specimen", "linear", "--json", "-")
            process = subprocess.Popen(  # noqa: S603
                [sys.executable, "-m", "reliab", "assess", path, *options], stdout=subprocess.DEVNULL
            )
            _, _, usage = os.wait4(process.pid, 0)
            print(
                f"{seconds} s at {rate} Hz: {usage.ru_utime + usage.ru_stime:.1f} s, "
                f"{usage.ru_maxrss / 1e6:.2f} GB",
                flush=True,
            )


if __name__ == "__main__":
    main()
