"""The clock of a channel is part of its data: where a file says that one began later, its motion is later.

The measured motion is that of the command 2 ms before, read from `LATE` on: whoever ignores its begin finds a
lead of 13.6 ms. The delay is estimated by a cross-spectrum of the test, not by the package.
"""

import warnings

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import netcdf_file, savemat

from reliab.core.errors import InputError
from reliab.recordings.reading import read_recording

RATE, SIZE, LATE, DELAY = 1024.0, 8192, 0.0156, 2e-3
TIME = np.arange(SIZE) / RATE
BEGIN, LATER = "2026-05-05 10:00:00", "2026-05-05 10:00:00.0156"


def motion(time):
    return 0.02 * np.sin(5.6 * time) * np.exp(-time / 9.0) + 0.004 * np.sin(14.0 * time)


COMMAND = motion(TIME)
MEASURED = motion(TIME + LATE - DELAY)


def delay_of(command, reading, step):
    window = np.hanning(command.size)
    frequency = np.fft.rfftfreq(command.size, step)
    x, y = (np.fft.rfft((values - values.mean()) * window) for values in (command, reading))
    band = (frequency > 0.5) & (frequency < 4.0)
    lag = -np.angle(y[band] / x[band]) / (2.0 * np.pi * frequency[band])
    return float(np.average(lag, weights=np.abs(x[band]) ** 2))


def tdms(folder, command_part, measured_part, values=MEASURED):
    from nptdms import ChannelObject, TdmsWriter

    common = {"wf_increment": 1.0 / RATE, "unit_string": "m"}
    with TdmsWriter(str(folder / "t.tdms")) as writer:
        content = (("Command", COMMAND, command_part), ("Measured", values, measured_part))
        writer.write_segment(
            [ChannelObject("Log", name, v, properties={**common, **p}) for name, v, p in content]
        )
    return folder / "t.tdms"


def tdms_start_time(folder):
    begins = (np.datetime64(BEGIN, "us"), np.datetime64(LATER, "us"))
    return tdms(folder, *({"wf_start_time": begin, "wf_start_offset": 0.0} for begin in begins))


def tdms_start_offset(folder):
    return tdms(folder, {"wf_start_offset": 0.0}, {"wf_start_offset": LATE})


def tdms_negative_start_offset(folder):
    return tdms(folder, {"wf_start_offset": 0.0}, {"wf_start_offset": -LATE}, motion(TIME - LATE - DELAY))


def lvm(folder, columns, names="X_Value\tCommand\tMeasured\tComment", **header):
    declared_values = {
        "Samples": [SIZE, SIZE],
        "Date": ["2026/05/05"] * 2,
        "Time": ["10:00:00.000"] * 2,
        "Y_Unit_Label": ["m", "m"],
        "X0": [0, 0],
        "Delta_X": [1.0 / RATE, 1.0 / RATE],
        **header,
    }
    layout = declared_values.pop("X_Columns", "One")
    lines = [f"LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\t{layout}\n***End_of_Header***\t\n"]
    lines += [f"{name}\t" + "\t".join(map(str, cells)) for name, cells in declared_values.items()]
    lines += ["***End_of_Header***\t\t", names]
    lines += ["\t".join(f"{cell:.9g}" for cell in row) for row in zip(*columns, strict=True)]
    (folder / "t.lvm").write_text("\n".join(lines).replace("nan", ""), encoding="utf-8")
    return folder / "t.lvm"


NO_TIMES = np.full(SIZE, np.nan)


def lvm_time(folder):
    times = ["10:00:00,000", "10:00:00,0156000000000001"]
    return lvm(folder, [NO_TIMES, COMMAND, MEASURED], Time=times, X_Columns="No")


def lvm_x0_beside_one_column_of_times(folder):
    return lvm(folder, [TIME, COMMAND, MEASURED], X0=[0, LATE])


def lvm_next_day(folder):
    dates, times = ["2026/05/05", "2026/05/06"], ["23:59:59.9944", "00:00:00.0100"]
    return lvm(folder, [NO_TIMES, COMMAND, MEASURED], Date=dates, Time=times, X_Columns="No")


def lvm_times_of_each(folder):
    grid_values = {"Samples": [SIZE, "", SIZE], "Date": ["2026/05/05", "", "2026/05/05"], "X0": [0, "", 0]}
    grid_values |= {"Time": ["10:00:00", "", "10:00:00.0156"], "Y_Unit_Label": ["m", "", "mm"]}
    grid_values |= {"Delta_X": [1.0 / RATE, "", 1.0 / RATE], "X_Columns": "Multi"}
    names = "X_Value\tCommand\tX_Value\tMeasured\tComment"
    return lvm(folder, [TIME, COMMAND, TIME, 1e3 * MEASURED], names, **grid_values)


def hdf5(folder, datasets, groups=()):
    with h5py.File(folder / "t.h5", "w") as file:
        for name, (values, attributes) in datasets.items():
            file[name] = values
            file[name].attrs.update({"units": "m", **attributes})
        for name, attributes in groups:
            file[name].attrs.update(attributes)
    return folder / "t.h5"


def hdf5_step_and_begin(folder):
    step = {"dt": 1.0 / RATE}
    return hdf5(
        folder, {"command": (COMMAND, {**step, "t0": 0.0}), "measured": (MEASURED, {**step, "t0": LATE})}
    )


def hdf5_dates_beside_one_time(folder):
    begins = {"command": (COMMAND, {"start_time": BEGIN}), "measured": (MEASURED, {"start_time": LATER})}
    return hdf5(folder, {"time": (TIME, {"units": "s"}), **begins})


def hdf5_dates_of_groups(folder):
    datasets = {"controller/command": (COMMAND, {}), "logger/measured": (MEASURED, {})}
    dates = (("controller", BEGIN), ("logger", LATER))
    return hdf5(folder, datasets, [(name, {"fs": RATE, "start_time": date}) for name, date in dates])


def hdf5_dates_of_groups_with_times(folder):
    datasets = {"controller/command": (COMMAND, {}), "logger/measured": (MEASURED, {})}
    datasets |= {f"{name}/time": (TIME, {"units": "s"}) for name in ("controller", "logger")}
    dates = (("controller", BEGIN), ("logger", LATER))
    return hdf5(folder, datasets, [(name, {"start_time": date}) for name, date in dates])


def netcdf(folder, units):
    clocks = {"a": (TIME, units[0]), "b": (TIME + (LATE if units[0] == units[1] else 0.0), units[1])}
    dataset = xr.Dataset(
        {"command": ("a", COMMAND, {"units": "m"}), "measured": ("b", MEASURED, {"units": "m"})},
        coords={
            name: (name, values, {"units": unit, "long_name": "time"})
            for name, (values, unit) in clocks.items()
        },
    )
    dataset.rename(a="time_a", b="time_b").to_netcdf(folder / "t.nc", engine="h5netcdf")
    return folder / "t.nc"


def netcdf_times_by_dimension(folder):
    return netcdf(folder, ("s", "s"))


def netcdf_times_since(folder):
    return netcdf(folder, (f"seconds since {BEGIN}", f"seconds since {LATER}"))


def classic_netcdf(folder):
    with netcdf_file(folder / "t.nc", "w") as file:
        for name, values, axis, unit in (
            ("time_a", TIME, "time_a", f"seconds since {BEGIN}"),
            ("time_b", TIME, "time_b", f"seconds since {LATER}"),
            ("command", COMMAND, "time_a", "m"),
            ("measured", MEASURED, "time_b", "m"),
        ):
            if axis not in file.dimensions:
                file.createDimension(axis, SIZE)
            variable = file.createVariable(name, "d", (axis,))
            variable[:], variable.units = values, unit
    return folder / "t.nc"


def simulink(folder):
    log_record = (("command", TIME, COMMAND), ("measured", TIME + LATE, MEASURED))
    scopes = {name: {"time": time, "signals": {"values": v, "label": name}} for name, time, v in log_record}
    savemat(folder / "t.mat", scopes)
    return folder / "t.mat"


def dspace(folder):
    fields = [(name, object) for name in ("Name", "Data", "Unit", "XIndex")]
    y = np.array([("command", COMMAND, "m", 1), ("measured", MEASURED, "m", 2)], dtype=fields)
    x = np.array(
        [(1e3 * TIME, "ms"), (1e3 * (TIME + LATE), "ms")], dtype=[("Data", object), ("Unit", object)]
    )
    savemat(folder / "t.mat", {"run": {"X": x, "Y": y}})
    return folder / "t.mat"


def _objects(path, variables):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        matio = pytest.importorskip("matio")
        matio.save_to_mat(str(path), variables, version="v7")
    return path


def timetables(folder):
    def table(name, values, begin):
        index = pd.Timestamp(begin) + pd.to_timedelta(np.round(1e9 * TIME).astype(np.int64), unit="ns")
        return pd.DataFrame({name: values}, index=index.rename("Time"))

    content = {"a": table("Command", COMMAND, BEGIN), "b": table("Measured", MEASURED, LATER)}
    return _objects(folder / "t.mat", content)


def timeseries_with_dates(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from matio.utils.matclass import MatlabOpaque
    nothing = np.zeros((0, 0))

    def series(name, values, date):
        times = {"Time_": TIME[:, np.newaxis], "Units": np.array(["seconds"]), "StartDate": np.array([date])}
        about = {"Name": np.array([name]), "Time": nothing, "Data": nothing, "Data_": values[:, np.newaxis]}
        about["TimeInfo"] = MatlabOpaque(properties=times, classname="tsdata.timemetadata")
        return MatlabOpaque(properties=about, classname="timeseries")

    dates = ("05-May-2026 10:00:00", "05-May-2026 10:00:00.0156")
    return _objects(
        folder / "t.mat",
        {"c": series("command", COMMAND, dates[0]), "m": series("measured", MEASURED, dates[1])},
    )


def two_columns_of_times(folder):
    header = "Time (s),Command (m),Time (s),Measured (m)"
    return _table(folder, header, TIME, COMMAND, TIME + LATE, MEASURED)


def times_with_roles(folder):
    header = "time_command_s,time_measured_s,command_m,measured_m"
    return _table(folder, header, TIME, TIME + LATE, COMMAND, MEASURED)


def _table(folder, header, *columns):
    np.savetxt(
        folder / "t.csv", np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9g"
    )
    return folder / "t.csv"


LATER_THAN_THE_COMMAND = (
    *(tdms_start_time, tdms_start_offset, tdms_negative_start_offset),
    *(lvm_time, lvm_x0_beside_one_column_of_times, lvm_next_day, lvm_times_of_each),
    *(hdf5_step_and_begin, hdf5_dates_beside_one_time, hdf5_dates_of_groups, hdf5_dates_of_groups_with_times),
    *(netcdf_times_by_dimension, netcdf_times_since, classic_netcdf, simulink, dspace),
    *(timetables, timeseries_with_dates, two_columns_of_times, times_with_roles),
)


@pytest.mark.default_cases(10)
@pytest.mark.parametrize("write", LATER_THAN_THE_COMMAND)
def test_late_channel_is_moved_to_its_start(tmp_path, write):
    test = read_recording(write(tmp_path))
    assert delay_of(test.command, test.measured, test.time_step) == pytest.approx(DELAY, abs=3e-5)
    reading = next(channel for channel in test.channels if channel.part == "measured")
    assert f"begins {1e3 * LATE:g} ms" in " ".join(reading.corrections)
    assert any(f"begins {1e3 * LATE:g} ms" in note for note in test.notes)


@pytest.mark.parametrize("steps", [2, 3, 2.5])
def test_whole_samples_are_moved_without_interpolation(tmp_path, steps):
    test = read_recording(tdms(tmp_path, {"wf_start_offset": 0.0}, {"wf_start_offset": steps / RATE}))
    is_whole = steps == int(steps)
    assert ("interpolated" in " ".join(test.channels[1].corrections)) != is_whole
    assert np.isin(test.measured, MEASURED).all() == is_whole


def test_drift_between_clocks_is_followed():
    times = TIME * (1.0 + 1e-4)
    table = {"time_command_s": TIME, "time_measured_s": times, "command_m": COMMAND}
    test = read_recording(pd.DataFrame({**table, "measured_m": motion(times - DELAY)}))
    assert delay_of(test.command, test.measured, test.time_step) == pytest.approx(DELAY, abs=3e-5)
    assert test.channels[1].corrections == ("interpolated at the samples of 'command_m'",)


def test_unset_labview_times_are_none(tmp_path):
    unset = {"wf_start_time": np.datetime64("1904-01-01", "us")}
    test = read_recording(tdms(tmp_path, unset, unset, motion(TIME - DELAY)))
    assert delay_of(test.command, test.measured, test.time_step) == pytest.approx(DELAY, abs=3e-5)


def test_channel_lacking_the_date_of_another_is_refused(tmp_path):
    begin = {"wf_start_time": np.datetime64(BEGIN, "us")}
    with pytest.raises(
        InputError, match=r"t\.tdms: 'Command' states when it begins, but 'Measured' does not"
    ):
        read_recording(tdms(tmp_path, begin, {}))


@pytest.mark.parametrize(
    ("step", "result"), [(1e-320, "9.99989e-321 s"), (1e-9, "1e-09 s"), (1e6, "1,000,000 s|1e\\+06 s")]
)
def test_implausible_step_is_refused(tmp_path, step, result):
    with pytest.raises(InputError, match=f"must be between 1e-06 and 1,000 s; found ({result})"):
        read_recording(tdms(tmp_path, {"wf_increment": step}, {"wf_increment": step}))


def test_a_waveform_over_anything_but_time_is_refused(tmp_path):
    dimensions = {"wf_xunit_string": "Hz"}
    with pytest.raises(InputError, match="Unknown unit of time: 'Hz'"):
        read_recording(tdms(tmp_path, dimensions, dimensions))


def test_segments_of_one_test_are_joined_and_others_are_tests(tmp_path):
    half = SIZE // 2
    first = lvm(tmp_path, [TIME[:half], COMMAND[:half], MEASURED[:half]], Samples=[half, half])
    first = first.read_text(encoding="utf-8")
    pieces = {}
    for begin in ("10:00:04.000", "10:00:09.000"):
        remainder = [TIME[:half], COMMAND[half:], MEASURED[half:]]
        second = lvm(tmp_path, remainder, Samples=[half, half], Time=[begin] * 2).read_text(encoding="utf-8")
        pieces[begin] = first + "\n\nChannels\t2\n" + second[second.index("Samples") :]
    (tmp_path / "t.lvm").write_text(pieces["10:00:04.000"], encoding="utf-8")
    np.testing.assert_allclose(read_recording(tmp_path / "t.lvm").command, COMMAND, atol=1e-9)
    (tmp_path / "t.lvm").write_text(pieces["10:00:09.000"], encoding="utf-8")
    with pytest.raises(InputError, match="several tests: 1, 2"):
        read_recording(tmp_path / "t.lvm")


def test_an_index_of_times_is_the_clock_of_a_data_frame():
    table = {"command_m": COMMAND, "measured_m": motion(TIME - DELAY)}
    dates = pd.Timestamp(BEGIN, tz="Europe/Rome") + pd.to_timedelta(TIME, unit="s")
    for frame in (
        pd.DataFrame(table, index=pd.to_timedelta(TIME, unit="s")),
        pd.DataFrame({"time": dates, **table}),
        pd.DataFrame({"time_s": TIME, **table}).set_index("time_s"),
    ):
        test = read_recording(frame)
        assert test.time_step == pytest.approx(1.0 / RATE, rel=1e-6)
        np.testing.assert_allclose(test.command, COMMAND, atol=1e-12)
