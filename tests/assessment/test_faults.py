"""Faults of a recording are found and stated with what they do to the error; sound recordings have none."""

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.assessment.verdict import Word
from reliab.core.errors import InputError
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


def judged(test, measured=None, command=None):
    return assess(
        Recording(
            command=test.command if command is None else command,
            measured=test.measured if measured is None else measured,
            time_step=1.0 / 256.0,
        ),
        ONE_HERTZ,
    )


def kinds(found):
    return {effect.fault.kind for effect in found.faults}


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(
    "rig", [{"delay": 0.001}, {"lead": 0.001}, {"lag": 0.001}, {"gain": 0.99}, {"backlash": 0.0004}]
)
def test_a_sound_recording_has_no_faults_whatever_the_actuator(shaken, rig):
    assert judged(shaken(**rig)).faults == ()


def test_an_offset_that_the_loop_felt_counts(shaken):
    """The command rests beside zero, and the transient of getting there is an error."""
    peak = np.abs(shaken().ideal).max()
    test = shaken(gain=0.998, bias=0.145 * peak)
    found = judged(test)
    (effect,) = found.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", True)
    assert found.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.05)
    assert effect.otherwise.rebuilt.rms.value < 0.5 * test.rms
    assert any("the structure felt it" in warning for warning in found.warnings)


def test_an_offset_that_the_loop_felt_before_the_recording_began_is_no_other_zero(good):
    """The command rests at the answer to it from the first sample on."""
    offset = 0.1 * np.abs(good.command).max()
    found = judged(good, good.measured, good.command - offset)
    (effect,) = found.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", True)


def test_an_offset_of_the_reading_alone_does_not(good):
    peak = np.abs(good.ideal).max()
    found = judged(good, good.measured + 0.08 * peak)
    (effect,) = found.faults
    assert (effect.fault.kind, effect.fault.in_loop) == ("offset", False)
    assert found.error.rebuilt.rms.value == pytest.approx(good.rms, rel=0.06)


def test_drift_is_found(good):
    peak = np.abs(good.ideal).max()
    found = judged(good, good.measured + 0.1 * peak * np.linspace(-0.5, 0.5, good.measured.size))
    assert "drift" in kinds(found)
    (effect,) = (effect for effect in found.faults if effect.fault.kind == "drift")
    assert np.ptp(effect.fault.in_measured) == pytest.approx(0.1 * peak, rel=0.05)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("channel", "samples", "size"), [("measured", 1, 0.2), ("command", 4, -0.1)])
def test_a_spike_is_stated_and_not_counted(good, channel, samples, size):
    spoilt = getattr(good, channel).copy()
    spoilt[3000 : 3000 + samples] += size
    found = judged(good, **{channel: spoilt})
    assert kinds(found) == {"spike"}
    assert found.error.rebuilt.rms.value == pytest.approx(good.rms, rel=0.06)
    assert any("no actuator moves like that" in warning for warning in found.warnings)


def test_a_standstill_that_turns_the_verdict_leaves_it_open(good):
    frozen = good.measured.copy()
    frozen[3000:3300] = frozen[3000]
    found = judged(good, frozen)
    assert "standstill" in kinds(found)
    assert found.verdict == "undecided"
    assert found.would_decide
    assert not found.reliable


def test_a_copied_channel_is_never_reliable(good):
    found = judged(good, good.command.copy())
    assert kinds(found) == {"copy"}
    assert found.verdict == "undecided"


@pytest.mark.parametrize(
    ("factor", "rule"),
    [
        (-1.0, "opposite sign of the command"),
        (1e3, "the same unit"),
        (1e-3, "the same unit"),
        (39.37, "the same unit"),
        (0.01, "the same unit"),
    ],
)
def test_another_sign_or_unit_is_refused(good, factor, rule):
    with pytest.raises(InputError, match=rule):
        judged(good, factor * good.measured)


def test_an_unrelated_channel_is_refused(good):
    noise = np.random.default_rng(1).normal(size=good.measured.size)
    with pytest.raises(InputError, match="follow the command"):
        judged(good, np.std(good.measured) * noise)


@pytest.mark.parametrize("zero", [0.7, -10.0])
def test_another_zero_of_both_channels_is_taken_away(shaken, zero):
    """Strokes of a piston: over a peak counted from its end, an error would be several times too small."""
    bad = shaken(delay=0.003)
    stroke = zero * np.abs(bad.ideal).max()
    found = judged(bad, bad.measured + stroke, bad.command + stroke)
    assert kinds(found) == {"zero"}
    assert found.error.rebuilt.rms.value == pytest.approx(bad.rms, rel=0.02)
    assert found.verdict is Word.NOT_RELIABLE
    assert any("taken as the position of rest" in warning for warning in found.warnings)


def test_a_release_from_a_displacement_has_its_zero_where_it_comes_to_rest():
    time = np.arange(0.0, 30.0, 1.0 / 256.0)
    command = np.exp(-0.1256 * time) * np.cos(2.0 * np.pi * time)
    found = judged(None, 0.999 * command, command)
    assert "zero" not in kinds(found)


@pytest.mark.parametrize("lost", ["samples", "end"])
def test_a_command_that_jumps_leaves_no_test_reliable(good, lost):
    command, measured = good.command, good.measured
    place = int(np.argmax(np.abs(command)))
    if lost == "samples":
        pieces = slice(0, place), slice(place + 128, None)
        command, measured = (
            np.concatenate([values[piece] for piece in pieces]) for values in (command, measured)
        )
    else:
        command, measured = (np.append(values[:place], np.zeros(512)) for values in (command, measured))
    found = judged(good, measured, command)
    assert "jump" in kinds(found)
    assert found.verdict is not Word.RELIABLE
    (effect,) = (effect for effect in found.faults if effect.fault.kind == "jump")
    assert f"{place / 256:.4g} s" in effect.fault.finding


@pytest.mark.parametrize("seconds", [0.0, 120.0])
def test_a_long_rest_beside_the_motion_makes_no_bad_test_reliable(shaken, seconds):
    test = shaken(delay=0.0027)
    assert 0.05 < test.rms < 0.1
    rest = np.zeros(int(256 * seconds))
    found = judged(test, np.append(rest, test.measured), np.append(rest, test.command))
    assert found.verdict is not Word.RELIABLE
    assert any("moves in" in reason for reason in found.reasons) == (seconds > 100.0)
