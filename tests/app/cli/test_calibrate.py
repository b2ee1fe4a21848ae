import json

import numpy as np
import pandas as pd
import pytest

import reliab
from reliab.app.cli import run
from reliab.assessment.budget.sizes import PriorSource
from reliab.recordings.channels_file import read_channels_file


@pytest.fixture
def sine(tmp_path):
    time = np.arange(0.0, 8.0, 1e-3)
    rng = np.random.default_rng(2)
    frame = pd.DataFrame(
        {
            "time_s": time,
            "command_mm": 20.0 * np.sin(6.0 * time),
            "measured_mm": 20.2 * np.sin(6.0 * (time - 4e-4)) + 0.01 * rng.normal(size=time.size),
        }
    )
    file = tmp_path / "sine.csv"
    frame.to_csv(file, index=False)
    return file


def test_command_and_function_write_the_same_calibration(sine, tmp_path, capsys):
    out = tmp_path / "channels.toml"
    assert run(["calibrate", str(sine), "--actuator-delay", "0", "--out", str(out), "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == reliab.calibrate(sine, actuator_delay=0).to_dict()
    assert content["skew_ms"]["value"] == pytest.approx(0.4, abs=0.05)
    calibration = read_channels_file(out).calibration
    assert calibration["skew"].value == pytest.approx(content["skew_ms"]["value"], rel=1e-5)
    assert calibration["scale"].deviation == pytest.approx(content["scale"]["sd"], rel=1e-2)


def test_a_calibration_keeps_names_and_replaces_an_earlier_one(sine, tmp_path):
    file = tmp_path / "channels.toml"
    file.write_text(
        '[calibration]\nskew_ms = 9.0\n\n[channels.measured]\ncolumn = "measured_mm"\n', encoding="utf-8"
    )
    assert run(["calibrate", str(sine), "--channels", str(file), "--out", str(file)]) == 0
    text = file.read_text(encoding="utf-8")
    assert text.count("[calibration]") == 1
    assert 'column = "measured_mm"' in text
    assert read_channels_file(file).calibration["skew"].value < 1.0


def test_another_file_of_channels_is_not_replaced(sine, tmp_path, capsys):
    out = tmp_path / "channels.toml"
    out.write_text("", encoding="utf-8")
    assert run(["calibrate", str(sine), "--out", str(out)]) == 2
    assert "--channels" in capsys.readouterr().err
    assert out.read_text(encoding="utf-8") == ""


def test_a_calibrated_skew_is_taken_off_a_test(sine, tmp_path):
    channels = tmp_path / "channels.toml"
    reliab.calibrate(sine, actuator_delay=0, out=channels)
    calibration = read_channels_file(channels).calibration
    assert calibration["hysteresis"].value == 0.0 < calibration["hysteresis"].deviation < 1e-4
    assessment = reliab.assess(sine, f=1, xi=0.05, channels=channels)
    option_answer = reliab.assess(sine, f=1, xi=0.05, **calibration)
    baseline = reliab.assess(sine, f=1, xi=0.05)
    assert (
        assessment.error.rebuilt.rms.value
        < option_answer.error.rebuilt.rms.value
        < baseline.error.rebuilt.rms.value
    )
    delay_items = [
        {item.name: item for item in result.error.budget}["filter_delay"]
        for result in (assessment, option_answer)
    ]
    assert [item.source for item in delay_items] == [PriorSource.STATED, PriorSource.DEFAULT]
    assert (
        delay_items[0].size < 0.25 * delay_items[1].size
    )  # filters of the channels are in a calibrated skew
    assert assessment.error.rebuilt.rms.value < 0.3 * baseline.error.rebuilt.rms.value
