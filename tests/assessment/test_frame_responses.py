"""Errors of floors and storeys, beside those of tests that are simulated apart."""

from dataclasses import replace

import numpy as np
import pytest
from assessment.frames_by_matrices import TWO_STOREYS, Outcome, run, run_yielding, shear

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.errors import InputError
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.report.kinds.assessment.frame import frame_assessment_report
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.structures.frame import Frame, Specimen
from reliab.structures.partition import Partition

RATE, DURATION = 256.0, 20.0
WHOLE = Frame(
    mass=TWO_STOREYS.mass, damping=TWO_STOREYS.damping, stiffness=TWO_STOREYS.stiffness, names=("low", "top")
)
STATED = FrameUnderTest(
    name="two",
    partition=Partition.from_frame(
        frame=WHOLE, interface=TWO_STOREYS.interface, specimen=Specimen(stiffness=2e5)
    ),
    output=None,
    error_of="interface",
)


def shaken(seed: int) -> np.ndarray:
    """Ground motion that begins at rest [m/s²]."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(DURATION * RATE)) / RATE
    coarse = np.interp(time, np.arange(0.0, DURATION + 0.1, 0.1), rng.standard_normal(201))
    return coarse * np.minimum(time / 2.0, 1.0)


@pytest.fixture(scope="module")
def test_and_truth():
    """Recording without noise, its ground motion, and what the frame did with and without its actuator."""
    ground = shaken(8)
    outcome = run(TWO_STOREYS, 1.02, 150.0, ground, 1.0 / RATE)
    recording = Recording(
        command=outcome.command, measured=outcome.measured, time_step=1.0 / RATE, name="one"
    )
    return recording, Motion(name="ground", acceleration=ground, time_step=1.0 / RATE), outcome


@pytest.fixture(scope="module")
def assessment_and_truth(test_and_truth):
    """The test with its ground motion."""
    recording, motion, _ = test_and_truth
    return assess(recording, STATED, motion=motion)


def test_errors_of_floors_and_storeys_are_those_of_the_simulation(assessment_and_truth, test_and_truth):
    floors, ideal = test_and_truth[2].floors, test_and_truth[2].ideal
    histories = {
        "floor low": (floors[0], ideal[0]),
        "floor top": (floors[1], ideal[1]),
        "storey low": (floors[0], ideal[0]),
        "storey top": (floors[1] - floors[0], ideal[1] - ideal[0]),
    }
    item = {single.name: single for single in assessment_and_truth.responses.each}
    assert item.keys() == histories.keys()
    for name, (history, exact) in histories.items():
        error, peak = history - exact, np.abs(exact).max()
        assert item[name].rms_mm.value == pytest.approx(1e3 * np.sqrt(np.mean(error**2)), rel=0.01)
        assert item[name].peak_mm.value == pytest.approx(1e3 * np.abs(error).max(), rel=0.01)
        assert item[name].rms.value == pytest.approx(np.sqrt(np.mean(error**2)) / peak, rel=0.01)
        assert item[name].mte.value == pytest.approx(np.abs(error).max() / peak, rel=0.01)


def test_the_largest_error_stands_first_and_its_storey_governs(assessment_and_truth):
    sizes = [single.rms.value for single in assessment_and_truth.responses.each]
    assert sizes == sorted(sizes, reverse=True)
    storeys = {
        single.name: single.rms.value
        for single in assessment_and_truth.responses.each
        if single.kind == "storey"
    }
    content = assessment_and_truth.to_dict()["responses"]
    assert content["governing_storey"] == max(storeys, key=storeys.get)
    assert content["governing_storey"] in assessment_and_truth.responses.sentence
    assert content["needs"] is None


def test_without_the_ground_motion_errors_are_lengths(test_and_truth, assessment_and_truth):
    separate = assess(test_and_truth[0], STATED).responses
    assert "the ground motion of the test is needed" in separate.sentence
    assert separate.to_dict()["needs"] == separate.sentence
    with_motion = {single.name: single.rms_mm.value for single in assessment_and_truth.responses.each}
    assert {single.name: single.rms_mm.value for single in separate.each} == pytest.approx(with_motion)
    assert all(single.rms is None and single.mte is None for single in separate.each)


def test_a_recorded_ground_acceleration_is_the_ground_motion(test_and_truth, assessment_and_truth):
    recording, motion, _ = test_and_truth
    with_channel = replace(recording, ground=np.array(motion.acceleration))
    item = assess(with_channel, STATED).responses.each
    assert [single.rms.value for single in item] == pytest.approx(
        [single.rms.value for single in assessment_and_truth.responses.each]
    )


@pytest.mark.slow
def test_another_ground_motion_is_noticed(test_and_truth, assessment_and_truth):
    recording, motion, _ = test_and_truth
    acceleration = np.array(motion.acceleration)
    half, unlike = (
        assess(
            recording, STATED, motion=Motion(name="other", acceleration=second, time_step=motion.time_step)
        )
        for second in (0.5 * acceleration, np.random.default_rng(9).permutation(acceleration))
    )
    assert not assessment_and_truth.responses.warnings
    assert "when it is multiplied by 2:" in " ".join(half.warnings)
    peaks = {single.name: single.rms.value for single in assessment_and_truth.responses.each}
    assert {single.name: single.rms.value for single in half.responses.each} == pytest.approx(peaks, rel=0.01)
    assert "assumed to belong to another test" in " ".join(unlike.warnings)
    assert all(single.rms is None for single in unlike.responses.each)


@pytest.mark.parametrize(("factor", "unit"), [(1.0 / 9.80665, "in g"), (100.0, "in gal"), (1e3, "in mm/s2")])
def test_a_recorded_ground_acceleration_in_another_unit_is_refused(test_and_truth, factor, unit):
    recording, motion, _ = test_and_truth
    with pytest.raises(InputError, match=unit):
        assess(replace(recording, ground=factor * np.array(motion.acceleration)), STATED)


@pytest.mark.slow
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_recorded_ground_acceleration_is_compared_beside_a_specimen_known_by_its_force(sign):
    ground = shaken(8)
    outcome, noise = run(TWO_STOREYS, 1.02, 150.0, ground, 1.0 / RATE), np.random.default_rng(3)
    peak = np.abs(outcome.measured).max()
    recording = Recording(
        command=outcome.command,
        measured=outcome.measured + 1e-3 * peak * noise.normal(size=ground.size),
        force=2e5 * (outcome.measured + 1e-3 * peak * noise.normal(size=ground.size)),
        ground=sign * ground,
        time_step=1.0 / RATE,
    )
    shown = assess(recording, STATED, measured_specimen=True).error.ground
    assert shown.fits
    assert shown.sign == sign
    assert ("The ground acceleration has the opposite sign." in shown.notes) is (sign < 0.0)
    with pytest.raises(InputError, match="does not fit its unit"):
        assess(replace(recording, ground=ground / 9.80665), STATED, measured_specimen=True)


@pytest.mark.usefixtures("all_draws")
def test_the_interval_holds_the_errors_of_another_structure_within_tolerances():
    ground = shaken(8)
    tested_frame = TWO_STOREYS.with_storeys("stiffness", np.array([0.97, 1.03]))
    outcome = run(tested_frame, 1.01, 200.0, ground, 1.0 / RATE)
    recording = Recording(command=outcome.command, measured=outcome.measured, time_step=1.0 / RATE)
    motion = Motion(name="ground", acceleration=ground, time_step=1.0 / RATE)
    loose = replace(STATED, tolerances=TolerancesTable(storey_stiffnesses=0.05))
    exact, coverage = (
        {single.name: single.rms for single in assess(recording, stated_values, motion=motion).responses.each}
        for stated_values in (STATED, loose)
    )
    for name, place in (("floor low", 0), ("floor top", 1)):
        true = outcome.error_of(outcome.floors[place], outcome.ideal[place])
        assert not exact[name].low <= true <= exact[name].high
        assert coverage[name].low <= true <= coverage[name].high


def test_the_report_lists_them(assessment_and_truth):
    report = frame_assessment_report(assessment_and_truth, provenance={})
    (section,) = [block for block in report.blocks if block.title == "Floors and storeys"]
    assert len(section.blocks[0].frame["0"]) == 4


def true_errors(outcome: Outcome, names: tuple[str, ...]) -> dict[str, float]:
    """RMS^R of floors and storeys."""
    first = np.zeros((1, outcome.ideal.shape[1]))
    pairs = [(outcome.floors, outcome.ideal)]
    pairs.append(tuple(np.diff(rows, axis=0, prepend=first) for rows in pairs[0]))
    return {
        f"{kind} {name}": outcome.error_of(history, exact)
        for kind, (rows, ideal) in zip(("floor", "storey"), pairs, strict=True)
        for name, history, exact in zip(names, rows, ideal, strict=True)
    }


@pytest.mark.slow
def test_floors_and_storeys_of_several_actuators_are_those_of_the_simulation():
    frame = replace(
        TWO_STOREYS,
        mass=np.diag([2000.0, 1800.0, 1500.0]),
        damping=shear(np.array([2400.0, 1800.0, 1500.0])),
        stiffness=shear(np.array([5e5, 4e5, 3e5])),
        interface=np.eye(3)[:, :2],
        influence=np.ones(3),
        specimen=(1e5, 0.0, 0.0),
    )
    names = ("low", "middle", "top")
    ground = shaken(8)
    outcome = run(frame, np.array([1.02, 0.99]), np.array([150.0, 220.0]), ground, 1.0 / RATE)
    partition = Partition(
        mass=frame.mass,
        damping=frame.damping,
        stiffness=frame.stiffness,
        interface=frame.interface,
        influence=frame.influence,
        specimen_stiffness=1e5 * np.eye(2),
        names=names[:2],
        degrees_of_freedom=names,
    )
    stated_values = FrameUnderTest(name="three", partition=partition, has_several=True)
    recording = Recording(
        command=outcome.command, measured=outcome.measured, time_step=1.0 / RATE, ground=ground
    )
    result = assess(recording, stated_values).responses
    errors = {single.name: single.rms.value for single in result.each}
    assert errors == pytest.approx(true_errors(outcome, names), rel=0.01)
    assert result.to_dict()["governing_storey"] in result.sentence
    lengths = assess(replace(recording, ground=None), stated_values).responses
    assert all(single.rms is None for single in lengths.each)
    assert "the ground motion of the test is needed" in lengths.sentence


@pytest.mark.slow
@pytest.mark.parametrize("reference", ["by its force", "not"])
def test_intervals_hold_the_errors_of_floors_beside_a_yielding_specimen(reference):
    ground = shaken(11)
    outcome = run_yielding(TWO_STOREYS, 1.02, 150.0, ground, 1.0 / RATE, ductility=2.0)
    recording = Recording(
        command=outcome.command,
        measured=outcome.measured,
        force=outcome.force if reference == "by its force" else None,
        ground=ground,
        time_step=1.0 / RATE,
    )
    result = assess(
        recording, STATED, equipment=ordinary_equipment(), measured_specimen=reference == "by its force"
    ).responses
    assert {single.name for single in result.each} == {*true_errors(outcome, ("low", "top"))}
    if reference == "not":
        assert "for a linear specimen" in result.sentence
        return
    assert result.specimen == "measured"
    for single in result.each:
        assert single.rms.low <= true_errors(outcome, ("low", "top"))[single.name] <= single.rms.high
