"""Five malformed files of each kind end with a clear error or warning."""

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from reliab.assessment.assess import assess
from reliab.core.errors import InputError
from reliab.recordings.reading import read_recording
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)
ROW = 1234


def comma(folder, columns):
    return _text(folder / "t.csv", columns, ",", ".")


def decimal_comma(folder, columns):
    return _text(folder / "t.csv", columns, ";", ",")


def tab(folder, columns):
    return _text(folder / "t.txt", columns, "\t", ".")


def matlab(folder, columns):
    savemat(folder / "t.mat", columns)
    return folder / "t.mat"


def hdf5(folder, columns):
    with h5py.File(folder / "t.h5", "w") as file:
        for name, values in columns.items():
            file[name] = values
    return folder / "t.h5"


def _text(path, columns, delimiter, decimal):
    rows = zip(*columns.values(), strict=True)
    lines = [delimiter.join(f"{cell:.12g}".replace(".", decimal) for cell in row) for row in rows]
    path.write_text("\n".join([delimiter.join(columns), *lines]), encoding="utf-8")
    return path


FORMATS = [comma, decimal_comma, tab, matlab, hdf5]


@pytest.fixture
def columns(simulate):
    test = simulate(rate=128.0)
    times = np.arange(test.command.size) * test.time_step
    return {"time_s": times, "command_m": test.command, "measured_m": test.measured}


def place(write, column):
    location = f"sample {ROW + 1}" if write in {matlab, hdf5} else f"line {ROW + 2}"
    return rf"{location}, column {column}"


def answer(path):
    return assess(read_recording(path), ONE_HERTZ)


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("write", FORMATS)
def test_sound_file_has_neither_error_nor_warning(tmp_path, columns, write):
    assert answer(write(tmp_path, columns)).warnings == ()


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize(("name", "part"), [("command_m", "command"), ("measured_m", "measured")])
def test_missing_column_is_named_and_a_near_miss_suggested(tmp_path, columns, write, name, part):
    del columns[name]
    with pytest.raises(InputError, match=f"No column for the {part}"):
        answer(write(tmp_path, columns))
    columns[f"{part[:-2]}de"] = columns["time_s"]
    with pytest.raises(InputError, match=rf"Did you mean '{part[:-2]}de'"):
        answer(write(tmp_path, columns))


@pytest.mark.parametrize("write", FORMATS)
def test_unequal_steps_are_rejected_with_their_place(tmp_path, columns, write):
    columns["time_s"][ROW:] += 3.0 / 128.0
    with pytest.raises(
        InputError, match=rf"{place(write, 'time_s')}: The times do not increase by equal steps"
    ):
        answer(write(tmp_path, columns))


@pytest.mark.parametrize("write", FORMATS)
def test_missing_value_is_rejected_with_its_place(tmp_path, columns, write):
    columns["measured_m"][ROW : ROW + 2] = np.nan
    with pytest.raises(
        InputError, match=rf"{place(write, 'measured_m')}: Not a finite number.*NaN or .*, 2 in all"
    ):
        answer(write(tmp_path, columns))


@pytest.mark.parametrize(
    "write",
    [comma, *(pytest.param(write, marks=pytest.mark.slow) for write in FORMATS if write is not comma)],
)
def test_swapped_columns_are_suspected(tmp_path, columns, write):
    columns["command_m"], columns["measured_m"] = columns["measured_m"], columns["command_m"]
    warnings = answer(write(tmp_path, columns)).warnings
    assert any("leads the command by 0.6" in warning and "swapped" in warning for warning in warnings)
    assert any("noisier than the measured" in warning for warning in warnings)


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize("name", ["command_m", "measured_m"])
def test_constant_signal_is_rejected(tmp_path, columns, write, name):
    columns[name][:] = 0.25
    with pytest.raises(InputError, match=r"does not move: 0\.25 throughout"):
        answer(write(tmp_path, columns))


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (lambda t: t[::-1], "equal steps"),
        (lambda t: np.delete(np.append(t, t[-1] + t[1]), ROW), "equal steps"),
        (lambda t: np.where(np.arange(t.size) == ROW, t - 0.9 * t[1], t), "equal steps"),
        (lambda t: np.full_like(t, 3.0), "equal steps"),
        (lambda t: 1e3 * t, "longer than 0.2 of a period"),
        (lambda t: 5e-4 * t, "shorter than 2 periods"),
    ],
)
def test_times_of_other_faults_are_rejected(tmp_path, columns, fault, message):
    columns["time_s"] = fault(columns["time_s"])
    with pytest.raises(InputError, match=message):
        answer(comma(tmp_path, columns))


@pytest.mark.parametrize("noise", [0.1, 2.0])
def test_noise_is_warned_of_and_then_rejected(simulate, noise):
    test = simulate(noise=noise, rate=256.0)
    if noise < 1.0:
        assert any("noisy" in warning for warning in assess(test, ONE_HERTZ).warnings)
        return
    with pytest.raises(InputError, match="does not follow the command"):
        assess(test, ONE_HERTZ)


def test_identical_columns_and_a_short_test_are_warned_of(simulate):
    from reliab.recordings.recording import Recording

    test = simulate(rate=256.0)
    part = slice(2000, 2000 + 5 * 256)
    cases = {
        "identical": Recording(command=test.command, measured=test.command, time_step=1 / 256),
        "is short": Recording(command=test.command[part], measured=test.measured[part], time_step=1 / 256),
    }
    for words, case in cases.items():
        assert any(words in warning for warning in assess(case, ONE_HERTZ).warnings), words
