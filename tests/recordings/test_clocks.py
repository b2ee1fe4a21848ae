"""Channels of several rates and jittering clocks are brought to one clock; gaps are refused."""

import h5py
import numpy as np
import pandas as pd
import pytest
from layouts import COMMAND, MEASURED, RATE, TIME

from reliab.core.errors import InputError
from reliab.recordings.reading import read_recording


def smooth(time):
    return 0.01 * np.sin(2.0 * np.pi * 0.7 * time)


@pytest.mark.parametrize("largest", [0.2, 0.45])
def test_a_jittering_clock_is_interpolated_and_said(largest):
    jitter = np.random.default_rng(1).uniform(-largest, largest, TIME.size) / RATE
    times = TIME + jitter
    test = read_recording(
        pd.DataFrame({"time_s": times, "command_m": smooth(times), "measured_m": smooth(times - 0.01)})
    )
    position = times[0] + test.time_step * np.arange(test.command.size)
    np.testing.assert_allclose(test.command[5:-5], smooth(position)[5:-5], atol=1e-7)
    assert any("jitters" in note for note in test.notes)


@pytest.mark.parametrize("place", [20, 1000, -20])
def test_sample_lost_by_a_jittering_clock_is_refused(place):
    times = TIME + np.random.default_rng(1).uniform(-0.3, 0.3, TIME.size) / RATE
    table = {"time_s": times, "command_m": COMMAND, "measured_m": MEASURED}
    missing = pd.DataFrame({name: np.delete(values, place) for name, values in table.items()})
    with pytest.raises(InputError, match="equal steps"):
        read_recording(missing)


@pytest.mark.default_cases(3)
@pytest.mark.parametrize(
    ("jump", "rule"),
    [
        (2.0 / RATE, "equal steps"),
        (-1.0 / RATE, "repeat the time"),
        (-3.0, "another test may begin there"),
    ],
)
def test_a_jump_of_time_is_refused(jump, rule):
    times = TIME.copy()
    times[1000:] += jump
    with pytest.raises(InputError, match=rule):
        read_recording(pd.DataFrame({"time_s": times, "command_m": COMMAND, "measured_m": MEASURED}))


def test_channels_of_two_rates_and_begins_are_brought_to_the_clock_of_the_command(tmp_path):
    slow = 0.05 + np.arange(780) / 100.0
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["controller/time"], file["controller/command_m"] = TIME, smooth(TIME)
        file["logger/time"], file["logger/measured_m"] = slow, smooth(slow - 0.01)
    test = read_recording(tmp_path / "t.h5")
    assert test.time_step == pytest.approx(1.0 / RATE)
    times = np.ceil(0.05 * RATE) / RATE + np.arange(test.command.size) / RATE
    np.testing.assert_allclose(test.command, smooth(times), atol=1e-12)
    np.testing.assert_allclose(test.measured[5:-5], smooth(times - 0.01)[5:-5], atol=1e-7)
    assert any("recorded at 100 Hz and interpolated at the 256 Hz" in note for note in test.notes)


def test_channels_sharing_half_of_their_time_are_refused(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["controller/time"], file["controller/command_m"] = TIME, COMMAND
        file["logger/time"], file["logger/measured_m"] = TIME + 4.0, MEASURED
    with pytest.raises(InputError, match="not recorded at the same time"):
        read_recording(tmp_path / "t.h5")


def test_possible_milliseconds_are_questioned():
    table = {"time": 4.0 * np.arange(TIME.size), "command_m": COMMAND, "measured_m": MEASURED}
    with pytest.raises(InputError, match="without a unit: hardly seconds"):
        read_recording(pd.DataFrame(table))
    assert read_recording(pd.DataFrame(table), time_units="ms").time_step == pytest.approx(4e-3)


def assert_samples(times, test):
    sample_times = times[0] + test.time_step * np.arange(test.command.size)
    np.testing.assert_allclose(test.command[5:-5], smooth(sample_times)[5:-5], atol=2e-6)
    return " ".join(test.notes), list(test.channels[0].corrections)


def read_at(times):
    histories = {"command_m": smooth(times), "measured_m": smooth(times - 0.01)}
    return read_recording(pd.DataFrame({"time_s": times, **histories}))


@pytest.mark.parametrize("first", [0.3, 0.5, 0.8])
def test_changing_rate_is_resampled_at_the_faster_one(first):
    """Whole milliseconds, of which every second one is missing from some time on."""
    times = np.arange(8000) / 1000.0
    remaining_rows = (times < 8.0 * first) | (np.arange(8000) % 2 == 0)
    test = read_at(times[remaining_rows])
    assert test.time_step == pytest.approx(1e-3)
    note, applied = assert_samples(times[remaining_rows], test)
    assert "step between samples changes between 0.001 and 0.002 s" in note
    assert applied == [note]


@pytest.mark.parametrize("size", [0.002, 0.05])
def test_drifting_clock_is_interpolated_and_reported(size):
    even = np.arange(8000) / 1000.0
    times = (even + size * np.sin(np.pi * even / 8.0)).round(6)
    note, _ = assert_samples(times, read_at(times))
    assert "The clock drifts by up to" in note


def test_rounded_times_are_no_drift():
    for decimals in (3, 4, 7):
        test = read_at((np.arange(8000) / 1024.0).round(decimals))
        assert test.notes == ()
        assert test.time_step == pytest.approx(1.0 / 1024.0, rel=1e-4)


def test_implausible_change_of_rate_is_refused():
    times = np.concatenate([np.arange(4000) / 1000.0, 4.0 + np.arange(200) / 20.0])
    with pytest.raises(
        InputError, match=r"steps between samples range from 0\.001 to 0\.05 s, by more than a factor of 20"
    ):
        read_at(times)


@pytest.mark.parametrize(("factor", "unit"), [(1.0 / 86400.0, "d"), (1.0 / 3600.0, "h"), (1.0 / 60.0, "min")])
def test_times_in_days_hours_and_minutes(factor, unit):
    table = {"command_m": COMMAND, "measured_m": MEASURED}
    test = read_recording(pd.DataFrame({f"Time [{unit}]": 46000.0 * (unit == "d") + factor * TIME, **table}))
    assert test.time_step == pytest.approx(1.0 / RATE, rel=1e-6)
    with pytest.raises(InputError, match=r"without a unit: hardly seconds|time step must be between"):
        read_recording(pd.DataFrame({"Time": factor * TIME, **table}))


@pytest.mark.parametrize("unit", ["samples", "ticks", "hundredths of s", "millis"])
def test_unknown_unit_of_times_is_questioned(unit):
    table = {f"Time ({unit})": TIME, "command_m": COMMAND, "measured_m": MEASURED}
    with pytest.raises(InputError, match=f"Unknown unit of the times: {unit}.*`time_units`"):
        read_recording(pd.DataFrame(table))


def test_multiples_of_a_unit_are_units():
    table = {"Time (0.1 ms)": 1e4 * TIME, "command (0.01 mm)": 1e5 * COMMAND, "measured_m": MEASURED}
    test = read_recording(pd.DataFrame(table))
    assert test.time_step == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(test.command, COMMAND, atol=1e-12)


def test_unknown_unit_of_a_channel_is_refused_until_stated(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["time"], file["command"], file["measured"] = TIME, COMMAND, MEASURED
        file["command"].attrs["units"], file["measured"].attrs["units"] = "thou", "m"
    with pytest.raises(InputError, match=r"t\.h5: Unknown unit 'thou' of 'command'"):
        read_recording(tmp_path / "t.h5")
    (tmp_path / "channels.toml").write_text('[channels.command]\nunit = "m"\n', encoding="utf-8")
    test = read_recording(tmp_path / "t.h5", channels=tmp_path / "channels.toml")
    np.testing.assert_allclose(test.command, COMMAND)


def test_stated_scale_of_times_is_applied(tmp_path):
    (tmp_path / "channels.toml").write_text(
        '[channels.time]\ncolumn = "ticks"\nscale = 1e-4\n', encoding="utf-8"
    )
    table = {"ticks": 1e4 * TIME, "command_m": COMMAND, "measured_m": MEASURED}
    test = read_recording(pd.DataFrame(table), channels=tmp_path / "channels.toml")
    assert test.time_step == pytest.approx(1.0 / RATE)
