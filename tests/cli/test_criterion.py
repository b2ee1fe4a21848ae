import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner, Result

from reliab.cli.criterion import app
from reliab.errors import InputError
from reliab.shipped import shipped

TABLE2 = shipped("datasets", "paper/table2.csv")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def answer(*arguments: object) -> dict:
    return json.loads(run(*arguments, "--json", "-").stdout)


def test_the_printed_table_gives_the_printed_criterion():
    found = answer("--ellipses", TABLE2)
    assert found["a"] == pytest.approx(5.29e-5, abs=0.005e-5)
    assert found["b"] == pytest.approx(1.048, abs=0.0005)
    assert found["correlation"] == pytest.approx(0.977, abs=0.0005)
    assert (found["f"], found["xi"], found["threshold"]) == (1.0, 0.02, 0.05)
    assert (found["confidence"], found["method"]) == (0.95, "quantile")
    assert (found["n_motions"], found["n_events"]) == (100, 19)


def test_the_roots_are_the_limits_of_a_test():
    found = answer("--ellipses", TABLE2)
    assert found["amplitude_limit"] ** 2 == pytest.approx(found["a"])
    assert found["delay_limit_ms"] ** 2 == pytest.approx(found["b"])


def test_one_criterion_stands_at_the_top_too():
    found = answer("--ellipses", TABLE2)
    (only,) = found["criteria"]
    assert {name: found[name] for name in only} == only


def test_several_confidences_give_a_list_in_order_and_no_top_level_values():
    found = answer("--ellipses", TABLE2, "--confidence", 0.9, "--confidence", 0.99)
    assert set(found) == {"criteria"}
    assert [each["confidence"] for each in found["criteria"]] == [0.9, 0.99]
    assert found["criteria"][0]["a"] > found["criteria"][1]["a"]


def test_the_table_shows_the_limits_and_the_number_of_earthquakes():
    shown = run("--ellipses", TABLE2).stdout
    assert "100 motions of 19 earthquakes" in shown
    assert "5.29e-05" in shown
    assert "1.05" in shown


def test_a_structure_can_be_declared_for_a_table():
    found = answer("--ellipses", TABLE2, "--f", 2, "--xi", 0.05)
    assert (found["f"], found["xi"]) == (2.0, 0.05)


def test_motions_are_simulated_then_and_there(tmp_path):
    from reliab.motions.synthetic import synthetic_suite
    from reliab.motions.writing import write_suite

    write_suite(synthetic_suite(count=6), tmp_path / "suite")
    found = answer(
        "--motions", tmp_path / "suite", "--f", 1, "--f", 2, "--threshold", 0.05, "--threshold", 0.1
    )
    assert [(each["f"], each["threshold"]) for each in found["criteria"]] == [
        (1.0, 0.05), (1.0, 0.1), (2.0, 0.05), (2.0, 0.1),
    ]  # fmt: skip
    assert {each["n_events"] for each in found["criteria"]} == {3}


@pytest.mark.parametrize(
    "wrong",
    [
        (),
        ("--ellipses", TABLE2, "--motions", "synthetic"),
        ("--ellipses", TABLE2, "--confidence", 95),
        ("--ellipses", TABLE2, "--method", "magic"),
        ("--ellipses", TABLE2, "--f", 1, "--f", 2),
        ("--ellipses", "none.csv"),
    ],
)
def test_bad_input_is_explained(wrong):
    result = run(*wrong)
    assert isinstance(result.exception, InputError)


def test_the_command_file_imports_no_numerics():
    code = "import sys, reliab.cli.criterion; print('numpy' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert result.stdout.strip() == "False"
