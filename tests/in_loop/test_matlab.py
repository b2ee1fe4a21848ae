"""The toolbox for MATLAB and Octave gives what the functions of Python give, and their sentences."""

import json
import os
import shutil
import subprocess
import sys
from importlib.resources import files

import numpy as np
import pytest

from reliab.api import assess, derive_criteria
from reliab.shipped import shipped

OCTAVE = shutil.which("octave-cli")
pytestmark = pytest.mark.skipif(OCTAVE is None, reason="Octave is not installed here")
TOOLBOX = str(files("reliab.in_loop").joinpath("matlab"))


def said(script, folder, *, code=0):
    """Run lines of Octave with the toolbox on its path; return what they print."""
    environment = {**os.environ, "RELIAB": f"{sys.executable} -m reliab"}
    words = [OCTAVE, "--quiet", "--no-init-file", "--eval", f"addpath('{TOOLBOX}'); {script}"]
    run = subprocess.run(  # noqa: S603 - Octave
        words, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == code, run.stderr
    return run.stdout if code == 0 else run.stderr


def test_a_monitor_is_written_wherever_it_shall_stand(tmp_path):
    script = "m = reliab.monitor_export('c', 'it''s here', 'f', 1, 'xi', 0.02, 'rate', 256);"
    assert said(f"{script} disp(m.degrees_of_freedom)", tmp_path).strip() == "1"
    assert (tmp_path / "it's here" / "reliab_monitor.c").is_file()


@pytest.mark.slow
def test_an_array_is_judged_as_its_file(tmp_path):
    path = shipped("datasets", "sample_test/test.csv")
    script = (
        f"x = csvread('{path}', 1, 0); r = reliab.assess(x, 'f', 1, 'xi', 0.02, 'exact', true);"
        "disp(jsonencode(r))"
    )
    answer = json.loads(said(script, tmp_path))
    expected = assess(path, f=1, xi=0.02, exact=True)
    assert answer["verdict"] == expected.to_dict()["verdict"]
    for name in ("A", "d_ms", "probability"):
        assert np.isclose(answer[name], expected.to_dict()[name], rtol=1e-4)


@pytest.mark.slow
def test_a_refusal_is_an_error_with_the_same_sentence(tmp_path):
    sentence = said("reliab.assess('absent.csv', 'f', 1, 'xi', 0.02)", tmp_path, code=1)
    assert "error: absent.csv: A test's file must be readable" in sentence


@pytest.mark.slow
def test_a_criterion_is_that_of_python(tmp_path):
    path = shipped("datasets", "paper/table2.csv")
    script = f"c = reliab.criterion('ellipses', '{path}', 'f', [1], 'xi', 0.02); disp(jsonencode(c))"
    answer = json.loads(said(script, tmp_path))
    expected = derive_criteria(ellipses=str(path), f=(1.0,), xi=(0.02,)).to_dict()
    assert [answer[name] for name in "ab"] == pytest.approx([expected[name] for name in "ab"], rel=1e-4)
