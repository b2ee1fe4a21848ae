"""Objects of MATLAB's classes as MATLAB saved them; the numbers are those of the scripts that made them."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.recordings.readers.hierarchical import read_hierarchical
from reliab.recordings.readers.matlab import tree_of_objects
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import read_recording

pytest.importorskip("matio")
MATLAB_FILES = Path(__file__).parent / "saved_by_matlab"
DAY = 86400.0


def read(name):
    (test,) = read_tests(MATLAB_FILES / f"{name}.mat")
    return test


@pytest.mark.parametrize(
    ("variable", "times", "values"),
    [
        ("timetable_step_millis", [0.0, 0.01, 0.02], [1.0, 2.0, 3.0]),
        ("timetable_step_start_offset", [0.0, 1.0, 2.0], [1.0, 2.0, 3.0]),
        ("timetable_step_caldays", [0.0, DAY, 2.0 * DAY], [1.0, 2.0, 3.0]),
        ("timetable_sample_rate", [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0], [1.0, 2.0, 3.0, 4.0]),
    ],
)
def test_timetable_times_saved_as_a_step(variable, times, values):
    test = read("timetable_steps_v7")
    np.testing.assert_array_equal(test.values[f"{variable}.data1"], values)
    np.testing.assert_allclose(test.series[f"{variable}.data1"].times, times, atol=1e-9)


def test_tables_and_timetables():
    test = read("tables_v7")
    np.testing.assert_array_equal(test.values["table_numeric.Var2"], [4.4, 5.5, 6.6])
    np.testing.assert_array_equal(test.values["table_row_names.Col1"], [1.0, 2.0, 3.0])
    np.testing.assert_allclose(test.series["timetable_duration.data1"].times, [10.0, 20.0, 30.0])
    np.testing.assert_allclose(test.series["timetable_datetime.data1"].times, [0.0, DAY, 2.0 * DAY])
    assert test.units["timetable_with_attrs.data1"] == "m/s"


@pytest.mark.parametrize("release", ["timetablev8_v7", "timetablev8_v73"])
def test_a_timetable_of_a_later_release_in_both_formats(release):
    assert read(release).values["timetable_v8.data1"] == pytest.approx([1.0, 2.0, 3.0])


def test_names_of_columns_as_they_were_written():
    np.testing.assert_array_equal(
        read("table_original_names_v7").values["table_original_names.p [bar]"], [1.0, 2.0]
    )


@pytest.mark.parametrize("version", ["v7", "v73"])
def test_function_handles_are_no_channels(version):
    handles = tree_of_objects(MATLAB_FILES / f"function_handles_{version}.mat")
    assert handles.pop("empty_fh") == []
    assert set(handles.values()) == {""}


def test_calendar_durations_have_no_length_in_seconds_and_spoil_no_file():
    assert "dur_" in " ".join(tree_of_objects(MATLAB_FILES / "time_v7.mat"))


def test_characters_beyond_sixteen_bits_are_text():
    """As the manual's UTF-16: numbers that are halves of a character could not be written out again."""
    with pytest.raises(InputError) as caught:
        read_hierarchical(MATLAB_FILES / "chars_v73.mat")
    assert str(caught.value).encode()


@pytest.mark.parametrize("path", sorted(MATLAB_FILES.glob("*.mat")), ids=lambda path: path.stem)
def test_none_of_them_is_taken_for_a_test(path):
    with pytest.raises(InputError, match=r"vectors of numbers|No column for the command"):
        read_recording(path)


def test_numbers_of_a_file_with_objects_are_bounded_before_these_are_read(monkeypatch):
    path = MATLAB_FILES / "timetablev8_v73.mat"
    with h5py.File(path) as file:
        sizes: list[int] = []
        file.visititems(lambda _, item: sizes.append(getattr(item, "nbytes", 0)))
    monkeypatch.setitem(LIMITS, "test", replace(LIMITS["test"], numbers=sum(sizes)))
    assert read_hierarchical(path)
    monkeypatch.setitem(LIMITS, "test", replace(LIMITS["test"], numbers=sum(sizes) - 1))
    with pytest.raises(ValueError, match="MB of numbers"):
        read_hierarchical(path)
