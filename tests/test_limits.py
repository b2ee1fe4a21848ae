"""What is too large is refused before it takes memory, with the limit, the value and the remedy."""

import tracemalloc

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from reliab.assessment.assess import assess
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.size import LARGEST_DRAW_SIZE
from reliab.core.errors import InputError
from reliab.core.files import LIMITS, require_small
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.discrepancy.campaign import reading
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.motions import motion as motion_module
from reliab.motions.faults import Report
from reliab.motions.motion import Motion
from reliab.motions.readers.source import open_source
from reliab.recordings.readers import hierarchical, matlab
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest
from reliab.sweep.request import SweepRequest
from reliab.tracking.indices.window import Window

FOUR_HERTZ = Structure(frequency=4.0, damping_ratio=0.02)
STEP = 1.0 / 256.0


@pytest.fixture(scope="module")
def histories():
    """A test that is one sample too long for a structure of 4 Hz; 18 MB."""
    command = np.sin(0.05 * np.arange(LARGEST_DRAW_SIZE + 1))
    return command, 0.99 * command


def test_more_structures_than_a_sweep_may_have_are_refused_before_they_are_made():
    frequencies, ratios = tuple(0.5 + 0.001 * np.arange(900)), tuple(0.01 + 1e-4 * np.arange(1000))
    for request in (SweepRequest, EllipseRequest):
        with pytest.raises(InputError, match=r"More than 10,000 structures.*; found 900,000\. Ask for fewer"):
            request(frequencies=frequencies, damping_ratios=ratios)


def test_results_that_fill_the_memory_are_refused():
    windows = tuple(Window(kind="seconds", seconds=10.0 + k) for k in range(20))
    with pytest.raises(InputError, match=r"more than 1 GB; found 3\.7 GB for 2,400 structures, 20 windows"):
        SweepRequest(
            frequencies=tuple(0.5 + 0.1 * np.arange(60)),
            damping_ratios=tuple(0.01 + 1e-3 * np.arange(40)),
            windows=windows,
        )


@pytest.mark.parametrize("columns", [1001, 100_000])
def test_tables_of_too_many_columns_are_refused_before_they_are_cut(tmp_path, columns):
    rows = [",".join(f"c{k}" for k in range(columns)), *[",".join(["0.1"] * columns)] * 3]
    (tmp_path / "wide.csv").write_text("\n".join(rows))
    for read in (read_tests, read_ellipses):
        with pytest.raises(InputError, match=rf"wide\.csv: .*more than 1,000 columns; found {columns:,}"):
            read(tmp_path / "wide.csv")


def test_columns_aligned_with_blanks_are_not_too_many(tmp_path):
    rows = [" " * 20 + (" " * 20).join(["0.1"] * 60)] * 3
    (tmp_path / "narrow.txt").write_text("\n".join(rows))
    LIMITS["test"].require_narrow(tmp_path / "narrow.txt")


@pytest.mark.parametrize(("name", "size"), [("e.csv", 5_000_000_000), ("e.nc", 3_000_000_000)])
def test_ellipses_larger_than_the_memory_are_refused_before_they_are_read(tmp_path, name, size):
    with (tmp_path / name).open("wb") as file:
        file.truncate(size)  # takes no room on the disk
    assert peak_and_refusal(lambda: read_ellipses(tmp_path / name))[0] < 20_000_000


def peak_and_refusal(work):
    """Memory [bytes] that a piece of work took at most before it was refused."""
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as refusal:
            work()
        return tracemalloc.get_traced_memory()[1], str(refusal.value)
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "judge",
    [
        lambda command, measured: rebuild(command, measured, STEP, FOUR_HERTZ),
        lambda command, measured: assess(
            Recording(command=command, measured=measured, time_step=STEP), FOUR_HERTZ
        ),
    ],
)
def test_draws_that_fill_the_memory_are_refused_at_once(histories, judge):
    memory, sentence = peak_and_refusal(lambda: judge(*histories))
    assert "may last 1.09 h at most" in sentence
    assert "Cut it where everything stands still" in sentence
    assert memory < 20 * histories[0].nbytes  # of 256 draws and their copies


@pytest.mark.slow
def test_draws_of_a_test_take_little_more_than_their_own_memory():
    time = np.arange(30_000) * STEP
    command = np.sin(6.0 * time) * np.exp(-0.01 * time)
    measured = 0.99 * command + 1e-5 * np.random.default_rng(0).normal(size=time.size)
    rebuild(command[:3000], measured[:3000], STEP, FOUR_HERTZ)
    tracemalloc.start()
    error = rebuild(command, measured, STEP, FOUR_HERTZ)
    current, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    draws = 256 * time.nbytes
    assert error.inferred.every == 1
    assert peak < 2.2 * draws
    assert current < 0.7 * draws


@pytest.mark.parametrize("kind", ["h5", "mat"])
def test_too_long_vectors_are_refused_before_reading(tmp_path, monkeypatch, kind):
    path, columns = tmp_path / f"test.{kind}", {"command_m": np.arange(99.0), "measured_m": np.arange(99.0)}
    if kind == "mat":
        savemat(path, columns)
    else:
        with h5py.File(path, "w") as file:
            file.update(columns)
    module = matlab if kind == "mat" else hierarchical
    calls = []

    def require_few(samples, source):
        calls.append((samples, source))
        raise InputError("A test may have 98 samples at most", value=samples, where=source)

    monkeypatch.setattr(module, "require_few_samples", require_few)
    with pytest.raises(InputError, match="98 samples at most; found 99"):
        read_tests(path)
    assert calls == [(99, f"test.{kind}, command_m")]


def test_a_recording_of_too_many_samples_is_refused():
    long = np.broadcast_to(0.0, (10_000_001,))  # one number in memory
    memory, sentence = peak_and_refusal(
        lambda: Recording(command=long, measured=long, time_step=STEP, name="t.h5")
    )
    assert sentence.startswith("t.h5: Too many samples: 10,000,001, above 10,000,000. Resample")
    assert memory < 1e6


def test_a_too_large_file_is_refused(tmp_path):
    (tmp_path / "t.csv").write_bytes(bytes(2_000_001))
    require_small(tmp_path / "t.csv", 2_000_001, remedy="Cut it")
    with pytest.raises(InputError, match=r"larger than 2 MB; found 2 MB. Cut it"):
        require_small(tmp_path / "t.csv", 2_000_000, remedy="Cut it")


def test_a_motion_of_ten_million_samples_is_refused_before_it_is_copied():
    long = np.broadcast_to(1.0, (10_000_000,))  # one number in memory
    memory, sentence = peak_and_refusal(lambda: Motion(name="long", acceleration=long, time_step=0.01))
    assert sentence.startswith("long: Too many samples, above 2,000,000; found 10,000,000. Keep")
    assert memory < 1e6


def test_a_motion_of_as_many_samples_as_allowed_is_accepted(monkeypatch):
    monkeypatch.setattr(motion_module, "MOST_SAMPLES", 64)
    assert Motion(name="m", acceleration=np.ones(64), time_step=0.01).duration == pytest.approx(0.63)
    with pytest.raises(InputError, match="above 64; found 65"):
        Motion(name="m", acceleration=np.ones(65), time_step=0.01)


def test_a_record_in_a_large_file_is_refused_after_reading_no_more_than_allowed(tmp_path):
    path = tmp_path / "record.txt"
    path.write_text("0.1\n" * 100)
    report = Report(file=str(path))
    assert open_source(path, report, byte_limit=400) is not None
    assert not report.faults
    assert open_source(path, report, byte_limit=399) is None
    with pytest.raises(InputError, match=r"The file is larger than 0\.000399 MB\. Keep"):
        report.require(None)
    assert open_source(path, report, limit=100, byte_limit=399).content == b"0.1\n" * 25  # a head of any file


@pytest.mark.slow
@pytest.mark.parametrize("rest_share", [pytest.param(0, marks=pytest.mark.slow), 10_000])
def test_a_long_running_test_holds_two_stretches_and_all_of_it_at_a_quarter_of_the_rate(rest_share):
    stretch, seconds = 2048, 80
    time = np.arange(seconds * 256) * STEP
    command = np.concatenate([np.zeros(rest_share), np.sin(6.0 * time)])
    monitor = Monitor(FOUR_HERTZ, STEP, stretch=stretch)
    for first in range(0, command.size, 3000):
        monitor.feed(command[first : first + 3000], 0.99 * command[first : first + 3000])
        assert monitor._running.kept_samples <= 2 * stretch  # noqa: SLF001
        assert monitor._running._table.shape[2] <= 4 * stretch  # noqa: SLF001
        assert monitor._held.rows.shape[1] <= max(2 * stretch, command.size // 4)  # noqa: SLF001
    assert monitor.now.samples == command.size


def test_a_campaign_of_too_many_samples_is_refused_before_the_rest_is_read(tmp_path, monkeypatch):
    tests = "".join(f'[[tests]]\nfile = "{name}.csv"\n' for name in "abc")
    (tmp_path / "campaign.toml").write_text(f"[sampling]\nrate_hz = 100\n{tests}")
    rows = "".join(f"{k / 100:.2f},{k % 7},{k % 7}\n" for k in range(100))
    for name in "ab":  # the third is not there, and not looked for
        (tmp_path / f"{name}.csv").write_text(f"time_s,command_m,measured_m\n{rows}")
    monkeypatch.setattr(reading, "MOST_SAMPLES", 199)
    with pytest.raises(InputError, match="have 199 samples together at most; found 200 in the first 2 of 3"):
        read_campaign(tmp_path)
    monkeypatch.setattr(reading, "MOST_SAMPLES", 200)
    with pytest.raises(InputError, match=r"c\.csv"):
        read_campaign(tmp_path)
