"""Every format, delimiter, unit and way to give the time yields the same test."""

import h5py
import numpy as np
import pandas as pd
import pytest
from scipy.io import netcdf_file, savemat

from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.following import rows_as_written
from reliab.recordings.reading import read_recording

RATE = 200.0
TIME = np.arange(2000) / RATE
COMMAND = 0.02 * np.sin(6.0 * TIME) * np.exp(-TIME / 8.0)
MEASURED = 0.0199 * np.sin(6.0 * (TIME - 0.004)) * np.exp(-TIME / 8.0)
COLUMNS = {"time_s": TIME, "command_m": COMMAND, "measured_m": MEASURED}


def text(path, header, columns, delimiter=",", *, decimal="."):
    rows = [
        delimiter.join(f"{cell:.9f}".replace(".", decimal) for cell in row)
        for row in zip(*columns, strict=True)
    ]
    path.write_text("\n".join([*header, *rows]), encoding="utf-8")
    return path


def write_csv(folder):
    return text(folder / "t.csv", ["time_s,command_m,measured_m"], COLUMNS.values())


def write_decimal_comma(folder):
    return text(folder / "t.csv", ["time;cmd;meas"], COLUMNS.values(), ";", decimal=",")


def write_tabs_and_units(folder):
    millimetres = [TIME, 1e3 * COMMAND, MEASURED]
    return text(folder / "t.txt", ["# rig 3", "Time\tCommand\tMeasured", "s\tmm\tm"], millimetres, "\t")


def write_blanks(folder):
    return text(folder / "t.dat", ["% t x_c x_m", "t x_c x_m"], COLUMNS.values(), " ")


def write_milliseconds_and_inches(folder):
    columns = [1e3 * TIME, COMMAND / 0.0254, MEASURED / 0.0254]
    return text(folder / "t.csv", ['"Time [ms]","Target disp (in)","Actual disp (in)"'], columns)


def write_no_header(folder):
    return text(folder / "t.csv", [], COLUMNS.values())


def write_rounded_times(folder):
    rows = [f"{t:.3f},{c:.9f},{m:.9f}" for t, c, m in zip(TIME, COMMAND, MEASURED, strict=True)]
    (folder / "t.csv").write_text("\n".join(["time,command,measured", *rows]), encoding="utf-8")
    return folder / "t.csv"


def write_matlab(folder):
    savemat(folder / "t.mat", {"test": {"time": TIME, "command": COMMAND, "measured": MEASURED}})
    return folder / "t.mat"


def write_matlab_rate(folder):
    savemat(folder / "t.mat", {"fs": RATE, "cmd": COMMAND, "meas": MEASURED, "name": "rig"})
    return folder / "t.mat"


def write_matlab_73(folder):
    with h5py.File(folder / "t.mat", "w", userblock_size=512) as file:
        for name, values in (("t", TIME), ("xc", COMMAND), ("xm", MEASURED)):
            file[name] = values[np.newaxis]
    with (folder / "t.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(512, b" "))
    return folder / "t.mat"


def write_hdf5(folder):
    with h5py.File(folder / "t.h5", "w") as file:
        for name, values in (("rig/time", TIME), ("rig/command", 1e3 * COMMAND), ("rig/measured", MEASURED)):
            file[name] = values
        file["rig/command"].attrs["units"] = "mm"
        file["rig/measured"].attrs["units"] = "m"
    return folder / "t.h5"


def write_netcdf_4(folder):
    import xarray as xr

    dataset = xr.Dataset(
        {"command": ("time", COMMAND), "measured": ("time", MEASURED)}, coords={"time": TIME}
    )
    dataset["time"].attrs["units"] = "s"
    dataset.to_netcdf(folder / "t.nc", engine="h5netcdf")
    return folder / "t.nc"


def write_netcdf_classic(folder):
    with netcdf_file(folder / "t.nc", "w") as file:
        file.createDimension("time", TIME.size)
        for name, values in (("time", TIME), ("command", COMMAND), ("measured", MEASURED)):
            file.createVariable(name, "d", ("time",))[:] = values
    return folder / "t.nc"


@pytest.mark.parametrize(
    "write",
    [
        write_csv, write_decimal_comma, write_tabs_and_units, write_blanks, write_milliseconds_and_inches,
        write_no_header, write_rounded_times, write_matlab, write_matlab_rate, write_matlab_73, write_hdf5,
        write_netcdf_4, write_netcdf_classic,
    ],
)  # fmt: skip
def test_the_same_test_comes_back(tmp_path, write):
    result = read_recording(write(tmp_path))
    assert result.time_step == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(result.measured, MEASURED, atol=2e-9)
    np.testing.assert_allclose(result.command, COMMAND, atol=2e-9)


def test_columns_and_rate_can_be_declared(tmp_path):
    path = text(tmp_path / "t.csv", ["a,b,c"], [COMMAND, TIME, MEASURED])
    result = read_recording(path, command="a", measured="c", rate_hz=100.0)
    assert result.time_step == pytest.approx(0.01)
    duration = read_recording(path, command="a", measured="c", time="b", units="mm")
    assert duration.time_step == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(duration.command, 1e-3 * COMMAND, atol=1e-12)


def test_coarsely_rounded_times_are_understood(tmp_path):
    times = (np.arange(2000) / 1024.0).round(3)
    path = text(tmp_path / "t.csv", ["time,command,measured"], [times, COMMAND, MEASURED])
    assert read_recording(path).time_step == pytest.approx(1.0 / 1024.0, rel=1e-3)


def test_unit_stated_for_one_column_is_taken_for_both_and_said(tmp_path):
    path = text(tmp_path / "t.csv", ["time,command [mm],measured"], [TIME, 1e3 * COMMAND, 1e3 * MEASURED])
    result = read_recording(path)
    np.testing.assert_allclose(result.measured, MEASURED, atol=2e-9)
    assert any("measured displacement states no unit" in note for note in result.notes)


def test_choice_among_nameless_columns_is_said(tmp_path):
    assert any("by their histories" in note for note in read_recording(write_no_header(tmp_path)).notes)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("time,command,command_filtered,measured", None),
        ("time,cmd_1,cmd_2,measured", "Several columns could be the command"),
        ("time,command,command,measured", "Two columns have the same name"),
    ],
)
def test_ambiguous_columns_are_said(tmp_path, header, message):
    path = text(tmp_path / "t.csv", [header], [TIME, COMMAND, 0.5 * COMMAND, MEASURED])
    if message is None:
        np.testing.assert_allclose(read_recording(path).command, COMMAND, atol=2e-9)
        return
    with pytest.raises(InputError, match=message):
        read_recording(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "rows of at least two numbers"),
        (b"time,command\n", "rows of at least two numbers"),
        (b"\x00\x01\x02\x03binary", "reliab does not read"),
        (b"MATLAB 5.0 broken", "Cannot read the file; found Mat file"),
        (b"\x89HDF\r\n\x1a\nbroken", "Cannot read the file; found Unable"),
        (b"CDF\x01broken", "Cannot read the file"),
        (b"time,command,measured\n0,1,2\n1,2\n", "line 3: 2 columns, but 3 in the first line"),
        (b"time,command,measured\n0,1,2\n1,x,2\n", "line 3, column command: Not a number"),
        (b"time,command,measured\n0,1,2\n1," + b"x" * 400 + b",2\n", "found 'x{40} …'. Correct the line"),
        (b"time,command,measured\n0,1,2\n1,2,2\n", "needs at least 64"),
    ],
)
def test_broken_files_are_explained(tmp_path, content, message):
    path = tmp_path / "t.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_recording(path)


def test_missing_file_is_reported(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: No such file"):
        read_recording(tmp_path / "none.csv")


def test_no_time_is_said(tmp_path):
    path = text(tmp_path / "t.csv", ["command,measured"], [COMMAND, MEASURED])
    with pytest.raises(InputError, match="No times and no sampling rate"):
        read_recording(path)
    assert read_recording(path, rate_hz=RATE).time_step == pytest.approx(1.0 / RATE)


def test_rate_disagreeing_with_times_is_reported(tmp_path):
    with pytest.raises(InputError, match="but the sampling rate is 1024 Hz"):
        read_recording(write_csv(tmp_path), rate_hz=1024.0)


def add_names(data):
    data.attrs["columns"] = ["time", "command", "measured"]
    data.attrs["units"] = ["s", "mm", "mm"]


def add_units_first(data):
    data.attrs["Unit"] = ["s", "mm", "mm"]
    data.attrs["channels"] = [" time", "command ", "measured"]


def add_labels(data):
    scale = data.file.create_dataset("names", data=["time", "command", "measured"], dtype=h5py.string_dtype())
    scale.make_scale("names")
    data.dims[data.shape.index(3)].attach_scale(scale)
    data.attrs["units"] = ["s", "mm", "mm"]


@pytest.mark.parametrize("name_columns", [add_names, add_units_first, add_labels])
@pytest.mark.parametrize("upright", [True, False])
def test_columns_of_a_matrix_in_hdf5_are_named_beside_it(tmp_path, name_columns, upright):
    columns = np.array([TIME, 1e3 * COMMAND, 1e3 * MEASURED])
    with h5py.File(tmp_path / "t.h5", "w") as file:
        data = file.create_dataset("daq/samples", data=columns.T if upright else columns)
        name_columns(data)
    result = read_recording(tmp_path / "t.h5")
    np.testing.assert_allclose(result.command, COMMAND, atol=1e-12)
    np.testing.assert_allclose(result.measured, MEASURED, atol=1e-12)


def test_unit_of_a_matrix_applies_to_each_column(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["rate"] = RATE
        data = file.create_dataset("samples", data=1e3 * np.array([COMMAND, MEASURED]).T)
        data.attrs["columns"] = ["command", "measured"]
        data.attrs["units"] = ["mm"]
    result = read_recording(tmp_path / "t.h5")
    assert result.time_step == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(result.command, COMMAND, atol=1e-12)
    np.testing.assert_allclose(result.measured, MEASURED, atol=1e-12)


@pytest.mark.parametrize("labels", [["command", "command"], ["command"]])
def test_nameless_matrix_columns_are_recognised_by_behaviour(tmp_path, labels):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["rate"] = RATE
        file.create_dataset("samples", data=np.array([COMMAND, MEASURED]).T).attrs["columns"] = labels
    result = read_recording(tmp_path / "t.h5")
    assert any("by their histories" in note for note in result.notes)
    np.testing.assert_allclose(result.command, COMMAND, atol=1e-12)


def test_a_header_states_the_skew_of_the_channels(tmp_path):
    file = text(tmp_path / "t.csv", ["# skew_ms: 0.2+-0.05", "time_s,command_m,measured_m"], COLUMNS.values())
    rows = next(rows_as_written(iter([file.read_bytes()]), name=file.name, declarations={}))
    assert read_recording(file).stated == rows.stated == {"skew": StatedValue(0.2, 0.05)}


@pytest.mark.parametrize(
    ("ending", "factor", "notes"), [("_mrad", 1e-3, 0), ("_deg", np.pi / 180.0, 0), ("", 1.0, 1)]
)
def test_a_rotation_needs_no_unit_of_length(ending, factor, notes):
    columns = {"time_s": TIME, "command_1_mm": 1e3 * COMMAND, "measured_1_mm": 1e3 * MEASURED}
    rotation = {
        f"{name}_2{ending}": values for name, values in (("command", COMMAND), ("measured", MEASURED))
    }
    result = read_recording(pd.DataFrame({**columns, **rotation}), several=True)
    assert sum("of actuator 2 states a unit of length" in note for note in result.notes) == notes
    np.testing.assert_allclose(result.command, [COMMAND, factor * COMMAND], atol=1e-12)
