import math
from collections.abc import Callable
from pathlib import Path

import pytest

from reliab.core.errors import InputError
from reliab.motions.checking import inspect
from reliab.motions.faults import MotionFault
from reliab.motions.loading import UnreadFileWarning, load_motions

Write = Callable[[str, str | bytes], Path]


def two_columns(units: str, scale: float, *, cycles: float = 10.0) -> str:
    samples = [scale * math.cos(0.1 * math.pi * cycles * i) for i in range(20)]
    lines = "".join(f"{0.01 * i:.2f} {sample:.6g}\n" for i, sample in enumerate(samples))
    return f"# units: {units}\n{lines}"


def test_sound_records_have_no_faults(records: dict[str, str], write: Write, tmp_path: Path) -> None:
    write("a.AT2", records["record.AT2"])
    write("b.csv", records["record.csv"])
    assert inspect(tmp_path).records == 2
    assert inspect(tmp_path).faults == []
    assert inspect(str(tmp_path / "a.AT2")).faults == []


def test_every_fault_of_every_file_is_reported(records: dict[str, str], write: Write, tmp_path: Path) -> None:
    at2 = records["record.AT2"]
    write("good.AT2", at2)
    write("binary.AT2", b"\x00\x01\x02")
    write("empty.AT2", b"")
    write("cut.AT2", at2.replace("NPTS=      7", "NPTS=      9"))
    write(
        "many.AT2",
        at2.replace(".3000000E+00", "NaN").replace("-.6000000E-01", "oops").replace("OF G", "OF FT"),
    )
    write("peak.AT2", at2.replace(".5000000E+00", ".5000000E+02"))
    write("step.AT2", at2.replace("DT=   .0050", "DT=   .0000"))
    write("unitless.txt", "0.1\n0.2\n")
    result = [(Path(fault.file).name, fault.line, fault.rule) for fault in inspect(tmp_path).faults]
    assert result == [
        ("binary.AT2", 1, "Not a record that reliab reads"),
        ("cut.AT2", 6, "Fewer samples than the header states"),
        ("empty.AT2", 1, "The file is empty"),
        ("many.AT2", 3, "Unknown unit of acceleration"),
        ("many.AT2", 5, "Not a finite number"),
        ("many.AT2", 6, "Not a number"),
        ("peak.AT2", 5, "Implausible peak, above 5 g"),
        ("step.AT2", 4, "The header's time step is no positive number"),
        ("unitless.txt", None, "No units stated"),
        ("unitless.txt", None, "No time step stated"),
    ]


def test_units_and_step_can_be_given_for_bare_records(write: Write, tmp_path: Path) -> None:
    write("a.txt", "0.1\n0.2\n")
    assert inspect(tmp_path, units="g", time_step=0.01).faults == []


def test_a_fault_in_one_of_several_channels_is_reported_once(
    records: dict[str, str], write: Write, tmp_path: Path
) -> None:
    single = records["record.V2"]
    write("a.V2", single + single.replace("in cm/sec2.", "in ft.") + single)
    faults = [(fault.line, fault.value) for fault in inspect(tmp_path).faults]
    assert len(faults) == len(set(faults)) == 1


def test_sets_select_checked_records(records: dict[str, str], write: Write, tmp_path: Path) -> None:
    write("a.AT2", records["record.AT2"])
    write("b.AT2", b"")
    write("catalog.csv", "motion,set,file\na,near,a.AT2\nb,held_out,b.AT2\n")
    assert len(inspect(tmp_path).faults) == 1
    assert inspect(tmp_path, sets=["near"]).faults == []
    assert inspect(tmp_path, sets=["far"]).faults[0].rule == "No records in the sets far"


@pytest.mark.parametrize(("units", "scale"), [("cm/s2", 0.3), ("m/s2", 0.0003), ("cm/s2", 2.0)])
def test_a_record_out_of_scale_with_its_folder_is_reported(
    units: str, scale: float, write: Write, tmp_path: Path
) -> None:
    for cycles, (name, peak) in enumerate({"a": 0.2, "b": 0.3, "c": 0.9}.items(), start=1):
        write(f"{name}.txt", two_columns("g", peak, cycles=cycles))
    odd = write("odd.txt", two_columns(units, scale))
    inspection = inspect(tmp_path)
    assert inspection.faults == []
    (note,) = inspection.notes
    assert (note.file, note.line) == (str(odd), None)
    assert "by more than a factor of 50" in note.rule
    assert "the record is weak or its header states wrong units" in note.remedy


def test_files_of_unsupported_formats_are_named(
    records: dict[str, str], write: Write, tmp_path: Path
) -> None:
    write("a.AT2", records["record.AT2"])
    write("sub/b.mat", b"MATLAB 5.0 MAT-file")
    inspection = inspect(tmp_path)
    assert (inspection.records, inspection.faults) == (1, [])
    (note,) = inspection.notes
    assert (note.file, note.value) == (str(tmp_path / "sub" / "b.mat"), "a MATLAB file")
    with pytest.warns(UnreadFileWarning, match=r"skipped sub/b\.mat"):
        assert load_motions(tmp_path).names == ("a",)


def test_units_given_for_a_whole_folder_do_not_hide_a_mixture(write: Write, tmp_path: Path) -> None:
    for name, peak in {"a": 200, "b": 300, "c": 900, "odd": 0.3}.items():
        write(f"{name}.txt", two_columns("cm/s2", peak).partition("\n")[2])
    (fault,) = inspect(tmp_path, units="cm/s2").faults
    assert Path(fault.file).name == "odd.txt"
    assert fault.value == "0.000306 g against 0.255 g"


def test_record_with_confirmed_units_may_be_weak(write: Write, tmp_path: Path) -> None:
    rows = ""
    for name, peak in {"a": 0.2, "b": 0.3, "c": 0.9, "weak": 0.001}.items():
        write(f"{name}.txt", two_columns("g", peak))
        rows += f"{name},{name}.txt,{'g' if name == 'weak' else ''}\n"
    write("catalog.csv", f"motion,file,units\n{rows}")
    assert inspect(tmp_path).faults == []


def test_records_of_a_wide_but_possible_range_are_not_reported(write: Write, tmp_path: Path) -> None:
    for name, peak in {"a": 0.02, "b": 0.15, "c": 0.3, "d": 0.5, "e": 1.5}.items():
        write(f"{name}.txt", two_columns("g", peak))
    assert inspect(tmp_path).faults == []


def test_duplicate_record_is_noted(write: Write, tmp_path: Path) -> None:
    samples = [math.sin(i * i) * math.sin(0.015 * i) for i in range(200)]
    for name, scale in (("one", 1.0), ("two", 1.0), ("half", 0.5)):
        lines = "".join(f"{0.01 * i:.2f} {scale * sample:.6g}\n" for i, sample in enumerate(samples))
        write(f"{name}.txt", f"# units: m/s2\n{lines}")
    write("other.txt", two_columns("m/s2", 0.5))
    inspection = inspect(tmp_path)
    assert inspection.faults == []
    copies = [note for note in inspection.notes if note.rule == "Duplicate record"]
    assert [Path(note.file).stem for note in copies] == ["one", "two"]
    assert all(note.value == "the same record as half times 2" for note in copies)


def test_missing_path_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="gone not found"):
        inspect(tmp_path / "gone")


def test_a_fault_is_an_error_of_one_sentence() -> None:
    fault = MotionFault(file="a.AT2", line=3, rule="It must be so", value="not so", remedy="Make it so")
    assert str(fault.error()) == "a.AT2, line 3: It must be so; found not so. Make it so."
    assert str(MotionFault(file="a", line=None, rule="It must be so").error()) == "a: It must be so."
