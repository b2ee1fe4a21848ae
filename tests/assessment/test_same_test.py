"""Runs of one test with different delays, against the true response of another code."""

from dataclasses import replace

import numpy as np
import pytest
from rebuilt_error.laboratory import DELAY, HYSTERESIS, RATE, Lab, run, synthetic_ground

from reliab import assess
from reliab.assessment.same_test import combine_runs
from reliab.assessment.verdict import Word
from reliab.core.errors import InputError
from reliab.recordings.recording import Recording

STEP = 1.0 / RATE
LAB = Lab(1.2, 0.04, 0.8)
GROUND = synthetic_ground(2, 12.0)


def runs_of(lab, taus=(0.0015, 0.003, 0.0045), gains=(1.0, 1.0, 1.0)):
    rng = np.random.default_rng(4)
    outcomes = []
    for tau, gain in zip(taus, gains, strict=True):
        outcome = run(replace(lab, kind=DELAY, numbers=(gain, tau, 0.0, 0.0)), GROUND)
        noise = 1e-3 * float(np.std(outcome.measured)) * rng.standard_normal(outcome.measured.size)
        outcomes.append(replace(outcome, measured=outcome.measured + noise))
    return outcomes


def assess_runs(outcomes, **stated_values):
    recordings = [
        Recording(command=outcome.command, measured=outcome.measured, time_step=STEP, name=f"run {place}")
        for place, outcome in enumerate(outcomes)
    ]
    arguments = {"f": 1.2, "xi": 0.04, "alpha": 0.8, **stated_values}
    return assess(recordings, **arguments)


@pytest.fixture(scope="module")
def yielding_runs():
    """Runs of a specimen that yields, which nobody stated."""
    peak = float(np.abs(run(LAB, GROUND).command).max())
    return runs_of(replace(LAB, specimen=HYSTERESIS, shape=(peak / 3.0, 0.03, 8.0)))


@pytest.fixture(scope="module")
def assessments(yielding_runs):
    return assess_runs(yielding_runs)


@pytest.mark.slow
def test_yielding_specimen_has_its_true_error_from_three_runs(yielding_runs, assessments):
    joint = assessments.same_test()
    exact = yielding_runs[0].ideal
    assert np.sqrt(np.mean((joint.response - exact) ** 2)) < 0.1 * yielding_runs[1].rms * np.abs(exact).max()
    for estimate, outcome in zip(joint.runs, yielding_runs, strict=True):
        assert estimate.error.value == pytest.approx(outcome.rms, rel=0.2)
        assert estimate.error.low < outcome.rms < estimate.error.high


@pytest.mark.slow
def test_the_dictionary_holds_every_run_with_its_own_error(assessments):
    content = assessments.same_test().to_dict()
    assert [single["file"] for single in content["runs"]] == ["run 0", "run 1", "run 2"]
    assert [single["d_ms"] for single in content["runs"]] == pytest.approx([1.5, 3.0, 4.5], rel=0.05)
    first = assessments.judged["run 0"].error.estimate(assessments.judged["run 0"].error.metric)
    assert content["runs"][0]["alone"]["value"] == first.value
    assert content["reliable"] == all(single["verdict"] == Word.RELIABLE for single in content["runs"])
    assert content["line_against_parabola"] < 0.05


@pytest.mark.slow
def test_wrongly_stated_structure_is_contradicted(yielding_runs):
    joint = assess_runs(yielding_runs, f=1.02, exact=True).same_test()
    assert any(run.contradicts for run in joint.runs)
    assert any("not as stated" in sentence for sentence in joint.sentences)
    assert joint.runs[1].error.value == pytest.approx(yielding_runs[1].rms, rel=0.25)


def test_two_runs_are_a_line_and_say_so(assessments):
    joint = combine_runs(dict(list(assessments.judged.items())[:2]))
    assert joint.checked is None
    assert "third run" in joint.sentences[0]


def test_incompatible_runs_are_refused(assessments):
    first = assessments.judged["run 0"]
    with pytest.raises(InputError, match="at least two runs"):
        combine_runs({"a": first})
    with pytest.raises(InputError, match="differ in gain or delay"):
        combine_runs({"a": first, "b": first})
    later = replace(first.recording, command=np.roll(first.recording.command, 300))
    with pytest.raises(InputError, match="different instants"):
        combine_runs({"a": first, "b": replace(first, recording=later)})
    backwards = replace(first.recording, command=first.recording.command[::-1].copy())
    with pytest.raises(InputError, match="different commands"):
        combine_runs({"a": first, "b": replace(first, recording=backwards)})
    faster = replace(first.recording, time_step=0.5 * STEP)
    with pytest.raises(InputError, match="different sampling rates"):
        combine_runs({"a": first, "b": replace(first, recording=faster)})
