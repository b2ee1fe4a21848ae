"""One test gets one verdict, whatever the layout of its file and the door by which it comes."""

import json

import layouts
import pandas as pd
import pytest

import reliab
from reliab.app import cli

FIRST = (layouts.mts_793, layouts.dspace, layouts.tdms, layouts.xpc)


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """Verdict on the test with its force, and on its two displacements alone."""
    folder = tmp_path_factory.mktemp("t")
    whole = judged(layouts.matlab_vectors(folder))
    columns = {"time_s": layouts.TIME, "command_m": layouts.COMMAND, "measured_m": layouts.MEASURED}
    return {True: whole, False: judged(pd.DataFrame(columns))}


def judged(path):
    return reliab.assess(path, f=1.0, xi=0.02).to_dict()


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    "write",
    [pytest.param(write, marks=[] if write in FIRST else pytest.mark.slow) for write in layouts.LAYOUTS],
)
def test_the_verdict_is_that_of_the_same_test_in_another_file(tmp_path, write, expected):
    """To 1e-6; the ends of the interval and the probability, of which text has 12 digits, to 5e-6."""
    answer = judged(write(tmp_path))
    has_force = any(channel["channel"] == "force" for channel in answer["recording"]["channels"])
    expected = expected[has_force]
    for name in ("A", "d_ms"):
        assert answer[name] == pytest.approx(expected[name], rel=1e-6)
    rms = {key: pytest.approx(expected["error"]["rms"][key], rel=1e-6, abs=5e-6) for key in ("low", "high")}
    rms["value"] = pytest.approx(expected["error"]["rms"]["value"], rel=1e-6)
    assert {key: answer["error"]["rms"][key] for key in rms} == rms
    assert answer["verdict"] == expected["verdict"]
    assert answer["probability"] == pytest.approx(expected["probability"], abs=5e-6)


def test_command_and_python_give_the_same_numbers(tmp_path, capsys):
    path = layouts.tdms(tmp_path)
    assert cli.run(["assess", str(path), "--f", "1.0", "--xi", "0.02", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    answer = json.loads(json.dumps(judged(path), default=str))
    for name in ("verdict", "A", "d_ms", "probability", "error"):
        assert content[name] == answer[name]
