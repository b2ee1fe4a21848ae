"""Faults of a recording are found and stated with what they do to the error; sound recordings have none."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.faults import faults_of_force
from reliab.assessment.rebuilt_error.specimen_check import slider_elongation
from reliab.assessment.verdict import Word
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)


@pytest.fixture(scope="module")
def shaken(ground_motions, simulate_rig):
    motion = ground_motions[3]

    def run(**rig):
        return simulate_rig(motion.acceleration, motion.time_step, seconds=30.0, db=45.0, **rig)

    return run


@pytest.fixture(scope="module")
def good(shaken):
    return shaken(gain=0.998, delay=0.0004)


def find_faults(test, measured=None, command=None):
    return assess(
        Recording(
            command=test.command if command is None else command,
            measured=test.measured if measured is None else measured,
            time_step=1.0 / 256.0,
        ),
        ONE_HERTZ,
    )


def kinds(result):
    return {effect.fault.kind for effect in result.faults}


def saturated(force, share):
    return np.clip(force, -share * np.abs(force).max(), share * np.abs(force).max())


def lost(history):
    place = np.abs(history).argmax()
    return np.where(np.abs(np.arange(history.size) - place) < 100, 0.0, history)


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(
    "rig", [{"delay": 0.001}, {"lead": 0.001}, {"lag": 0.001}, {"gain": 0.99}, {"backlash": 0.0004}]
)
def test_a_sound_recording_has_no_faults_whatever_the_actuator(shaken, rig):
    assert find_faults(shaken(**rig)).faults == ()


def test_offset_in_the_loop_counts(shaken):
    """The command rests beside zero, and the transient of getting there is an error."""
    peak = np.abs(shaken().ideal).max()
    test = shaken(gain=0.998, bias=0.145 * peak)
    result = find_faults(test)
    (effect,) = result.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", True)
    assert result.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.05)
    assert effect.otherwise.rebuilt.rms.value < 0.5 * test.rms
    assert any("the structure felt it" in warning for warning in result.warnings)


def test_offset_in_the_loop_before_the_recording_is_no_other_zero(good):
    """The command rests at the answer to it from the first sample on."""
    offset = 0.1 * np.abs(good.command).max()
    result = find_faults(good, good.measured, good.command - offset)
    (effect,) = result.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", True)


def test_an_offset_of_the_reading_alone_does_not(good):
    peak = np.abs(good.ideal).max()
    result = find_faults(good, good.measured + 0.08 * peak)
    (effect,) = result.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", False)
    assert result.error.rebuilt.rms.value == pytest.approx(good.rms, rel=0.06)


def test_drift_is_found(good):
    peak = np.abs(good.ideal).max()
    result = find_faults(good, good.measured + 0.1 * peak * np.linspace(-0.5, 0.5, good.measured.size))
    assert "drift" in kinds(result)
    (effect,) = (effect for effect in result.faults if effect.fault.kind == "drift")
    assert np.ptp(effect.fault.in_measured) == pytest.approx(0.1 * peak, rel=0.05)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("channel", "samples", "size"), [("measured", 1, 0.2), ("command", 4, -0.1)])
def test_a_spike_is_stated_and_not_counted(good, channel, samples, size):
    spoilt = getattr(good, channel).copy()
    spoilt[3000 : 3000 + samples] += size
    result = find_faults(good, **{channel: spoilt})
    assert kinds(result) == {"spike"}
    assert result.error.rebuilt.rms.value == pytest.approx(good.rms, rel=0.06)
    assert any("no actuator moves like that" in warning for warning in result.warnings)


def test_decisive_standstill_leaves_the_verdict_open(good):
    frozen = good.measured.copy()
    frozen[3000:3300] = frozen[3000]
    result = find_faults(good, frozen)
    assert "standstill" in kinds(result)
    assert result.verdict == "undecided"
    assert result.would_decide
    assert not result.reliable


@pytest.mark.parametrize("channel", ["command", "measured"])
@pytest.mark.parametrize("spoil", [lost, lambda history: saturated(history, 0.7)])
def test_a_channel_that_stood_still_makes_no_test_bad(good, shaken, channel, spoil):
    """Without the standstill the error is the true one, and the verdict stays open unless both agree."""
    result = find_faults(good, **{channel: spoil(getattr(good, channel))})
    (effect,) = (effect for effect in result.faults if effect.fault.kind == "standstill")
    assert effect.otherwise.rebuilt.rms.value == pytest.approx(good.rms, rel=0.06)
    assert result.verdict == "undecided"
    bad = shaken(delay=0.02)
    assert find_faults(bad, **{channel: spoil(getattr(bad, channel))}).verdict == "not_reliable"


def test_a_copied_channel_is_never_reliable(good):
    result = find_faults(good, good.command.copy())
    assert kinds(result) == {"copy"}
    assert result.verdict == "undecided"


def with_force(test, force):
    """Return the recording of a test with a force [N] and its noise."""
    noisy = force + 0.002 * force.std() * np.random.default_rng(3).normal(size=force.size)
    return Recording(command=test.command, measured=test.measured, time_step=1.0 / 256.0, force=noisy)


STATED = {"mass": StatedValue(1000.0)}
STIFFNESS = 1000.0 * ONE_HERTZ.circular_frequency**2


@pytest.mark.parametrize("spoil", [lambda force: saturated(force, 0.6), lost])
def test_a_saturated_or_lost_load_cell_is_no_yielding_specimen(shaken, good, spoil):
    sound = with_force(good, STIFFNESS * good.measured)
    spoilt = replace(sound, force=spoil(sound.force))
    result, alone = (
        assess(test, ONE_HERTZ, stated=STATED, linear_specimen=True)
        for test in (spoilt, replace(sound, force=None))
    )
    assert kinds(result) == {"force"}
    assert result.verdict == "undecided"
    assert "stands still" in result.reasons[0]
    assert "computer received" in result.would_decide[0]
    assert result.error.rms == alone.error.rms
    bad = with_force(late := shaken(delay=0.02), STIFFNESS * late.measured)
    assert assess(replace(bad, force=spoil(bad.force)), ONE_HERTZ, stated=STATED).verdict == "not_reliable"
    asked = assess(spoilt, ONE_HERTZ, stated=STATED, equipment=ordinary_equipment())
    assert not any("No force was recorded" in warning for warning in asked.warnings)
    with pytest.raises(InputError, match="cannot be learned from a force that stood still"):
        assess(spoilt, ONE_HERTZ, stated=STATED, measured_specimen=True)


@pytest.mark.parametrize(
    "law",
    [
        lambda x: slider_elongation(x, 0.3 * np.abs(x).max()),  # yields and unloads at once
        lambda x: np.maximum(x, 0.0),  # a slack cable
        lambda x: x - np.clip(x, -0.4 * np.abs(x).max(), 0.4 * np.abs(x).max()),  # a gap
        lambda x: np.round(x, 3),  # a coarse converter
    ],
)
def test_specimens_whose_force_stands_still_have_no_fault(good, law):
    force = STIFFNESS * law(good.measured)
    recording = Recording(command=good.command, measured=good.measured, time_step=1.0 / 256.0, force=force)
    assert not list(faults_of_force(recording))


@pytest.mark.parametrize(
    ("factor", "rule"),
    [
        (-1.0, "opposite sign of the command"),
        (1e3, "different units"),
        (1e-3, "different units"),
        (39.37, "different units"),
        (0.01, "different units"),
    ],
)
def test_another_sign_or_unit_is_refused(good, factor, rule):
    with pytest.raises(InputError, match=rule):
        find_faults(good, factor * good.measured)


def test_an_unrelated_channel_is_refused(good):
    noise = np.random.default_rng(1).normal(size=good.measured.size)
    with pytest.raises(InputError, match="follow the command"):
        find_faults(good, np.std(good.measured) * noise)


@pytest.mark.parametrize("zero", [0.7, -10.0])
def test_another_zero_of_both_channels_is_taken_away(shaken, zero):
    """Strokes of a piston: over a peak counted from its end, an error would be several times too small."""
    bad = shaken(delay=0.003)
    stroke = zero * np.abs(bad.ideal).max()
    result = find_faults(bad, bad.measured + stroke, bad.command + stroke)
    assert kinds(result) == {"zero"}
    assert result.error.rebuilt.rms.value == pytest.approx(bad.rms, rel=0.02)
    assert result.verdict is Word.NOT_RELIABLE
    assert any("taken as the position of rest" in warning for warning in result.warnings)


def test_a_release_from_a_displacement_has_its_zero_where_it_comes_to_rest():
    time = np.arange(0.0, 30.0, 1.0 / 256.0)
    command = np.exp(-0.1256 * time) * np.cos(2.0 * np.pi * time)
    result = find_faults(None, 0.999 * command, command)
    assert "zero" not in kinds(result)


@pytest.mark.parametrize("missing", ["samples", "end"])
def test_jumping_command_leaves_no_test_reliable(good, missing):
    command, measured_displacement = good.command, good.measured
    place = int(np.argmax(np.abs(command)))
    if missing == "samples":
        pieces = slice(0, place), slice(place + 128, None)
        command, measured_displacement = (
            np.concatenate([values[piece] for piece in pieces]) for values in (command, measured_displacement)
        )
    else:
        command, measured_displacement = (
            np.append(values[:place], np.zeros(512)) for values in (command, measured_displacement)
        )
    result = find_faults(good, measured_displacement, command)
    assert "jump" in kinds(result)
    assert result.verdict is not Word.RELIABLE
    (effect,) = (effect for effect in result.faults if effect.fault.kind == "jump")
    assert f"{place / 256:.4g} s" in effect.fault.finding


@pytest.mark.parametrize("seconds", [0.0, 120.0])
def test_a_long_rest_beside_the_motion_makes_no_bad_test_reliable(shaken, seconds):
    test = shaken(delay=0.0027)
    assert 0.05 < test.rms < 0.1
    remainder = np.zeros(int(256 * seconds))
    result = find_faults(test, np.append(remainder, test.measured), np.append(remainder, test.command))
    assert result.verdict is not Word.RELIABLE
    assert any("moves in" in reason for reason in result.reasons) == (seconds > 100.0)
