"""What the page computes is what Python computes."""

import json
import shlex

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.special import ndtr, ndtri, owens_t
from scipy.stats import t as student

from reliab.app.cli import run
from reliab.assessment.assess import assess
from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.placement import carried_limits
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Side
from reliab.criterion.published import published_criterion
from reliab.criterion.response_measures import ResponseMeasures
from reliab.criterion.scope import compare_with_scope
from reliab.recordings.reading import read_recording
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import ellipse_of_response

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


def asked(f, xi, threshold, confidence, metric, duration):
    return {
        "frequency": f,
        "dampingRatio": xi,
        "threshold": threshold,
        "confidence": confidence,
        "metric": metric,
        "duration": duration,
    }


def by_python(question, side, **options):
    f, xi, threshold, confidence, metric, duration = question
    criterion = default_criterion(f, xi, threshold, confidence, metric=metric, duration=duration, **options)
    return carried_limits(criterion, Structure(frequency=f, damping_ratio=xi), Side(side))[:2]


def test_special_functions(by_javascript):
    places = np.linspace(-8.0, 8.0, 33).tolist()
    pairs = [[h, a] for h in (-3.0, 0.0, 0.4, 2.0, 6.0) for a in (-9.0, -0.5, 0.0, 0.3, 1.0, 2.5)]
    degrees = [[x, n] for x in (-20.0, -2.5, -0.1, 0.0, 1.0, 7.0) for n in (1.0, 2.7, 18.4, 99.0)]
    shares = np.geomspace(1e-12, 0.999, 25).tolist()
    answers = by_javascript(
        ("special", {"name": "normalCumulative", "values": [[x] for x in places]}),
        ("special", {"name": "normalQuantile", "values": [[p] for p in shares]}),
        ("special", {"name": "owensT", "values": pairs}),
        ("special", {"name": "studentCumulative", "values": degrees}),
    )
    expected = (
        ndtr(places),
        ndtri(shares),
        owens_t(*np.transpose(pairs)),
        student.cdf(*np.transpose(degrees)),
    )
    for answer, values in zip(answers, expected, strict=True):
        np.testing.assert_allclose(answer, values, rtol=1e-10, atol=1e-15)


@pytest.mark.parametrize(("size", "points"), [(64, 64), (97, 97), (250, 250), (97, 128)])
def test_transform_and_spline(by_javascript, size, points):
    values = np.random.default_rng(size).normal(size=size)
    places = np.linspace(0.0, size - 1.0, 200)
    (real, imaginary), interpolated = by_javascript(
        ("transform", {"values": values.tolist(), "points": points}),
        ("spline", {"values": values.tolist(), "places": places.tolist()}),
    )
    expected = np.fft.rfft(values, points)
    np.testing.assert_allclose(np.array(real) + 1j * np.array(imaginary), expected, atol=1e-11)
    np.testing.assert_allclose(interpolated, CubicSpline(np.arange(size), values)(places), atol=1e-11)


@pytest.mark.slow
def test_limits_are_those_of_python(by_javascript):
    sides = ("lag", "lead")
    answers = by_javascript(
        *[("limits", {**asked(*question), "side": side}) for question in QUESTIONS for side in sides]
    )
    expected = [by_python(question, side) for question in QUESTIONS for side in sides]
    np.testing.assert_allclose(answers, expected, rtol=ROUNDED)
    assert answers[-1] == [0.0, 0.0]  # 19 earthquakes do not carry 99.5 %


@pytest.mark.slow
def test_a_threshold_that_an_actuator_at_rest_keeps_accepts_nothing(by_javascript):
    questions = [(f, xi, 0.2, 0.9, "rms", None) for f in (0.25, 0.6, 1.0, 2.0) for xi in (0.02, 0.05, 0.1)]
    answers = by_javascript(*[("limits", {**asked(*question), "side": "lag"}) for question in questions])
    refused = 0
    for question, answer in zip(questions, answers, strict=True):
        try:
            assert answer == pytest.approx(by_python(question, "lag"), rel=ROUNDED)
        except InputError:
            assert answer == [0.0, 0.0]
            refused += 1
    assert 0 < refused < len(questions)


@pytest.mark.slow
def test_band_holds_the_criterion_without_one_earthquake(by_javascript, shipped_ellipses):
    (answer,) = by_javascript(("band", {**asked(*QUESTIONS[0]), "side": "lag"}))
    for event in np.unique(shipped_ellipses["record"]["event"].values)[::6]:
        for (low, high), limit in zip(
            answer, by_python(QUESTIONS[0], "lag", without=str(event)), strict=True
        ):
            assert 0.99 * low <= limit <= 1.01 * high


@pytest.mark.slow
def test_band_is_the_criterion_without_one_earthquake_after_the_other(by_javascript, shipped_ellipses):
    (answer,) = by_javascript(("band", {**asked(*QUESTIONS[0]), "side": "lag"}))
    events = np.unique(shipped_ellipses["record"]["event"].values)
    without = np.array([by_python(QUESTIONS[0], "lag", without=str(event)) for event in events])
    # The page carries the population once; Python does it again without each earthquake
    np.testing.assert_allclose(answer, np.transpose([without.min(axis=0), without.max(axis=0)]), rtol=1e-2)


def test_a_length_is_among_those_of_the_motions_as_assess_says_it(by_javascript, packed):
    lengths = packed["lengths"]
    cases = [5.0, lengths[0], 12.0, lengths[1], 30.0, lengths[2], 95.0, lengths[3], 130.0]
    asked_of = [{"quantities": {"length": length}, "ranges": {"length": lengths}} for length in cases]
    answers = [answer["position"] for answer in by_javascript(*(("among", asked) for asked in asked_of))]
    scope = {"length": lengths}
    assert answers == [str(compare_with_scope(scope, {"length": length}).position) for length in cases]
    assert set(answers) == {"inside", "at the edge", "outside"}


@pytest.mark.parametrize(("f", "xi", "share"), [(0.9, 0.024, 1.0), (1.7, 0.08, 0.4)])
def test_a_response_is_among_those_of_the_motions_as_assess_says_it(by_javascript, f, xi, share):
    """The least favourable quantity decides; ranges are those of the nearest structure that ships."""
    step, structure = 0.01, Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
    times = step * np.arange(3000)
    motion = np.sin(2.0 * np.pi * f * times) * np.exp(-(((times - 12.0) / 4.0) ** 2))
    of_one = ResponseMeasures.of_one(ellipse_of_response(motion, step, structure), structure, "a test")
    quantities = {name: float(values.item()) for name, values in of_one.compared.items()}
    stated = {"frequency": f, "dampingRatio": xi, "share": share}
    measured, ranges = by_javascript(
        ("response", {"values": motion.tolist(), "step": step, "structure": stated}),
        ("ranges", {"structure": stated}),
    )
    assert measured == pytest.approx(quantities, rel=1e-6)
    scope = default_criterion(f, xi).provenance.scope
    for name in quantities:
        assert ranges[name] == pytest.approx(scope[name], rel=1e-3)
    cases = [quantities | {"effective_duration": value} for value in (*ranges["effective_duration"], 900.0)]
    answers = by_javascript(*(("among", {"quantities": case, "ranges": ranges}) for case in cases))
    expected = [str(compare_with_scope(ranges, case).position) for case in cases]
    assert [answer["position"] for answer in answers] == expected
    assert expected[-1] == "outside"


def test_printed_law_and_index(by_javascript):
    printed = published_criterion("guo_2017_18")
    limits, outside, index = by_javascript(
        ("printed", asked(1.3, 0.04, 0.05, 0.95, "rms", None)),
        ("printed", asked(1.3, 0.04, 0.04, 0.95, "rms", None)),
        ("index", {"limits": [0.021 * 0.02, 0.1655], "amplitude": 1.0039, "delay": -0.39e-3}),
    )
    assert limits == pytest.approx([float(limit) for limit in printed.limits(1.3, 0.04)], rel=1e-12)
    assert outside is None
    assert index == pytest.approx(0.0039**2 / 0.00042 + 0.39**2 / 0.1655, rel=1e-12)


def written(command, measured, step):
    rows = zip(np.arange(command.size) * step, command, measured, strict=True)
    return "time_s,command_m,measured_m\n" + "\n".join(f"{t:.9g},{x:.10g},{y:.10g}" for t, x, y in rows)


def history(count, step, frequency):
    """A motion that grows and decays, at two frequencies, after a short rest."""
    time = np.maximum(np.arange(count) * step - 1.0, 0.0)
    shape = time**2 * np.exp(-time / 4.0)
    return 0.01 * shape * (np.sin(2.0 * np.pi * frequency * time) + 0.3 * np.sin(7.1 * frequency * time))


def late(command, gain, delay, step):
    places = np.arange(command.size) * step
    return gain * CubicSpline(places, command)(np.clip(places - delay, 0.0, None))


def made_tests():
    noise = np.random.default_rng(4).normal(size=5000)
    command = history(5000, 0.005, 1.2)
    yield "clean", written(command, late(command, 1.004, -0.0011, 0.005), 0.005), (1.2, 0.03, 1.0)
    noisy = late(command, 0.99, 0.003, 0.005) + 2e-4 * noise
    yield "noisy", written(command, noisy, 0.005), (1.25, 0.05, 0.6)
    yield "offset", written(command, noisy + 1.5e-3, 0.005), (1.2, 0.03, 0.8)
    moving = command[400:4001]
    yield "in motion", written(moving, late(moving, 0.998, 0.002, 0.005), 0.005), (1.2, 0.03, 1.0)
    spiked = noisy.copy()
    spiked[2000:2002] += 0.05
    yield "spike", written(command, spiked, 0.005), (1.2, 0.03, 1.0)
    drifting = noisy + np.linspace(-2e-3, 2e-3, 5000)
    yield "drift", written(command, drifting, 0.005), (1.2, 0.03, 1.0)
    yield "sample", SAMPLE.read_text(encoding="utf-8"), (1.0, 0.02, 1.0)


REPRESENTATIVE = {"noisy", "drift", "sample"}


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("text", "structure"),
    [
        pytest.param(*case, id=name, marks=() if name in REPRESENTATIVE else pytest.mark.slow)
        for name, *case in made_tests()
    ],
)
def test_amplitude_and_delay_are_those_of_assess(by_javascript, tmp_path, text, structure):
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    f, xi, alpha = structure
    python = assess(
        read_recording(path), Structure(frequency=f, damping_ratio=xi, experimental_fraction=alpha)
    ).tracking
    (page,) = by_javascript(("test", {"text": text, "threshold": 0.05}))
    assert page["amplitude"] == pytest.approx(python.amplitude, rel=1e-6)
    assert page["delay"] == pytest.approx(python.delay, rel=1e-6, abs=1e-9)


CRITERION = {"threshold": 0.05, "confidence": 0.95, "metric": "rms"}
OTHER_CRITERION = {"threshold": 0.03, "confidence": 0.9, "metric": "mte"}


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("name", "structure", "deviations", "criterion"),
    [
        ("test.csv", (1.0, 0.02, 1.0), (0.0, 0.0), CRITERION),
        ("Versuch 3 (neu), März.csv", (0.97, 0.024, 0.9), (0.013, 0.1), OTHER_CRITERION),
    ],
)
def test_the_command_to_copy_is_one_that_assess_takes(
    by_javascript, tmp_path, monkeypatch, capsys, name, structure, deviations, criterion
):
    (tmp_path / name).write_bytes(SAMPLE.read_bytes())
    monkeypatch.chdir(tmp_path)
    (line,) = by_javascript(("command", asked_of(name, structure, deviations, criterion)))
    program, *arguments = shlex.split(line)
    assert program == "reliab"
    assert run([*arguments, "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    f, xi, alpha = structure
    assert answer.items() >= ({"f": f, "xi": xi, "alpha": alpha} | criterion).items()
    tolerances = [StatedValue.parse(arguments[place]).deviation for place in (3, 5)]
    assert tolerances == pytest.approx([f * deviations[0], xi * deviations[1]], rel=2e-3)


def asked_of(name, structure, deviations, criterion):
    f, xi, alpha = structure
    return {
        "name": name,
        "structure": {"frequency": f, "dampingRatio": xi, "share": alpha},
        "deviations": {"frequency": deviations[0], "dampingRatio": deviations[1]},
        "criterion": criterion,
    }


@pytest.mark.default_cases(4)
@pytest.mark.parametrize(
    "name",
    [
        "$(reboot).csv",
        "`id`.csv",
        'a".csv',
        "a'b.csv",
        "a;b.csv",
        "a\nb.csv",
        "-rf.csv",
        "a!b.csv",
        "a%b%.csv",
        "a\\.csv",
        "\x1b[2J.csv",
        "~.csv",
    ],
)
def test_a_name_that_a_shell_could_misread_is_no_part_of_the_command(by_javascript, name):
    (line,) = by_javascript(("command", asked_of(name, (1.0, 0.02, 1.0), (0.0, 0.0), CRITERION)))
    assert line == "reliab assess FILE --f 1 --xi 0.02"


@pytest.mark.parametrize(
    "text",
    [
        "time,command [mm],measured [mm]\n{rows}",
        "# a comment\n\nt;xc_mm;xm_mm\n{rows;}",
        "Time (s)\tCommand\tMeasured\ns\tmm\tmm\n{rows\t}",
    ],
)
def test_files_are_read_as_by_python(by_javascript, tmp_path, text):
    command = 50.0 * history(400, 0.01, 1.0)
    columns = (np.arange(400) * 0.01, command, 0.99 * command)
    for mark in (",", ";", "\t"):
        rows = "\n".join(mark.join(f"{value:.8g}" for value in row) for row in zip(*columns, strict=True))
        text = text.replace("{rows}" if mark == "," else f"{{rows{mark}}}", rows)
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    recording = read_recording(path)
    (page,) = by_javascript(("read", {"text": text}))
    assert page["step"] == pytest.approx(recording.time_step, rel=1e-9)
    np.testing.assert_allclose(page["command"], recording.command, rtol=1e-12)
    np.testing.assert_allclose(page["measured"], recording.measured, rtol=1e-12)


@pytest.mark.default_cases(5)
@pytest.mark.parametrize(
    "name",
    [
        *("force_n", "Force [kN]", "load cell (kip)", "f_m", "reaction", "daq.force", "force"),
        *(
            "ground_acceleration_mps2",
            "ag",
            "ag [g]",
            "a_g (m/s²)",
            "xg_dd",
            "excitation_gal",
            "table_acceleration",
        ),
        *("temperature", "force_rate", "velocity_mps", "forced", "temposonic2", "strain"),
    ],
)
def test_command_and_measured_are_recognised_beside_other_channels_as_by_python(
    by_javascript, tmp_path, name
):
    rows = "\n".join(f"{i / 64},{i % 7},{i % 7},{i % 5}" for i in range(80))
    text = f"time_s,command_mm,measured_mm,{name}\n{rows}\n"
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    recording = read_recording(path)
    (page,) = by_javascript(("read", {"text": text}))
    np.testing.assert_allclose(page["command"], recording.command, rtol=1e-12)
    np.testing.assert_allclose(page["measured"], recording.measured, rtol=1e-12)


def table(rows):
    return "time,command,measured\n" + "\n".join(",".join(map(str, row)) for row in rows)


@pytest.mark.default_cases(4)
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "must hold rows of numbers"),
        ("<script>alert(1)</script>", "must hold rows of numbers"),
        (table([(0, 1, 2), (1, 2)]), "columns"),
        (table([(0, 1, 2), (1, 2, 3)]), "64 samples"),
        (table([(0, k % 7, k % 7) for k in range(80)]), "increase"),
        (table([(k + (k > 40), k % 7, k % 7) for k in range(300)]), "equal steps"),
        (
            table([(k + max(k - 200, 0), k % 7, k % 7) for k in range(400)]),
            "step between samples must not change",
        ),
        (table([(k, k % 7, "nan") for k in range(90)]), "finite"),
        (table([(k, k % 7, "1e999") for k in range(90)]), "finite"),
        (table([(k, k % 7, 1) for k in range(90)]).replace("measured", "force"), "measured"),
        (table([(k / 50, k % 7, 1) for k in range(900)]), "must move"),
        (table([(k / 50, k % 7, -(k % 7)) for k in range(900)]), "sign"),
        (table([(k / 50, k % 7, 1000 * (k % 7)) for k in range(900)]), "the same unit"),
        (table([(k / 50, k % 7, k % 7) for k in range(900)]), "identical"),
        (table([(k / 50, k % 7, k % 5 if k < 400 else 4) for k in range(900)]), "stands still"),
    ],
)
def test_a_recording_of_which_amplitude_and_delay_say_nothing_is_refused(by_javascript, text, reason):
    (page,) = by_javascript(("test", {"text": text, "threshold": 0.05}))
    assert reason in page["refused"]
