from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions, read_motion

Write = Callable[[str, str | bytes], Path]
GAL = np.array([0.3437285, 0.343881, -34.40236, 0.344152, 0.3442641])
FIVE = """   3.437285e-01
   3.438810e-01
  -3.440236e+01
   3.441520e-01
   3.442641e-01
"""
COUNT_LINE = "5 acceleration pts, approx    0 secs, units=cm/sec2(04),Format=(1E15.6)"


@pytest.fixture
def cosmos(records: dict[str, str]) -> str:
    return records["record.V2c"]


def test_step_is_value_62_instead_of_the_raw_step(cosmos: str, write: Write) -> None:
    motion = read_motion(write("a.acc.V2c", cosmos))
    np.testing.assert_allclose(motion.acceleration, GAL / 100, rtol=1e-15)
    assert motion.time_step == 0.005
    assert motion.event == "2018-11-30 17:29:29"


@pytest.mark.parametrize(
    ("announcement", "lines", "factor"),
    [
        (
            "5 acceleration pts, approx 0 secs, units=g(02),Format=(1E15.6)",
            FIVE.replace("E+01", "E-01"),
            9.80665,
        ),
        ("5 acceleration data points, units= cm/sec2 (04), Format= (8F10.5)", None, 0.01),
        ("5 ACCELERATION PTS, APPROX 0 SECS, UNITS=GAL(10),FORMAT=(8F10.5)", None, 0.01),
    ],
)
def test_variants_of_the_announcement_are_read(
    announcement: str, lines: str | None, factor: float, cosmos: str, write: Write
) -> None:
    archive = "".join(f"{value:10.5f}" for value in GAL) + "\n"
    body = archive if lines is None else lines.replace("e+01", "e-01")
    motion = read_motion(write("a.V2c", cosmos.replace(COUNT_LINE, announcement).replace(FIVE, body)))
    expected = np.round(GAL, 5) if lines is None else np.where(np.abs(GAL) > 1, GAL / 100, GAL)
    np.testing.assert_allclose(motion.acceleration, expected * factor, rtol=1e-12)


def test_touching_numbers_are_split_by_printed_format(cosmos: str, write: Write) -> None:
    values = [101.12345, -101.12345, 2001.5, 3001.25, -4001.0]
    touching = "".join(f"{value:10.5f}" for value in values)
    assert "101.12345-101.12345" in touching
    text = cosmos.replace(COUNT_LINE, COUNT_LINE.replace("1E15.6", "8F10.5")).replace(FIVE, f"{touching}\n")
    np.testing.assert_allclose(read_motion(write("a.V2c", text)).acceleration, np.array(values) / 100)


def test_channels_are_read_and_velocity_is_not(cosmos: str, write: Write) -> None:
    velocity = cosmos.replace("acceleration pts", "velocity pts").replace("cm/sec2(04)", "cm/sec(05)")
    path = write("three.V2c", cosmos + velocity + cosmos.replace("90 deg", "Up"))
    assert load_motions(path).names == ("three/1", "three/2")


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("       5 acceleration", "      50 acceleration", "found 5 of 50"),
        ("       5 acceleration", "       4 acceleration", "More samples .*; found 5 instead of 4"),
        (
            "cm/sec2(04)",
            "counts(50)",
            "Unknown unit of acceleration; found 'counts'",
        ),
        ("units=cm/sec2(04),", "", "No units stated"),
        ("   3.438810e-01", "    -999.000000", "has gaps; found the mark of a missing sample, -999"),
        ("       5.000000", "       0.000000", "time step is no positive number"),
        ("       5.000000", "    -999.000000", "No time step stated"),
        ("100 Real-header", " 10 Real-header", "value 62 of the COSMOS real header, is missing"),
        ("acceleration pts", "velocity pts", "must hold acceleration"),
    ],
)
def test_a_fault_is_explained(old: str, new: str, rule: str, cosmos: str, write: Write) -> None:
    assert old in cosmos
    with pytest.raises(InputError, match=rule):
        read_motion(write("a.V2c", cosmos.replace(old, new)))


@pytest.mark.parametrize(
    ("announcement", "mark"), [("-999, -999.00", -999.0), ("-88, -88.50", -88.5), ("", -999.0)]
)
def test_header_names_the_mark_of_unknown_values(
    announcement: str, mark: float, cosmos: str, write: Write
) -> None:
    line = "Values used when parameter or data value is unknown/unspecified:   -999, -999.00"
    assert line in cosmos
    text = cosmos.replace(line, line.replace("-999, -999.00", announcement) if announcement else " ")
    path = write("a.V2c", text.replace("   3.438810e-01", f"{mark:15.6f}"))
    with pytest.raises(InputError, match=f"found the mark of a missing sample, {mark:g}"):
        read_motion(path)


def test_step_missing_in_header_can_be_given(cosmos: str, write: Write) -> None:
    path = write("a.V2c", cosmos.replace("       5.000000", "    -999.000000"))
    assert read_motion(path, time_step=0.01).time_step == 0.01


def test_truncated_real_header_is_explained(cosmos: str, write: Write) -> None:
    start, end = cosmos.index("follow on  20 lines"), cosmos.index("   1 Comment line")
    with pytest.raises(InputError, match="positive number; found nothing"):
        read_motion(write("a.V2c", cosmos[: start + 44] + cosmos[end:]))
