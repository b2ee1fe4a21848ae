"""A threshold that one command takes every command takes."""

import json
import re

import pytest

from reliab.app.cli import run
from reliab.core.shipped import shipped
from reliab.criterion.ellipse_reading import read_ellipses

TEST = str(shipped("datasets", "sample_test/test.csv"))
STRUCTURE = ("--f", "1", "--xi", "0.02")
QUESTIONS = {
    "assess": ["assess", TEST, *STRUCTURE],
    "design": ["design", *STRUCTURE],
    "monitor": ["monitor", TEST, *STRUCTURE, "--wait", "0.05"],
    "criterion": ["criterion", "--ellipses", "real_suite", *STRUCTURE],
}


@pytest.mark.slow
@pytest.mark.parametrize("threshold", ["0.005", "0.04"])
@pytest.mark.parametrize("question", QUESTIONS.values(), ids=QUESTIONS)
def test_every_question_interpolates_untraced_thresholds(question, threshold):
    assert run([*question, "--threshold", threshold, "--json", "-"]) in (0, 1)


@pytest.mark.slow
@pytest.mark.parametrize("scheme", [(), ("--calibration",)])
def test_a_criterion_is_put_to_the_test_at_any_threshold(tmp_path, scheme):
    ellipses_at_one = read_ellipses("real_suite").sel(f=[1.0], xi=[0.05])
    ellipses_at_one.to_netcdf(tmp_path / "one.nc", engine="h5netcdf")
    options = ("--scheme", "k_fold", "--trials", "20", "--threshold", "0.04")
    assert run(["validate", "--ellipses", str(tmp_path / "one.nc"), *options, *scheme]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("threshold", [0.15, 0.5])
def test_a_test_is_judged_by_its_error_where_no_criterion_is_possible(capsys, threshold):
    arguments = ("--threshold", str(threshold), "--json", "-")
    assert run([*QUESTIONS["assess"], *arguments]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["verdict"], answer["threshold"]) == ("reliable", threshold)
    if threshold > 0.2:
        assert (answer["confidence"], answer["by_index"]["verdict"]) == (None, "undecided")
        assert run([*QUESTIONS["criterion"], *arguments]) == 2


@pytest.mark.parametrize("question", QUESTIONS.values(), ids=QUESTIONS)
@pytest.mark.parametrize("threshold", ["0", "5", "nan"])
def test_every_question_refuses_invalid_shares(capsys, question, threshold):
    assert run([*question, "--threshold", threshold]) == 2
    assert re.search("--threshold must be (positive, and )?at most 2", capsys.readouterr().err)
