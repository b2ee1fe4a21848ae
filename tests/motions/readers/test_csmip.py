from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions, read_motion

Write = Callable[[str, str | bytes], Path]
GAL = [-0.001239, 1.171726, -12.6262, -7.202959, 123.4567, -8.110211, 222.25, 8.140768]


@pytest.fixture
def csmip(records: dict[str, str]) -> str:
    return records["record.V2"]


@pytest.fixture
def three_channels(csmip: str) -> str:
    up = csmip.replace("360 Deg", "Up").replace("222.25000", "  9.00000")
    return csmip + up.replace("Chan  1", "Chan  2") + csmip.replace("360", "90").replace("Chan  1", "Chan  3")


def test_acceleration_is_read_and_velocity_and_displacement_are_not(csmip: str, write: Write) -> None:
    motion = read_motion(write("a.V2", csmip))
    np.testing.assert_allclose(motion.acceleration, np.array(GAL) / 100, rtol=1e-15)
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
def test_variants_of_the_announcement_are_read(
    announcement: str, factor: float, csmip: str, write: Write
) -> None:
    original = "     8 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)"
    assert original in csmip
    motion = read_motion(write("a.dat", csmip.replace(original, announcement)))
    np.testing.assert_allclose(motion.acceleration, np.array(GAL) * factor, rtol=1e-15)


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


@pytest.mark.parametrize(
    ("old", "new", "line", "rule"),
    [
        ("     8 points of accel", "    18 points of accel", 13, "found 8 of 18"),
        ("     8 points of accel", "     0 points of accel", 12, "whole number of at least 2; found 0"),
        ("     8 points of accel", "     x points of accel", 12, "whole number of at least 2; found x"),
        (
            "at  .005 sec, in",
            "at  .000 sec, in",
            12,
            "time step is no positive number; found .000",
        ),
        ("in cm/sec2.", "in ft/s2.", 12, "Unknown unit of acceleration; found 'ft/s2'"),
        ("in cm/sec2.", "in g.", 12, "Two different units in one file; found g here and cm/s2 in line 9"),
        ("  1.171726", "********** ", 13, "Not a number"),
        ("123.456700", "       NaN", 13, "Not a finite number; found 'NaN'"),
        (" 222.25000", " 9222.2500", 13, "above 5 g; found 9.404 g with samples in cm/s2"),
    ],
)
def test_a_fault_is_told_with_its_line(
    old: str, new: str, line: int, rule: str, csmip: str, write: Write
) -> None:
    assert old in csmip
    path = write("a.V2", csmip.replace(old, new))
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    assert str(caught.value).startswith(f"{path}, line {line}: ")


def test_a_file_cut_within_the_acceleration_is_refused(csmip: str, write: Write) -> None:
    cut = csmip[: csmip.index("123.456700")]
    with pytest.raises(InputError, match="found 4 of 8"):
        read_motion(write("a.V2", cut))


def test_file_with_csmip_suffix_only_is_explained(write: Write) -> None:
    with pytest.raises(InputError, match="must announce its points of accel data"):
        read_motion(write("a.V2", "nothing of the kind\n"))
