"""The study of specimens that are known by their force: its specimens, its rates, its report."""

import numpy as np
import pandas as pd
import pytest
from reliab_studies.measured_specimen.judging import compare_with_stated, summarise
from reliab_studies.measured_specimen.kind import KIND, RATES, TESTS
from reliab_studies.measured_specimen.simulated_tests import Actuator, Loop
from reliab_studies.measured_specimen.specimens import FAMILIES, PARAMETERS, STATES, resist

from reliab.core.errors import InputError

_STEP = 1.0 / 512.0
_TIMES = np.arange(0.0, 8.0, _STEP)


def _force(family, parameters, path):
    all_parameters = np.zeros(PARAMETERS)
    all_parameters[: len(parameters)] = parameters
    state, increments = np.zeros(STATES), np.diff(path, prepend=0.0)
    law = FAMILIES[family][0]
    return np.array(
        [
            resist(law, x, increment, increment / _STEP, _STEP, state, all_parameters)
            for x, increment in zip(path.tolist(), increments.tolist(), strict=True)
        ]
    )


@pytest.mark.slow
def test_a_ramberg_osgood_specimen_follows_its_skeleton_and_the_rule_of_masing():
    path = 2.0 * np.sin(np.pi * _TIMES)
    force = _force("Ramberg-Osgood", [0.5, 5.0], path)
    loading = _TIMES <= 0.5
    assert force[loading] * (1.0 + 0.5 * force[loading] ** 4) == pytest.approx(path[loading], abs=1e-6)
    half = (force - force.max()) / 2.0
    unloading = (_TIMES > 0.5) & (_TIMES < 1.4)
    reference = (path[unloading] - path.max()) / 2.0
    assert half[unloading] * (1.0 + 0.5 * half[unloading] ** 4) == pytest.approx(reference, abs=2e-3)


@pytest.mark.slow
def test_a_magnetorheological_damper_dissipates_in_every_cycle():
    path = np.sin(2.0 * np.pi * _TIMES)
    dissipative_force = _force("MR damper", [0.8, 0.05, 0.3], path) - 0.5 * path
    late = _TIMES >= 4.0
    work = np.trapezoid(dissipative_force[late], path[late])
    assert 4 * 4 * 0.4 < work < 4 * 4 * 1.2  # about that of friction of its size


def test_the_loop_of_a_linear_specimen_is_an_oscillator():
    load = np.zeros(_TIMES.size)
    load[1:] = 1.0
    loop = Loop(
        frequency=1.0,
        damping_ratio=0.05,
        share=0.6,
        family="linear",
        parameters=[0.0],
        yield_displacement=1.0,
    )
    command, displacement, force = loop.run(load, _STEP, Actuator())
    turns, damped_frequency = 2.0 * np.pi, 2.0 * np.pi * np.sqrt(1.0 - 0.05**2)
    decay = np.exp(-0.05 * turns * _TIMES)
    reference = (
        1.0
        - decay
        * (
            np.cos(damped_frequency * _TIMES)
            + 0.05 * turns / damped_frequency * np.sin(damped_frequency * _TIMES)
        )
    ) / turns**2
    assert command == pytest.approx(reference, abs=0.02 * reference.max())
    assert np.array_equal(displacement, command)
    assert force == pytest.approx(0.6 * turns**2 * displacement)


def _make_row(**changes):
    row = {"family": "gap", "decibels": 40.0, "true": 0.04, "value": 0.041, "low": 0.038, "high": 0.044}
    return {**row, "word": "reliable", "left": 0.1, "inside": 0.9, "held_out": 0.01, **changes}


def test_rates_count_missed_refused_and_undecided_tests():
    tests = pd.DataFrame(
        [
            _make_row(),
            _make_row(value=0.05, low=0.045, high=0.06, word="undecided"),
            _make_row(true=0.06, value=0.049, low=0.04, high=0.07),
            _make_row(value=np.nan, low=np.nan, high=np.nan, word="refused"),
        ]
    )
    row = summarise(tests, 0.05).iloc[-1]
    assert row[["near", "wide", "held"]].tolist() == [0.25, 0.5, 0.5]
    assert row[["false_safe", "undecided"]].tolist() == [0.25, 0.5]
    assert row["accepted"] == pytest.approx(1.0 / 3.0)


def test_verdicts_and_widths_tell_the_loss_of_a_linear_specimen():
    stated_columns = {"stated_value": 0.04, "stated_low": 0.039, "stated_high": 0.041}
    tests = pd.DataFrame(
        [
            _make_row(family="linear", **stated_columns, stated_word="reliable"),
            _make_row(family="linear", **stated_columns, stated_word="not_reliable"),
            _make_row(),
        ]
    )
    losses = compare_with_stated(tests)
    assert (losses["tests"], losses["agree"], losses["opposed"]) == (2.0, 0.5, 0.5)
    assert losses["width"] == pytest.approx(3.0)
    assert compare_with_stated(pd.DataFrame([_make_row()])) == {}


def test_the_report_says_the_rates(tmp_path, text_of):
    study = KIND.tables.model_validate({"title": "Measured", "kind": "measured_specimen"})
    stated_columns = {
        "stated_value": 0.05,
        "stated_low": 0.04,
        "stated_high": 0.055,
        "stated_word": "reliable",
    }
    linear = _make_row(family="linear", value=0.05, low=0.045, high=0.06, **stated_columns)
    tests = pd.DataFrame([_make_row(), _make_row(decibels=30.0), linear])
    tests.to_csv(tmp_path / TESTS, index=False)
    summarise(tests, 0.05).to_csv(tmp_path / RATES, index=False)
    text = text_of(KIND.report(study, tmp_path))
    assert "Of 3 tests the computed error lies within 10 % of the true one in 67 %" in text
    assert "interval holds it in 67 %" in text
    assert "One test of a linear specimen was judged as if the specimen were stated as linear, too" in text


@pytest.mark.parametrize(
    ("tables", "says"),
    [({"specimens": {"families": ["glass"]}}, "glass"), ({"motions": {"results": "ductility"}}, "stored")],
)
def test_unknown_settings_of_the_study_are_refused(tables, says):
    content = {"title": "Measured", "kind": "measured_specimen", **tables}
    with pytest.raises((InputError, ValueError), match=says):
        KIND.stages(KIND.tables.model_validate(content))


@pytest.mark.slow
def test_the_study_judges_tests(tmp_path):
    content = {
        "title": "Measured",
        "kind": "measured_specimen",
        "specimens": {"families": ["linear", "Ramberg-Osgood"], "tests": 1},
    }
    study = KIND.tables.model_validate(content)
    (stage,) = KIND.stages(study)
    stage.work(tmp_path)
    tests = pd.read_csv(tmp_path / TESTS)
    assert (tests["value"] / tests["true"]).iloc[0] == pytest.approx(1.0, abs=0.05)
    assert tests["word"].isin(["reliable", "undecided", "not_reliable"]).all()
    assert tests["stated_value"].notna().tolist() == [True, False]
