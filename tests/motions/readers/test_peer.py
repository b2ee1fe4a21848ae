from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY as G
from reliab.motions.loading import read_motion
from reliab.motions.motion import Motion

Write = Callable[[str, str | bytes], Path]
SAMPLES = [0.1, -0.2, 0.3, -0.4, 0.5, -0.06, 0.007]
LINES = """   .1000000E+00  -.2000000E+00   .3000000E+00  -.4000000E+00   .5000000E+00
  -.6000000E-01   .7000000E-02
"""
TITLE = "Nowhere-01, 10/18/1989, Testing Station, 90"


def at2(
    sizes: str = "NPTS=      7, DT=   .0050 SEC,",
    lines: str = LINES,
    title: str = TITLE,
    units: str = "ACCELERATION TIME SERIES IN UNITS OF G",
) -> str:
    return f"PEER NGA STRONG MOTION DATABASE RECORD\n{title}\n{units}\n{sizes}\n{lines}"


def assert_read(motion: Motion, time_step: float = 0.005) -> None:
    np.testing.assert_allclose(motion.acceleration, np.array(SAMPLES) * G, rtol=1e-15)
    assert motion.time_step == time_step


@pytest.mark.parametrize(
    "sizes",
    [
        "NPTS=  7, DT= .00500 SEC",
        "NPTS=      7, DT=  0.00500 SEC                                             ",
        "NPTS= 7, DT= 0.0050 ",
        "NPTS= 7,\tDT=\t0.0050\tSEC   ",
        "NPTS =      7 , DT =   .0050 SEC ,                                             ",
        "NPTS=      7, DT=   .0050 SEC,   4 POLE @    30.00000 HZ,  -5 POLE @      .13000",
        "NPTS=      7, DT=   .0050 SEC, 5 POLE @ 40.0 HZ",
        "NPTS=7,DT=.005SEC",
        "npts= 7 dt= 5.0D-03 sec",
        "NPTS: 7 DT: 0.005",
        "NPTS 7 DT .005",
        "DT= .005 SEC, NPTS= 7",
        "   7    .0050    NPTS, DT",
        "7 .005 NPTS, DT",
        "7, .005, NPTS, DT, 5 POLE @ 40.0 HZ",
        "7\t.005\tNPTS,DT",
        "7 .005 NPTS DT",
        "NPTS, DT = 7, .005",
    ],
)
def test_every_variant_of_the_sizes_is_read(sizes: str, write: Write) -> None:
    assert_read(read_motion(write("a.AT2", at2(sizes))))


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: "\n\n  \n" + text,
        lambda text: text.replace("PEER", "\ufeffPEER"),
        lambda text: text.replace("E+00", "D+00").replace("E-0", "d-0"),
        lambda text: text + "\n\n",
        lambda text: text.rstrip(),
        lambda text: text + "\x1a",
        lambda text: text.replace("   .1", "\t.1"),
        lambda text: text.replace("DATABASE RECORD", "DATABASE RECORD. FROM THE \f PAGE"),
    ],
)
def test_harmless_differences_in_layout_are_read(change: Callable[[str], str], write: Write) -> None:
    assert_read(read_motion(write("a.AT2", change(at2()))))


def test_latin_1_bytes_in_a_header_are_read(write: Write) -> None:
    motion = read_motion(write("a.AT2", at2(title="Düzce, 11/12/1999, Bolu, 0").encode("latin-1")))
    assert_read(motion)
    assert motion.event == "DÜZCE 1999-11-12"


@pytest.mark.parametrize(
    "lines",
    [
        "-.1000E+00-.2000E+00 .3000E+00-.4000E+00\n.5000E+00-.6000E-01 .7000E-02",
        ".1000E+00-.2000E+00.3000E+00-.4000E+00\n.5000E+00-.6000E-01.7000E-02",
        ".1000D+00-.2000D+00 .3000D+00-.4000D+00\n.5000D+00-.6000D-01.7000D-02",
        "0.1-0.2+0.3-0.4 0.5-0.06 0.007",
    ],
)
def test_glued_numbers_are_split_if_unambiguous(lines: str, write: Write) -> None:
    motion = read_motion(write("a.AT2", at2(lines=lines)))
    np.testing.assert_allclose(np.abs(motion.acceleration), np.abs(SAMPLES) * G, rtol=1e-15)


@pytest.mark.parametrize("joined_text", [".1-2", ".1234-101", ".1E-023.5", ".1E-1-.2E-1", "1.2.3", "1E5-2E5"])
def test_ambiguous_glued_numbers_are_refused(joined_text: str, write: Write) -> None:
    with pytest.raises(InputError, match=rf"line 6: Not a number; found '{joined_text}'"):
        read_motion(write("a.AT2", at2(lines=LINES.replace("-.6000000E-01", joined_text))))


@pytest.mark.parametrize(
    ("units", "factor"),
    [
        ("ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=23.0 Hz", G),
        ("ACCELERATION TIME SERIES IN UNITS OF CM/SEC/SEC", 0.01),
        ("ACCELERATION TIME SERIES IN UNITS OF CM/S**2. FILTERED", 0.01),
        ("ACCELERATION TIME SERIES, UNITS = GAL", 0.01),
        ("ACCELERATION TIME SERIES IN UNITS OF M/S2", 1.0),
        ("ACCELERATION TIME SERIES", G),
        ("", G),
    ],
)
def test_units_are_those_of_the_header_or_else_g(units: str, factor: float, write: Write) -> None:
    motion = read_motion(write("a.AT2", at2(units=units)))
    np.testing.assert_allclose(motion.acceleration, np.array(SAMPLES) * factor, rtol=1e-15)


def test_units_on_the_line_of_the_sizes_are_read(write: Write) -> None:
    motion = read_motion(write("a.AT2", at2("NPTS= 7, DT= .005 SEC, UNITS: CM/S2", units="ACCELERATION")))
    assert motion.peak_acceleration == 0.005


@pytest.mark.parametrize(
    ("title", "event"),
    [
        ("Loma Prieta, 10/18/1989, BRAN, 0", "LOMA PRIETA 1989-10-18"),
        ("LOMA PRIETA 10/18/89 00:05, CAPITOLA, 000 (CDMG STATION 47125)", "LOMA PRIETA 1989-10-18"),
        ("CHI-CHI 09/20/99, CHY101, W (CWB)", "CHI-CHI 1999-09-20"),
        ("Friuli, Italy 5/6/1976 2000, TOLMEZZO, 000", "FRIULI ITALY 1976-05-06"),
        ("Parkfield, 9/28/04, Cholame", "PARKFIELD 2004-09-28"),
        ("EL CENTRO SITE IMPERIAL VALLEY IRRIGATION DISTRICT", "a"),
        ("10/18/1989", "a"),
    ],
)
def test_the_event_is_the_earthquake_and_its_date(title: str, event: str, write: Write) -> None:
    assert read_motion(write("a.AT2", at2(title=title))).event == event


def test_stated_event_is_preserved(write: Write) -> None:
    motion = read_motion(write("x/a.AT2", at2()), event="KOBE", name="KOBE/A", set_name="near")
    assert (motion.name, motion.event, motion.set_name) == ("KOBE/A", "KOBE", "near")


def test_the_format_is_found_without_the_ending(write: Write) -> None:
    assert_read(read_motion(write("record.data", at2())))


@pytest.mark.parametrize(
    ("text", "line", "rule"),
    [
        (
            at2("NPTS= 70, DT= .005 SEC"),
            6,
            "Fewer samples than the header states; found 7 of 70",
        ),
        (at2("NPTS= 8, DT= .005 SEC"), 6, "found 7 of 8"),
        (at2("NPTS= 5, DT= .005 SEC"), 6, "More samples .*; found 7 instead of 5"),
        (at2(lines=LINES + LINES), 7, "More samples .*; found 14 instead of 7"),
        (at2("NPTS= seven, DT= .005 SEC"), 4, "whole number of at least 2; found seven"),
        (at2("NPTS= 7.5, DT= .005 SEC"), 4, "whole number of at least 2; found 7.5"),
        (at2("NPTS= -7, DT= .005 SEC"), 4, "whole number of at least 2; found -7"),
        (at2("NPTS= , DT= "), 4, "whole number of at least 2; found nothing"),
        (at2("NPTS= 7, DT= 0.0 SEC"), 4, "time step is no positive number; found 0.0"),
        (at2("NPTS= 7, DT= -.005 SEC"), 4, "positive number; found -.005"),
        (at2("NPTS= 7, DT= NaN SEC"), 4, "positive number; found NaN"),
        (at2("NPTS= 7, DT= 1e999 SEC"), 4, "positive number; found 1e999"),
        (at2("NPTS= 7, DT= 1e999999999999999999999 SEC"), 4, "positive number"),
        (
            at2(lines=LINES.replace(".3000000E+00", "  abcdefE+00")),
            5,
            "Not a number; found 'abcdefE[+]00'",
        ),
        (at2(lines=LINES.replace("-.6000000E-01", "************")), 6, r"a number; found '\*{12}'"),
        (at2(lines=LINES.replace("-.6000000E-01", "1_000")), 6, "a number; found '1_000'"),
        (at2(lines=LINES.replace("-.6000000E-01", "0x1F")), 6, "a number; found '0x1F'"),
        (at2(lines=LINES.replace("-.6000000E-01", "٣")), 6, "a number"),
        (at2(lines=LINES.replace("-.6000000E-01", "NaN")), 6, "Not a finite number; found 'NaN'"),
        (at2(lines=LINES.replace("-.6000000E-01", "-Infinity")), 6, "Not a finite number; found '-Infinity'"),
        (at2(lines=LINES.replace("-.6000000E-01", "1.#QNAN")), 6, "Not a finite number"),
        (at2(lines=LINES.replace("-.6000000E-01", "1e999")), 6, "Not a finite number; found '1e999'"),
        (
            at2(lines=LINES.replace("-.6000000E-01", "-6.0")),
            6,
            "Implausible peak, above 5 g; found 6 g",
        ),
        (
            at2(units="VELOCITY TIME SERIES IN UNITS OF CM/S"),
            3,
            "Not a record of acceleration; found velocity",
        ),
        (at2(units="ACCELERATION TIME SERIES IN UNITS OF FURLONGS"), 3, "Unknown unit of acceleration"),
        (
            at2("NPTS= 7, DT= .005 SEC, UNITS: CM/S2"),
            4,
            "Two different units in one file; found cm/s2 here and g in line 3",
        ),
        (at2(lines="0.0 0.0 0.0 0.0 0.0 0.0 0.0"), 5, "All samples are zero"),
        ("PEER\nwithout\nsizes\n0.1 0.2\n", 1, "must state NPTS and DT"),
    ],
)
def test_a_fault_is_told_with_file_line_rule_and_remedy(
    text: str, line: int, rule: str, write: Write
) -> None:
    path = write("a.AT2", text)
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    assert str(caught.value).startswith(f"{path}, line {line}: ")
    assert caught.value.remedy or "acceleration" in caught.value.rule
    assert "\n" not in str(caught.value)


def test_padding_of_the_last_line_is_not_a_sample(write: Write) -> None:
    padded_record = LINES.rstrip() + "  0.000000E+00  0.000000E+00\n"
    assert_read(read_motion(write("a.AT2", at2(lines=padded_record))))


def test_units_contradicting_header_are_refused(write: Write) -> None:
    path = write("a.AT2", at2())
    with pytest.raises(InputError, match=r"line 3: .*found g in the header, cm/s2 in the arguments"):
        read_motion(path, units="gal")
    assert_read(read_motion(path, units="G"))


@pytest.mark.parametrize(("output", "true_step"), [(".0024", 1 / 409.6), (".0066", 1 / 150), (".02", 0.0204)])
def test_a_rounded_step_can_be_corrected(output: str, true_step: float, write: Write) -> None:
    path = write("a.AT2", at2(f"NPTS= 7, DT= {output} SEC"))
    assert_read(read_motion(path, time_step=true_step), true_step)


def test_step_contradicting_header_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match=r"line 4: .*found 0.005 s in the header, 0.01 s in the arguments"):
        read_motion(write("a.AT2", at2()), time_step=0.01)
