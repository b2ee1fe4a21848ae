"""The toolbox for MATLAB and Octave gives what the functions of Python give, and their sentences."""

import json
import os
import shutil
import subprocess
import sys
from importlib.resources import files

import numpy as np
import pytest

from reliab.app.api.assessment import assess
from reliab.app.api.criteria import derive_criteria
from reliab.app.api.diagnosis import diagnose_campaign
from reliab.core.shipped import shipped

OCTAVE = shutil.which("octave-cli")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="Octave is not installed here")
TOOLBOX = str(files("reliab.in_loop").joinpath("matlab"))


ANSWERS = """
for word; do printf '%s\\n' "$word" >> words.txt; answer=$word; done
printf '{"verdict": "reliable", "rms": {"low": 0.01}, "criteria": [{"a": 1}, {"a": 2}],' > "$answer"
printf '"none": null}' >> "$answer"
"""
REFUSES = """
echo 'Error: The file must be there; found 2 of 3. Give it'
exit 2
"""


def run_octave(script, folder, *, code=0, program=f"{sys.executable} -m reliab"):
    """Run lines of Octave with the toolbox on its path; return what they print."""
    environment = {**os.environ, "RELIAB": program}
    words = [OCTAVE, "--quiet", "--no-init-file", "--eval", f"addpath('{TOOLBOX}'); {script}"]
    run = subprocess.run(  # noqa: S603 - Octave
        words, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == code, run.stderr
    return run.stdout if code == 0 else run.stderr


@pytest.mark.slow
@needs_octave
def test_a_monitor_is_written_wherever_it_shall_stand(tmp_path):
    script = "m = reliab.monitor_export('c', 'it''s here', 'f', 1, 'xi', 0.02, 'rate', 256);"
    assert run_octave(f"{script} disp(m.degrees_of_freedom)", tmp_path).strip() == "1"
    assert (tmp_path / "it's here" / "reliab_monitor.c").is_file()


@needs_octave
def test_names_and_values_are_options_of_the_command_line(tmp_path):
    """With a program in the place of reliab, which keeps its words and answers."""
    (tmp_path / "answers.sh").write_text(ANSWERS)
    script = """
        r = reliab.assess('t.csv', 'f', 1, 'xi', '0.02', 'exact', true, 'check', false, 'feedback_lag', 2.5);
        assert(strcmp(r.verdict, 'reliable') && r.rms.low == 0.01 && isempty(r.none));
        r = reliab.criterion('ellipses', {'a b.csv', 'c.csv'}, 'f', [1 2]);
        assert([r.criteria.a], [1 2]);
        reliab.diagnose('it''s', 'out', 'x');
        reliab.monitor_export('fmu3', 'm.fmu', 'structure', 'frame.toml', 'rate', 4096);
    """
    run_octave(script, tmp_path, program="sh answers.sh")
    words = (tmp_path / "words.txt").read_text().splitlines()
    calls = [
        "assess t.csv --f 1 --xi 0.02 --exact --feedback-lag 2.5 --json *",
        "criterion --ellipses a b.csv c.csv --f 1 2 --json *",
        "diagnose it's --out x --json *",
        "monitor --export fmu3 m.fmu --structure frame.toml --rate 4096 --json *",
    ]
    assert " ".join("*" if word.endswith(".json") else word for word in words) == " ".join(calls)


@needs_octave
def test_refusals_of_the_command_line_are_errors(tmp_path):
    (tmp_path / "refuses.sh").write_text(REFUSES)
    sentence = run_octave("reliab.criterion('f', 1)", tmp_path, code=1, program="sh refuses.sh")
    assert sentence.splitlines()[0] == "error: The file must be there; found 2 of 3. Give it"


@needs_octave
@pytest.mark.slow
def test_diagnosis_equals_python(tmp_path):
    folder = shipped("datasets", "campaigns/rig_c")
    script = f"d = reliab.diagnose('{folder}'); disp(jsonencode(d))"
    answer = json.loads(run_octave(script, tmp_path))
    expected = diagnose_campaign(str(folder)).to_dict()
    assert answer["verdict"] == expected["verdict"]
    assert answer.keys() == expected.keys()


@needs_octave
@pytest.mark.slow
def test_an_array_is_judged_as_its_file(tmp_path):
    """The file's header, a line above its columns, states the skew that the array is given beside it."""
    path = shipped("datasets", "sample_test/test.csv")
    script = (
        f"x = csvread('{path}', 2, 0); "
        "r = reliab.assess(x, 'f', 1, 'xi', 0.02, 'skew', '0±0.41', 'exact', true); disp(jsonencode(r))"
    )
    answer = json.loads(run_octave(script, tmp_path))
    expected = assess(path, f=1, xi=0.02, exact=True)
    assert answer["verdict"] == expected.to_dict()["verdict"]
    for name in ("A", "d_ms", "probability"):
        assert np.isclose(answer[name], expected.to_dict()[name], rtol=1e-4)


@needs_octave
@pytest.mark.slow
def test_a_refusal_is_an_error_with_the_same_sentence(tmp_path):
    sentence = run_octave("reliab.assess('absent.csv', 'f', 1, 'xi', 0.02)", tmp_path, code=1)
    assert "error: absent.csv: No such file" in sentence


@needs_octave
@pytest.mark.slow
def test_criterion_equals_python(tmp_path):
    path = shipped("datasets", "paper/table2.csv")
    script = f"c = reliab.criterion('ellipses', '{path}', 'f', [1], 'xi', 0.02); disp(jsonencode(c))"
    answer = json.loads(run_octave(script, tmp_path))
    expected = derive_criteria(ellipses=str(path), f=(1.0,), xi=(0.02,)).to_dict()
    assert [answer[name] for name in "ab"] == pytest.approx([expected[name] for name in "ab"], rel=1e-4)


@pytest.mark.parametrize("is_accepted", [True, False])
def test_the_toolbox_is_matlab_and_not_octave_alone(tmp_path, is_accepted):
    """A parser of MATLAB's language takes it, and does not take what Octave alone has."""
    pytest.importorskip("miss_hit", reason="MISS_HIT is not installed here (it comes with the extra test)")
    (tmp_path / "octave.m").write_text("function x = octave(a)\n    x = !a;  # not a\nend\n")
    words = [sys.executable, "-m", "miss_hit.mh_lint", TOOLBOX if is_accepted else str(tmp_path)]
    run = subprocess.run(words, capture_output=True, text=True, check=False)  # noqa: S603 - the parser
    assert (run.returncode == 0) is is_accepted, run.stdout
    assert f"{5 if is_accepted else 1} file(s) analysed" in run.stdout
