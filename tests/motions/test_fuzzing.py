"""No content of a file gives anything but a motion or an error that says what to do.

Damage to sound records and catalogues is tried in `tests/fuzz`.
"""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions, read_motion
from reliab.motions.motion import Motion

NAMES = [
    *("record.AT2", "record.NS", "record.V2", "record.V2c", "record.csv", "record.txt", "record"),
    *("record.smc", "record.v1", "record.V2A", "record.sac"),
]
TOKENS = st.sampled_from(
    [
        *[
            "nan",
            "-inf",
            "1e999",
            "-1e-400",
            "1.0D+01",
            "******",
            "0",
            "-1",
            "1e9",
            "1e308",
            "-1e308",
            "999999999999999999999",
            "0x1F",
        ],
        *[
            "-.1234E-02-.2345E-02",
            "1.5.5",
            "--1",
            "+",
            ".",
            "E5",
            "1_000",
            "٣",
            "½",
            ",",
            ";",
            "#",
            "G",
            "NPTS=",
            "DT=",
            "cm/sec2",
            "(8f0.0)",
        ],
        *("", "\x00", "\t", "\r", "\x1a", "NPTS, DT", "UNITS OF", "units: m/s2", "dt = ", "time [ms]"),
        *("points of accel data equally spaced at 0 sec", "CORRECTED ACCELEROGRAM", "NO. OF POINTS = 3"),
        *("* VOL1DS", "#K-NET CSV", "N-S E-W U-D", "scale factor 0", "sampling rate: 0 kHz"),
        *("missing value: 1", "DURATION = 0", "2026/05/05 10:00:00.5", "End of data", "Real-header values"),
        "units=g,Format=(1E0.1)",
    ]
)


def outcomes(name: str, content: bytes) -> None:
    """Read a file in every way."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        faults = inspect(folder, units="g" if path.suffix == ".txt" else None).faults
        assert all(fault.rule and fault.file for fault in faults)
        try:
            motions = list(load_motions(path))
        except InputError as error:
            assert str(path) in str(error)  # noqa: PT017 - both outcomes are right
        else:
            assert all(isinstance(motion, Motion) for motion in motions)


@pytest.mark.parametrize(
    ("kind", "last"),
    [
        ("record.AT2", ".7000000E-02"),
        ("record.NS", "13106"),
        ("record.V2", "8.140768"),
        ("record.V2c", "3.442641e-01"),
    ],
)
def test_a_record_cut_before_its_last_sample_is_never_read(
    kind: str, last: str, records: dict[str, str], tmp_path: Path
) -> None:
    text = records[kind]
    for end in range(0, text.rindex(last), 11):
        (tmp_path / kind).write_text(text[:end])
        with pytest.raises(InputError):
            read_motion(tmp_path / kind, units="g" if "NPTS" not in text[:end] else None, time_step=0.005)


@given(name=st.sampled_from(NAMES), content=st.binary(max_size=300))
def test_any_bytes_are_read_or_explained(name: str, content: bytes) -> None:
    outcomes(name, content)


@given(
    name=st.sampled_from(NAMES),
    lines=st.lists(st.lists(TOKENS, max_size=5), max_size=12),
    ending=st.sampled_from(["\n", "\r\n", "\r"]),
    encoding=st.sampled_from(["utf-8", "latin-1", "utf-16"]),
)
def test_any_words_of_the_formats_are_read_or_explained(
    name: str, lines: list[list[str]], ending: str, encoding: str
) -> None:
    outcomes(name, ending.join(" ".join(line) for line in lines).encode(encoding, errors="replace"))


@given(
    samples=st.lists(st.floats(-49.0, 49.0), min_size=2, max_size=40).filter(any),
    step=st.floats(1e-4, 1.0),
)
def test_plain_text_keeps_every_bit(samples: list[float], step: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.txt"
        path.write_text("\n".join(map(repr, samples)))
        motion = read_motion(path, time_step=step, units="m/s2")
    np.testing.assert_array_equal(motion.acceleration, samples)
    assert motion.time_step == step
