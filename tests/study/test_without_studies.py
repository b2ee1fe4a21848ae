"""The product answers where the studies were taken away."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import reliab

ASKED = """
import sys
from reliab.app.cli import run
print([run(arguments.split()) for arguments in sys.argv[1:]], file=sys.stderr)
"""


@pytest.fixture
def answered(tmp_path, request):
    """What commands say in a checkout that has no folder of studies."""
    checkout, product = tmp_path, Path(reliab.__file__).parent
    for folder in (product, product.parent / "datasets"):
        (checkout / folder.name).symlink_to(folder)
    return subprocess.run(  # noqa: S603 - our own words
        [sys.executable, "-W", "error", "-c", ASKED, *request.param],
        cwd=checkout,
        env={**os.environ, "PYTHONPATH": str(checkout)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
@pytest.mark.parametrize("answered", [["assess sample_test --f 1 --xi 0.02"]], indirect=True)
def test_assessments_need_no_study(answered):
    assert answered.stderr.splitlines()[-1] == "[0]"
    assert "RELIABLE" in answered.stdout


@pytest.mark.slow
@pytest.mark.parametrize("answered", [["criterion --ellipses real_suite --f 1 --xi 0.02"]], indirect=True)
def test_criteria_need_no_study(answered):
    assert answered.stderr.splitlines()[-1] == "[0]"
    assert "confidence" in answered.stdout


@pytest.mark.slow
@pytest.mark.parametrize("answered", [["run --list", "run"]], indirect=True)
def test_a_run_says_that_no_study_ships_and_what_to_name_instead(answered):
    assert answered.stderr.splitlines()[-1] == "[0, 2]"
    assert "none ships" in answered.stderr
    assert "No study" in answered.stderr
