import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.motions.loading import read_motion

Write = Callable[[str, str | bytes], Path]
SAMPLES = [0.1, -0.2, 0.3, -0.25]
SINGLE_COLUMN = "".join(f"{value}\n" for value in SAMPLES)
TWO = "".join(f"{0.01 * i:.2f} {value}\n" for i, value in enumerate(SAMPLES))


@pytest.mark.parametrize(
    "header",
    [
        "# time_step: 0.01\n# units: m/s2\n",
        "# dt = 0.01 s, units = m/s2\n",
        "% dt: 10 ms\n% Units: s, m/s/s\n",
        "// sampling rate: 100 Hz\n! acceleration [m/s^2]\n",
        "Sampling_Frequency (Hz): 100\nacceleration_mps2\n",
        "Time step = .01\nAcceleration in m/s**2\n",
        "\n\n# delta t = 1.0D-2\n\n# UNITS OF M/SEC2\n\n",
        "# samples: 4\n# fs = 100\n# Acceleration (m/s²)\n",
        "dt = 0.01\nacceleration_m/s2\n",
        "dt = 0.01\nacc_x_m/s^2\n",
        "# motion: with units: g and dt = 5\n# event: dt = 9\n# dt = 0.01\n# units: m/s2\n",
    ],
)
def test_step_and_units_are_found_in_a_header(header: str, write: Write) -> None:
    motion = read_motion(write("a.txt", header + SINGLE_COLUMN))
    assert motion.acceleration.tolist() == SAMPLES
    assert motion.time_step == 0.01


@pytest.mark.parametrize(("units", "factor"), [("g", 9.80665), ("gal", 0.01), ("cm/s2", 0.01), ("m/s2", 1.0)])
def test_step_and_units_can_be_given(units: str, factor: float, write: Write) -> None:
    motion = read_motion(write("a.txt", SINGLE_COLUMN), time_step=0.02, units=units)
    np.testing.assert_allclose(motion.acceleration, np.array(SAMPLES) * factor)
    assert motion.time_step == 0.02


def test_decimal_commas_stand_between_semicolons(write: Write) -> None:
    acceleration = np.sin(np.arange(500) / 7.0)
    rows = (f"{0.01 * k:.2f};{100.0 * value:.6f}".replace(".", ",") for k, value in enumerate(acceleration))
    motion = read_motion(write("a.csv", "\n".join(["t [s];a [cm/s2]", *rows])))
    assert motion.time_step == pytest.approx(0.01)
    np.testing.assert_allclose(motion.acceleration, acceleration, atol=1e-8)


@pytest.mark.parametrize("delimiter", [" ", "\t", ",", ";", ", ", "   ", " ;"])
@pytest.mark.parametrize("tail", ["", "delimiter"])
def test_two_columns_tell_the_step_whatever_separates_them(delimiter: str, tail: str, write: Write) -> None:
    body = TWO.replace(" ", delimiter)
    if tail:
        body = body.replace("\n", f"{delimiter}\n")
    motion = read_motion(write("a.csv", f"time (s){delimiter}acc (m/s2)\n{body}"))
    assert motion.acceleration.tolist() == SAMPLES
    assert motion.time_step == 0.01


@pytest.mark.slow
@given(
    step=st.sampled_from([0.0024, 0.0066, 1 / 150, 1 / 1024, 0.005, 0.02]),
    start=st.floats(-5.0, 5.0),
    decimals=st.integers(3, 9),
)
def test_rounded_times_tell_the_step(step: float, start: float, decimals: int) -> None:
    times = start + step * np.arange(400)
    if step < 1.2 * 10.0**-decimals:
        return
    lines = "".join(f"{time:.{decimals}f} {0.1 * (-1) ** i}\n" for i, time in enumerate(times))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.txt"
        path.write_text(lines)
        motion = read_motion(path, units="g")
    assert motion.time_step == pytest.approx(step, abs=1.1 * 10.0**-decimals / 399)


def test_times_in_exponents_and_single_precision_tell_the_step(write: Write) -> None:
    times = (0.005 * np.arange(4000)).astype(np.float32)
    lines = "".join(f"{time:.7e} {0.1 * (-1) ** i}\n" for i, time in enumerate(times))
    assert read_motion(write("a.txt", lines), units="g").time_step == pytest.approx(0.005, rel=1e-6)


def test_an_event_can_be_declared_in_the_header(write: Write) -> None:
    motion = read_motion(write("a.txt", "# event: KOBE 1995\n# units: g\n# dt = 0.01\n" + SINGLE_COLUMN))
    assert motion.event == "KOBE 1995"


@pytest.mark.parametrize(
    ("text", "line", "rule"),
    [
        (SINGLE_COLUMN, None, "No units stated"),
        ("# units: g\n" + SINGLE_COLUMN, None, "No time step stated"),
        (
            "# units: furlongs\n" + TWO,
            1,
            "Unknown unit of acceleration; found 'furlongs'",
        ),
        (
            "# acceleration (in/s2)\n" + TWO,
            1,
            "Unknown unit of acceleration; found 'in/s2'",
        ),
        (
            "# units: g\n# acceleration [m/s2]\n" + TWO,
            2,
            "Two different units in one file; found m/s2 here and g in line 1",
        ),
        (
            "# units: g\n# dt = 0.01\n# dt = 0.02\n" + SINGLE_COLUMN,
            3,
            "Two different time steps in one file; found 0.02 here and 0.01 in line 2",
        ),
        ("# units: g\n# dt = 0\n" + SINGLE_COLUMN, 2, "positive number; found 0"),
        ("# units: g\n# dt = often\n" + SINGLE_COLUMN, 2, "positive number; found often"),
        ("# units: g\n# sampling rate: 0 Hz\n" + SINGLE_COLUMN, 2, "positive number; found 0"),
        (
            "# units: g\n# dt = 0.02\n" + TWO,
            2,
            "contradicts the column of times; found 0.02 s in the header, 0.01 s",
        ),
        ("# units: g\n# samples: 5\n# dt = 0.01\n" + SINGLE_COLUMN, 7, "Fewer samples .*; found 4 of 5"),
        (
            "# units: g\n# samples: 3\n# dt = 0.01\n" + SINGLE_COLUMN,
            7,
            "More samples .*; found 4 instead of 3",
        ),
        (
            "# units: g\n# samples: many\n# dt = 0.01\n" + SINGLE_COLUMN,
            2,
            "whole number of at least 2; found many",
        ),
        ("# units: g\n" + TWO.replace("0.02", "0.025"), 5, "equal steps; found 0.03 s after 0.025 s"),
        ("# units: g\n" + TWO.replace("0.02", "0.01"), 4, "equal steps; found 0.01 s after 0.01 s"),
        ("# units: g\n" + TWO.replace("0.02 ", ""), 4, "number of columns changes; found 1 instead of 2"),
        ("# units: g\n# dt = 0.01\n" + SINGLE_COLUMN.replace("0.3", "0.3 0.4"), 5, "found 2 instead of 1"),
        (
            "# units: g\n1 2 3\n4 5 6\n",
            2,
            "unclear what the columns hold; found 3 columns without names",
        ),
        ("# units: g\n0,00;0,1\n0,01;0,2\n", 2, "Not a number; found '0,00'"),
        ("# units: g\n# dt = 0.01\n0.5\n", 3, "Too few samples; found 1"),
        ("# units: g\n-1e308 0.1\n1e308 0.2\n", 3, "equal steps"),
        ("# units: g\n# dt = 0.01\n-1e308\n1e308\n", 3, "above 5 g; found inf g"),
        ("# units: g\n0.0 0.5\n", 2, "Too few samples; found 1"),
        ("# units: g\n# dt = 0.01\n0.5\nnan\n", 4, "Not a finite number; found 'nan'"),
        ("# units: g\n# dt = 0.01\ninf\n0.5\n", 3, "Not a finite number; found 'inf'"),
        ("# units: g\n# dt = 0.01\n0.5\n350.0\n", 4, "above 5 g; found 350 g with samples in g"),
        ("# units: g\n# dt = 0.01\n0\n0\n", 3, "All samples are zero"),
        ("only words\nand more\n", 1, "must hold samples"),
        ("# nothing but comments\n", 1, "must hold samples"),
        (",,,\n", 1, "must hold samples"),
    ],
)
def test_a_fault_is_told_with_its_line(text: str, line: int | None, rule: str, write: Write) -> None:
    path = write("a.txt", text)
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    location = str(path) if line is None else f"{path}, line {line}"
    assert str(caught.value).startswith(f"{location}: ")


def test_prose_about_acceleration_is_not_taken_for_units(write: Write) -> None:
    header = "# acceleration (corrected) in the N-S direction\n"
    assert read_motion(write("a.txt", header + TWO), units="m/s2").peak_acceleration == 0.3


def test_the_symbol_of_ground_acceleration_is_not_taken_for_units(write: Write) -> None:
    with pytest.raises(InputError, match="No units stated"):
        read_motion(write("a.csv", "t,a_g\n" + TWO.replace(" ", ",")))
