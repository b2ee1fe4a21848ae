"""Layouts of other programs' files."""

import json
from importlib.util import find_spec
from pathlib import Path

import h5py
import layouts
import numpy as np
import pandas as pd
import pytest
from layouts import COMMAND, FORCE, LAYOUTS, MEASURED, RATE, TIME, dspace, mts_793
from nptdms import TdmsFile

import reliab
from reliab.app import cli
from reliab.core.errors import InputError
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import read_recording

PRECISION = {dspace: 1e-9}
"""Files of single precision."""


@pytest.mark.default_cases(15)
@pytest.mark.parametrize("write", LAYOUTS)
def test_a_test_in_any_layout_is_read_without_an_option(tmp_path, write):
    test = read_recording(write(tmp_path))
    assert test.time_step == pytest.approx(1.0 / RATE, rel=1e-9)
    precision = PRECISION.get(write, 1e-12)
    np.testing.assert_allclose(test.command, COMMAND, atol=precision)
    np.testing.assert_allclose(test.measured, MEASURED, atol=precision)
    if test.force is not None:
        np.testing.assert_allclose(test.force, FORCE, atol=1e-4)
    parts = [str(channel.part) for channel in test.channels]
    assert parts[:2] == ["command", "measured"]
    assert all(channel.reason for channel in test.channels)


def test_blocks_of_one_acquisition_are_joined_and_others_are_tests(tmp_path):
    content = mts_793(tmp_path).read_text(encoding="utf-8")
    rows = content.splitlines()
    names = next(place for place, line in enumerate(rows) if line.startswith("Time\t"))
    upper, table = rows[names - 2 : names + 2], rows[names + 2 :]
    complete = [*rows[: names + 2], *table[:1000], *upper, *table[1000:]]
    (tmp_path / "t.dat").write_text("\n".join(complete), encoding="utf-8")
    np.testing.assert_allclose(read_recording(tmp_path / "t.dat").command, COMMAND, atol=1e-12)
    separate = [*rows[: names + 2], *table[:1000], *upper, *table[:900]]
    (tmp_path / "t.dat").write_text("\n".join(separate), encoding="utf-8")
    with pytest.raises(InputError, match="The file holds several tests: 1, 2"):
        read_recording(tmp_path / "t.dat")
    assert read_recording(tmp_path / "t.dat", test="2").command.size == 900


def test_groups_of_the_same_names_are_tests(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        for name, factor in (("run 1", 1.0), ("run 2", 2.0)):
            for channel, values in (
                ("time", TIME),
                ("command", factor * COMMAND),
                ("measured", factor * MEASURED),
            ):
                file[f"{name}/{channel}"] = values
    with pytest.raises(InputError, match="several tests: run 1, run 2"):
        read_recording(tmp_path / "t.h5")
    np.testing.assert_array_equal(read_recording(tmp_path / "t.h5", test="run 2").command, 2.0 * COMMAND)


def test_a_header_with_numbers_between_blocks_of_one_acquisition_is_left_out(tmp_path):
    rows = mts_793(tmp_path).read_text(encoding="utf-8").splitlines()
    names = next(place for place, line in enumerate(rows) if line.startswith("Time\t"))
    title = "Data Acquisition\t\t\tTime:\t12.0\tSec\t5/5/2026 10:00:05 AM"
    upper, table = [title, *rows[names : names + 2]], rows[names + 2 :]
    complete = [*rows[:names], *upper, *table[:1000], *upper, *table[1000:]]
    (tmp_path / "t.dat").write_text("\n".join(complete), encoding="utf-8")
    np.testing.assert_allclose(read_recording(tmp_path / "t.dat").command, COMMAND, atol=1e-12)


def lvm_of(separator, decimal, comment=""):
    """A file of LabVIEW with other separators, and a comment in one of its rows."""
    header = ["LabVIEW Measurement", "Separator|" + {",": "Comma", ";": "Semicolon", "\t": "Tab"}[separator]]
    header += [f"Decimal_Separator|{decimal}", "X_Columns|One", "***End_of_Header***|", ""]
    header += ["Channels|2|", "Samples|2048|2048", "Y_Unit_Label|m|m", "X0|0|0"]
    header += [f"Delta_X|{1.0 / RATE}|{1.0 / RATE}", "***End_of_Header***||"]
    rows = [f"{t:.9g}|{c:.15g}|{m:.15g}" for t, c, m in zip(TIME, COMMAND, MEASURED, strict=True)]
    lines = [*header, "X_Value|Command|Measured|Comment", *rows]
    lines = [line.replace(".", decimal).replace("|", separator) for line in lines]
    lines[500] += f"{separator}{comment}"
    return lines


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", ","), ("\t", ","), ("\t", ".")])
@pytest.mark.parametrize("comment", ["", "valve opened, 3 of 4"])
def test_labview_files_of_any_separators_with_comments(tmp_path, separator, decimal, comment):
    path = tmp_path / "t.lvm"
    path.write_text("\n".join(lvm_of(separator, decimal, comment)), encoding="utf-8")
    test = read_recording(path)
    np.testing.assert_allclose(test.command, COMMAND, atol=1e-12)
    np.testing.assert_allclose(test.measured, MEASURED, atol=1e-12)


def test_a_broken_row_of_labview_is_named_by_its_line_in_the_file(tmp_path):
    lines = lvm_of("\t", ".")
    lines[700] = f"x{lines[700]}"
    (tmp_path / "t.lvm").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match=r"t\.lvm, line 701, column X_Value 0: Not a number"):
        read_recording(tmp_path / "t.lvm")


def data_of(package, *lower):
    folder = Path(find_spec(package).origin).parent.joinpath(*lower)
    if not folder.is_dir():
        pytest.skip(f"{package} was installed without the data of its tests")
    return folder


SCIPY_FILES = sorted((Path(find_spec("scipy.io").origin).parent / "matlab" / "tests" / "data").glob("*.mat"))
THETA = np.arange(9) * np.pi / 4.0


@pytest.mark.parametrize(
    "name",
    [
        "testdouble_4.2c_SOL2.mat",
        "testdouble_6.1_SOL2.mat",
        "testdouble_6.5.1_GLNX86.mat",
        "testdouble_7.1_GLNX86.mat",
        "testdouble_7.4_GLNX86.mat",
        "testhdf5_7.4_GLNX86.mat",
        "testmulti_7.1_GLNX86.mat",
        "testmulti_7.4_GLNX86.mat",
    ],
)
def test_vectors_saved_by_matlab(name):
    (test,) = read_tests(data_of("scipy.io", "matlab", "tests", "data") / name)
    variable = "theta" if "multi" in name else "testdouble"  # beside other variables
    np.testing.assert_allclose(test.values[variable], THETA, rtol=1e-15)


@pytest.mark.parametrize("release", ["6.1_SOL2", "6.5.1_GLNX86", "7.1_GLNX86", "7.4_GLNX86"])
def test_structure_fields_and_cells_saved_by_matlab(release):
    folder = data_of("scipy.io", "matlab", "tests", "data")
    (structure,) = read_tests(folder / f"teststruct_{release}.mat")
    np.testing.assert_allclose(
        structure.values["teststruct.doublefield"], [np.sqrt(2.0), np.e, np.pi], rtol=1e-15
    )
    (cells,) = read_tests(folder / f"testcell_{release}.mat")
    np.testing.assert_array_equal(cells.values["testcell(4)"], [1.0, 2.0, 3.0])


@pytest.mark.parametrize("path", SCIPY_FILES, ids=lambda path: path.name)
def test_other_files_saved_by_matlab_are_no_tests(path):
    """None of them is one: each gives one sentence, and no warning."""
    with pytest.raises(InputError):
        read_recording(path)


@pytest.mark.parametrize("name", ["raw1.tdms", "big_endian.tdms", "Digital_Input.tdms"])
def test_channels_written_by_labview(name):
    path = data_of("nptdms", "test", "data") / name
    (test,) = read_tests(path)
    group = TdmsFile.read(path).groups()[0]  # of SignalExpress the test; thinned copies stand behind it
    for channel in group.channels():
        np.testing.assert_array_equal(test.values[channel.name], channel[:])
        assert np.diff(test.series[channel.name].times) == pytest.approx(channel.properties["wf_increment"])
        assert test.units.get(channel.name, "") == channel.properties.get("unit_string", "")


FIRST = (layouts.mts_793, layouts.dspace, layouts.tdms, layouts.xpc)


@pytest.mark.parametrize(
    ("encoding", "header"),
    [
        ("cp932", "時間(秒),指令変位(mm),計測変位(mm),荷重(kN)"),
        ("gb18030", "时间(s),命令位移(mm),实测位移(mm),荷载(kN)"),
        ("big5", "時間(s),命令位移(mm),實測位移(mm),荷載(kN)"),
        ("euc_kr", "시간(s),명령변위(mm),측정변위(mm),하중(kN)"),
        ("latin-1", "Temps (s),Déplacement commandé (mm),Déplacement mesuré (mm),Force (kN)"),
    ],
)
def test_names_are_read_in_the_encodings_of_their_countries(tmp_path, encoding, header):
    path, names = tmp_path / "t.csv", header.split(",")
    pd.DataFrame(dict(zip(names, layouts.COLUMNS, strict=True))).to_csv(path, index=False, encoding=encoding)
    recording = read_recording(path)
    assert recording.measured == pytest.approx(MEASURED, abs=1e-9)
    assert recording.force == pytest.approx(FORCE, rel=1e-9)
    assert [channel.column for channel in recording.channels if channel.unit == "kN"] == names[3:]


def test_names_in_a_labview_file_are_read_in_shift_jis(tmp_path):
    path = layouts.labview_measurement(tmp_path)
    text = path.read_text(encoding="utf-8").replace("Disp Setpoint", "指令変位").replace("LVDT", "計測変位")
    path.write_bytes(text.encode("cp932"))
    recording = read_recording(path)
    assert [channel.column for channel in recording.channels[:2]] == ["指令変位", "計測変位"]
    assert recording.measured == pytest.approx(MEASURED, abs=1e-9)


@pytest.fixture(scope="module")
def reference_verdict(tmp_path_factory):
    """Verdict on the test with its force, and on its two displacements alone."""
    folder = tmp_path_factory.mktemp("t")
    complete = assess_file(layouts.matlab_vectors(folder))
    columns = {"time_s": layouts.TIME, "command_m": layouts.COMMAND, "measured_m": layouts.MEASURED}
    return {True: complete, False: assess_file(pd.DataFrame(columns))}


def assess_file(path):
    return reliab.assess(path, f=1.0, xi=0.02).to_dict()


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    "write",
    [pytest.param(write, marks=[] if write in FIRST else pytest.mark.slow) for write in layouts.LAYOUTS],
)
def test_verdict_is_the_same_for_every_layout(tmp_path, write, reference_verdict):
    """To 1e-6; the ends of the interval and the probability, of which text has 12 digits, to 5e-6."""
    answer = assess_file(write(tmp_path))
    has_force = any(channel["channel"] == "force" for channel in answer["recording"]["channels"])
    reference_verdict = reference_verdict[has_force]
    for name in ("A", "d_ms"):
        assert answer[name] == pytest.approx(reference_verdict[name], rel=1e-6)
    rms = {
        key: pytest.approx(reference_verdict["error"]["rms"][key], rel=1e-6, abs=5e-6)
        for key in ("low", "high")
    }
    rms["value"] = pytest.approx(reference_verdict["error"]["rms"]["value"], rel=1e-6)
    assert {key: answer["error"]["rms"][key] for key in rms} == rms
    assert answer["verdict"] == reference_verdict["verdict"]
    assert answer["probability"] == pytest.approx(reference_verdict["probability"], abs=5e-6)


def test_command_and_python_give_the_same_numbers(tmp_path, capsys):
    path = layouts.tdms(tmp_path)
    assert cli.run(["assess", str(path), "--f", "1.0", "--xi", "0.02", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    answer = json.loads(json.dumps(assess_file(path), default=str))
    for name in ("verdict", "A", "d_ms", "probability", "error"):
        assert content[name] == answer[name]
