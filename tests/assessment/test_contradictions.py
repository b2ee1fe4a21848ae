"""A stated quantity that the recording contradicts leaves no test reliable."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from coupled_structures import ideal_response

from reliab.assessment.assess import assess
from reliab.assessment.assessment import Assessment
from reliab.assessment.checks import CHECKS, check_stability, moves_at_resonance
from reliab.assessment.tracking_index import track
from reliab.assessment.verdict import Doubt, Verdict, Word
from reliab.core.shipped import shipped
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.structures.frame import Frame, Specimen, floor_interface, modal_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)
FIVE_HERTZ = Structure(frequency=5.0, damping_ratio=0.02)


def frequency_case(simulate, ground_motions):
    del ground_motions
    return assess(simulate(noise=0.001, delay=1e-4), FIVE_HERTZ)


def motion_case(simulate, ground_motions):
    return assess(simulate(noise=0.001, delay=1e-4, gain=0.999), ONE_HERTZ, motion=ground_motions[4])


def stability_case(simulate, ground_motions):
    del ground_motions
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Assessment, "stability_margin", -0.1)
        return assess(simulate(noise=0.001, delay=1e-4, gain=0.999), ONE_HERTZ)


def columns_case(simulate, ground_motions):
    """A late test whose columns are swapped: it seems to lead, and so to be better than it is."""
    del ground_motions
    late = simulate(noise=0.0, delay=1.8e-3, gain=1.0, whole=True)
    return assess(replace(late, command=late.measured, measured=late.command), ONE_HERTZ)


def specimen_case(simulate, ground_motions):
    """A measured specimen whose force follows its motion only in part."""
    del ground_motions
    test = simulate(noise=0.001, delay=1e-4, gain=0.999)
    chance = np.convolve(np.random.default_rng(1).standard_normal(test.command.size), np.hanning(200), "same")
    force = 39.5 * (test.measured + 0.5 * test.measured.std() / chance.std() * chance)
    return assess(
        replace(test, force=force),
        ONE_HERTZ,
        stated={"f": StatedValue(1.0), "xi": StatedValue(0.02), "mass": StatedValue(1.0)},
        measured_specimen=True,
    )


def ground_case(simulate, ground_motions):
    """A small error beside the ground motion of another test."""
    del simulate
    frame = read_structure(shipped("datasets", "frames/two_actuators.toml"))
    step, samples = ground_motions[0].time_step, slice(2500)
    ideal = ideal_response(frame.partition, ground_motions[0].acceleration[samples], step)
    command = frame.kinematics @ ideal
    chance = np.random.default_rng(1).standard_normal(command.shape)
    return assess(
        Recording(
            command=command,
            measured=0.999 * command + 1e-5 * command.std(axis=1, keepdims=True) * chance,
            time_step=step,
            ground=ground_motions[1].acceleration[samples],
        ),
        frame,
    )


CASES = {
    "stated_values": (ground_case, "does not belong to this test"),
    "frequency": (
        frequency_case,
        "the structure is stated at 5 Hz, where the command shows no resonance",
    ),
    "motion": (motion_case, "was not found in the record"),
    "specimen": (specimen_case, "None of the specimen models predicts its force"),
    "stability": (stability_case, "the loop is unstable"),
    "columns": (columns_case, "the columns may be swapped"),
}


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("kind", CASES)
def test_contradictions_leave_no_test_reliable(simulate, ground_motions, kind):
    make, words = CASES[kind]
    assessment = make(simulate, ground_motions)
    assert any(words in warning for warning in assessment.warnings)
    assert assessment.verdict is Word.UNDECIDED
    assert any(words in reason for reason in assessment.reasons)
    assert assessment.probability > 0.95  # the error alone would be called reliable
    assert len(assessment.would_decide) == len(set(assessment.would_decide)) > 0


def test_every_check_has_its_case():
    elsewhere = {"linearity", "rest", "matrix_entries", "faults", "force"}  # in files of their own
    assert {check.__name__.removeprefix("check_") for check in CHECKS} == elsewhere | set(CASES)


@pytest.mark.parametrize(("margin", "is_unstable"), [(None, True), (-0.1, True), (0.1, False)])
def test_a_loop_without_a_margin_is_unstable(margin, is_unstable):
    doubts = list(check_stability(SimpleNamespace(stability_margin=margin)))
    assert ["the loop is unstable" in doubt.finding for doubt in doubts] == [True] * is_unstable


def test_a_bad_test_stays_bad_unless_its_structure_may_be_another_one():
    bad = Verdict(word=Word.NOT_RELIABLE, reasons=("The error is large.",))
    doubt = Doubt(finding="It is doubted.", remedy="Find out.")
    assert bad.limit([doubt]) is bad
    assert bad.limit([doubt, replace(doubt, of_structure=True)]).word is Word.UNDECIDED
    assert replace(bad, word=Word.RELIABLE).limit([doubt]).word is Word.UNDECIDED
    assert replace(bad, word=Word.RELIABLE).limit([]).word is Word.RELIABLE


def test_stiff_structure_moving_below_its_frequency_is_not_doubted(simulate):
    """Under slow ground motions it follows the ground, with a resonance at its own frequency."""
    lower = 0
    for motion in range(6):
        test = simulate(motion, f=8.0, noise=0.001, delay=1e-4, whole=True)
        tracking = track(test, draws=2)
        lower += tracking.plain.equivalent_frequency < 4.0
        assert moves_at_resonance(test, tracking, [8.0])
        for wrong in (0.2, 40.0):
            assert not moves_at_resonance(test, tracking, [wrong]), (motion, wrong)
    assert lower > 0


@pytest.mark.slow
def test_a_frame_is_doubted_as_well(simulate):
    mass, stiffness = shear_frame([2000.0, 1500.0], [4e7, 3e7])
    full_test = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.03))
    partition = Partition.from_frame(
        frame=full_test, interface=floor_interface(full_test, 1), specimen=Specimen(stiffness=2e7)
    )
    frame = FrameUnderTest(name="stiff", partition=partition, output=None, error_of="interface")
    result = assess(simulate(noise=0.001, delay=1e-4, gain=0.999), frame)
    assert result.error.probability > 0.95
    assert result.verdict is Word.UNDECIDED
    assert any("no resonance" in warning for warning in result.to_dict()["warnings"])


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("frequency", [1.0, 2.0])
def test_a_reliable_test_has_no_contradictions(simulate, frequency):
    sound = assess(
        simulate(f=frequency, noise=0.001, delay=1e-4, gain=0.999), replace(ONE_HERTZ, frequency=frequency)
    )
    assert sound.reliable
    assert not np.any(sound.contradictions)


def test_a_lead_is_no_swap_where_the_measured_column_has_a_sensors_noise(simulate):
    early = simulate(noise=0.001, delay=-1.9e-3, gain=1.0)
    swapped_test = replace(early, command=early.measured, measured=early.command)
    assert not assess(early, ONE_HERTZ).column_doubts
    assert assess(swapped_test, ONE_HERTZ).column_doubts
