from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

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


@pytest.mark.parametrize(
    ("old", "new", "line", "rule"),
    [
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
)
def test_a_fault_is_told_with_its_line(
    old: str, new: str, line: int, rule: str, knet: str, write: Write
) -> None:
    path = write("a.NS", knet.replace(old, new))
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    assert str(caught.value).startswith(f"{path}, line {line}: ")


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
