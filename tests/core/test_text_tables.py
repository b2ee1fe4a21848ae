"""Numbers, times of day and sampling rates as programs of many countries write them into texts."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.text_tables import TimesOfDay, number_of, time_of_day
from reliab.recordings.following import rows_as_written
from reliab.recordings.readers.text import header_of
from reliab.recordings.reading import read_recording

RATE = 256.0
TIME = np.arange(1024) / RATE
COMMAND = 20.0 * np.sin(6.0 * TIME)  # mm
MEASURED = 19.0 * np.sin(6.0 * (TIME - 0.004))
NAMES = "Time (s),Command (mm),Measured (mm)"


@pytest.mark.parametrize(
    ("cell", "number"),
    [
        ("1.5E-02", 0.015),
        ("1.5D-02", 0.015),
        ("-1.5d+02", -150.0),
        ("1.234-102", 1.234e-102),
        ("1,5", 1.5),
        ("1,234.5", 1234.5),
        ("1.234,5", 1234.5),
        ("1,234,567", 1234567.0),
        ("1 234,5", 1234.5),
        ("1'234.5", 1234.5),
        ("−3.5", -3.5),
        ("n/a", np.nan),
        ("*****", None),
        ("2026-11-24", None),
        ("12:30", None),
    ],
)
def test_a_number_in_any_notation(cell, number):
    result = number_of(cell)
    assert result is number is None or result == pytest.approx(number, nan_ok=True)


@pytest.mark.parametrize(
    ("cell", "seconds"),
    [
        ("09:15:30.5", 33330.5),
        ("2026-11-24T09:15:30,5", 33330.5),
        ("09:15:30:500", 33330.5),
        ("11:59:59 PM", 86399.0),
        ("12:00:01 AM", 1.0),
        ("12:00:01 p.m.", 43201.0),
        ("02:03.25", 123.25),
        ("14:30", None),
        ("running", None),
    ],
)
def test_a_time_of_day_in_any_notation(cell, seconds):
    assert time_of_day(cell) == (None if seconds is None else pytest.approx(seconds))


def test_times_of_day_are_counted_beyond_midnight_in_any_pieces():
    seconds = np.array([86398.5, 86399.5, 0.5, 1.5, 86399.0, 0.25])
    counter = TimesOfDay()
    pieces = [counter.count_seconds(piece) for piece in (seconds[:2], seconds[2:2], seconds[2:])]
    reference = [0.0, 1.0, 2.0, 3.0, 86400.5, 86401.75]
    np.testing.assert_allclose(np.concatenate(pieces), reference)


def rows(times=None, command=COMMAND, measured=MEASURED, number="{:.6f}"):
    times = [f"{time:.9f}" for time in TIME] if times is None else times
    cells = ((number.format(value) for value in values) for values in (command, measured))
    return [",".join(row) for row in zip(times, *cells, strict=True)]


def write_lines(folder, *lines):
    (folder / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    return folder / "t.csv"


def times_of_day(begin, *, half_day):
    for time in begin + TIME:
        hour, minute, second = int(time // 3600) % 24, int(time // 60) % 60, time % 60
        ending = f" {'AM' if hour < 12 else 'PM'}" if half_day else ""
        yield f"{(hour + 11) % 12 + 1 if half_day else hour}:{minute:02d}:{second:010.7f}{ending}"


@pytest.mark.parametrize("half_day", [True, False])
@pytest.mark.parametrize("begin", [43198.0, 86398.0], ids=["noon", "midnight"])
def test_clocks_of_twelve_and_of_twenty_four_hours_are_times_at_every_door(tmp_path, begin, half_day):
    path = write_lines(tmp_path, NAMES.replace(" (s)", ""), *rows(times_of_day(begin, half_day=half_day)))
    test = read_recording(path)
    assert test.time_step == pytest.approx(1.0 / RATE, rel=1e-6)
    np.testing.assert_allclose(test.measured, 1e-3 * MEASURED, atol=1e-8)
    texts = list(rows_as_written(iter([path.read_bytes() + b"\n"]), name="t.csv", declarations={}))
    np.testing.assert_allclose(np.concatenate([part.time for part in texts]), TIME, atol=1e-6)


def test_exponents_of_fortran_are_numbers_at_every_door(tmp_path):
    path = write_lines(tmp_path, NAMES, *(row.replace("e", "D") for row in rows(number="{:.9e}")))
    np.testing.assert_allclose(read_recording(path).command, 1e-3 * COMMAND, atol=1e-9)
    (part,) = rows_as_written(iter([path.read_bytes() + b"\n"]), name="t.csv", declarations={})
    np.testing.assert_allclose(part.command, 1e-3 * COMMAND, atol=1e-9)


def test_thousands_in_quotation_marks_are_numbers(tmp_path):
    cells = (
        '"{:,.3f}","{:,.3f}","{:,.3f}"'.format(*row)
        for row in zip(TIME, 1e3 * COMMAND, 1e3 * MEASURED, strict=True)
    )
    test = read_recording(write_lines(tmp_path, "Time (s),Command (um),Measured (um)", *cells), rate_hz=None)
    np.testing.assert_allclose(test.command, 1e-3 * COMMAND, atol=1e-9)


def test_ambiguous_commas_are_refused(tmp_path):
    cells = (
        f"{t:.6f}\t{c:,.0f}\t{m:,.0f}" for t, c, m in zip(TIME, 1e3 * COMMAND, 1e3 * MEASURED, strict=True)
    )
    with pytest.raises(InputError, match=r"t\.csv, line 2: It is unclear whether the comma is a decimal"):
        read_recording(write_lines(tmp_path, "Time (s)\tCommand (um)\tMeasured (um)", *cells))


@pytest.mark.parametrize(
    ("lines", "hertz"),
    [
        (["# Sample Rate: 1,024 Hz"], 1024.0),
        (["# Sampling frequency: 1.024 kHz"], 1024.0),
        (["# Sampling rate [kHz] = 1.024"], 1024.0),
        (["# dt (ms) = 0.9765625"], 1024.0),
        (["# time step: 0.9765625 milliseconds"], 1024.0),
        (["Sample interval,0.0009765625,s"], 1024.0),
        (['Sample Rate,"1,024",Hz'], 1024.0),
        (["Sample Rate,512,512,512"], 512.0),
        (["# sample rate: 1 024 Hz"], 1024.0),
        (["# rate: 0.5 ms"], 2000.0),
        (["# rate: 1024 Hz", "# dt: 0.0009765625"], 1024.0),
        (["# rate: 1024 Hz", "# dt: 0.002"], None),
        (["# rated force: 1024 kN"], None),
    ],
)
@pytest.mark.parametrize("width", [2, 3])
def test_a_sampling_rate_in_any_notation(lines, hertz, width):
    names = ["time_s", "command_mm", "measured_mm"][-width:]
    header = header_of([*lines, ",".join(names)], width, ",")
    rates = [value if name == "rate" else 1.0 / value for name, value in header.sampling.items()]
    assert rates == ([] if hertz is None else [pytest.approx(hertz)])
    assert (header.names, header.units) == (names, [""] * width)


def test_a_separator_of_thousands_is_not_decimal(tmp_path):
    cells = (f"{c:.5f};{m:.5f}".replace(".", ",") for c, m in zip(COMMAND, MEASURED, strict=True))
    path = write_lines(
        tmp_path, "# Abtastrate", "# sample rate: 1.024 Hz", "Sollweg [mm];Istweg [mm]", *cells
    )
    assert read_recording(path).time_step == pytest.approx(1.0 / 1024.0)


def test_an_impossible_sampling_rate_is_refused(tmp_path):
    cells = (f"{c:.5f},{m:.5f}" for c, m in zip(COMMAND, MEASURED, strict=True))
    path = write_lines(tmp_path, "# sample rate: 1.024 Hz", "command_mm,measured_mm", *cells)
    with pytest.raises(InputError, match=r"t\.csv: The file states a sampling rate of 1\.024 Hz.*`rate`"):
        read_recording(path)
    assert read_recording(path, rate_hz=1024.0).time_step == pytest.approx(1.0 / 1024.0)


@pytest.mark.parametrize("header", ["# scale factor: 0.5", "scale,1,0.01,0.009", "offset,0,0,3.5"])
def test_scales_above_a_table_are_asked_about(tmp_path, header):
    with pytest.raises(
        InputError, match=r"t\.csv: The file states .* but not whether its numbers contain it"
    ):
        read_recording(write_lines(tmp_path, header, "time_s,command_mm,measured_mm", *rows()))


def test_a_comment_states_the_units_of_columns_without_any(tmp_path):
    table = rows([f"{1e3 * time:.9f}" for time in TIME])
    path = write_lines(tmp_path, "# units: mm", "# time unit: ms", "time,command,measured", *table)
    test = read_recording(path)
    np.testing.assert_allclose(test.command, 1e-3 * COMMAND, atol=1e-8)
    assert test.time_step == pytest.approx(1.0 / RATE)


def test_a_message_names_the_line_of_the_file(tmp_path):
    """Only what ends a line ends it: a sign of cp1252 that Python takes for an end of a line does not."""
    table = rows()
    table[500] = "x,y,z,1"
    content = b"Rig 3 \x85 second\r\n" + "\r\n".join([NAMES, *table]).encode()
    (tmp_path / "t.csv").write_bytes(content)
    with pytest.raises(InputError, match=r"t\.csv, line 503: 4 columns, but 3 in the first line"):
        read_recording(tmp_path / "t.csv")
