import json
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import typer
from scipy.interpolate import CubicSpline
from typer.testing import CliRunner, Result

from reliab.cli.assess import assess
from reliab.criterion import published_criterion
from reliab.errors import InputError

app = typer.Typer()
app.command()(assess)


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(*arguments: object) -> dict:
    return json.loads(run(*arguments, "--json", "-").stdout)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Files of three tests of a one-hertz response, and a ground motion."""
    made = tmp_path_factory.mktemp("tests")
    rng = np.random.default_rng(5)
    times = np.arange(0.0, 40.0, 1.0 / 256.0)
    command = np.sin(2.0 * np.pi * times) * np.sin(np.pi * times / 40.0) ** 2
    path = CubicSpline(times, command)
    for name, gain, delay in (("good", 0.999, 0.0004), ("late", 1.0, 0.004), ("weak", 0.96, 0.0004)):
        measured = gain * path(np.clip(times - delay, 0.0, None)) + 0.003 * rng.normal(size=times.size)
        frame = pd.DataFrame({"time_s": times, "command_m": command, "measured_m": measured})
        frame.to_csv(made / f"{name}.csv", index=False)
    shaking = np.exp(-(((times - 8.0) / 5.0) ** 2)) * rng.normal(size=times.size)
    lines = ["# units: m/s2", f"# dt = {1.0 / 256.0}", *(f"{sample:.6f}" for sample in shaking)]
    (made / "ground.txt").write_text("\n".join(lines), encoding="utf-8")
    return made


def test_good_test_is_reliable_and_says_so(folder):
    found = answer(folder / "good.csv", "--f", 1, "--xi", 0.02)
    assert found["reliable"] is True
    assert found["probability"] > 0.95
    assert found["A"] == pytest.approx(0.999, abs=1e-3)
    assert found["d_ms"] == pytest.approx(0.4, abs=0.05)
    shown = run(folder / "good.csv").stdout
    assert "RELIABLE at an error of 5% (RMS) for 95% of ground motions" in shown
    assert "Stability margin" in shown


@pytest.mark.parametrize(("name", "first"), [("late", "delay"), ("weak", "amplitude")])
def test_what_to_improve_first_is_named(folder, name, first):
    assert answer(folder / f"{name}.csv")["improve"]["first"] == first
    assert f"Improve first: the {first}" in run(folder / f"{name}.csv").stdout


def test_check_turns_the_verdict_into_an_exit_code(folder):
    assert run(folder / "good.csv", "--check").exit_code == 0
    assert run(folder / "late.csv").exit_code == 0
    assert run(folder / "late.csv", "--check").exit_code == 1


def test_threshold_and_confidence_move_the_verdict(folder):
    strict = answer(folder / "good.csv", "--threshold", 0.02, "--confidence", 0.99)
    assert (strict["threshold"], strict["confidence"]) == (0.02, 0.99)
    assert strict["index"] > answer(folder / "good.csv")["index"]


def test_known_ground_motion_gives_its_own_verdict(folder):
    found = answer(folder / "good.csv", "--motion", folder / "ground.txt")
    assert found["basis"] == "motion"
    assert found["motion"]["name"] == "ground"
    assert found["reliable"] is (found["motion"]["error"] <= 0.05)


def test_criterion_of_a_file_is_used(folder):
    (folder / "criterion.json").write_text(published_criterion("guo_2017_12").to_json(), encoding="utf-8")
    found = answer(folder / "good.csv", "--criterion", folder / "criterion.json")
    assert found["population"]["law"] == "guo_2017_12"
    assert found["probability"] is None


def test_design_states_tolerable_errors_and_a_chart(folder):
    found = answer("--design", "--f", 1, "--f", 0.6, "--confidence", 0.8, "--confidence", 0.95)
    assert [(each["f"], each["confidence"]) for each in found["design"]] == [
        (1.0, 0.8), (1.0, 0.95), (0.6, 0.8), (0.6, 0.95),
    ]  # fmt: skip
    assert len({each["f"] for each in found["chart"]}) == 8
    limits = [each["delay_limit_ms"] for each in found["design"]]
    assert limits[0] > limits[1]
    assert limits[2] > limits[0]
    result = run("--design", "--figure", folder / "chart.svg")
    assert "d alone" in result.stdout
    assert (folder / "chart.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")


@pytest.mark.parametrize(
    "wrong",
    [
        (),
        ("none.csv",),
        ("good.csv", "--f", 1, "--f", 2),
        ("good.csv", "--confidence", 95),
        ("good.csv", "--threshold", 5),
        ("good.csv", "--command", "comand_m"),
        ("good.csv", "--criterion", "none.json"),
        ("good.csv", "--criterion", "good.csv", "--threshold", 0.02),
        ("good.csv", "--motion", "none.at2"),
        ("good.csv", "--metric", "peak"),
        ("good.csv", "--units", "furlong"),
        ("good.csv", "--xi", 2),
        ("--design", "--figure", "none/chart.svg"),
    ],
)
def test_bad_input_is_explained(folder, wrong, monkeypatch):
    monkeypatch.chdir(folder)
    assert isinstance(run(*wrong).exception, InputError)


def test_the_command_file_imports_no_numerics():
    code = "import sys, reliab.cli.assess; print('numpy' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert result.stdout.strip() == "False"
