"""Tests of partitioned frames: the error, faults of the recording, and a criterion of the same frame."""

from dataclasses import replace

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import Rig, Sensors, run_laboratory

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import PriorSource, ordinary_equipment
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.criterion.derivation import published_criterion
from reliab.effects.registry import find_effect
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.recordings.recording import Recording
from reliab.report.kinds.assessment.frame import frame_assessment_report
from reliab.simulation.frames.frame_file import FrameUnderTest, governing_mode, read_structure
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.simulation.transfer_systems.transfer_function import TransferFunction
from reliab.structures.frame import Frame, Specimen, floor_interface, modal_damping, reference_response
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame

RATE, THINNED = 4096.0, 8
LAG = StatedValue(1.5e3 / RATE)
"""Time by which the digital laboratory feeds the force back late [ms]."""


SERVO = TransferFunction(numerator=(1.0,), denominator=(2e-6, 2e-3, 1.0), delay=0.002)


@pytest.fixture(scope="module")
def frame():
    mass, stiffness = shear_frame([2000.0, 1500.0], [4e5, 3e5])
    full_test = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.03))
    partition = Partition.from_frame(
        frame=full_test, interface=floor_interface(full_test, 1), specimen=Specimen(stiffness=2e5)
    )
    return FrameUnderTest(name="two storeys", partition=partition, output=None, error_of="interface")


@pytest.fixture(scope="module")
def test_and_truth(frame):
    """A test with a late actuator, and its true error from the exact response of the undivided frame."""
    return simulate_frame(frame.partition, synthetic_suite(count=2)[0], 3)


def simulate_frame(partition, motion, seed):
    """Recording of a test by the digital laboratory, and its true error."""
    ground = motion.acceleration[: int(20.0 / motion.time_step)]
    rig = Rig(transfer_system=SERVO, sensors=Sensors(displacement_noise=2e-6))
    run = run_laboratory(partition, rig, ground, motion.time_step, rate=RATE, seed=seed)
    fine = np.interp(np.arange(run.piston.size) / RATE, motion.time_step * np.arange(ground.size), ground)
    exact = partition.direction @ reference_response(partition.frame, fine, 1.0 / RATE)
    error = float(np.sqrt(np.mean((run.piston - exact) ** 2)) / np.abs(exact).max())
    recording = Recording(
        name="frame.csv",
        command=run.command[::THINNED].copy(),
        measured=run.measured[::THINNED].copy(),
        time_step=THINNED / RATE,
    )
    return recording, error


def test_error_is_against_the_undivided_frame(frame, test_and_truth):
    recording, truth = test_and_truth
    assessment = assess(recording, frame, stated={"feedback_lag": LAG})
    assert truth > 0.02
    assert assessment.error.estimate(Metric.RMS).value == pytest.approx(truth, rel=0.05)
    assert assessment.faults == ()
    assert 0.0 < assessment.stability_margin < 1.0
    summary = assessment.to_dict()
    assert summary["reliable"] == (summary["verdict"] == "reliable")
    assert summary["by_index"] is None


def test_a_noisy_recording_of_a_frame_is_said_so(frame, test_and_truth):
    recording, _ = test_and_truth
    noise = 0.1 * recording.measured.std() * np.random.default_rng(2).standard_normal(recording.measured.size)
    noisy = assess(replace(recording, measured=recording.measured + noise), frame)
    assert any("The test is noisy" in warning for warning in noisy.warnings)
    assert not any("The test is noisy" in warning for warning in assess(recording, frame).warnings)


@pytest.mark.slow
def test_a_spike_is_stated_and_does_not_move_the_error(frame, test_and_truth):
    recording, truth = test_and_truth
    spiky = recording.measured.copy()
    spiky[3000] += 0.5 * np.abs(recording.command).max()
    spoilt = assess(replace(recording, measured=spiky), frame, stated={"feedback_lag": LAG})
    assert [(effect.fault.kind, effect.fault.in_loop) for effect in spoilt.faults] == [("spike", False)]
    assert spoilt.error.estimate(Metric.RMS).value == pytest.approx(truth, rel=0.05)
    assert spoilt.to_dict()["faults"][0]["kind"] == "spike"


@pytest.mark.slow
def test_an_offset_is_stated_with_the_error_without_it(frame, test_and_truth):
    recording, truth = test_and_truth
    shift = recording.measured + 0.05 * np.abs(recording.command).max()
    spoilt = assess(replace(recording, measured=shift), frame, stated={"feedback_lag": LAG})
    (effect,) = spoilt.faults
    assert effect.fault.kind == "offset"
    bare = spoilt.error if effect.fault.in_loop is False else effect.otherwise
    assert bare.estimate(Metric.RMS).value == pytest.approx(truth, rel=0.05)


def test_a_copied_channel_is_not_called_reliable(frame, test_and_truth):
    recording, _ = test_and_truth
    duplicate = assess(replace(recording, measured=recording.command.copy()), frame)
    assert not duplicate.reliable
    assert any("identical" in warning for warning in duplicate.warnings)


def test_a_criterion_of_the_frame_gives_an_index_beside_the_error(frame, test_and_truth):
    mode = governing_mode(frame.partition, frame.output)
    provenance = replace(
        published_criterion("guo_2017_18").provenance, experimental_fraction=mode.experimental_fraction
    )
    criterion = replace(published_criterion("guo_2017_18"), provenance=provenance)
    assessment = assess(test_and_truth[0], frame, criterion=criterion)
    index_content = assessment.to_dict()["by_index"]
    a, b = (float(limit) for limit in criterion.limits(mode.frequency, mode.damping_ratio))
    amplitude, delay = assessment.tracking.amplitude, 1e3 * assessment.tracking.delay
    assert index_content["index"] == pytest.approx((amplitude - 1.0) ** 2 / a + delay**2 / b)
    assert index_content["reliable"] == (index_content["verdict"] == "reliable")
    assert index_content["confidence"] == 0.95


def test_a_criterion_for_a_case_outside_of_its_population_promises_nothing_for_a_frame(frame, test_and_truth):
    mode = governing_mode(frame.partition, frame.output)
    output = published_criterion("guo_2017_18")
    changes = {"experimental_fraction": mode.experimental_fraction, "position": "outside"}
    criterion = replace(output, provenance=replace(output.provenance, **changes))
    assessment = assess(test_and_truth[0], frame, criterion=criterion)
    index_content = assessment.to_dict()["by_index"]
    assert (index_content["confidence"], index_content["verdict"]) == (None, "undecided")
    facts = frame_assessment_report(assessment, provenance={}).facts
    assert "no share of" in str(facts["Index of the criterion"])


def test_a_criterion_of_another_structure_is_refused(frame, test_and_truth):
    with pytest.raises(InputError, match="must be that of the frame"):
        assess(test_and_truth[0], frame, criterion=published_criterion("guo_2017_18"))


def test_unusable_recording_is_refused(frame, test_and_truth):
    recording, _ = test_and_truth
    with pytest.raises(InputError, match="opposite sign of the command"):
        assess(replace(recording, measured=-recording.measured), frame)
    short = replace(recording, command=recording.command[:400], measured=recording.measured[:400])
    with pytest.raises(InputError, match="2 periods"):
        assess(short, frame)


def test_tracking_over_frequency_equals_the_servo(frame, test_and_truth):
    recording, _ = test_and_truth
    assessment = assess(recording, frame, stated={"feedback_lag": LAG})
    summary = assessment.to_dict()
    result, coverage = assessment.over_frequency, 0.5 / RATE
    servo = SERVO.transfer(2j * np.pi * result.frequency, frame.partition.specimen)
    exact = -np.angle(servo) / (2.0 * np.pi * result.frequency) + coverage
    for name, values, expected in (
        ("A", result.amplitude, np.abs(servo)),
        ("d_ms", 1e3 * result.delay, 1e3 * exact),
    ):
        deviation = np.array(summary["over_frequency"][f"{name}_deviation"])
        assert np.mean(np.abs(values - expected) < 2.0 * deviation + 2e-4 * np.abs(expected)) > 0.85
    assert [mode["d_ms"] for mode in summary["modes"][:1]] == pytest.approx([1e3 * exact[0]], rel=0.02)


@pytest.mark.slow
def test_a_linear_servo_leaves_nothing_beside_its_amplitude_and_delay(frame, test_and_truth):
    recording, _ = test_and_truth
    assessment = assess(recording, frame)
    assert assessment.resolved.rms == pytest.approx(assessment.error.estimate(Metric.RMS).value, rel=0.02)
    assert assessment.resolved.remaining_rms < 0.02 * assessment.resolved.rms
    stuck = replace(recording, measured=np.round(recording.measured / 2e-3) * 2e-3)
    assert assess(stuck, frame).resolved.remaining_rms > 2.0 * assessment.resolved.remaining_rms


def test_the_report_shows_tracking_and_parts(frame, test_and_truth):
    assessment = assess(test_and_truth[0], frame, stated={"feedback_lag": LAG})
    document = frame_assessment_report(assessment, provenance={"file": "frame.csv"})
    titles = [section.title for section in document.blocks]
    assert titles[0] == "The error of this test"
    assert "Amplitude and delay over frequency" in titles
    error = f"{100 * assessment.error.estimate(Metric.RMS).value:.3g} %"
    assert any(error in str(piece) for piece in document.verdict)


def test_cases_outside_the_error_equation_are_refused(frame, test_and_truth):
    recording, _ = test_and_truth
    friction = find_effect("coulomb_friction")(force_n=1.0, regularisation_velocity_m_per_s=0.01)
    rubbing = replace(frame, partition=replace(frame.partition, effects=(friction,)))
    with pytest.raises(InputError, match=r"linear specimen.*coulomb_friction"):
        assess(recording, rubbing)
    elsewhere = replace(frame, output=np.array([1.0, 0.0]), error_of="degree of freedom 0")
    with pytest.raises(InputError, match="interface displacement"):
        assess(recording, elsewhere)


def test_a_stated_scale_is_taken_off_the_reading(frame, test_and_truth):
    recording, truth = test_and_truth
    scaled_copy = replace(recording, measured=1.02 * recording.measured)
    correction = assess(scaled_copy, frame, stated={"feedback_lag": LAG, "scale": StatedValue(1.02)})
    assert correction.error.estimate(Metric.RMS).value == pytest.approx(truth, rel=0.05)


def test_a_loop_beyond_its_critical_delay_has_no_margin(frame, test_and_truth):
    assessment = assess(test_and_truth[0], frame, stated={"feedback_lag": LAG})
    margins = {0.0: None, 0.5 * assessment.tracking.delay: -1.0, np.inf: 1.0}
    for critical, margin in margins.items():
        verdict = replace(assessment, limit=replace(assessment.limit, delay=critical))
        assert verdict.stability_margin == (margin if margin is None else pytest.approx(margin))
    incoherent = replace(assessment, over_frequency=None)
    assert any("hardly coherent" in words for words in incoherent.warnings)


@pytest.mark.slow
def test_intervals_hold_where_the_stiffness_is_known_to_three_per_cent(frame):
    full_test, rng = frame.partition.frame, np.random.default_rng(33)
    uncertain = replace(frame, tolerances=TolerancesTable(stiffness=0.03))
    coverage = {"exact": 0, "uncertain": 0}
    motions = synthetic_suite(count=12)
    for seed, motion in enumerate(motions):
        factor = 1.0 + 0.03 * rng.normal()
        assembly = replace(full_test, stiffness=factor * full_test.stiffness)
        specimen = Specimen(stiffness=factor * frame.partition.specimen.stiffness)
        true = Partition.from_frame(frame=assembly, interface=frame.partition.direction, specimen=specimen)
        recording, error = simulate_frame(true, motion, seed)
        for name, reference in (("exact", frame), ("uncertain", uncertain)):
            interval = assess(recording, reference, stated={"feedback_lag": LAG}).error.estimate(Metric.RMS)
            coverage[name] += interval.low <= error <= interval.high
    assert coverage["exact"] <= 0.5 * len(motions)
    assert coverage["uncertain"] >= 10  # 12 intervals of 90 % hold fewer in 11 % of cases


def test_the_tolerances_of_a_frame_stand_in_its_budget(frame, test_and_truth):
    tolerances = TolerancesTable(mass=0.03, stiffness=0.04, damping_ratio=0.1, specimen_stiffness=0.02)
    budget = assess(test_and_truth[0], replace(frame, tolerances=tolerances)).to_dict()["budget"]
    sizes = {item["name"]: item["size"] for item in budget}
    assert 0.0 < sizes["frequency"] < 2.5
    assert sizes["damping_ratio"] == pytest.approx(10.0, rel=0.05)
    assert sizes["experimental_fraction"] == pytest.approx(2.0, rel=0.05)
    sources = {item["name"]: item["source"] for item in budget}
    assert (sources["frequency"], sources["damping_ratio"]) == ("learned from this test", "stated")
    contributions = [item["contribution"] for item in budget]
    assert contributions == sorted(contributions, reverse=True)


def test_frequencies_are_not_stated_beside_mass_and_stiffness():
    with pytest.raises(ValueError, match="give frequency, or mass and stiffness"):
        TolerancesTable(frequency=0.01, stiffness=0.03)


@pytest.mark.slow
def test_unstated_quantities_of_a_frame_are_as_uncertain_as_equipment(frame, test_and_truth):
    recording, _ = test_and_truth
    assumptions = assess(recording, frame, equipment=ordinary_equipment())
    exact = assess(recording, frame)
    sources = {item.name: item.source for item in assumptions.error.budget}
    expected = {"damping_ratio", "sensor_scale", "time_shift", "filter_delay", "feedback_lag"}
    assert expected <= {name for name, source in sources.items() if source is PriorSource.DEFAULT}
    widths = [result.error.estimate(Metric.RMS) for result in (assumptions, exact)]
    assert widths[0].high - widths[0].low > 5.0 * (widths[1].high - widths[1].low)
    assert 0.01 <= assumptions.error.probability <= 0.99
    stated_values = assess(
        recording, frame, stated={"skew": StatedValue(0.0, 0.01)}, equipment=ordinary_equipment()
    )
    (skew,) = [item for item in stated_values.error.budget if item.name == "time_shift"]
    assert (skew.source, skew.size) == (PriorSource.STATED, pytest.approx(0.01, rel=0.01))
    linear = assess(recording, frame, equipment=ordinary_equipment(), linear_specimen=True)
    assert linear.turning.error_if_yielding is None
    assert assumptions.turning.error_if_yielding is not None
    assert any("No force was recorded" in warning for warning in assumptions.warnings)
    assert assumptions.to_dict()["would_turn"] == assumptions.turning.to_dict()


@pytest.mark.parametrize(
    "path", sorted(shipped("datasets", "frames/README.md").parent.glob("*.toml")), ids=lambda path: path.stem
)
def test_every_shipped_frame_can_judge_a_test(path):
    assert read_structure(path).output is None
