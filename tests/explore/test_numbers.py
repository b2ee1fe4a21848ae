"""What the page computes is what Python computes."""

import json
import shlex

import numpy as np
import pytest
from scipy.special import ndtr, ndtri, owens_t
from scipy.stats import t as student

from reliab.app.cli import run
from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.placement import scale_limits
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Side
from reliab.criterion.derivation import published_criterion
from reliab.structures.structure import Structure

ROUNDED = 3e-4
"""Limits that protect every length are carried, and the page keeps eleven binary digits of what it stores."""

SAMPLE = shipped("datasets", "sample_test/test.csv")
QUESTIONS = [
    (1.0, 0.02, 0.05, 0.95, "rms", None),
    (0.83, 0.037, 0.034, 0.9, "mte", None),
    (1.6, 0.055, 0.07, 0.975, "rms", 23.7),
    (2.0, 0.1, 0.1, 0.5, "rms", 40.0),
    (1.0, 0.05, 0.05, 0.8, "rms", None),
    (3.0, 0.015, 0.01, 0.99, "mte", 90.0),
    (1.0, 0.02, 0.05, 0.995, "rms", None),
]


def question_of(f, xi, threshold, confidence, metric, duration):
    return {
        "frequency": f,
        "dampingRatio": xi,
        "threshold": threshold,
        "confidence": confidence,
        "metric": metric,
        "duration": duration,
    }


def python_answer(question, side, **options):
    f, xi, threshold, confidence, metric, duration = question
    criterion = default_criterion(f, xi, threshold, confidence, metric=metric, duration=duration, **options)
    return scale_limits(criterion, Structure(frequency=f, damping_ratio=xi), Side(side))[:2]


@pytest.mark.slow
def test_special_functions(javascript):
    places = np.linspace(-8.0, 8.0, 33).tolist()
    pairs = [[h, a] for h in (-3.0, 0.0, 0.4, 2.0, 6.0) for a in (-9.0, -0.5, 0.0, 0.3, 1.0, 2.5)]
    degrees = [[x, n] for x in (-20.0, -2.5, -0.1, 0.0, 1.0, 7.0) for n in (1.0, 2.7, 18.4, 99.0)]
    shares = np.geomspace(1e-12, 0.999, 25).tolist()
    answers = javascript(
        ("special", {"name": "normalCumulative", "values": [[x] for x in places]}),
        ("special", {"name": "normalQuantile", "values": [[p] for p in shares]}),
        ("special", {"name": "owensT", "values": pairs}),
        ("special", {"name": "studentCumulative", "values": degrees}),
    )
    reference = (
        ndtr(places),
        ndtri(shares),
        owens_t(*np.transpose(pairs)),
        student.cdf(*np.transpose(degrees)),
    )
    for answer, values in zip(answers, reference, strict=True):
        np.testing.assert_allclose(answer, values, rtol=1e-10, atol=1e-15)


@pytest.mark.slow
def test_limits_are_those_of_python(javascript):
    sides = ("lag", "lead")
    answers = javascript(
        *[("limits", {**question_of(*question), "side": side}) for question in QUESTIONS for side in sides]
    )
    reference = [python_answer(question, side) for question in QUESTIONS for side in sides]
    np.testing.assert_allclose(answers, reference, rtol=ROUNDED)
    assert answers[-1] == [0.0, 0.0]  # 19 earthquakes do not carry 99.5 %


@pytest.mark.slow
def test_a_threshold_kept_by_an_actuator_at_rest_accepts_nothing(javascript):
    questions = [(f, xi, 0.2, 0.9, "rms", None) for f in (0.25, 0.6, 1.0, 2.0) for xi in (0.02, 0.05, 0.1)]
    answers = javascript(*[("limits", {**question_of(*question), "side": "lag"}) for question in questions])
    refusal = 0
    for question, answer in zip(questions, answers, strict=True):
        try:
            assert answer == pytest.approx(python_answer(question, "lag"), rel=ROUNDED)
        except InputError:
            assert answer == [0.0, 0.0]
            refusal += 1
    assert 0 < refusal < len(questions)


@pytest.mark.slow
def test_band_holds_the_criterion_without_one_earthquake(javascript, shipped_ellipses):
    (answer,) = javascript(("band", {**question_of(*QUESTIONS[0]), "side": "lag"}))
    for event in np.unique(shipped_ellipses["record"]["event"].values)[::6]:
        for (low, high), limit in zip(
            answer, python_answer(QUESTIONS[0], "lag", without=str(event)), strict=True
        ):
            assert 0.99 * low <= limit <= 1.01 * high


@pytest.mark.slow
def test_band_is_the_criterion_without_one_earthquake_after_the_other(javascript, shipped_ellipses):
    (answer,) = javascript(("band", {**question_of(*QUESTIONS[0]), "side": "lag"}))
    events = np.unique(shipped_ellipses["record"]["event"].values)
    baseline = np.array([python_answer(QUESTIONS[0], "lag", without=str(event)) for event in events])
    # The page carries the population once; Python does it again without each earthquake
    np.testing.assert_allclose(answer, np.transpose([baseline.min(axis=0), baseline.max(axis=0)]), rtol=1e-2)


def test_printed_law_and_index(javascript):
    output = published_criterion("guo_2017_18")
    limits, is_outside, index = javascript(
        ("printed", question_of(1.3, 0.04, 0.05, 0.95, "rms", None)),
        ("printed", question_of(1.3, 0.04, 0.04, 0.95, "rms", None)),
        ("index", {"limits": [0.021 * 0.02, 0.1655], "amplitude": 1.0039, "delay": -0.39e-3}),
    )
    assert limits == pytest.approx([float(limit) for limit in output.limits(1.3, 0.04)], rel=1e-12)
    assert is_outside is None
    assert index == pytest.approx(0.0039**2 / 0.00042 + 0.39**2 / 0.1655, rel=1e-12)


CRITERION = {"threshold": 0.05, "confidence": 0.95, "metric": "rms"}
OTHER_CRITERION = {"threshold": 0.03, "confidence": 0.9, "metric": "mte"}


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("structure", "deviations", "criterion"),
    [
        ((1.0, 0.02, 1.0), (0.0, 0.0), CRITERION),
        ((0.97, 0.024, 0.9), (0.013, 0.1), OTHER_CRITERION),
    ],
)
def test_the_command_to_copy_is_accepted_by_assess(
    javascript, tmp_path, monkeypatch, capsys, structure, deviations, criterion
):
    (tmp_path / "TEST.csv").write_bytes(SAMPLE.read_bytes())
    monkeypatch.chdir(tmp_path)
    f, xi, alpha = structure
    (line,) = javascript(
        (
            "command",
            {
                "structure": {"frequency": f, "dampingRatio": xi, "share": alpha},
                "deviations": {"frequency": deviations[0], "dampingRatio": deviations[1]},
                "criterion": criterion,
            },
        )
    )
    program, *arguments = shlex.split(line)
    assert program == "reliab"
    assert run([*arguments, "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer.items() >= ({"f": f, "xi": xi, "alpha": alpha} | criterion).items()
    tolerances = [StatedValue.parse(arguments[place]).deviation for place in (3, 5)]
    assert tolerances == pytest.approx([f * deviations[0], xi * deviations[1]], rel=2e-3)
