from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions, read_motion

Write = Callable[[str, str | bytes], Path]
SAMPLES = np.array([0.1, -0.2, 0.3, -0.25, 0.05, 0.15, -0.35, 0.2])


def rows(*columns: object, mark: str = " ") -> str:
    return "".join(mark.join(map(str, row)) + "\n" for row in zip(*columns, strict=True))


def times(scale: float = 1.0) -> list[float]:
    return [round(0.01 * scale * i, 6) for i in range(8)]


@pytest.mark.parametrize(
    ("heading", "columns"),
    [
        ("time [s], acceleration [m/s2]", (times(), SAMPLES)),
        ("time [ms], acceleration [m/s2]", (times(1e3), SAMPLES)),
        ("Time (msec)   Acc (m/s2)", (times(1e3), SAMPLES)),
        ("time_us,acc_mps2", (times(1e6), SAMPLES)),
        ("acc (m/s2), time (s)", (SAMPLES, times())),
        ("No, Time (s), Acc (m/s2)", (range(8), times(), SAMPLES)),
        ("n, t, a (m/s2)", (range(1, 9), times(), SAMPLES)),
        ("time (s), vel (m/s), acc (m/s2), disp (m)", (times(), 2 * SAMPLES, SAMPLES, 3 * SAMPLES)),
        ("acc (m/s2)   vel (m/s)   disp (m)", (times(), SAMPLES, 2 * SAMPLES, 3 * SAMPLES)),
    ],
)
def test_acceleration_is_found_among_named_columns(
    heading: str, columns: tuple[object, ...], write: Write
) -> None:
    motion = read_motion(write("a.csv", f"{heading}\n{rows(*columns, mark=',')}"))
    np.testing.assert_array_equal(motion.acceleration, SAMPLES)
    assert motion.time_step == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize("first", [0, 1])
def test_sample_numbers_are_no_times(first: int, write: Write) -> None:
    text = rows(range(first, first + 8), SAMPLES)
    path = write("a.txt", f"# dt: 0.01\n# units: m/s2\n{text}")
    np.testing.assert_array_equal(read_motion(path).acceleration, SAMPLES)
    assert [note.value for note in inspect(path).notes] == ["column of sample numbers left out"]
    with pytest.raises(InputError, match="No time step stated"):
        read_motion(write("b.txt", f"# units: m/s2\n{text}"))


def test_times_in_milliseconds_without_a_unit_are_asked_back(write: Write) -> None:
    path = write("a.txt", f"# dt: 0.01\n# units: m/s2\n{rows(times(1e3), SAMPLES)}")
    with pytest.raises(InputError, match=r"name of the column of times: time \[ms\]"):
        read_motion(path)


@pytest.mark.parametrize("heading", ["N-S  E-W  U-D", "L T V", "HNN HNE HNZ", "1(gal),2(gal),3(gal)"])
def test_each_named_component_is_a_motion_of_one_event(heading: str, write: Write) -> None:
    text = f"# dt: 0.01\n# units: gal\n# {heading}\n{rows(SAMPLES, 2 * SAMPLES, 3 * SAMPLES)}"
    suite = load_motions(write("a.txt", text))
    assert suite.names == ("a/1", "a/2", "a/3")
    assert set(suite.events) == {"a"}
    for factor, motion in enumerate(suite, start=1):
        np.testing.assert_allclose(motion.acceleration, factor * SAMPLES / 100, rtol=1e-12)


@pytest.mark.parametrize(
    ("heading", "columns", "rule"),
    [
        (
            "# units: m/s2",
            (times(), SAMPLES, SAMPLES),
            "what the columns hold; found 3 columns without names",
        ),
        ("# units: m/s2", (times(), SAMPLES, SAMPLES, SAMPLES), "what the columns hold; found 4 columns"),
        ("time (s), velocity (m/s)", (times(), SAMPLES), "Not a record of acceleration; found columns time"),
        (
            "time (s), N-S (V), E-W (V)",
            (times(), SAMPLES, SAMPLES),
            "Unknown unit of acceleration; found 'V'",
        ),
        (
            "# units: g\ntime (s), acc (m/s2)",
            (times(), SAMPLES),
            "Two different units in one file; found m/s2 here and g",
        ),
        ("# units: g\ntime (s), U(-), N(+)", (times(), SAMPLES, SAMPLES), "what the columns hold"),
    ],
)
def test_indistinguishable_columns_are_refused(
    heading: str, columns: tuple[object, ...], rule: str, write: Write
) -> None:
    with pytest.raises(InputError, match=rule):
        list(load_motions(write("a.csv", f"{heading}\n{rows(*columns, mark=',')}")))


@pytest.mark.parametrize("line_values", [2, 3, 5, 8])
def test_count_identifies_consecutive_samples(line_values: int, write: Write) -> None:
    cells = [str(value) for value in SAMPLES]
    lines = "".join(" ".join(cells[i : i + line_values]) + "\n" for i in range(0, 8, line_values))
    path = write("a.txt", f"# dt: 0.01\n# units: m/s2\n# samples: 8\n{lines}")
    np.testing.assert_array_equal(read_motion(path).acceleration, SAMPLES)


@pytest.mark.parametrize("sizes", ["8\n0.01\n", "8 0.01\n", "8, 0.01\n", "0.01\n8\n", "8.\n.01\n"])
def test_lines_of_count_and_step_are_no_samples(sizes: str, write: Write) -> None:
    path = write("a.txt", sizes + rows(SAMPLES))
    for time_step in (None, 0.01):
        motion = read_motion(path, units="m/s2", time_step=time_step)
        np.testing.assert_array_equal(motion.acceleration, SAMPLES)
        assert motion.time_step == 0.01


def test_step_before_samples_must_match_header(write: Write) -> None:
    with pytest.raises(
        InputError, match=r"line 4: Two different time steps in one file; found 0\.01 here and 0\.02"
    ):
        read_motion(write("a.txt", f"# dt: 0.02\n# units: gal\n8\n0.01\n{rows(SAMPLES)}"))


def test_count_before_the_samples_of_a_file_cut_short_is_no_sample(write: Write) -> None:
    with pytest.raises(InputError, match="found 8 of 3000"):
        read_motion(write("a.txt", f"3000\n{rows(SAMPLES)}"), units="m/s2", time_step=0.01)


def test_whole_numbers_are_samples_where_they_count_nothing(write: Write) -> None:
    path = write("a.txt", "100\n-200\n300\n-250\n")
    assert read_motion(path, units="gal", time_step=0.01).acceleration.tolist() == [1.0, -2.0, 3.0, -2.5]


def test_rows_cut_to_the_number_of_a_count_are_not_taken_for_one_record(write: Write) -> None:
    """Of twelve rows of three columns four are left, which are twelve numbers."""
    text = f"NDATA: 12\ndt: 0.01\nunits: gal\nN-S E-W U-D\n{rows(*[SAMPLES[:4]] * 3)}"
    with pytest.raises(InputError, match="found 4 of 12"):
        list(load_motions(write("a.txt", text)))
