"""Every option of `reliab assess` changes the answer, or is refused."""

import json

import pytest
import typer
from typer.testing import CliRunner

from reliab.app.cli.assess import assess

app = typer.Typer()
app.command()(assess)

PLAIN = ("--f", "1", "--xi", "0.02")
CHANGES = {
    "--f": ("test.csv", "--f", "1±0.05", "--xi", "0.02"),
    "--xi": ("test.csv", "--f", "1", "--xi", "0.05"),
    "--alpha": ("test.csv", *PLAIN, "--alpha", "0.5"),
    "--scale": ("test.csv", *PLAIN, "--scale", "1.003"),
    "--feedback-lag": ("test.csv", *PLAIN, "--feedback-lag", "0.5"),
    "--mass": ("whole.csv", *PLAIN, "--mass", "2"),
    "--skew": ("test.csv", *PLAIN, "--skew", "0.3±0.1"),
    "--command-scale": ("test.csv", *PLAIN, "--command-scale", "1.002"),
    "--hysteresis": ("test.csv", *PLAIN, "--hysteresis", "0.002"),
    "--resolution": ("test.csv", *PLAIN, "--resolution", "0.05"),
    "--filter": ("test.csv", *PLAIN, "--filter", "measured=60"),
    "--equipment": ("test.csv", *PLAIN, "--equipment", "equipment.toml"),
    "--exact": ("test.csv", *PLAIN, "--exact"),
    "--model": ("test.csv", *PLAIN, "--model", "model.toml"),
    "--motion": ("test.csv", *PLAIN, "--motion", "ground.txt"),
    "--structure": ("test.csv", "--structure", "frame.toml"),
    "--criterion": ("test.csv", *PLAIN, "--criterion", "criterion.json"),
    "--threshold": ("test.csv", *PLAIN, "--threshold", "0.03"),
    "--metric": ("test.csv", *PLAIN, "--metric", "mte"),
    "--confidence": ("test.csv", *PLAIN, "--confidence", "0.8"),
    "--command": ("test.csv", *PLAIN, "--command", "other_m"),
    "--measured": ("test.csv", *PLAIN, "--measured", "other_m"),
    "--time": ("test.csv", *PLAIN, "--time", "slow_s"),
    "--units": ("bare.csv", *PLAIN, "--rate", "128", "--units", "mm"),
    "--rate": ("bare.csv", *PLAIN, "--rate", "100"),
    "--time-units": ("ms.csv", *PLAIN, "--time-units", "ms"),
    "--delimiter": ("bar.csv", *PLAIN, "--delimiter", "|"),
}
"""A call with the option, and the same call without it must answer otherwise, or be refused."""

BASES = {
    "--f": ("test.csv", *PLAIN),
    "--xi": ("test.csv", *PLAIN),
    "--mass": ("whole.csv", *PLAIN),
    "--units": ("bare.csv", *PLAIN, "--rate", "128"),
    "--rate": ("bare.csv", *PLAIN),
    "--time-units": ("ms.csv", *PLAIN),
    "--delimiter": ("bar.csv", *PLAIN),
}
SEEN_ELSEWHERE = {
    **dict.fromkeys(
        ("--specimen", "--corrected", "--force-channel"), "tests/assessment/test_measured_specimen.py"
    ),
    "--details": "tests/app/cli/test_assess.py",
    "--check": "tests/app/cli/test_assess.py",
    "--report": "test_a_report_and_a_json_file_are_written",
    "--date": "test_a_report_and_a_json_file_are_written",
    **dict.fromkeys(("--title", "--paper", "--laboratory", "--logo"), "tests/report/test_setting.py"),
    "--out": "tests/app/cli/test_assess_several.py",
    "--test": "tests/recordings/test_layouts.py",
    "--channels": "tests/app/cli/test_calibrate.py",
    "--json": "test_a_report_and_a_json_file_are_written",
}


@pytest.fixture(scope="module")
def folder(folder_of_a_test):
    (folder_of_a_test / "equipment.toml").write_text("xi = 0.05\n", encoding="utf-8")
    return folder_of_a_test


@pytest.fixture(scope="module")
def answer(folder):
    cache = {}

    def ask(arguments):
        if arguments not in cache:
            with pytest.MonkeyPatch.context() as patch:
                patch.chdir(folder)
                result = CliRunner().invoke(app, [*arguments, "--json", "-"])
            cache[arguments] = (
                str(result.exception) if result.exit_code else {**json.loads(result.stdout), "test": ""}
            )
        return cache[arguments]

    return ask


def test_no_option_is_left_out():
    command = typer.main.get_command(app)
    options = {parameter.opts[0] for parameter in command.params if parameter.opts[0].startswith("--")}
    assert options - {"--help", "--install-completion", "--show-completion"} == {*CHANGES, *SEEN_ELSEWHERE}


@pytest.mark.slow
@pytest.mark.default_cases(7)
@pytest.mark.parametrize("option", CHANGES)
def test_an_option_changes_the_answer(answer, option):
    content, original = answer(CHANGES[option]), answer(BASES.get(option, ("test.csv", *PLAIN)))
    assert isinstance(content, dict), content
    assert content != original


def test_a_frame_names_its_error(answer):
    content = answer(("test.csv", "--structure", "frame.toml"))
    assert content["modes"][0]["alpha"] < 1.0
    assert content["verdict"] in {"reliable", "undecided", "not_reliable"}
    assert (
        content["error"]["rms"]["low"] <= content["error"]["rms"]["value"] <= content["error"]["rms"]["high"]
    )
    for extra in (("--f", "1"), ("--xi", "0.02"), ("--alpha", "0.5")):
        assert "no effect together with `structure`" in answer(
            ("test.csv", "--structure", "frame.toml", *extra)
        )


@pytest.mark.slow
def test_the_report_on_a_frame_states_its_answer(folder, monkeypatch):
    monkeypatch.chdir(folder)
    calls = ["test.csv", "--structure", "frame.toml"]
    assert CliRunner().invoke(app, [*calls, "--report", "f.pdf", "--date", "2026-01-01"]).exit_code == 0
    assert (folder / "f.pdf").read_bytes()[:5] == b"%PDF-"


@pytest.mark.slow
def test_a_report_and_a_json_file_are_written(folder, monkeypatch):
    monkeypatch.chdir(folder)
    for date in ("2026-01-01", "2026-02-02"):
        result = CliRunner().invoke(
            app,
            ["test.csv", *PLAIN, "--report", f"{date}.pdf", "--date", date, "--json", f"{date}.json"],
        )
        assert result.exit_code == 0
        assert result.stdout  # the answer is printed too
    first, second = (folder / f"{date}.pdf" for date in ("2026-01-01", "2026-02-02"))
    assert first.read_bytes() != second.read_bytes()
    assert json.loads((folder / "2026-01-01.json").read_text(encoding="utf-8"))["f"] == 1.0
