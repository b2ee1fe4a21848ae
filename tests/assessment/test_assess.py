"""The verdict agrees with the criterion, and with the motion's own boundary where it is known."""

import json

import numpy as np
import pytest
from reliab_studies.validation.beyond_the_model import Rig, rigs_of_delay
from scipy.interpolate import CubicSpline

from reliab.assessment.assess import assess
from reliab.assessment.assessment import improvement
from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.own_motion import OwnBoundary
from reliab.assessment.placement import LARGEST_PROBABILITY, scale_limits
from reliab.core.vocabulary import Metric, Side
from reliab.criterion.derivation import published_criterion
from reliab.effects.backlash import Backlash
from reliab.motions.motion import resample
from reliab.recordings.recording import Recording
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure, critical_delay

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)


def test_index_and_probability_are_those_of_the_criterion(simulate):
    test = simulate(noise=0.001)
    result, criterion = assess(test, ONE_HERTZ), default_criterion(1.0, 0.02, duration=test.duration)
    position = (result.tracking.amplitude, result.tracking.delay, 1.0, 0.02)
    assert result.index == pytest.approx(float(criterion.index(*position)))
    promised = min(float(criterion.probability(*position)), LARGEST_PROBABILITY)
    assert result.index_probability == pytest.approx(promised, abs=2e-3)
    assert result.stability_margin == pytest.approx(
        1.0 - position[1] / float(critical_delay(ONE_HERTZ, position[0]))
    )
    assert result.reliable


@pytest.mark.slow
def test_worse_rig_is_less_probable_and_rejected(simulate):
    better, worse = (assess(simulate(delay=delay), ONE_HERTZ) for delay in (0.0005, 0.004))
    assert better.probability > 0.97
    assert better.index_probability > 0.97
    assert worse.probability < 0.03
    assert worse.index_probability < 0.5
    assert worse.verdict == "not_reliable"


@pytest.mark.slow
@pytest.mark.parametrize("motion", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_own_boundary_separates_errors_below_and_above_the_threshold(simulate, ground_motions, motion):
    for delay in (0.0008, 0.003):
        test = simulate(motion, delay=delay, noise=0.001)
        own_value = assess(test, ONE_HERTZ, motion=ground_motions[motion]).placement
        assert (own_value.index <= 1.0) is (own_value.error <= 0.05)
        assert own_value.probability == float(own_value.error <= 0.05)


@pytest.mark.slow
def test_own_index_is_one_on_the_boundary(ground_motions):
    motion = ground_motions[0]
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    boundary = OwnBoundary(excitation=excitation, structure=ONE_HERTZ, threshold=0.05, metric=Metric.RMS)
    for side in (Side.LEAD, Side.LAG):
        contour = boundary.contour(side)
        for k in (10, contour.amplitude.size // 2, -10):
            position = float(contour.amplitude[k]), float(contour.delay[k])
            assert boundary.index(*position) == pytest.approx(1, abs=1e-3)
    half = 1.0 + 0.5 * (contour.amplitude[10] - 1.0), 0.5 * contour.delay[10]
    assert boundary.index(*map(float, half)) == pytest.approx(0.25, abs=1e-3)
    assert boundary.index(1.0, 0.0) == 0.0


def test_error_under_the_own_motion_equals_the_simulated_test(simulate, ground_motions):
    test, perfect = simulate(noise=0.0), simulate(gain=1.0, delay=0.0, noise=0.0)
    deviation = test.measured - perfect.command
    error = np.sqrt(np.mean(deviation**2)) / np.abs(perfect.command).max()
    assert assess(test, ONE_HERTZ, motion=ground_motions[0]).placement.error == pytest.approx(error, rel=5e-3)


@pytest.mark.slow
def test_structure_outside_the_criterion_is_warned_of_and_carried_over(simulate):
    structure = Structure(frequency=3.0, damping_ratio=0.02)
    test = simulate(f=3.0, delay=0.0001)
    result = assess(test, structure)
    assert any("criterion does not cover the structure" in warning for warning in result.warnings)
    at_edge = default_criterion(2.0, 0.02, duration=test.duration).limits(2.0, 0.02)
    assert result.population.a == pytest.approx(float(at_edge[0]))
    assert result.population.b == pytest.approx(float(at_edge[1]) * (2.0 / 3.0) ** 2)
    assert scale_limits(result.criterion, ONE_HERTZ)[1] == pytest.approx(float(at_edge[1]) * 4.0)


def test_published_criterion_has_no_probability(simulate):
    result = assess(simulate(), ONE_HERTZ, criterion=published_criterion("guo_2017_12"))
    assert result.index_probability is None
    assert result.criterion.threshold == 0.05


def test_varying_delay_is_warned_of(simulate):
    test = simulate(noise=0.0)
    times = np.arange(test.command.size) * test.time_step
    late = CubicSpline(times, test.command)(np.clip(times - 0.002 * times / times[-1], 0.0, None))
    result = assess(Recording(command=test.command, measured=late, time_step=test.time_step), ONE_HERTZ)
    assert any("delay varies over the test" in warning for warning in result.warnings)


@pytest.fixture(scope="module")
def rig_assessments(ground_motions):
    """Assess rigs that are no constant gain and delay, of about 0.8 ms, with noise at 50 dB."""
    record = resample(ground_motions[1], 1024.0)
    rng, result = np.random.default_rng(8), {}
    peak = np.abs(
        run_closed_loop(HybridTest(structure=ONE_HERTZ), record.acceleration, 1 / 1024).measured
    ).max()
    loose = Rig(name="backlash", actuator=Actuator(delay=0.0004), effects=(Backlash(width_m=0.01 * peak),))
    for rig in (*rigs_of_delay(0.0008), loose):
        test = HybridTest(structure=ONE_HERTZ, actuator=rig.actuator, effects=rig.effects)
        run = run_closed_loop(test, record.acceleration, 1 / 1024, compensator=rig.compensator)
        size = 0.003 * np.sqrt(np.mean(run.measured**2))
        recording = Recording(
            command=run.command.values[0],
            measured=run.measured + size * rng.normal(size=run.measured.size),
            time_step=1 / 1024,
        )
        result[rig.name] = assess(recording, ONE_HERTZ)
    return result


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rig", "words"),
    [
        ("constant delay", None),
        ("first-order lag", None),
        ("second-order dynamics", None),
        ("inverse compensation, wrong estimate", None),
        ("drifting delay", "delay varies over the test"),
        ("backlash", "neither gain nor delay"),
    ],
)
def test_only_rigs_with_errors_beyond_a_and_d_are_warned_of(rig_assessments, rig, words):
    warnings = rig_assessments[rig].warnings
    if words is None:
        assert warnings == ()
    else:
        assert any(words in warning for warning in warnings)


@pytest.mark.slow
def test_partial_experimental_fraction_is_said(simulate):
    half = Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=0.5)
    assert any("it is conservative." in warning for warning in assess(simulate(), half).warnings)
    stiff = Structure(frequency=15.0, damping_ratio=0.05, experimental_fraction=0.5)
    assert any("outside of 0.5 to 3 Hz" in warning for warning in assess(simulate(), stiff).warnings)


def test_wrong_frequency_is_suspected(simulate):
    assert any("check the frequency" in w for w in assess(simulate(f=0.5, whole=True), ONE_HERTZ).warnings)


def test_summary_is_plain_json_with_the_stable_keys(simulate, ground_motions):
    for motion in (None, ground_motions[0]):
        result = assess(simulate(), ONE_HERTZ, motion=motion).to_dict()
        stable = {"A", "phi", "f_eq_hz", "d_ms", "index", "reliable", "probability", "stability_margin"}
        stable |= {"verdict", "reasons", "would_decide", "error", "by_index", "tracking", "faults", "window"}
        assert stable <= set(result)
        assert json.loads(json.dumps(result, allow_nan=False)) == result
        assert result["index_interval"][0] < result["index"] < result["index_interval"][1]
        for name in ("rms", "mte"):
            assert 0.0 < result["error"][name]["low"] <= result["error"][name]["value"]
            assert result["error"][name]["value"] <= result["error"][name]["high"]
        assert sum(part["share"] for part in result["error"]["parts"].values()) == pytest.approx(1.0)
        assert result["phi"] == pytest.approx(-2e-3 * np.pi * result["f_eq_hz"] * result["d_ms"])


def test_named_improvement_suffices():
    result = improvement(1.002, 0.0015, 5e-5, 1.0)
    assert result.first == "delay"
    assert 0.002**2 / 5e-5 + (1e3 * result.tolerable_delay) ** 2 == pytest.approx(1.0)
    assert result.tolerable_amplitude_error == 0.0  # the delay alone is too long
    assert improvement(0.99, 0.0001, 5e-5, 1.0).first == "amplitude"
