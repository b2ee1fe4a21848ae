"""Large input: time and peak memory of every command against its size, each in a process of its own.

python tests/benchmarks/scale.py [motions] [record] [test] [campaign]    all of them by default
"""

import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from reliab.motions.catalogue import write_suite
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite

COUNTS = (100, 1_000, 10_000)
STRUCTURE = ("--f", 1, "--xi", 0.02)
DAY = 86_400  # s
NAMES = ("time_s", "command_m", "measured_m")
PROGRAM = "import sys; from reliab.app.cli import run; sys.exit(run(sys.argv[1:]))"


def measure_command(label: str, *arguments: object) -> None:
    """Run a command in a new process; print its time [s], peak memory [MB], exit code and first line."""
    read, write = os.pipe()
    start = time.perf_counter()
    child = os.fork()
    if child == 0:
        os.dup2(write, 1)
        os.dup2(write, 2)
        os.closerange(3, 64)
        os.execv(sys.executable, [sys.executable, "-c", PROGRAM, *map(str, arguments)])  # noqa: S606
    os.close(write)
    with os.fdopen(read, errors="replace") as stream:
        lines = [line.strip() for line in stream if line.strip()]
    _, status, usage = os.wait4(child, 0)
    seconds, memory = time.perf_counter() - start, usage.ru_maxrss / 1e3
    code = os.waitstatus_to_exitcode(status)
    last_line = f" {lines[-1]}" if code and lines else ""
    print(f"{label:38} {seconds:8.1f} s {memory:8.0f} MB  exit {code}{last_line}", flush=True)


def short_motion(number: int) -> Motion:
    """Eight seconds of noise under an envelope, at 50 Hz."""
    instants = np.arange(0.0, 8.0, 0.02)
    noise = np.random.default_rng((17, number)).standard_normal(instants.size)
    return Motion(
        name=f"E{number // 4}/M{number}",
        event=f"E{number // 4}",
        acceleration=np.round(noise * np.sin(np.pi * instants / 8.0) ** 2, 4),
        time_step=0.02,
    )


def motions(folder: Path) -> None:
    for count in COUNTS:
        suite = folder / f"suite_{count}"
        write_suite(MotionSuite.from_motions(map(short_motion, range(count))), suite)
        store, ellipses = folder / f"{count}.zarr", folder / f"{count}.nc"
        work = f"{count:,} motions"
        measure_command(f"simulate, {work}", "simulate", "--motions", suite, *STRUCTURE, "--out", store)
        files = [path for path in store.rglob("*") if path.is_file()]
        store_size = sum(path.stat().st_size for path in files)
        print(f"  store: {store_size / count:,.0f} bytes and {len(files) / count:.1f} files a motion")
        measure_command(f"ellipses, {work}", "ellipses", "--results", store, "--out", ellipses)
        measure_command(f"criterion, {work}", "criterion", "--ellipses", ellipses, *STRUCTURE)
        shutil.rmtree(store)
        shutil.rmtree(suite)


def record(folder: Path) -> None:
    path = folder / "long.txt"
    noise = np.random.default_rng(17).standard_normal(1_000_000)
    lines = "\n".join(f"{value:.4f}" for value in noise)
    with path.open("w") as stream:
        stream.write("# units: m/s2\n# time_step: 0.01\n")
        for _ in range(10):
            stream.write(f"{lines}\n")
    measure_command("a record of 10,000,000 samples", "motions", "list", path)


def pieces(rate: int) -> Iterator[np.ndarray]:
    """An hour of time, command and measured displacement after the other, for a day."""
    steps = 3_600 * rate
    for hour in range(DAY // 3_600):
        instants = (hour * steps + np.arange(steps)) / rate
        command, late = (
            0.01 * np.sin(2.0 * np.pi * instants_of_channel) * np.sin(0.001 * instants_of_channel)
            for instants_of_channel in (instants, instants - 0.004)
        )
        yield np.stack([instants, command, late + 1e-6 * np.sin(37.0 * instants)], axis=1)


def test(folder: Path) -> None:
    for rate in (32, 256):
        path = folder / f"day_{rate}.h5"
        with h5py.File(path, "w") as file:
            for name, values in zip(NAMES, np.concatenate(list(pieces(rate))).T, strict=True):
                file[name] = values
        del values  # a new process begins with the memory that this one has
        measure_command(f"assess, 24 h at {rate} Hz", "assess", path, *STRUCTURE)
        path.unlink()
    with (folder / "day.csv").open("w") as stream:
        stream.write(",".join(NAMES) + "\n")
        for piece in pieces(32):
            np.savetxt(stream, piece, fmt="%.8g", delimiter=",")
    measure_command(
        "monitor, 24 h at 32 Hz", "monitor", folder / "day.csv", *STRUCTURE, "--wait", 1, "--every", 600
    )


def campaign(folder: Path) -> None:
    for tests, seconds in ((10, 6), (100, 6), (1_000, 6), (1_000, 40)):
        place = folder / f"campaign_{tests}_{seconds}"
        place.mkdir()
        names = [f"t{number:04d}.csv" for number in range(tests)]
        for number, name in enumerate(names):
            _write_test(place / name, number, seconds)
        held_out = "\nheld_out = true\n"
        tables = [
            f'[[tests]]\nfile = "{name}"\nmotion = "M{k}"{held_out if k == 0 else ""}'
            for k, name in enumerate(names)
        ]
        (place / "campaign.toml").write_text(CAMPAIGN + "\n".join(tables) + "\n")
        measure_command(f"diagnose, {tests:,} tests of {seconds} s", "diagnose", place)


CAMPAIGN = """name = "many tests"
[structure]
frequency_hz = 1.0
damping_ratio = 0.05
mass_kg = 1000.0
experimental_fraction = 1.0
[actuator]
gain = 1.0
delay_s = 0.004
[sampling]
rate_hz = 128
"""


def _write_test(path: Path, number: int, seconds: int) -> None:
    random = np.random.default_rng((18, number))
    instants = np.arange(seconds * 128) / 128
    phase, frequency = random.uniform(0.0, 6.0), random.uniform(0.7, 1.4)

    def command(instants_of_channel: np.ndarray) -> np.ndarray:
        envelope = np.sin(np.pi * np.clip(instants_of_channel, 0.0, seconds) / seconds) ** 2
        return 0.01 * np.sin(2.0 * np.pi * frequency * instants_of_channel + phase) * envelope

    noise = 1e-6 * random.standard_normal(instants.size)
    columns = (instants, command(instants), command(instants - 0.004) + noise)
    np.savetxt(
        path,
        np.stack(columns, axis=1),
        fmt="%.9f",
        delimiter=",",
        header=",".join(NAMES),
        comments="",
    )


PARTS = {"motions": motions, "record": record, "test": test, "campaign": campaign}


def main() -> None:
    for name in sys.argv[1:] or PARTS:
        with tempfile.TemporaryDirectory() as folder:
            PARTS[name](Path(folder))


if __name__ == "__main__":
    main()
