"""One test in every layout in which laboratories keep theirs; each function writes a file.

The files are made as the programs make them: text line by line, MATLAB by SciPy and mat-io, HDF5 by h5py,
TDMS by npTDMS.
"""

import warnings

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import netcdf_file, savemat

RATE = 256.0
SIZE = 2048
TIME = np.arange(SIZE) / RATE
_RANDOM = np.random.default_rng(3)


def _motion(time):
    return 0.02 * np.sin(2.0 * np.pi * 0.9 * time) * np.exp(-time / 9.0) + 0.004 * np.sin(
        2.0 * np.pi * 2.3 * time
    )


COMMAND = _motion(TIME)
MEASURED = 0.997 * _motion(TIME - 0.006) + 2e-6 * _RANDOM.normal(size=SIZE)
FORCE = 4e4 * MEASURED + 300.0 * np.gradient(MEASURED, 1.0 / RATE) + 5.0 * _RANDOM.normal(size=SIZE)
GROUND = _RANDOM.normal(size=SIZE)
VALVE = 0.5 * np.gradient(COMMAND, 1.0 / RATE)
COLUMNS = [TIME, 1e3 * COMMAND, 1e3 * MEASURED, 1e-3 * FORCE]  # s, mm, mm and kN


def _rows(columns, delimiter=",", *, decimal="."):
    cells = (
        delimiter.join(f"{cell:.12g}".replace(".", decimal) for cell in row)
        for row in zip(*columns, strict=True)
    )
    return "\n".join(cells)


def _text(path, header, columns, delimiter=",", *, decimal=".", encoding="utf-8", end="\n"):
    content = f"{header}\n{_rows(columns, delimiter, decimal=decimal)}\n"
    path.write_bytes(content.replace("\n", end).encode(encoding))
    return path


def csv_with_units_in_brackets(folder):
    header = "Time (sec),Voltage command,Dis command (mm),Dis feedback (mm),Load cell (kN)"
    return _text(folder / "t.csv", header, [TIME, 10.0 * VALVE, 1e3 * COMMAND, 1e3 * MEASURED, 1e-3 * FORCE])


def semicolons_and_decimal_comma(folder):
    header = "Zeit [s];Sollweg [mm];Istweg [mm];Kraft [kN]"
    return _text(folder / "t.csv", header, COLUMNS, ";", decimal=",", encoding="latin-1", end="\r\n")


def tabs_units_below_utf_16(folder):
    header = "Rig 3\nOperator: N. N.\n\nTime\tTarget\tActual\tForce\ns\tmm\tmm\tN"
    return _text(
        folder / "t.txt", header, [TIME, 1e3 * COMMAND, 1e3 * MEASURED, FORCE], "\t", encoding="utf-16"
    )


def blanks_and_long_preamble(folder):
    header = "\n".join([f"Setting {k} of the controller" for k in range(60)] + ["time_s x_c_mm x_m_mm"])
    return _text(folder / "t.dat", header, COLUMNS[:3], "   ")


def mts_793(folder):
    header = (
        "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Header:\t\tTime:\t0.0039\tSec\t11/24/2026 09:00:00 AM\n"
        "Data Acquisition:\tTimed Data\n\nStation Name:\tRTHS.cfg\n"
        "Time\tCh 1 Axial Displacement Command\tCh 1 Axial Displacement\tCh 1 Axial Disp. Error\t"
        "Ch 1 Axial Force\tServovalve Command\nSec\tmm\tmm\tmm\tkN\tV"
    )
    columns = [TIME, 1e3 * COMMAND, 1e3 * MEASURED, 1e3 * (COMMAND - MEASURED), 1e-3 * FORCE, VALVE]
    return _text(folder / "specimen.dat", header, columns, "\t", end="\r\n")


def labview_measurement(folder):
    header = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
        "Multi_Headings\tYes\nX_Columns\tOne\nTime_Pref\tRelative\nOperator\tlab\nDate\t2026/11/24\n***End_of_Header***\t\n\t\n"
        "Channels\t3\nSamples\t2048\t2048\t2048\nDate\t2026/11/24\t2026/11/24\t2026/11/24\n"
        "Y_Unit_Label\tmm\tmm\tkN\nX_Dimension\tTime\tTime\tTime\nX0\t0\t0\t0\nDelta_X\t0,00390625\t0,00390625\t0,00390625\n"
        "***End_of_Header***\t\t\t\nX_Value\tDisp Setpoint\tLVDT\tLoad\tComment"
    )
    return _text(folder / "t.lvm", header, COLUMNS, "\t", decimal=",", end="\r\n")


def labview_measurement_without_times(folder):
    header = (
        "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tNo\nX_Columns\tNo\n"
        "***End_of_Header***\t\n\t\nChannels\t2\nSamples\t2048\t2048\nY_Unit_Label\tMillimeters\tMillimeters\nX0\t0\t0\n"
        "Delta_X\t0.00390625\t0.00390625\n***End_of_Header***\t\t\nX_Value\tcmd_disp\tmeas_disp\tComment"
    )
    rows = _rows([1e3 * COMMAND, 1e3 * MEASURED], "\t").replace("\n", "\n\t")
    (folder / "t.lvm").write_text(f"{header}\n\t{rows}\n", encoding="utf-8")
    return folder / "t.lvm"


def time_of_day_and_remarks(folder):
    lines = ["Timestamp,Remark,Commanded (in),Achieved (in)"]
    for t, c, m in zip(TIME, COMMAND / 0.0254, MEASURED / 0.0254, strict=True):
        lines.append(f"2026-11-24 09:15:{30.0 + t:012.9f},ok,{c:.12g},{m:.12g}")
    (folder / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    return folder / "t.csv"


def matlab_vectors(folder):
    savemat(
        folder / "t.mat",
        {"t": TIME, "disp_cmd": COMMAND, "disp_meas": MEASURED, "force_N": FORCE, "note": "rig 3"},
    )
    return folder / "t.mat"


def matlab_matrix_with_names(folder):
    names = np.array(["Time", "Command", "Feedback", "Load"], dtype=object)
    units = np.array(["sec", "mm", "mm", "kN"], dtype=object)
    matrix = np.column_stack(COLUMNS)
    savemat(folder / "t.mat", {"data": matrix, "channel_names": names, "channel_units": units})
    return folder / "t.mat"


def _capture():
    channels = [
        ('Platform()://HIL/"Model Root"/"Valve Cmd"/Out1', "V", VALVE),
        ('Platform()://HIL/"Model Root"/Actuator/x_desired/Out1', "mm", 1e3 * COMMAND),
        ('Platform()://HIL/"Model Root"/Actuator/x_measured/Out1', "mm", 1e3 * MEASURED),
        ('Platform()://HIL/"Model Root"/Specimen/Force/Out1', "kN", 1e-3 * FORCE),
    ]
    dtype = [(name, object) for name in ("Name", "Type", "Data", "Unit", "XIndex")]
    ys = np.array([(name, 1, data.astype(np.float32), unit, 1) for name, unit, data in channels], dtype=dtype)
    xs = np.array([("Time", 4, TIME)], dtype=[(name, object) for name in ("Name", "Type", "Data")])
    return {
        "X": xs,
        "Y": ys,
        "Capture": {"SamplingPeriod": 1.0 / RATE, "Downsampling": 1},
        "RTProgram": "rths.sdf",
    }


def dspace(folder):
    savemat(folder / "rths_001.mat", {"rths_001": _capture()}, do_compression=True)
    return folder / "rths_001.mat"


def xpc(folder):
    data = np.zeros(1, dtype=[("values", object), ("time", object)])
    data[0] = (np.column_stack([TIME, COMMAND, MEASURED, FORCE]), TIME)
    savemat(folder / "t.mat", {"data": data})
    return folder / "t.mat"


def simulink_structure_with_time(folder):
    signals = np.array(
        [
            (COMMAND, "target displacement", "m/cmd"),
            (MEASURED, "actuator displacement", "m/pos"),
            (FORCE, "force", "m/f"),
        ],
        dtype=[(name, object) for name in ("values", "label", "blockName")],
    )
    savemat(folder / "t.mat", {"ScopeData": {"time": TIME, "signals": signals, "blockName": "rths/Scope"}})
    return folder / "t.mat"


def simulink_array_per_signal(folder):
    savemat(
        folder / "t.mat", {"tout": TIME, "xc": np.column_stack([COMMAND]), "xm": np.column_stack([MEASURED])}
    )
    return folder / "t.mat"


def _save_objects(path, variables, version):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        matio = pytest.importorskip("matio")  # without a wheel for Python 3.14
        matio.save_to_mat(str(path), variables, version=version)
    return path


def _timetable():
    index = pd.to_timedelta(np.round(TIME * 1e9).astype(np.int64), unit="ns")
    table = pd.DataFrame({"CommandDisp": COMMAND, "MeasuredDisp": MEASURED, "Force": FORCE}, index=index)
    table.index.name = "Time"
    return table


def timetable(folder):
    return _save_objects(folder / "t.mat", {"log": _timetable()}, "v7")


def timetable_73(folder):
    return _save_objects(folder / "t.mat", {"log": _timetable()}, "v7.3")


def timeseries(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from matio.utils.matclass import MatlabOpaque

    def series(name, values):
        about = {"Time": TIME[:, np.newaxis], "Data": values[:, np.newaxis], "Name": np.array([name])}
        return MatlabOpaque(properties=about, classname="timeseries")

    content = {"d": series("desired disp", COMMAND), "m": series("feedback disp", MEASURED)}
    return _save_objects(folder / "t.mat", content, "v7")


def timeseries_as_saved(folder):
    """Names with which MATLAB saves properties, and equal steps without any vector of times."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from matio.utils.matclass import MatlabOpaque
    nothing = np.zeros((0, 0))

    def series(name, values, unit, steps):
        times = {"Time_": nothing, "Start_": np.array([[0.0]]), "Increment_": np.array([[1e3 / RATE]])}
        if not steps:
            times = {
                "Time_": 1e3 * TIME[:, np.newaxis],
                "Start_": nothing,
                "Increment_": np.array([[np.nan]]),
            }
        times |= {"Length": np.array([[float(SIZE)]]), "Units": np.array(["milliseconds"])}
        about = {
            "Name": np.array([name]),
            "Time": nothing,
            "Data": nothing,
            "Data_": values[:, np.newaxis],
            "TimeInfo": MatlabOpaque(properties=times, classname="tsdata.timemetadata"),
            "DataInfo": MatlabOpaque(properties={"Units": np.array([unit])}, classname="tsdata.datametadata"),
            "IsTimeFirst_": np.array([[True]]),
        }
        return MatlabOpaque(properties=about, classname="timeseries")

    content = {
        "d": series("desired disp", 1e3 * COMMAND, "mm", steps=True),
        "m": series("feedback disp", 1e3 * MEASURED, "mm", steps=False),
        "f": series("load cell", 1e-3 * FORCE, "kN", steps=True),
    }
    return _save_objects(folder / "t.mat", content, "v7")


def _matlab_73(path, fill):
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(512, b" "))
    return path


def _store(file, place, values, kind="double"):
    file[place] = values
    file[place].attrs["MATLAB_class"] = np.bytes_(kind)
    return file[place]


def _characters(file, place, text):
    return _store(file, place, np.array([[ord(letter)] for letter in text], dtype=np.uint16), "char")


def matlab_73_vectors(folder):
    def fill(file):
        for name, values in (("time", TIME), ("Cmd", COMMAND), ("Fbk", MEASURED)):
            _store(file, name, values[np.newaxis])

    return _matlab_73(folder / "t.mat", fill)


def dspace_73(folder):
    def fill(file):
        capture = file.create_group("rths_001")
        capture.attrs["MATLAB_class"] = np.bytes_("struct")
        x = capture.create_group("X")
        x.attrs["MATLAB_class"] = np.bytes_("struct")
        _store(file, "rths_001/X/Data", TIME[:, np.newaxis])
        y = capture.create_group("Y")
        y.attrs["MATLAB_class"] = np.bytes_("struct")
        content = (("disp_target", COMMAND), ("disp_actual", MEASURED))
        names = [_characters(file, f"#refs#/n{k}", name).ref for k, (name, _) in enumerate(content)]
        data = [
            _store(file, f"#refs#/d{k}", values[:, np.newaxis]).ref for k, (_, values) in enumerate(content)
        ]
        y.create_dataset("Name", data=np.array([names], dtype=h5py.ref_dtype).T, dtype=h5py.ref_dtype)
        y.create_dataset("Data", data=np.array([data], dtype=h5py.ref_dtype).T, dtype=h5py.ref_dtype)

    return _matlab_73(folder / "t.mat", fill)


def hdf5_groups(folder):
    with h5py.File(folder / "t.h5", "w") as file:
        for name, values, unit in (
            ("daq/Actuator 1/Command", 1e3 * COMMAND, "mm"),
            ("daq/Actuator 1/Position", 1e3 * MEASURED, "mm"),
            ("daq/Actuator 1/Force", 1e-3 * FORCE, "kN"),
        ):
            file[name] = values
            file[name].attrs["unit"] = unit
        file["daq"].attrs["sampling_rate"] = RATE
    return folder / "t.h5"


def tdms(folder):
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    waveform = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0}
    with TdmsWriter(str(folder / "t.tdms")) as writer:
        channels = [
            ChannelObject("Measured Data", name, values, properties={**waveform, "unit_string": unit})
            for name, values, unit in (
                ("Servo valve", VALVE, "V"),
                ("Disp Reference", 1e3 * COMMAND, "mm"),
                ("Temposonic", 1e3 * MEASURED, "mm"),
                ("Load Cell", 1e-3 * FORCE, "kN"),
            )
        ]
        writer.write_segment([RootObject({"Author": "lab"}), GroupObject("Measured Data"), *channels])
    return folder / "t.tdms"


def tdms_with_times(folder):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(folder / "t.tdms")) as writer:
        for begin in range(0, SIZE, 512):  # in pieces, as a logger writes
            piece = slice(begin, begin + 512)
            content = (("Time", TIME), ("Target (m)", COMMAND), ("Response (m)", MEASURED))
            writer.write_segment([ChannelObject("Log", name, values[piece]) for name, values in content])
    return folder / "t.tdms"


def classic_netcdf(folder):
    with netcdf_file(folder / "t.nc", "w") as file:
        file.createDimension("time", SIZE)
        for name, values, unit in (
            ("time", TIME, "s"),
            ("commanded", COMMAND, "m"),
            ("measured", MEASURED, "m"),
        ):
            variable = file.createVariable(name, "d", ("time",))
            variable[:] = values
            variable.units = unit
    return folder / "t.nc"


def record(folder):
    from reliab.recordings.record import record_test, write_record

    dataset, _ = record_test(csv_with_units_in_brackets(folder))
    write_record(dataset, folder / "t.nc")
    return folder / "t.nc"


def mts_test_suite(folder):
    header = (
        '"Run Time","Axial Displacement Command","Axial Displacement","Axial Force"\n'
        '"Timer","Axial Disp Cmd","Axial Disp Fbk","Axial Force Fbk"\n"sec","mm","mm","kN"'
    )
    return _text(folder / "t.csv", header, COLUMNS)


def labview_measurement_of_several_clocks(folder):
    header = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
        "Multi_Headings\tYes\nX_Columns\tMulti\nTime_Pref\tAbsolute\nDate\t2026/01/02\n***End_of_Header***\t\n\t\n"
        "Channels\t2\t\t\t\nSamples\t2048\t\t2048\nY_Unit_Label\tmm\t\tmm\nX_Dimension\tTime\t\tTime\nX0\t0.0\t\t0.0\n"
        "Delta_X\t0.00390625\t\t0.00390625\n***End_of_Header***\t\t\t\t\n"
        "X_Value\tDisp Cmd\tX_Value\tDisp Fbk\tComment"
    )
    return _text(folder / "t.lvm", header, [TIME, 1e3 * COMMAND, TIME, 1e3 * MEASURED], "\t")


def dewesoft(folder):
    header = "DEWESoft X\nSample rate: 256 Hz\n\nTime (s);Cmd Disp (mm);LVDT (mm);Load cell (kN)"
    return _text(folder / "t.csv", header, COLUMNS, ";", decimal=",")


def catman(folder):
    header = (
        "HBM_CATMAN_DATAFILE\t5.0\n24.11.2026\t10:00:00\n"
        "Time  1 - default sample rate\tWeg Soll\tWeg Ist\tKraft\n"
        "[s]\t[mm]\t[mm]\t[kN]\nMX440 CH1\tMX440 CH2\tMX440 CH3\tMX440 CH4\nSampleRate\t256\t256\t256\n"
    )
    return _text(folder / "t.asc", header, COLUMNS, "\t", decimal=",", encoding="latin-1")


def nees_with_units_above(folder):
    header = (
        "Active channels:\tTime,DispCmd,LVDT1,LC1\nSample rate:\t256.0000\nChannel units:\tsec,mm,mm,kN\n\n"
        "Time\tDispCmd\tLVDT1\tLC1\nsec\tmm\tmm\tkN"
    )
    return _text(folder / "t.txt", header, COLUMNS, "\t")


def excel_with_dates(folder):
    lines = ["Zeitstempel;Sollweg [mm];Istweg [mm]"]
    for t, c, m in zip(TIME, 1e3 * COMMAND, 1e3 * MEASURED, strict=True):
        cells = ";".join(f"{number:.12g}".replace(".", ",") for number in (c, m))
        lines.append(f"24.11.2026 10:00:{t:012.9f};" + cells)
    (folder / "t.csv").write_text("\n".join(lines), encoding="utf-8")
    return folder / "t.csv"


def pacific_instruments(folder):
    header = (
        "Pacific Instruments PI660\nTest: RTHS1\nChannel,1,2,3,4\n"
        "Description,Time,Actuator Command,Actuator Position,Actuator Load\nUnits,sec,in,in,kip"
    )
    columns = [np.arange(SIZE), TIME, COMMAND / 0.0254, MEASURED / 0.0254, FORCE / 4448.2216152605]
    return _text(folder / "t.csv", header, columns)


def matlab_4(folder):
    savemat(folder / "t.mat", {"t": TIME, "disp_cmd": COMMAND, "disp_meas": MEASURED}, format="4")
    return folder / "t.mat"


def simulink_array(folder):
    savemat(folder / "t.mat", {"simout": np.column_stack([TIME, COMMAND, MEASURED, FORCE])})
    return folder / "t.mat"


def save_logged_signals(folder):
    signals = np.array(
        [
            (name, {"Time": TIME, "Data": values})
            for name, values in (("u_cmd", COMMAND), ("u_meas", MEASURED), ("F_meas", FORCE))
        ],
        dtype=[("Name", object), ("Values", object)],
    )
    savemat(folder / "t.mat", {"logsout": signals})
    return folder / "t.mat"


def save_logsout(folder):
    """`logsout` of Simulink: an object of signals, each with a name and a `timeseries` without one."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from matio.utils.matclass import MatlabOpaque
    signals = np.empty((1, 3), dtype=object)
    for place, (name, values) in enumerate(
        (("disp_cmd", COMMAND), ("disp_meas", MEASURED), ("force", FORCE))
    ):
        about = {"Time": TIME[:, np.newaxis], "Data": values[:, np.newaxis], "Name": np.array([""])}
        series = MatlabOpaque(properties=about, classname="timeseries")
        signals[0, place] = MatlabOpaque(
            properties={"Name": np.array([name]), "Values": series},
            classname="Simulink.SimulationData.Signal",
        )
    log_record = MatlabOpaque(
        properties={"Name": np.array(["logsout"]), "Elements": signals},
        classname="Simulink.SimulationData.Dataset",
    )
    return _save_objects(folder / "t.mat", {"logsout": log_record}, "v7.3")


def signal_express(folder):
    """TDMS of SignalExpress: the test beside thinned copies of it, as in npTDMS's Digital_Input.tdms."""
    from nptdms import ChannelObject, TdmsWriter

    channels = [
        ChannelObject(f"07/09/2026 - Voltage - {name}", channel, values[::interval], properties=step)
        for name, interval in (("All Data", 1), ("Decimated Data_Level1", 8))
        for step in ({"wf_increment": interval / RATE},)
        for channel, values in (("Disp Cmd (m)", COMMAND), ("Disp Fbk (m)", MEASURED))
    ]
    with TdmsWriter(str(folder / "t.tdms")) as writer:
        writer.write_segment(channels)
    return folder / "t.tdms"


def names_in_a_comment_with_a_title(folder):
    header = "# RTHS test 12\n# date: 2026-11-01\n# columns: time[s] x_ref[mm] x_act[mm] F[kN]"
    return _text(folder / "t.dat", header, COLUMNS, " ")


def catman_with_names_below_the_units(folder):
    header = (
        "HBM_CATMAN_DATAFILE_40\nnoname\nCHANNELCOUNT=4\n\nTime  1 - default sample rate\tMX840_0_CH 1\t"
        "MX840_0_CH 2\tMX840_0_CH 3\ns\tmm\tmm\tkN\nSollweg\tIstweg\tKraft"
    )
    return _text(folder / "t.asc", header, COLUMNS, "\t", decimal=",", end="\r\n")


def structures_of_values_beside_their_time(folder):
    channels = (("cmd", 1e3 * COMMAND, "mm"), ("fbk", 1e3 * MEASURED, "mm"), ("force", FORCE, "N"))
    log_record = {name: {"values": values, "unit": unit} for name, values, unit in channels}
    savemat(folder / "t.mat", {"rec": {"time": TIME, **log_record}})
    return folder / "t.mat"


def simulink_output_beside_its_time(folder):
    names = np.array(["xd (m)", "xm (m)", "Fm (N)"], dtype=object)
    savemat(
        folder / "t.mat", {"tout": TIME, "yout": np.column_stack([COMMAND, MEASURED, FORCE]), "labels": names}
    )
    return folder / "t.mat"


def hdf5_table(folder):
    with h5py.File(folder / "t.h5", "w") as file:
        file["data"] = np.rec.fromarrays(
            [TIME, COMMAND, MEASURED, FORCE], names="time_s,u_cmd_m,u_meas_m,f_N"
        )
    return folder / "t.h5"


def hdf5_matrix_with_names_as_attributes(folder):
    with h5py.File(folder / "t.h5", "w") as file:
        matrix = np.column_stack(COLUMNS)
        data = file.create_dataset("daq", data=matrix)
        data.attrs["columns"] = ["time", "disp_cmd", "disp_fbk", "load"]
        data.attrs["units"] = ["s", "mm", "mm", "kN"]
    return folder / "t.h5"


def xarray_with_dates(folder):
    times = pd.date_range("2026-11-24 09:00", periods=SIZE, freq="3906250ns")
    channels = {"command": 1e3 * COMMAND, "measured": 1e3 * MEASURED}
    variables = {name: ("time", values, {"units": "mm"}) for name, values in channels.items()}
    xr.Dataset(variables, coords={"time": times}).to_netcdf(folder / "t.nc", engine="h5netcdf")
    return folder / "t.nc"


def xarray_with_a_dimension_of_channels(folder):
    displacement = (("channel", "time"), np.stack([COMMAND, MEASURED]), {"units": "m"})
    coordinates = {"channel": ["command", "measured"], "time": ("time", TIME, {"units": "s"})}
    xr.Dataset({"displacement": displacement}, coords=coordinates).to_netcdf(
        folder / "t.nc", engine="h5netcdf"
    )
    return folder / "t.nc"


LAYOUTS = tuple(
    item
    for name, item in globals().items()
    if not name.startswith("_") and getattr(item, "__module__", "") == __name__
)
"""Functions above, each of which writes one layout."""
