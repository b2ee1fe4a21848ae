"""Records of K-NET, CSMIP and COSMOS, whose headers stand at fixed places."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from motions.conftest import CSMIP_SAMPLES

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions, read_motion

Write = Callable[[str, str | bytes], Path]
COUNTS = np.array([13186, 13190, 13196, 13187, 13185, 13194, 13191, 13185, 13190, 13106])


@pytest.fixture
def knet(records: dict[str, str]) -> str:
    return records["record.NS"]


def test_counts_become_acceleration_without_their_mean(knet: str, write: Write) -> None:
    motion = read_motion(write("XYZ0011801241951.NS", knet))
    gal = (COUNTS - COUNTS.mean()) * 3920 / 6182761
    np.testing.assert_allclose(motion.acceleration, gal / 100, rtol=1e-12)
    assert motion.time_step == 0.1
    assert motion.duration == pytest.approx(0.9)
    assert abs(motion.acceleration.mean()) < 1e-15


def test_maximum_is_of_the_record_without_mean(knet: str, write: Write) -> None:
    motion = read_motion(write("a.NS", knet))
    assert motion.peak_acceleration * 100 == pytest.approx(0.0475516, rel=1e-4)


def test_components_of_one_earthquake_share_the_event(knet: str, write: Write) -> None:
    folder = write("XYZ001.NS", knet).parent
    write("XYZ001.EW", knet.replace("N-S", "E-W"))
    write("XYZ002.EW", knet.replace("19:51:00", "20:10:00"))
    suite = load_motions(folder)
    assert suite.names == ("XYZ001.EW", "XYZ001.NS", "XYZ002.EW")
    assert suite.events == (*["2018-01-24 19:51:00 41.0N 142.5E"] * 2, "2018-01-24 20:10:00 41.0N 142.5E")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("3920(gal)/6182761", "3920(gal)/6182761  "),
        ("Max. Acc. (gal)", "Max Acc. (gal)"),
        ("Dir.              N-S", "Dir.              4"),
        ("10Hz", "10"),
        ("Long.", "Lon."),
        ("Memo. ", "Memo."),
        ("\n", "\r\n"),
    ],
)
def test_small_differences_between_networks_are_read(old: str, new: str, knet: str, write: Write) -> None:
    motion = read_motion(write("a.NS2", knet.replace(old, new)))
    assert motion.acceleration.size == 10
    assert motion.time_step == 0.1


@pytest.mark.parametrize("rate", ["", "Sampling Freq(Hz) fastHz\n"])
def test_missing_rate_is_requested(rate: str, knet: str, write: Write) -> None:
    with pytest.raises(InputError, match="No time step stated"):
        read_motion(write("a.NS", knet.replace("Sampling Freq(Hz) 10Hz\n", rate)))


def test_a_dead_channel_is_refused(knet: str, write: Write) -> None:
    head = knet[: knet.index("   13186")]
    with pytest.raises(InputError, match="All samples are zero"):
        read_motion(write("a.NS", head + " 13190" * 10))


def test_an_empty_record_with_the_ending_of_a_component_is_explained(write: Write) -> None:
    with pytest.raises(InputError, match="K-NET file must hold its labels from Origin Time to Memo"):
        read_motion(write("a.EW", "1 2 3\n"))


@pytest.fixture
def csmip(records: dict[str, str]) -> str:
    return records["record.V2"]


@pytest.fixture
def three_channels(csmip: str) -> str:
    up = csmip.replace("360 Deg", "Up").replace("222.25000", "  9.00000")
    return csmip + up.replace("Chan  1", "Chan  2") + csmip.replace("360", "90").replace("Chan  1", "Chan  3")


def test_acceleration_is_read_and_velocity_and_displacement_are_not(csmip: str, write: Write) -> None:
    motion = read_motion(write("a.V2", csmip))
    np.testing.assert_allclose(motion.acceleration, np.array(CSMIP_SAMPLES) / 100, rtol=1e-15)
    assert motion.time_step == 0.005
    assert motion.event == "2012-02-13 21:06:02.8"


@pytest.mark.parametrize(
    ("announcement", "factor"),
    [
        ("     8 POINTS OF ACCEL DATA EQUALLY SPACED AT  .005 SEC, IN CM/SEC2. (8F10.6)", 0.01),
        ("     8 points of accel data equally spaced at  .005 sec, in cm/sec/sec (8f10.6)", 0.01),
        ("     8 points of accel data equally spaced at .005 sec. in cm/sec2.   (8f10.6)   ", 0.01),
        ("8 points of accel data equally spaced at .005 seconds, in gal (8f10.6)", 0.01),
    ],
)
def test_variants_of_the_announcement_of_csmip_are_read(
    announcement: str, factor: float, csmip: str, write: Write
) -> None:
    original = "     8 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)"
    assert original in csmip
    motion = read_motion(write("a.dat", csmip.replace(original, announcement)))
    np.testing.assert_allclose(motion.acceleration, np.array(CSMIP_SAMPLES) * factor, rtol=1e-15)


def test_a_record_in_g_is_read(csmip: str, write: Write) -> None:
    text = csmip.replace("in cm/sec2.", "in g.").replace("cm/sec/sec", "g")
    text = text.replace("222.25000", "  2.25000").replace("123.456700", "  1.456700").replace("-12", " -1")
    text = text.replace("-7.202959", " -.202959").replace("-8.110211", " -.110211").replace(" 8.14", "  .14")
    assert read_motion(write("a.V2", text)).peak_acceleration > 9.80665 * 2


def test_channels_are_motions_of_one_event(three_channels: str, write: Write) -> None:
    path = write("CE999.V2", three_channels)
    suite = load_motions(path)
    assert suite.names == ("CE999/1", "CE999/2", "CE999/3")
    assert len(set(suite.events)) == 1
    peaks = [motion.peak_acceleration for motion in suite]
    assert peaks == pytest.approx([2.2225, 1.234567, 2.2225])


def test_channels_of_a_record_without_origin_share_the_event_of_the_file(
    three_channels: str, write: Write
) -> None:
    text = three_channels.replace("Origin: 02/13/12, 21:06:02.8 UTC", "Origin:  To be determined")
    assert set(load_motions(write("CE999.V2", text)).events) == {"CE999"}


def test_one_channel_of_several_must_be_chosen(three_channels: str, write: Write) -> None:
    path = write("a.V2", three_channels)
    assert read_motion(path, channel=2).peak_acceleration == pytest.approx(1.234567)
    with pytest.raises(
        InputError, match=r"several channels; found channels 1 \(360 Deg\), 2 \(Up\), 3 \(90 Deg\)"
    ):
        read_motion(path)
    with pytest.raises(InputError, match="found channel 4 of 3"):
        read_motion(path, channel=4)


def test_a_file_cut_within_the_acceleration_is_refused(csmip: str, write: Write) -> None:
    cut = csmip[: csmip.index("123.456700")]
    with pytest.raises(InputError, match="found 4 of 8"):
        read_motion(write("a.V2", cut))


def test_file_with_csmip_suffix_only_is_explained(write: Write) -> None:
    with pytest.raises(InputError, match="must announce its points of accel data"):
        read_motion(write("a.V2", "nothing of the kind\n"))


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
def test_variants_of_the_announcement_of_cosmos_are_read(
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


FAULTS = {
    "record.NS": [
        ("   13190    13106\n", "", 18, "found 8 of 10"),
        ("13106\n", "13106\n 13 14 15 16 17 18 19 20\n", 20, "More samples .*; found 18 instead of 10"),
        ("10Hz", "0Hz", 11, "positive number; found 0"),
        ("3920(gal)/6182761", "0(gal)/6182761", 14, "gal over counts"),
        ("3920(gal)/6182761", "3920(gal)/0", 14, "gal over counts"),
        ("Duration Time(s)  1", "Duration Time(s)  -1", 12, "positive number of seconds"),
        ("Duration Time(s)  1", "Duration Time(s)  long", 12, "positive number of seconds"),
        ("   13196", " 1319six", 18, "Not a number; found '1319six'"),
        ("   13196", "99999999", 18, "Implausible peak, above 5 g"),
        ("   13196    13187", " 1.7e308 1.7e308", 18, "Implausible peak, above 5 g"),
        ("   13196", "     nan", 18, "Not a finite number; found 'nan'"),
    ],
    "record.V2": [
        ("     8 points of accel", "    18 points of accel", 13, "found 8 of 18"),
        ("     8 points of accel", "     0 points of accel", 12, "whole number of at least 2; found 0"),
        ("     8 points of accel", "     x points of accel", 12, "whole number of at least 2; found x"),
        ("at  .005 sec, in", "at  .000 sec, in", 12, "time step is no positive number; found .000"),
        ("in cm/sec2.", "in ft/s2.", 12, "Unknown unit of acceleration; found 'ft/s2'"),
        ("in cm/sec2.", "in g.", 12, "Two different units in one file; found g here and cm/s2 in line 9"),
        ("  1.171726", "********** ", 13, "Not a number"),
        ("123.456700", "       NaN", 13, "Not a finite number; found 'NaN'"),
        (" 222.25000", " 9222.2500", 13, "above 5 g; found 9.404 g with samples in cm/s2"),
    ],
    "record.V2c": [
        ("       5 acceleration", "      50 acceleration", 44, "found 5 of 50"),
        ("       5 acceleration", "       4 acceleration", 44, "More samples .*; found 5 instead of 4"),
        ("cm/sec2(04)", "counts(50)", 39, "Unknown unit of acceleration; found 'counts'"),
        ("units=cm/sec2(04),", "", 0, "No units stated"),
        ("   3.438810e-01", "    -999.000000", 41, "has gaps; found the mark of a missing sample, -999"),
        ("       5.000000", "       0.000000", 29, "time step is no positive number"),
        ("       5.000000", "    -999.000000", 0, "No time step stated"),
        ("100 Real-header", " 10 Real-header", 1, "value 62 of the COSMOS real header, is missing"),
        ("acceleration pts", "velocity pts", 1, "must hold acceleration"),
    ],
}


@pytest.mark.parametrize(
    ("kind", "old", "new", "line", "rule"),
    [(kind, *fault) for kind, faults in FAULTS.items() for fault in faults],
)
def test_a_fault_is_told_with_its_line(
    kind: str, old: str, new: str, line: int, rule: str, records: dict[str, str], write: Write
) -> None:
    assert old in records[kind]
    path = write(kind, records[kind].replace(old, new))
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    location = f"{path}, line {line}" if line else str(path)
    assert str(caught.value).startswith(f"{location}: ")
