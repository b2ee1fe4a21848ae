"""A test with recorded ground acceleration tells a structure that was stated wrongly, and is not obeyed."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure


@pytest.fixture(scope="module")
def late_test(ground_motions, simulate_rig):
    motion = ground_motions[3]
    return simulate_rig(motion.acceleration, motion.time_step, seconds=30.0, delay=0.0022, db=40.0)


@pytest.fixture(scope="module")
def assessments(late_test):
    test = late_test

    def ask(frequency=1.0, damping_ratio=0.02, *, sign=1.0, ground=None, force=None, **larger):
        recording = Recording(
            command=test.command,
            measured=test.measured,
            time_step=1.0 / 256.0,
            ground=sign * test.ground if ground is None else ground,
            force=None if force is None else force(test.measured),
        )
        structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
        return test, assess(recording, structure, **larger)

    return ask


def test_a_structure_stated_rightly_is_not_contradicted(assessments):
    test, result = assessments()
    assert result.equation.wrong == ()
    assert result.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.02)


def test_a_wrong_frequency_is_told_and_leaves_the_verdict_open(assessments):
    test, result = assessments(1.02)
    assert result.equation.wrong == ("f",)
    assert any("The recording shows a natural frequency of" in warning for warning in result.warnings)
    assert result.verdict == "undecided"
    assert result.error.rebuilt.rms.value < 0.9 * test.rms  # with the frequency as stated


def test_a_frequency_within_its_stated_tolerance_is_not_contradicted(assessments):
    _, result = assessments(1.02, stated={"f": StatedValue(1.02, 0.015)})
    assert result.equation.wrong == ()


def test_decisive_wrong_damping_ratio_leaves_the_verdict_open(assessments):
    _, result = assessments(damping_ratio=0.031)
    assert result.equation.wrong == ("xi",)
    assert result.verdict == "undecided"
    assert any("damping ratio of 0.0" in reason for reason in result.reasons)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_short_pulse_belongs_to_its_test(simulate_rig, sign):
    """After it the ground rests, and the equation leaves nothing but noise."""
    step = 1.0 / 256.0
    pulse = np.where(np.arange(0.0, 30.0, step) < 0.2, 1.0, 0.0)
    test = simulate_rig(pulse, step, seconds=30.0, delay=0.0022, db=40.0)
    recording = Recording(
        command=test.command, measured=test.measured, time_step=step, ground=sign * test.ground
    )
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    shown = assess(recording, structure).error.ground
    assert not shown.doubts
    assert shown.frequency == pytest.approx(1.0, rel=0.02)
    shifted = replace(recording, ground=np.roll(recording.ground, 1000))
    assert assess(shifted, structure).error.ground.doubts


@pytest.mark.parametrize("assumptions", [0.02, 0.05])
def test_unstated_damping_ratio_comes_from_the_test(assessments, assumptions):
    """Simulated with 0.02; as uncertain as the skew of the channels leaves it."""
    messages = ("No damping ratio was stated.",)
    test, result = assessments(damping_ratio=assumptions, assumed=messages, equipment=ordinary_equipment())
    stated_values = result.stated["xi"]
    assert stated_values.value == pytest.approx(0.02, rel=0.06)
    assert 0.001 < stated_values.deviation < 0.01
    rms = result.error.rms
    assert rms.low < test.rms < rms.high
    assert rms.value == pytest.approx(test.rms, abs=0.2 * (rms.high - rms.low))
    assert not any("was stated" in w.removeprefix("No damping ratio was stated") for w in result.warnings)
    of_ratio = next(item for item in result.error.budget if item.name == "damping_ratio")
    assert of_ratio.source == "learned from this test"


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(
    ("sign", "words"),
    [
        (-1.0, "opposite sign"),
        (0.0, "zero throughout"),
        *((unit, "does not belong to this test") for unit in (1e6, 6.0, -0.5)),
    ],
)
def test_another_ground_acceleration_is_said(assessments, sign, words):
    _, result = assessments(sign=sign)
    assert any(words in warning for warning in result.warnings)


UNITS = {"g": 9.80665, "gal": 0.01, "mm/s2": 0.001, "ft/s2": 0.3048, "in/s2": 0.0254}


@pytest.mark.default_cases(6)
@pytest.mark.parametrize("power", [1.0, -1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("unit", UNITS)
def test_a_ground_acceleration_in_another_unit_is_refused_by_its_name(assessments, unit, sign, power):
    with pytest.raises(InputError, match="does not fit its unit") as refusal:
        assessments(sign=sign * UNITS[unit] ** -power)
    assert (f"Is it in {unit}?" in str(refusal.value)) is (power > 0.0)
    assert ("times as large" in str(refusal.value)) is (power < 0.0)


@pytest.mark.default_cases(3)
@pytest.mark.parametrize("frequency", [1.0, 0.98])
@pytest.mark.parametrize("factor", [1.0, -1.0, 100.0])
def test_an_absolute_acceleration_is_no_ground_acceleration(late_test, assessments, frequency, factor):
    relative = np.gradient(np.gradient(late_test.command, 1 / 256), 1 / 256)
    absolute = factor * (late_test.ground + relative)
    _, result = assessments(frequency, ground=absolute)
    assert result.equation.identified is None
    assert any("absolute acceleration" in warning for warning in result.warnings)


def test_contradicting_channel_leaves_no_test_reliable(assessments):
    assert assessments(threshold=0.3)[1].verdict == "reliable"
    _, result = assessments(sign=6.0, threshold=0.3)
    assert result.verdict == "undecided"
    assert any("unit and range of the ground acceleration" in remedy for remedy in result.would_decide)


def test_a_frequency_far_from_the_stated_one_is_not_taken(assessments):
    """It would be the stated structure that is another one, or the channel."""
    _, result = assessments(0.7)
    assert result.equation.identified is None
    assert any("the structure would have 1" in reason for reason in result.reasons)


@pytest.mark.parametrize(("cubic", "open_"), [(0.0, False), (3000.0, True)])
def test_apparently_nonlinear_specimen_leaves_the_verdict_open(assessments, cubic, open_):
    _, result = assessments(force=lambda displacement: 39.5 * displacement + cubic * displacement**3)
    assert bool(result.equation.nonlinear) is open_
    assert (result.verdict == "undecided") is open_
    assert any("give a model" in remedy for remedy in result.would_decide) is open_


EVERY = 16  # of the samples simulated at 4096 Hz one is recorded
MASS = 1000.0
BAD, GOOD = 0.0022, 0.0012  # delays [s] with errors of 6 and 3 %


@pytest.fixture(scope="module")
def skewed_assessments(ground_motions, simulate_rig):
    """Judge a test whose measured displacement was recorded late, by steps of 0.244 ms."""
    motion = ground_motions[3]

    def ask(*, delay, late=0, force_case=False, stated_ratio=0.02, has_ground=True):
        test = simulate_rig(
            motion.acceleration, motion.time_step, seconds=30.0, delay=delay, rate=4096.0, db=200.0
        )
        places = np.arange(0, test.command.size, EVERY)
        generator = np.random.default_rng(7)

        def noisy(history):
            return history + 0.004 * np.std(history) * generator.normal(size=history.size)

        recording = Recording(
            command=test.command[places],
            measured=noisy(test.measured[np.clip(places - late, 0, test.measured.size - 1)]),
            time_step=EVERY / 4096.0,
            ground=test.ground[places] if has_ground else None,
            force=noisy(MASS * (2.0 * np.pi) ** 2 * test.measured[places]) if force_case else None,
        )
        stated_values = {"mass": StatedValue(MASS)} if force_case else {}
        return test, assess(
            recording, Structure(frequency=1.0, damping_ratio=stated_ratio), stated=stated_values
        )

    return ask


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("force_case", [False, True])
@pytest.mark.parametrize(
    ("delay", "late", "stated_ratio"), [(BAD, -4, 0.02), (GOOD, 4, 0.02), (BAD, 0, 0.027)]
)
def test_a_skew_or_a_wrong_damping_ratio_leaves_the_verdict_open(
    skewed_assessments, force_case, delay, late, stated_ratio
):
    _, result = skewed_assessments(delay=delay, late=late, force_case=force_case, stated_ratio=stated_ratio)
    assert result.verdict == "undecided"
    assert any("state how uncertain it is" in remedy for remedy in result.would_decide)


@pytest.mark.parametrize(("late", "wrong"), [(-4, ("skew",)), (0, ()), (4, ("skew",))])
def test_a_force_alone_shows_the_skew_of_the_channels(skewed_assessments, late, wrong):
    _, result = skewed_assessments(delay=GOOD, late=late, force_case=True, has_ground=False)
    assert result.equation.wrong == wrong
    skew = 1e3 * late / 4096.0
    sentences = result.equation.contradictions
    assert [abs(float(text.split()[9]) - skew) < 0.03 for text in sentences] == [True] * len(wrong)


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("force_case", [False, True])
@pytest.mark.parametrize("delay", [BAD, GOOD])
def test_sound_channels_lose_nothing(skewed_assessments, force_case, delay):
    test, result = skewed_assessments(delay=delay, force_case=force_case)
    assert result.equation.contradictions == ()
    assert result.verdict == ("reliable" if delay == GOOD else "not_reliable")
    assert result.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.015)  # as far as the noise lets
