from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY as G
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions

Write = Callable[[str, str | bytes], Path]
TEXT = "0.1\n-0.2\n0.3\n"


@pytest.fixture
def at2(records: dict[str, str]) -> str:
    return records["record.AT2"]


def test_a_catalogue_names_motions_events_and_sets(at2: str, write: Write) -> None:
    write("near/a.AT2", at2)
    write("b.txt", TEXT)
    folder = write(
        "catalog.csv",
        "motion,event,set,file,dt_s,units,whatever\n"
        "KOBE/A,KOBE,near,near/a.AT2,,,5\n"
        '\n"B, quoted",,,b.txt,0.02,cm/s2,\n',
    ).parent
    suite = load_motions(folder)
    assert suite.names == ("KOBE/A", "B, quoted")
    assert suite.events == ("KOBE", "B, quoted")
    assert suite.set_names == ("near", "")
    assert suite[0].acceleration[0] == pytest.approx(0.1 * G)
    assert (suite[1].time_step, suite[1].peak_acceleration) == (0.02, 0.003)
    assert [motion.event for motion in suite] == list(suite.events)
    assert inspect(folder).faults == []


def test_columns_are_found_in_any_order_and_case(at2: str, write: Write) -> None:
    write("a.AT2", at2)
    folder = write("catalog.csv", "\ufeff File , MOTION\r\na.AT2,x\r\n").parent
    assert load_motions(folder).names == ("x",)


def test_a_true_step_corrects_a_rounded_one(at2: str, write: Write) -> None:
    write("a.AT2", at2.replace(".0050", ".0024"))
    folder = write("catalog.csv", "motion,file,dt_s\nx,a.AT2,0.00244140625\n").parent
    assert load_motions(folder)[0].time_step == 0.00244140625


def test_catalogue_notes_of_header_change_nothing(at2: str, write: Write) -> None:
    write("a.AT2", at2)
    folder = write("catalog.csv", "motion,file,header_dt_s,header_npts\nx,a.AT2,0.005,7\n").parent
    assert load_motions(folder)[0].time_step == 0.005
    assert inspect(folder).faults == []


def test_channels_of_a_file_are_chosen_by_number(records: dict[str, str], write: Write) -> None:
    single = records["record.V2"]
    write("a.V2", single + single.replace("222.25000", "  2.25000"))
    folder = write("catalog.csv", "motion,file,channel\nx,a.V2,2\ny,a.V2,1\n").parent
    peaks = [motion.peak_acceleration for motion in load_motions(folder)]
    assert peaks == pytest.approx([1.234567, 2.2225])


@pytest.mark.parametrize(
    ("table", "line", "rule"),
    [
        ("motion,path\nx,a.AT2\n", 1, "No column file in the catalogue"),
        ("a,b\n", 1, "No column motion and file in the catalogue"),
        ("motion,file\n", 1, "catalogue has no rows"),
        ("motion,file\nx,a.AT2\nx,a.AT2\n", 3, "have the same name; found x, as in line 2"),
        ("motion,file\nx,gone.AT2\n", 2, "gone.AT2 not found"),
        ("motion,file\nx,.\n", 2, "not found"),
        (f"motion,file\nx,{'long' * 1000}\n", 2, "longlong"),
        ("motion,file\n,a.AT2\n", 2, "column motion is empty"),
        ("motion,file\nx\n", 2, "column file is empty"),
        ("motion,file,dt_s\nx,a.AT2,0\n", 2, "Not a positive number in the column dt_s; found 0"),
        ("motion,file,dt_s\nx,a.AT2,fast\n", 2, "Not a positive number in the column dt_s; found fast"),
        ("motion,file,dt_s\nx,a.AT2,nan\n", 2, "Not a positive number in the column dt_s; found nan"),
        ("motion,file,units\nx,a.AT2,ft\n", 2, "Unknown unit of acceleration; found ft"),
        ("motion,file,channel\nx,a.AT2,1.5\n", 2, "Not a whole number in the column channel; found 1.5"),
        ("motion,file,header_npts\nx,a.AT2,-1\n", 2, "Not a positive number in the column header_npts"),
        ("", 1, "is empty"),
        (b"motion,file\nx,\x00\n", 1, "Not a text file"),
    ],
)
def test_a_faulty_catalogue_is_explained(
    table: str | bytes, line: int, rule: str, at2: str, write: Write
) -> None:
    write("a.AT2", at2)
    path = write("catalog.csv", table)
    with pytest.raises(InputError, match=rule) as caught:
        load_motions(path.parent)
    assert str(caught.value).startswith(f"{path}, line {line}: ")
    assert [(fault.file, fault.line) for fault in inspect(path.parent).faults] == [(str(path), line)]


@pytest.mark.parametrize(
    ("column", "value", "line", "rule"),
    [
        ("units", "cm/s2", 3, "found g in the header, cm/s2 in catalog.csv, line 2"),
        ("dt_s", "0.01", 4, "found 0.005 s in the header, 0.01 s in catalog.csv, line 2"),
        ("header_npts", "8", 4, "found 7 in the header, 8 in catalog.csv, line 2"),
        ("header_dt_s", "0.01", 4, "found 0.005 s in the header, 0.01 s in catalog.csv, line 2"),
        ("channel", "2", None, "No such channel in the file; found channel 2 of 1"),
    ],
)
def test_catalogue_contradicting_header_is_refused(
    column: str, value: str, line: int | None, rule: str, at2: str, write: Write
) -> None:
    record = write("a.AT2", at2)
    folder = write("catalog.csv", f"motion,file,{column}\nx,a.AT2,{value}\n").parent
    with pytest.raises(InputError, match=rule):
        load_motions(folder)[0]
    assert [(fault.file, fault.line) for fault in inspect(folder).faults] == [(str(record), line)]


def test_every_faulty_row_is_reported(at2: str, write: Write) -> None:
    write("a.AT2", at2)
    rows = "ok,a.AT2,\nx,gone,0\nok,a.AT2,\ny,a.AT2,-1\n"
    folder = write("catalog.csv", f"motion,file,dt_s\n{rows}").parent
    assert [fault.line for fault in inspect(folder).faults] == [3, 3, 4, 5]


def test_arguments_must_not_contradict_catalogue(write: Write) -> None:
    write("a.txt", TEXT)
    folder = write("catalog.csv", "motion,file,dt_s,units\nx,a.txt,0.01,g\n").parent
    np.testing.assert_allclose(load_motions(folder, units="g", time_step=0.01)[0].peak_acceleration, 0.3 * G)
    with pytest.raises(
        InputError, match="catalogue states other units than you; found g in the catalogue, m/s2 from you"
    ):
        load_motions(folder, units="m/s2")
    with pytest.raises(InputError, match="catalogue states other time steps than you"):
        load_motions(folder, time_step=0.02)


def test_arguments_complete_rows_without_declarations(write: Write) -> None:
    write("a.txt", TEXT)
    folder = write("catalog.csv", "motion,file\nx,a.txt\n").parent
    assert load_motions(folder, units="m/s2", time_step=0.01)[0].peak_acceleration == 0.3


def test_paths_written_on_windows_are_found(at2: str, write: Write) -> None:
    write("near/a.AT2", at2)
    folder = write("catalog.csv", "motion,file\nx,near\\a.AT2\n").parent
    assert load_motions(folder)[0].name == "x"
