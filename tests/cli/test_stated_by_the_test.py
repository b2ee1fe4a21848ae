"""What a test's own file states goes before the laboratory's `channels.toml`, whoever reads it."""

from pathlib import Path

import pytest
from late_runs import runs_of

import reliab
from reliab.api import add_to_rig

SECONDS = 14.0
STRUCTURE = {"f": 1.0, "xi": 0.05}
HEADER = "# skew_ms: 2.0±0.1\n# scale: 1.003\n"
OF_ALL_TESTS = "[calibration]\nskew_ms = -5.0\nskew_sd_ms = 0.1\nscale = 0.98\n"


def assessed(files: list[Path], channels: Path | None) -> float:
    return reliab.assess(files[0], **STRUCTURE, channels=channels, exact=True).error.rebuilt.rms.value


def compared(files: list[Path], channels: Path | None) -> float:
    ranked = reliab.compare(files, **STRUCTURE, channels=channels, exact=True).tests
    return next(test.error.value for test in ranked if test.file == str(files[0]))


def followed(files: list[Path], channels: Path | None) -> float:
    *_, end = reliab.follow_test(files[0], **STRUCTURE, channels=channels, exact=True, every=60.0, wait=0.05)
    return end.to_dict()["error"]["rms"]["value"]


def kept(files: list[Path], channels: Path | None) -> float:
    rig = files[0].parent / ("plain" if channels is None else "stated")
    return add_to_rig(rig, files[:1], **STRUCTURE, channels=channels, exact=True).added[0]["rms"]


@pytest.mark.parametrize(
    "ask",
    [
        assessed,
        followed,
        pytest.param(compared, marks=pytest.mark.slow),
        pytest.param(kept, marks=pytest.mark.slow),
    ],
)
def test_the_header_of_a_test_goes_before_the_file_of_the_laboratory(tmp_path, ask):
    channels = tmp_path / "channels.toml"
    channels.write_text(OF_ALL_TESTS, encoding="utf-8")
    plain, told = (
        [tmp_path / f"{len(header)} {name}" for name in ("first.csv", "second.csv")]
        for header in ("", HEADER)
    )
    for number, frame in enumerate(runs_of(3)[0]):
        rows = frame[frame["time_s"] < SECONDS].to_csv(index=False)
        plain[number].write_text(rows, encoding="utf-8")
        told[number].write_text(HEADER + rows, encoding="utf-8")
    error = ask(told, channels)
    assert error == ask(told, None)
    assert error != pytest.approx(ask(plain, channels), rel=0.05)
