import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions, read_motion

SAMPLES = np.random.default_rng(5).normal(size=3000)


@pytest.fixture
def write(obspy: Any, tmp_path: Path) -> Any:
    """Write traces as miniSEED; each is a channel, a first second and samples."""

    def writer(*traces: tuple[str, int, np.ndarray]) -> Path:
        stream = obspy.Stream(
            obspy.Trace(
                samples.copy(),
                header={
                    "network": "XX",
                    "station": "STA1",
                    "channel": channel,
                    "delta": 0.01,
                    "starttime": obspy.UTCDateTime(2026, 5, 5, 10, 0, second),
                },
            )
            for channel, second, samples in traces
        )
        path = tmp_path / "a.mseed"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            stream.write(str(path), format="MSEED")
        return path

    return writer


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_channels_are_components_of_one_earthquake(precision: type, write: Any) -> None:
    path = write(("HNE", 0, SAMPLES.astype(precision)), ("HNN", 0, -SAMPLES[::-1].astype(precision)))
    suite = load_motions(path, units="gal")
    assert suite.names == ("a/1", "a/2")
    assert set(suite.events) == {"XX.STA1 2026-05-05 10:00:00"}
    np.testing.assert_array_equal(suite[0].acceleration, SAMPLES.astype(precision).astype(float) * 0.01)
    assert suite[0].time_step == 0.01


@pytest.mark.parametrize(
    ("traces", "rule"),
    [
        (
            [("HNE", 0, (1000 * SAMPLES).astype(np.int32))],
            "are not acceleration; found counts of a digitizer",
        ),
        ([("HHE", 0, SAMPLES)], "Not a record of acceleration; found velocity .channel HHE belongs"),
        (
            [("HNE", 0, SAMPLES), ("HNE", 50, SAMPLES)],
            "has gaps; found channel XX.STA1..HNE in 2 pieces",
        ),
    ],
)
def test_non_acceleration_channels_are_refused(traces: list[Any], rule: str, write: Any) -> None:
    with pytest.raises(InputError, match=rule):
        list(load_motions(write(*traces), units="gal"))


def test_units_must_be_given(write: Any) -> None:
    with pytest.raises(InputError, match="No units stated"):
        read_motion(write(("HNE", 0, SAMPLES)))


def test_file_cut_short_is_refused(write: Any) -> None:
    path = write(("HNE", 0, SAMPLES))
    path.write_bytes(path.read_bytes()[:9000])
    with pytest.raises(InputError, match="miniSEED file is damaged"):
        read_motion(path, units="gal")


def test_missing_library_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "obspy", None)
    path = tmp_path / "a.mseed"
    path.write_bytes(b"000001D STA1   HNEXX" + bytes(100))
    with pytest.raises(InputError, match=r'needs ObsPy.*pip install "reliab\[records\]"'):
        read_motion(path, units="gal")
