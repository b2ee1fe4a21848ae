"""What was not stated and would turn a verdict, against simulations by another code."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from rebuilt_error.laboratory import CUBIC, DELAY, HYSTERESIS, RATE, Lab, run, synthetic_ground

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import Equipment, exact_equipment, ordinary_equipment
from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.rebuild import rebuild
from reliab.assessment.turning import (
    DUCTILITIES,
    HARDENINGS,
    Turning,
    _errors_if_filtered,
    errors_with,
    examine_turning,
    hardened,
    yielded,
)
from reliab.assessment.verdict import Verdict, Word
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
LAB = Lab(1.2, 0.04, 0.8, DELAY, (0.995, 0.002, 0.0, 0.0))
STRUCTURE = Structure(frequency=1.2, damping_ratio=0.04, experimental_fraction=0.8)


def make_question(threshold, **changes):
    arguments = {
        "structure": STRUCTURE,
        "stated": {},
        "equipment": ordinary_equipment(),
        "metric": Metric.RMS,
    }
    return Question(**{**arguments, "threshold": threshold, "model": None, "seed": 0, **changes})


def error_under(rebuilt, threshold):
    return ErrorOfTest(rebuilt=rebuilt, metric=Metric.RMS, threshold=threshold)


@pytest.fixture(scope="module")
def linear():
    return run(LAB, synthetic_ground(2, 15.0))


@pytest.fixture(scope="module")
def rebuilt(linear):
    return rebuild(linear.command, linear.measured, STEP, STRUCTURE)


@pytest.mark.parametrize("reduction", [2.0, 3.5])
def test_error_of_a_yielding_specimen_equals_its_simulation(linear, reduction):
    displacement = float(np.abs(linear.command).max()) / reduction
    yielding = replace(LAB, specimen=HYSTERESIS, shape=(displacement, 0.03, 8.0))
    outcome = run(yielding, synthetic_ground(2, 15.0))
    result = rebuild(outcome.command, outcome.measured, STEP, STRUCTURE)
    ductility = float(np.abs(outcome.measured).max()) / displacement
    error = errors_with(result, Metric.RMS, yielded, (ductility,))[ductility]
    assert error == pytest.approx(outcome.rms, rel=0.01)
    assert result.rms.value != pytest.approx(outcome.rms, rel=0.2)


def test_smallest_ductility_is_the_first_beyond_the_threshold(linear, rebuilt):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    sizes = errors_with(rebuilt, Metric.RMS, yielded, DUCTILITIES)
    assert sizes[6.0] < sizes[2.0] < 0.9 * rebuilt.rms.value
    threshold = 0.5 * (sizes[2.0] + sizes[2.5])
    question = make_question(threshold)
    turning = examine_turning(error_under(rebuilt, threshold), recording, question)
    assert turning.smallest_ductility == next(d for d in DUCTILITIES if sizes[d] < threshold)
    assert turning.error_if_yielding == (min(sizes.values()), max(sizes.values()))
    assert f"from a ductility of {turning.smallest_ductility:g} on" in turning.sentences[0]
    upper = examine_turning(error_under(rebuilt, 1.0), recording, make_question(1.0))
    assert upper.smallest_ductility is None
    assert "same verdict" in upper.sentences[0]


def test_error_of_a_hardening_specimen_equals_its_simulation(linear):
    largest = float(np.abs(linear.command).max())
    hardening = replace(LAB, specimen=CUBIC, shape=(0.3 / largest**2, 0.0, 0.0))
    outcome = run(hardening, synthetic_ground(2, 15.0))
    result = rebuild(outcome.command, outcome.measured, STEP, STRUCTURE)
    share = 0.3 * (float(np.abs(outcome.measured).max()) / largest) ** 2
    error = errors_with(result, Metric.RMS, hardened, (share,))[share]
    assert error == pytest.approx(outcome.rms, rel=0.01)
    assert result.rms.value != pytest.approx(outcome.rms, rel=0.05)


def test_smallest_hardening_is_the_first_beyond_the_threshold(linear, rebuilt):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    sizes = errors_with(rebuilt, Metric.RMS, hardened, HARDENINGS)
    threshold = 0.5 * (sizes[0.1] + sizes[0.15])
    turning = examine_turning(error_under(rebuilt, threshold), recording, make_question(threshold))
    lower = rebuilt.rms.value < threshold
    assert turning.smallest_hardening == next(h for h in HARDENINGS if (sizes[h] < threshold) != lower)
    assert turning.error_if_hardening == (min(sizes.values()), max(sizes.values()))
    share = f"{100.0 * turning.smallest_hardening:g} %"
    assert f"from a hardening of {share} on)" in turning.sentences[0]


def filter_values(values, corner):
    """Filter of second order by its transfer function, at rest before and after."""
    padded_record = np.concatenate([np.zeros(4096), values, np.full(4096, values[-1])])
    ratio = np.fft.rfftfreq(padded_record.size, STEP) / corner
    filtered_values = np.fft.rfft(padded_record) / (1.0 + 1j * math.sqrt(2.0) * ratio - ratio**2)
    return np.fft.irfft(filtered_values, padded_record.size)[4096 : 4096 + values.size]


def test_a_filter_on_one_channel_changes_the_error_as_its_removal_does(linear):
    """A test that is read through a filter has the error of the same test read without."""
    read = filter_values(linear.measured, 100.0)
    result = rebuild(linear.command, read, STEP, STRUCTURE)
    bare = _errors_if_filtered(error_under(result, 0.0))[100.0]
    assert result.rms.value > 1.3 * linear.rms
    assert bare == pytest.approx(linear.rms, rel=0.05)


def test_highest_filter_is_the_first_beyond_the_threshold(linear, rebuilt):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    largest = _errors_if_filtered(error_under(rebuilt, 1.0))
    threshold = 0.5 * (largest[100.0] + largest[80.0])
    turning = examine_turning(error_under(rebuilt, threshold), recording, make_question(threshold))
    assert turning.highest_filter == 80.0
    assert "at 80 Hz or lower on one channel alone" in turning.sentences[-1]
    stated_values = make_question(threshold, stated={"filter_delay": StatedValue(0.0, 0.01)})
    assert examine_turning(error_under(rebuilt, threshold), recording, stated_values).highest_filter is None


def test_nothing_is_asked_of_an_exact_laboratory_or_a_recorded_force(linear, rebuilt):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    error = error_under(rebuilt, 1.0)
    assert examine_turning(error, recording, make_question(1.0, equipment=exact_equipment())) == Turning()
    force_case = replace(recording, force=linear.force)
    assert examine_turning(error, force_case, make_question(1.0)).error_if_yielding is None


def test_a_specimen_may_have_yielded_whose_force_nobody_recorded_or_stated(linear):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    assert make_question(1.0).may_have_yielded(recording)
    assert not make_question(1.0, linear_specimen=True).may_have_yielded(recording)
    assert not make_question(1.0, equipment=exact_equipment()).may_have_yielded(recording)
    assert not make_question(1.0, measured_specimen=True).may_have_yielded(recording)
    assert not make_question(1.0).may_have_yielded(replace(recording, force=linear.force))


def test_assess_states_turning_points_of_its_verdict(linear):
    recording = Recording(command=linear.command, measured=linear.measured, time_step=STEP)
    content = assess(recording, STRUCTURE, equipment=ordinary_equipment(), threshold=0.2).to_dict()
    assert content["verdict"] == "reliable"
    assert set(content["would_turn"]) == {
        "smallest_ductility",
        "error_if_yielding",
        "smallest_hardening",
        "error_if_hardening",
        "highest_filter_hz",
    }
    assert any("No force was recorded" in warning for warning in content["warnings"])


@pytest.mark.slow
def test_yielded_specimen_turns_a_verdict_by_its_odds():
    lab = Lab(0.6, 0.05, 1.0, DELAY, (0.98, 0.0, 0.0, 0.0))
    outcome = run(lab, synthetic_ground(5, 15.0))
    recording = Recording(command=outcome.command, measured=outcome.measured, time_step=STEP)
    small = {field.name: 1e-9 for field in fields(Equipment) if field.name != "yielding"}
    reference = replace(ordinary_equipment(), **small)
    structure = Structure(frequency=0.6, damping_ratio=0.05)
    result = assess(recording, structure, equipment=reference, threshold=0.026)
    assert result.turning.smallest_ductility is not None
    assert result.probability > 0.95
    likely = result.probability / (1.0 + result.turning.odds) >= 0.95
    messages = result.warnings if likely else result.reasons
    assert any("(ductility up to 6)" in sentence for sentence in messages)
    assert result.reliable == likely
    linear = assess(recording, structure, equipment=reference, threshold=0.026, linear_specimen=True)
    assert not any("yielded" in reason for reason in linear.reasons)


@pytest.mark.parametrize("word", Word)
def test_only_a_reliable_verdict_is_limited_by_yielding(word):
    verdict = Verdict(word=word, reasons=("By its error.",))
    hardening = {"error_if_hardening": (0.01, 0.02)}
    turning = Turning(smallest_ductility=2.0, error_if_yielding=(0.01, 0.07), **hardening)
    is_limited = word is Word.RELIABLE
    assert bool(list(turning.doubts(verdict, 1.0))) is is_limited
    assert not list(replace(turning, odds=0.01).doubts(verdict, 0.99))
    assert bool(list(replace(turning, odds=0.1).doubts(verdict, 0.99))) is is_limited
    assert not list(Turning(error_if_yielding=(0.01, 0.02), **hardening).doubts(verdict, 1.0))
    hardening_test = Turning(
        smallest_hardening=0.4, error_if_yielding=(0.01, 0.02), error_if_hardening=(0.02, 0.07)
    )
    assert bool(list(hardening_test.doubts(verdict, 1.0))) is is_limited
