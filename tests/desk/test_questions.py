"""Forms become arguments, commands and files of channels that mean the same."""

import json
import shlex
import tomllib

import pytest
from hypothesis import given, strategies as st

import reliab
from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.desk.page import channels_toml, command_line, number, python_line
from reliab.desk.pages.judge import corrections_of

SAMPLE = shipped("datasets", "sample_test/test.csv")
QUESTION = {"f": "1±0.01", "xi": "0.02±0.002", "threshold": 0.04, "specimen": "linear"}


@pytest.mark.slow
def test_command_and_python_line_of_a_page_give_its_answer(capsys):
    content = reliab.assess(SAMPLE, **QUESTION).to_dict()
    command = shlex.split(command_line("assess", [str(SAMPLE)], QUESTION))
    assert run([*command[1:], "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(content))
    line = python_line("assess", [str(SAMPLE)], QUESTION)
    assert eval(line, {"reliab": reliab}).to_dict() == content  # noqa: S307 - what a user would run


@pytest.mark.parametrize("name", ["my test.csv", "$(id).csv", "-rf", "a'b\".csv", "é;rm.csv"])
def test_names_stay_one_argument_of_the_shell(name):
    parts = shlex.split(command_line("assess", [name], {"f": 1}))
    assert parts[2].removeprefix("./") == name
    assert parts[3:] == ["--f", "1"]
    assert not parts[2].startswith("-")


@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=1))
def test_any_name_of_a_column_is_read_back_from_the_file_of_channels(column):
    text = channels_toml({"measured": {"column": column, "sign": -1}}, 512.0)
    assert tomllib.loads(text) == {
        "channels": {"measured": {"column": column, "sign": -1}},
        "sampling": {"rate_hz": 512.0},
    }


def test_corrections_act_like_the_file_of_channels(tmp_path):
    values = {"column_measured": "command_m", "column_command": "measured_m", "unit_command": "mm"}
    path = tmp_path / "channels.toml"
    path.write_text(channels_toml(corrections_of({**values, "sign_measured": "-1"})), encoding="utf-8")
    plain, corrected_recording = reliab.read_recording(SAMPLE), reliab.read_recording(SAMPLE, channels=path)
    assert corrected_recording.command[5000] == pytest.approx(1e-3 * plain.measured[5000])
    assert corrected_recording.measured[5000] == pytest.approx(-plain.command[5000])


def test_nothing_corrected_makes_no_file():
    assert channels_toml(corrections_of({"column_time": "", "unit_force": "", "sign_force": ""})) == ""


def test_numbers_are_read_with_a_decimal_comma_and_others_refused():
    assert number("0,04", "threshold") == 0.04
    with pytest.raises(InputError, match="`threshold` must be a number; found 'five'"):
        number("five", "threshold")


def test_a_flag_has_no_value():
    assert command_line("assess", (), {"exact": True, "f": 1}) == "reliab assess --exact --f 1"
