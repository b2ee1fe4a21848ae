"""The same test comes back from every layout, and what was recognised is stated."""

import h5py
import numpy as np
import pytest
from layouts import COMMAND, FORCE, LAYOUTS, MEASURED, RATE, TIME, dspace, mts_793

from reliab.core.errors import InputError
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
    above, table = rows[names - 2 : names + 2], rows[names + 2 :]
    whole = [*rows[: names + 2], *table[:1000], *above, *table[1000:]]
    (tmp_path / "t.dat").write_text("\n".join(whole), encoding="utf-8")
    np.testing.assert_allclose(read_recording(tmp_path / "t.dat").command, COMMAND, atol=1e-12)
    apart = [*rows[: names + 2], *table[:1000], *above, *table[:900]]
    (tmp_path / "t.dat").write_text("\n".join(apart), encoding="utf-8")
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
    above, table = [title, *rows[names : names + 2]], rows[names + 2 :]
    whole = [*rows[:names], *above, *table[:1000], *above, *table[1000:]]
    (tmp_path / "t.dat").write_text("\n".join(whole), encoding="utf-8")
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
