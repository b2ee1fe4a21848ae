import json
import re
from functools import cache

import numpy as np
import pandas as pd
import pytest
import typer
from scipy.interpolate import CubicSpline
from typer.testing import CliRunner, Result

from reliab.app.cli import application, run as run_command, spread
from reliab.app.cli.commands import as_options
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent_with_interval
from reliab.criterion.derivation import published_criterion

ONE_HERTZ = ("--f", "1", "--xi", "0.02")

APP = application("assess", "design")


@cache
def run(*arguments: object, command: str = "assess") -> Result:
    """Ask once; tests whose files or terminal change ask `run.__wrapped__`."""
    return CliRunner().invoke(APP, [command, *map(str, arguments)])


def answer(*arguments: object) -> dict:
    return json.loads(run(*arguments, *ONE_HERTZ, "--json", "-").stdout)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Files of three tests of a one-hertz response, a ground motion and a criterion."""
    root = tmp_path_factory.mktemp("tests")
    rng = np.random.default_rng(5)
    times = np.arange(0.0, 40.0, 1.0 / 256.0)
    command = np.sin(2.0 * np.pi * times) * np.sin(np.pi * times / 40.0) ** 2
    path = CubicSpline(times, command)
    for name, gain, delay in (("good", 0.999, 0.0004), ("late", 1.0, 0.004), ("weak", 0.96, 0.0004)):
        measured = gain * path(np.clip(times - delay, 0.0, None)) + 0.003 * rng.normal(size=times.size)
        frame = pd.DataFrame({"time_s": times, "command_m": command, "measured_m": measured})
        frame.to_csv(root / f"{name}.csv", index=False)
    shaking = np.exp(-(((times - 8.0) / 5.0) ** 2)) * rng.normal(size=times.size)
    lines = ["# units: m/s2", f"# dt = {1.0 / 256.0}", *(f"{sample:.6f}" for sample in shaking)]
    (root / "ground.txt").write_text("\n".join(lines), encoding="utf-8")
    (root / "criterion.json").write_text(published_criterion("guo_2017_12").to_json(), encoding="utf-8")
    return root


def test_good_test_is_reliable_and_says_so(folder):
    content = answer(folder / "good.csv", "--exact")
    assert content["reliable"] is True
    assert content["probability"] > 0.95
    assert content["A"] == pytest.approx(0.999, abs=1e-3)
    assert content["d_ms"] == pytest.approx(0.4, abs=0.05)
    output = run(folder / "good.csv", *ONE_HERTZ, "--exact", "--details").stdout
    assert output.startswith("RELIABLE: RMS error ")
    assert "more than 99 % likely to be below 5 %" in output
    for sentence in (
        "Structure: f = 1 Hz, ξ = 0.02, share of the stiffness in the laboratory α = 1",
        "Threshold and window: 5 %, over the test's own 40 s",
        "root mean square and largest value of measured minus exact displacement",
        "Delay that makes the loop unstable [ms], free share of it [%]",
        "Largest tracking error over the command's peak",
        "Channels: command = 'command_m'",
    ):
        assert sentence in " ".join(output.split())


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("name", "first"), [("late", "delay"), ("weak", "amplitude")])
def test_first_improvement_is_named(folder, name, first):
    assert answer(folder / f"{name}.csv")["improve"]["first"] == first
    assert f"Improve first: {first}" in run(folder / f"{name}.csv", *ONE_HERTZ).stdout


def test_most_useful_improvement_comes_before_the_budget_table(folder):
    output = " ".join(run("sample_test", *ONE_HERTZ, "--details").stdout.split())
    assert output.startswith("RELIABLE: RMS error 2.2 %, 9")
    assert "To narrow the interval: calibrate the displacement sensor" in output
    assert "skew of the channels" in output
    left_open = answer(folder / "good.csv")
    assert left_open["verdict"] == "undecided"  # at resonance half a sample of skew is half of the threshold
    assert "Feed one signal to both channels" in left_open["would_decide"][0]
    content = answer(folder / "good.csv", "--skew", "0±0.1")
    assert content["would_decide"][0].startswith("Calibrate the displacement sensor")


@pytest.mark.parametrize(
    ("name", "width"),
    [
        ("good", 80),
        ("late", 120),
        ("weak", 80),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (("good", 120), ("late", 80), ("weak", 120))
        ),
    ],
)
def test_the_screen_says_its_verdict_once_and_in_ten_lines(folder, monkeypatch, name, width):
    monkeypatch.setattr("reliab.app.cli.output._WIDTH_OF_PIPES", width)
    output = run.__wrapped__(folder / f"{name}.csv", *ONE_HERTZ).stdout
    assert len(output.splitlines()) <= 10
    assert output.count("likely to be below") == 1
    content = answer(folder / f"{name}.csv")
    text = " ".join(output.split())
    for metric in ("rms", "mte"):
        size = content["error"][metric]
        assert percent_with_interval(**size) in text
    assert content["budget"][0]["quantity"] in text
    assert all(screen_of(remedy).lower() in text.lower() for remedy in content["would_decide"])
    details = run.__wrapped__(folder / f"{name}.csv", *ONE_HERTZ, "--details").stdout
    details = " ".join(details.split())
    remarks = [*content["notes"], *content["warnings"]]
    assert all(" ".join(screen_of(remark).split()) in details for remark in remarks)


def screen_of(sentence):
    """Write the arguments that a sentence names as options."""
    return as_options(sentence, typer.main.get_command(application("assess")))


def test_contradictions_are_printed_once(folder):
    frame = pd.read_csv(folder / "good.csv").assign(measured_m=lambda table: table["command_m"])
    frame.to_csv(folder / "same.csv", index=False)
    output = " ".join(run(folder / "same.csv", *ONE_HERTZ).stdout.split())
    content = answer(folder / "same.csv")
    assert content["verdict"] == "undecided"
    for doubt in content["reasons"][:-1]:
        assert output.count(doubt) == 1


def test_check_turns_the_verdict_into_an_exit_code(folder):
    assert run(folder / "good.csv", *ONE_HERTZ, "--exact", "--check").exit_code == 0
    assert run(folder / "late.csv", *ONE_HERTZ).exit_code == 0
    assert run(folder / "late.csv", *ONE_HERTZ, "--check").exit_code == 1
    frame = pd.read_csv(folder / "good.csv")
    frame.assign(measured_m=frame["command_m"]).to_csv(folder / "copied.csv", index=False)
    copied_result = run(folder / "copied.csv", *ONE_HERTZ, "--check")
    assert copied_result.exit_code == 1
    assert copied_result.stdout.startswith("UNDECIDED")
    assert "To narrow the interval" in copied_result.stdout


def test_threshold_and_confidence_move_the_verdict():
    strict = answer("sample_test", "--threshold", 0.02, "--confidence", 0.99)
    assert (strict["threshold"], strict["confidence"]) == (0.02, 0.99)
    assert strict["index"] > answer("sample_test")["index"]


@pytest.mark.slow
def test_known_ground_motion_gives_its_own_verdict(folder):
    content = answer(folder / "good.csv", "--motion", folder / "ground.txt")
    assert content["basis"] == "motion"
    assert content["motion"]["name"] == "ground"
    assert content["by_index"]["reliable"] is (content["motion"]["error"] <= 0.05)
    assert content["motion"]["window_s"] == pytest.approx(
        [content["motion"]["begin_s"], content["motion"]["begin_s"] + content["duration_s"]]
    )
    assert 0.01 <= content["motion"]["probability"] <= 0.99
    assert content["scope"]["position"] == "outside"  # no ground motion has a response that is one sine
    assert content["population"]["probability"] is None


def test_criterion_of_a_file_is_used(folder):
    content = answer(folder / "good.csv", "--criterion", folder / "criterion.json")
    assert content["population"]["law"] == "guo_2017_12"
    assert content["by_index"]["probability"] is None


@pytest.mark.slow
def test_design_states_tolerable_errors_and_a_chart(folder):
    content = json.loads(
        run(
            *("--f", 1, "--f", 0.6, "--confidence", 0.8, "--confidence", 0.95, "--json", "-"),
            command="design",
        ).stdout
    )
    assert [(row["f"], row["confidence"]) for row in content["design"]] == [
        (1.0, 0.8), (1.0, 0.95), (0.6, 0.8), (0.6, 0.95),
    ]  # fmt: skip
    assert len({row["f"] for row in content["chart"]}) == 8
    limits = [row["delay_limit_ms"] for row in content["design"]]
    assert limits[0] > limits[1]
    assert limits[2] > limits[0]
    result = run("--figure", folder / "chart.svg", command="design")
    assert "d alone" in result.stdout
    assert (folder / "chart.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")


@pytest.mark.parametrize(
    ("wrong", "rule"),
    [
        ((), "No test given"),
        (("none.csv",), "No such file|Cannot read"),
        (("good.csv",), "depends on the natural frequency of the structure"),
        (("good.csv", "--f", 1, "--f", 2), "takes one value"),
        (("good.csv", "--f", "one"), "is no number"),
        (("good.csv", "--f", "1±"), "is no number"),
        (("good.csv", "--f", "1", "--xi", "2%"), "Write 0.02 for 2 %"),
        (("good.csv", "--f", "1", "--xi", "0.02", "--threshold", "5%"), "Write 0.05 for 5 %"),
        (
            ("good.csv", "--f", "1", "--xi", "0.02", "--threshold", "low"),
            "The value of --threshold is no number",
        ),
        (("good.csv", "--f", "1±0.5"), "below 0.333"),
        (("good.csv", "--f", 1, "--confidence", 95), "confidence must lie between"),
        (("good.csv", "--f", 1, "--threshold", 5), "must be (positive, and )?at most 2"),
        (("good.csv", "--f", 1, "--threshold", 0), "must be (positive, and )?at most 2"),
        (("good.csv", "--f", 1, "--command", "comand_m"), "No column 'comand_m' for the command"),
        (("good.csv", "--f", 1, "--criterion", "none.json"), "No such file"),
        (
            ("good.csv", "--f", 1, "--criterion", "criterion.json", "--threshold", 0.02),
            "`threshold` has no effect together with",
        ),
        (
            ("good.csv", "--f", 1, "--criterion", "criterion.json", "--metric", "mte"),
            "`metric` has no effect together with",
        ),
        (("good.csv", "--f", 1, "--motion", "none.at2"), "No such file"),
        (("good.csv", "--f", 1, "--metric", "peak"), "The metric is rms or mte"),
        (("good.csv", "--f", 1, "--units", "furlong"), "Unknown unit of length"),
        (("good.csv", "--f", 1, "--xi", 2), "damping ratio must be at least 1e-12 and below 1"),
        (("good.csv", "--f", 1, "--date", "2026-01-01"), "`date` has no effect"),
        (("good.csv", "--f", 1, "--mass", 2), "without a column of force"),
        (("good.csv", "--f", 1, "--model", "none.toml"), "No such file"),
    ],
)
def test_bad_input_is_explained(folder, wrong, rule, monkeypatch):
    monkeypatch.chdir(folder)
    refusal = run(*wrong).exception
    assert isinstance(refusal, InputError)
    assert re.search(rule, str(refusal))


@pytest.mark.parametrize(
    ("wrong", "rule"),
    [
        (("--alpha", 0.1), "at least 10 ξ"),
        (("--threshold", 0), "must be (positive, and )?at most 2"),
        (("--f", "1±0.01"), "takes exact values"),
        (("--figure", "none/chart.svg"), "Cannot write the figure"),
        (("--structure", "frame.toml"), "Judge a trial test of the frame"),
    ],
)
def test_bad_input_of_a_design_is_explained(wrong, rule):
    refusal = run(*wrong, command="design").exception
    assert isinstance(refusal, InputError)
    assert re.search(rule, str(refusal))


def test_a_mass_tells_the_unit_of_a_force_without_any_ground_acceleration(folder, tmp_path):
    test = pd.read_csv(folder / "good.csv")
    kilonewtons = 1e-3 * 50.0 * (2.0 * np.pi) ** 2 * test["measured_m"]
    test.assign(force_N=kilonewtons).to_csv(tmp_path / "force.csv", index=False)
    refusal = str(run(tmp_path / "force.csv", "--f", 1, "--mass", 50).exception)
    assert "does not fit the stated specimen" in refusal
    assert "kilonewtons for newtons" in refusal


def test_a_file_after_a_frequency_is_no_frequency(folder, capsys):
    assert run_command(["assess", "--f", "1", str(folder / "good.csv"), "--xi", "0.02", "--exact"]) == 0
    assert capsys.readouterr().out.startswith("RELIABLE")
    assert list(spread(["design", "--f", "1", "2±0.1"], typer.main.get_command(application()))) == [
        *("design", "--f", "1", "--f", "2±0.1"),
    ]


def test_option_keeps_its_words_among_numbers():
    arguments = ["simulate", "--window", "5", "arias", "record", "--f", "1", "2", "arias", "--out", "a"]
    assert list(spread(arguments, typer.main.get_command(application()))) == [
        *("simulate", "--window", "5", "--window", "arias", "--window", "record"),
        *("--f", "1", "--f", "2", "arias", "--out", "a"),
    ]


def test_options_go_before_the_header(folder):
    text = (folder / "good.csv").read_text(encoding="utf-8")
    values = folder / "stated.csv"
    values.write_text(f"# f = 1 ± 0.01 Hz\n# xi: 0.02+-0.002\n{text}", encoding="utf-8")
    output = json.loads(run(values, "--json", "-").stdout)
    assert output["stated"]["f"] == {"value": 1.0, "deviation": 0.01}
    assert output["stated"]["xi"] == {"value": 0.02, "deviation": 0.002}
    assert {"frequency", "damping_ratio"} <= {row["name"] for row in output["error"]["widest"]}
    assert json.loads(run(values, "--f", 1.1, "--json", "-").stdout)["f"] == 1.1


@pytest.mark.slow
def test_an_assumed_damping_ratio_is_said(folder):
    frame = pd.read_csv(folder / "good.csv")
    path = CubicSpline(frame["time_s"], frame["command_m"])
    noise = 1e-4 * np.random.default_rng(1).normal(size=len(frame))
    for name, delay in (("prompt", 1e-4), ("between", 1.5e-3)):
        frame["measured_m"] = path(np.clip(frame["time_s"] - delay, 0.0, None)) + noise
        frame.to_csv(folder / f"{name}.csv", index=False)
    output = " ".join(run(folder / "prompt.csv", "--f", 1, "--exact").stdout.split())
    assert output.startswith("RELIABLE")  # whatever the damping ratio
    assert "No damping ratio was stated" in output
    result = json.loads(run(folder / "between.csv", "--f", 1, "--xi", 0.02, "--exact", "--json", "-").stdout)
    assert result["verdict"] != "undecided"
    left_open = json.loads(run(folder / "between.csv", "--f", 1, "--exact", "--json", "-").stdout)
    assert left_open["verdict"] == "undecided"
    interval = left_open["error"]["rms"]
    assert interval["low"] < result["error"]["rms"]["value"] < interval["high"]
    assert "damping ratio" in left_open["would_decide"][0]
