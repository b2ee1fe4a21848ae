"""What no recording can be is refused, whether it comes from a file, from Python or from a simulation."""

from dataclasses import replace

import h5py
import numpy as np
import pandas as pd
import pytest

import reliab
from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.recordings.readers import layouts, registry
from reliab.recordings.readers.columns import Series
from reliab.recordings.readers.layouts import tests_of_tree as of_tree
from reliab.recordings.recording import FEWEST_SAMPLES, LARGEST_READING, Recording, require_few_samples

MOVING = np.sin(np.arange(0.0, 20.0, 0.01))
TABLE = pd.DataFrame({"time": 0.01 * np.arange(MOVING.size), "command": MOVING, "measured": MOVING})


def recording(**variant):
    return Recording(**{"command": MOVING, "measured": MOVING, "time_step": 0.01, **variant})


def insert_value(value):
    values = MOVING.copy()
    values[99] = value
    return values


@pytest.mark.parametrize(
    ("variant", "rule"),
    [
        ({"command": MOVING[1:]}, "the same length, at least 64; found 1999 and 2000"),
        ({"command": MOVING[:63], "measured": MOVING[:63]}, "the same length, at least 64; found 63 and 63"),
        ({"command": np.float64(1.0), "measured": np.float64(1.0)}, "at least 64; found 1 and 1"),
        ({"command": np.stack([MOVING, MOVING])}, "the same length, at least 64; found 4000 and 2000"),
        (
            {"actuators": ("1", "2")},
            "a number of its own; found 1, 2 for commands of shape",
        ),
        ({"time_step": 0.0}, "time step must be between 1e-06 and 1,000 s; found 0 s"),
        ({"time_step": np.nan}, "time step must be .* found nan s"),
        ({"time_step": np.inf}, "time step must be .* found inf s"),
        ({"command": 0.0 * MOVING}, "command does not move: 0 throughout"),
        ({"measured": 3.0 + 1e-10 * MOVING}, "measured displacement does not move: 3 throughout"),
        (
            {"command": insert_value(np.nan)},
            "finite number below 1e.30; found nan in the command, sample 100",
        ),
        (
            {"measured": insert_value(-LARGEST_READING)},
            "found -1e.30 in the measured displacement, sample 100",
        ),
        ({"ground": insert_value(np.inf)}, "found inf in the ground acceleration, sample 100"),
        ({"force": insert_value(np.nan)}, "found nan in the force, sample 100"),
    ],
)
def test_impossible_recording_is_refused(variant, rule):
    with pytest.raises(InputError, match=rule):
        recording(**variant)


@pytest.mark.parametrize(
    ("variant", "rule"),
    [
        ({"command": np.stack([0.0 * MOVING, 0.0 * MOVING])}, "command does not move: 0 throughout"),
        ({"measured": np.stack([MOVING, insert_value(np.nan)])}, "found nan in the measured displacement 2"),
        ({"actuators": ("1",)}, "Each actuator needs a number of its own"),
    ],
)
def test_an_impossible_recording_of_several_actuators_is_refused(variant, rule):
    both = np.stack([MOVING, 0.0 * MOVING])
    assert recording(command=both, measured=both).actuators == ("1", "2")
    with pytest.raises(InputError, match=rule):
        recording(**{"command": both, "measured": both, **variant})


def test_the_shortest_and_the_smallest_recording_are_taken():
    small_sample = MOVING[:FEWEST_SAMPLES]
    assert recording(command=small_sample, measured=small_sample).duration == pytest.approx(0.01 * 63)
    assert recording(measured=3.0 + 1e-8 * MOVING, ground=0.0 * MOVING).force is None


def test_too_many_samples_are_refused(monkeypatch):
    monkeypatch.setattr("reliab.recordings.recording.MOST_SAMPLES", 20)
    require_few_samples(20, "test.csv")
    with pytest.raises(InputError, match=r"test.csv: Too many samples: 21"):
        require_few_samples(21, "test.csv")


def test_files_without_vectors_list_their_content(tmp_path):
    with pytest.raises(InputError, match=r"No vectors of numbers in the file; found words, sizes"):
        of_tree(tmp_path / "a.mat", {"words": np.array(["a"]), "sizes": np.array(3.0)})
    with pytest.raises(InputError, match="found nothing"):
        of_tree(tmp_path / "a.mat", {})


def test_matrices_may_lie(tmp_path):
    """A column of a matrix is along its longer side, whichever that is."""
    standing = np.arange(40.0).reshape(20, 2)
    for matrix in (standing, standing.T):
        (result,) = of_tree(tmp_path / "a.mat", {"x": matrix, "dt": np.array([[0.5]])})
        assert {name: values.tolist() for name, values in result.values.items()} == {
            "x[1]": standing[:, 0].tolist(),
            "x[2]": standing[:, 1].tolist(),
        }
        assert result.scalars == {"dt": 0.5}
        assert not result.named


@pytest.mark.parametrize(("columns", "rule"), [(1, None), (4, r"'column 1' and 'column 2'.* move alike")])
def test_nameless_columns_are_two_or_three(tmp_path, columns, rule):
    file = tmp_path / "test.csv"
    np.savetxt(file, np.column_stack([MOVING] * columns), delimiter=",")
    with pytest.raises(InputError, match=rule):
        reliab.assess(file, f=1.0, xi=0.02)


@pytest.mark.parametrize(
    ("test", "declared_values", "rule"),
    [
        (recording(), {"units": "m"}, "`units` has no effect together with a test that was already read"),
        (TABLE, {"rate": 0.0}, "`rate` must be between 0.001 and 1e.09 Hz; found 0 Hz"),
        (TABLE, {"rate": float("inf")}, "`rate` must be .* found inf"),
        (TABLE, {"delimiter": ";"}, "`delimiter` has no effect together with a data frame"),
        (TABLE, {"command": "commanded"}, "Did you mean 'command'"),
        (TABLE, {"measured": "zzzz"}, "No column .zzzz. for the measured"),
    ],
)
def test_meaningless_statements_are_refused(test, declared_values, rule):
    with pytest.raises(InputError, match=rule):
        reliab.assess(test, f=1.0, xi=0.02, **declared_values)


def test_a_test_of_more_channels_than_any_laboratory_has_is_refused(monkeypatch):
    monkeypatch.setattr(layouts, "MOST_COLUMNS", 2)
    histories = layouts._Histories()  # noqa: SLF001 - before any file is read
    for name in ("first", "first"):
        histories.add(name, Series(values=np.zeros(3)))
    assert list(histories.series) == ["first", "first (2)"]
    with pytest.raises(InputError, match="holds more than 2 channels"):
        histories.add("third", Series(values=np.zeros(3)))


def test_huge_file_is_refused_before_reading(monkeypatch, tmp_path):
    TABLE.to_csv(tmp_path / "t.csv", index=False)
    monkeypatch.setitem(LIMITS, "test", replace(LIMITS["test"], bytes=1000))
    with pytest.raises(InputError, match=r"t\.csv.*larger than"):
        registry.read_tests(tmp_path / "t.csv")


def limit_test(monkeypatch, kind, **sizes):
    monkeypatch.setitem(LIMITS, kind, replace(LIMITS[kind], **sizes))


def test_numbers_of_a_file_are_bounded_together_and_before_they_are_read(monkeypatch, tmp_path):
    path = tmp_path / "test.h5"
    with h5py.File(path, "w") as file:
        for name in ("time", "command", "measured"):
            file[name] = TABLE[name].to_numpy()
    limit_test(monkeypatch, "test", numbers=3 * 8 * MOVING.size)
    assert reliab.read_recording(path).command.size == MOVING.size
    limit_test(monkeypatch, "test", numbers=3 * 8 * MOVING.size - 1)
    with pytest.raises(InputError, match=r"more than 0\.047999 MB of numbers"):
        reliab.read_recording(path)


def test_a_text_is_bounded_before_it_is_read_and_the_remedy_is_another_format(monkeypatch, tmp_path):
    path = tmp_path / "test.csv"
    TABLE.to_csv(path, index=False)
    limit_test(monkeypatch, "text of a test", bytes=path.stat().st_size)
    assert reliab.read_recording(path).command.size == MOVING.size
    limit_test(monkeypatch, "text of a test", bytes=path.stat().st_size - 1)
    with pytest.raises(InputError, match="or export it as HDF5"):
        reliab.read_recording(path)


def test_a_usual_mark_of_missing_samples_is_refused_by_its_number(tmp_path):
    time = np.arange(0.0, 20.0, 0.01)
    command = 10.0 * np.sin(6.0 * time)
    reading = 0.99 * command
    reading[700:703] = -9999.0
    path = tmp_path / "test.csv"
    rows = np.column_stack([time, command, reading])
    np.savetxt(path, rows, delimiter=",", header="time_s,command_mm,measured_mm", comments="")
    with pytest.raises(InputError, match=r"line 702, column measured_mm: .*-9999, which marks .*, 3 in all"):
        reliab.read_recording(path)
