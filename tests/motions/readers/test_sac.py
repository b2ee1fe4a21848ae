import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions, read_motion

Write = Callable[[str, str | bytes], Path]
SAMPLES = np.random.default_rng(5).normal(size=300).astype(np.float32)


def sac(*, order: str = "<", samples: np.ndarray = SAMPLES, **values: object) -> bytes:
    """Write a SAC file field by field, after the description of its format."""
    reals = [-12345.0] * 70
    reals[0], reals[5] = 0.005, 0.0  # step and begin
    reals[3], reals[7] = values.get("scale", -12345.0), values.get("origin", -12345.0)
    integers = [-12345] * 40
    integers[0:6] = values.get("time", (2026, 125, 10, 0, 0, 0))
    integers[6], integers[9], integers[15] = 6, values.get("count", len(samples)), 1
    integers[16], integers[35] = values.get("quantity", 5), values.get("even", 1)
    text = (
        f"{'STA1':8}{values.get('event', '-12345'):16}".ljust(160)
        + f"{values.get('channel', 'HNE'):8}{'XX':8}"
    )
    header = struct.pack(f"{order}70f40i", *reals, *integers) + text.ljust(192).encode()
    return header + samples.astype(f"{order}f4").tobytes()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("name", ["a.sac", "XX.STA1..HNE.D", "record"])
def test_samples_are_read_in_either_order_of_bytes(order: str, name: str, write: Write) -> None:
    motion = read_motion(write(name, sac(order=order)), units="gal")
    np.testing.assert_allclose(motion.acceleration * 100, SAMPLES, rtol=1e-12)
    assert motion.time_step == 0.005
    assert motion.event == "XX.STA1 2026-05-05 10:00:00"


def test_components_of_one_earthquake_share_its_origin(write: Write) -> None:
    write("a.sac", sac(origin=-5.0, event="Somequake"))
    write("b.sac", sac(origin=-7.0, time=(2026, 125, 10, 0, 2, 0), event="Somequake", samples=-SAMPLES[::-1]))
    folder = write("c.sac", sac(time=(-12345,) * 6, samples=SAMPLES[1:])).parent
    assert load_motions(folder, units="g").events == (*["SOMEQUAKE 2026-05-05 09:59:55"] * 2, "c")


@pytest.mark.parametrize(
    ("content", "rule"),
    [
        (sac(), "No units stated"),
        (sac()[:900], "Fewer samples than the header states; found 67 of 300"),
        (sac()[:600], "header of 632 bytes is missing"),
        (sac(quantity=7), "Not a record of acceleration; found velocity"),
        (sac(quantity=6), "Not a record of acceleration; found displacement"),
        (sac(channel="HHZ"), "Not a record of acceleration; found velocity .channel HHZ belongs"),
        (sac(scale=2.0), "scale is not 1; found 2"),
        (sac(even=0), "time series at equal steps"),
        (sac(samples=np.array([1.0, np.nan], np.float32)), "Samples are missing; found NaN or infinity"),
        (sac(count=1), "Too few samples; found 1"),
    ],
)
def test_non_acceleration_channels_are_refused(content: bytes, rule: str, write: Write) -> None:
    with pytest.raises(InputError, match=rule):
        read_motion(write("a.sac", content), units=None if "units" in rule else "m/s2")


def test_file_of_obspy_is_read(obspy: Any, tmp_path: Path) -> None:
    trace = obspy.Trace(SAMPLES.copy(), header={"delta": 0.005, "channel": "HNE", "station": "STA1"})
    trace.stats.starttime = obspy.UTCDateTime(2026, 5, 5, 10)
    trace.write(str(tmp_path / "a.sac"), format="SAC")
    np.testing.assert_allclose(
        read_motion(tmp_path / "a.sac", units="m/s2").acceleration, SAMPLES, rtol=1e-12
    )
