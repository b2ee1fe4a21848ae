"""Bad campaign folders give one sentence: file, rule, value, remedy."""

import re

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose


def change(path, pattern, replacement):
    text = path.read_text(encoding="utf-8")
    variant = re.sub(pattern, replacement, text, count=1)
    assert variant != text
    path.write_text(variant, encoding="utf-8")


def spoil_line(path, number, line):
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[number - 1] = line
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_good_folder_is_read_and_the_last_test_held_out(small_campaign):
    campaign = read_campaign(small_campaign)
    assert [test.held_out for test in campaign.tests] == [False, True]
    assert campaign.rate == 256.0
    assert campaign.nominal.specimen.stiffness == pytest.approx(1000.0 * (2.0 * np.pi) ** 2)


def test_single_test_is_divided(small_campaign):
    change(small_campaign / "campaign.toml", r'\[\[tests\]\]\nfile = "b.csv"\n', "")
    campaign = read_campaign(small_campaign)
    assert campaign.training[0].end == campaign.proof[0].begin
    assert campaign.proof[0].end == campaign.tests[0].size


SPOILT_TOML = [
    ("frequency_hz = 1.0", "frequency_hz = -1.0", "line 3.*must be between 0.01 and 10,000 Hz, not -1.0"),
    ("damping_ratio = 0.05", 'damping_ratio = "two"', "line 4.*number"),
    ("delay_s = 0.005", "dealy_s = 0.005", "line 8.*actuator.dealy_s is not a known key"),
    ("rate_hz = 256\n", "", "sampling.rate_hz is missing"),
    (r"\[sampling\]", "[sampling", "with a readable campaign.toml"),
    ('file = "b.csv"', 'file = "c.csv"', "c.csv: No such file"),
    ('file = "a.csv"\n', 'file = "a.csv"\nheld_out = 3\n', "held_out"),
    ("rate_hz = 256", "rate_hz = 512", "but the sampling rate is 512 Hz"),
]


@pytest.mark.parametrize(("pattern", "replacement", "message"), SPOILT_TOML)
def test_spoilt_description_names_place_and_rule(small_campaign, pattern, replacement, message):
    change(small_campaign / "campaign.toml", pattern, replacement)
    with pytest.raises(InputError, match=f"(?s){message}"):
        read_campaign(small_campaign)


SPOILT_TABLES = [
    (11, "0.035,nan,0.1", "line 11, column command_m: .*finite number.*NaN"),
    (11, "0.035,0.1,", "line 11, column measured_m: .*finite number"),
    (11, "0.035,0.1", "line 11: 2 columns, but 3 in the first line"),
    (11, "0.035,abc,0.1", "line 11, column command_m: Not a number.*'abc'"),
    (11, "0.5,0.1,0.1", "line 11.*equal steps"),
    (1, "time_s,command,measured", "state its unit.*command_m"),
    (1, "command_m,measured_m,time_s", "equal steps|Samples"),
    (1, "time_s,command_m,command_m", "Two columns have the same name"),
]


@pytest.mark.parametrize(("number", "line", "message"), SPOILT_TABLES)
def test_spoilt_table_says_line_and_column(small_campaign, number, line, message):
    spoil_line(small_campaign / "a.csv", number, line)
    with pytest.raises(InputError, match=f"(?s){message}"):
        read_campaign(small_campaign)


def test_missing_folder(tmp_path):
    with pytest.raises(InputError, match=r"campaign\.toml.*No such file"):
        read_campaign(tmp_path / "nowhere")


def test_all_tests_held_out(small_campaign):
    text = (small_campaign / "campaign.toml").read_text(encoding="utf-8")
    text = re.sub(r'(file = ".*")', r"\1\nheld_out = true", text)
    (small_campaign / "campaign.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="must not be held out"):
        read_campaign(small_campaign)


def test_channels_without_a_block_are_refused(small_campaign):
    for name in ("a.csv", "b.csv"):
        change(small_campaign / name, "time_s,command_m,measured_m", "time_s,ground_acceleration_mps2,other")
    with pytest.raises(InputError, match="at least one block"):
        diagnose(read_campaign(small_campaign))


def test_displacement_at_rest(small_campaign):
    for name in ("a.csv", "b.csv"):
        lines = (small_campaign / name).read_text(encoding="utf-8").splitlines()
        remainder = [f"{line.split(',')[0]},0.0,0.0" for line in lines[1:]]
        (small_campaign / name).write_text("\n".join([lines[0], *remainder]) + "\n", encoding="utf-8")
    with pytest.raises(InputError, match="must move"):
        diagnose(read_campaign(small_campaign))
