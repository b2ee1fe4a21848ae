"""Simulate the tests of the sample rig and add them: `python tests/rig/make_sample_rig.py FOLDER`.

The tests are simulated by `tests/assessment/rebuilt_error/laboratory.py`, which shares no code with `reliab`,
under ground motions that nobody recorded. FOLDER becomes `datasets/sample_rig`, without the records, which
would take thirty megabytes.
"""

import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "assessment")]

from rebuilt_error import laboratory as lab  # noqa: E402

from reliab.app.api.rigs import add_to_rig  # noqa: E402

EARTHQUAKES, PER_EARTHQUAKE, PER_DAY, RATE, SECONDS = 42, 3, 6, 256.0, 20.0
CHANGED, LATER = 63, 1e-3
"""From this test on the actuator is later by so much [s]: its valve was exchanged."""


def simulate_test(number, event, rng):
    """Time, command and measured displacement of a test."""
    ground = rng.uniform(0.15, 0.6) * lab.synthetic_ground(1000 + event, SECONDS, RATE)
    structure = lab.Lab(1.0, 0.03)
    ideal = lab.run(structure, ground, RATE, ideal=ground).command
    late = 1e-3 * (0.8 + 0.6 / (1.0 + number % PER_DAY) + 0.2 * rng.normal()) + LATER * (number >= CHANGED)
    late = max(late, 4e-4)
    gain = 0.998 - 0.008 * np.tanh(np.abs(ideal).max() / 0.05) + 0.0015 * rng.normal()
    actuator = (gain, 1.4 / late, 0.7, 0.0)  # of second order, which lags by 1.4 over its circular frequency
    stiff = replace(structure, kind=lab.SECOND_ORDER, numbers=actuator)
    tested_frame = lab.run(stiff, ground, RATE, parts=16, ideal=ideal)
    noise = lab.noise("white", ideal.size, 2e-5, rng, RATE)
    return np.stack(
        [np.arange(ideal.size) / RATE, tested_frame.command, tested_frame.measured + noise], axis=1
    )


def main(folder):
    """Write each test as a file, and add it to the rig."""
    rng = np.random.default_rng(39)
    with tempfile.TemporaryDirectory() as place:
        for number in range(EARTHQUAKES * PER_EARTHQUAKE):
            event = number // PER_EARTHQUAKE
            file = Path(place) / f"test_{number + 1:03d}.csv"
            table = simulate_test(number, event, rng)
            np.savetxt(file, table, "%.7g", ",", header="time_s,command_m,measured_m", comments="")
            day, place_in_day = divmod(number, PER_DAY)
            date = f"2025-{1 + day // 28:02d}-{1 + day % 28:02d}T{9 + place_in_day:02d}:00"
            add_to_rig(folder, file, f=1, xi=0.03, date=date, event=f"simulated {event + 1}")
    shutil.rmtree(Path(folder) / "records")
    (Path(folder) / "table.csv").unlink()


if __name__ == "__main__":
    main(*sys.argv[1:])
