"""What a test's own file states goes before the laboratory's `channels.toml`, whoever reads it."""

from pathlib import Path

import pytest
from late_runs import runs_of

import reliab
from reliab.app.api.rigs import add_to_rig
from reliab.core.errors import InputError
from reliab.signals.filters import LowPass

SECONDS = 14.0
STRUCTURE = {"f": 1.0, "xi": 0.05}
HEADER = "# skew_ms: 2.0±0.1\n# scale: 1.003\n"
CALIBRATION = "[calibration]\nskew_ms = -5.0\nskew_sd_ms = 0.1\nscale = 0.98\n"


def delay_of_assess(files: list[Path], channels: Path | None) -> float:
    return reliab.assess(files[0], **STRUCTURE, channels=channels, exact=True).error.rebuilt.rms.value


def delay_of_compare(files: list[Path], channels: Path | None) -> float:
    comparison = reliab.compare(files, **STRUCTURE, channels=channels, exact=True).tests
    return next(test.error.value for test in comparison if test.file == str(files[0]))


def delay_of_monitor(files: list[Path], channels: Path | None) -> float:
    *_, end = reliab.follow_test(files[0], **STRUCTURE, channels=channels, exact=True, every=60.0, wait=0.05)
    return end.to_dict()["error"]["rms"]["value"]


def delay_of_rig(files: list[Path], channels: Path | None) -> float:
    rig = files[0].parent / ("plain" if channels is None else "stated")
    return add_to_rig(rig, files[:1], **STRUCTURE, channels=channels, exact=True).added[0]["rms"]


@pytest.mark.parametrize(
    "ask",
    [
        delay_of_assess,
        delay_of_monitor,
        pytest.param(delay_of_compare, marks=pytest.mark.slow),
        pytest.param(delay_of_rig, marks=pytest.mark.slow),
    ],
)
def test_the_header_of_a_test_goes_before_the_file_of_the_laboratory(tmp_path, ask):
    channels = tmp_path / "channels.toml"
    channels.write_text(CALIBRATION, encoding="utf-8")
    plain, corrected = (
        [tmp_path / f"{len(header)} {name}" for name in ("first.csv", "second.csv")]
        for header in ("", HEADER)
    )
    for number, frame in enumerate(runs_of(3)[0]):
        rows = frame[frame["time_s"] < SECONDS].to_csv(index=False)
        plain[number].write_text(rows, encoding="utf-8")
        corrected[number].write_text(HEADER + rows, encoding="utf-8")
    error = ask(corrected, channels)
    assert error == pytest.approx(ask(corrected, None), rel=0.005)  # a calibration says more of the filters
    assert error != pytest.approx(ask(plain, channels), rel=0.05)


FILTERS = '[filters]\nmeasured = "30"\n'


@pytest.fixture
def filtered_test(tmp_path):
    """A test whose measured displacement passed a filter, as it was before and after it, and its file."""
    frame = runs_of(1)[0][0]
    frame = frame[frame["time_s"] < SECONDS]
    name = next(name for name in frame.columns if name.startswith("measured"))
    smooth = LowPass(corner=30.0).apply(frame[name].to_numpy(), float(frame["time_s"].diff().iloc[1]))
    (tmp_path / "channels.toml").write_text(FILTERS, encoding="utf-8")
    frame.assign(**{name: smooth}).to_csv(tmp_path / "test.csv", index=False)
    return frame, tmp_path / "test.csv", tmp_path / "channels.toml"


def test_a_filter_of_the_laboratory_is_taken_off(filtered_test):
    plain, file, channels = filtered_test
    true, filtered_error, corrected_error = (
        reliab.assess(test, **STRUCTURE, channels=values, exact=True).error.rebuilt.rms.value
        for test, values in ((plain, None), (file, None), (file, channels))
    )
    assert corrected_error == pytest.approx(true, rel=0.02)
    assert filtered_error != pytest.approx(true, rel=0.05)
    assessment = reliab.assess(file, **STRUCTURE, filter=["measured=30"], exact=True).error.rebuilt.rms.value
    assert corrected_error == assessment


def test_a_laboratory_filter_widens_the_running_interval(filtered_test):
    _, file, channels = filtered_test
    narrow, wide = (
        reliab.follow_test(file, **STRUCTURE, channels=values, exact=True, every=60.0, wait=0.05)
        for values in (None, channels)
    )
    widths = [
        end["high"] - end["low"] for *_, last in (narrow, wide) for end in [last.to_dict()["error"]["rms"]]
    ]
    assert widths[1] > 2.0 * widths[0]


def test_a_calibrated_skew_holds_the_delay_of_filters(filtered_test):
    _, file, channels = filtered_test
    channels.write_text(FILTERS + CALIBRATION, encoding="utf-8")
    with pytest.raises(InputError, match="includes the delay of the filters"):
        reliab.assess(file, **STRUCTURE, channels=channels)
    channels.write_text(CALIBRATION, encoding="utf-8")
    with pytest.raises(InputError, match="includes the delay of the filters"):
        reliab.assess(file, **STRUCTURE, channels=channels, filter=["measured=30"])
