"""A test with recorded ground acceleration tells a structure that was stated wrongly, and is not obeyed."""

import pytest

from reliab.loop.structure import Structure
from reliab.stated_value import StatedValue
from reliab.validation.assessment import Recording, assess


@pytest.fixture(scope="module")
def judged(ground_motions, simulate_rig):
    motion = ground_motions[3]
    test = simulate_rig(motion.acceleration, motion.time_step, seconds=30.0, delay=0.0022, db=40.0)

    def ask(frequency=1.0, damping_ratio=0.02, *, sign=1.0, force=None, stated=None):
        recording = Recording(
            command=test.command,
            measured=test.measured,
            time_step=1.0 / 256.0,
            ground=sign * test.ground,
            force=None if force is None else force(test.measured),
        )
        structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
        return test, assess(recording, structure, stated=stated)

    return ask


def test_a_structure_stated_rightly_is_not_contradicted(judged):
    test, found = judged()
    assert found.equation.wrong == ()
    assert found.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.02)


def test_a_wrong_frequency_is_told_and_not_obeyed(judged):
    test, found = judged(1.02)
    assert found.equation.wrong == ("f",)
    assert any("shows a natural frequency of" in warning for warning in found.warnings)
    assert found.error.rebuilt.rms.value == pytest.approx(test.rms, rel=0.02)
    (as_stated,) = found.otherwise_stated
    assert as_stated.rebuilt.rms.value < 0.9 * test.rms


def test_a_frequency_within_its_stated_tolerance_is_not_contradicted(judged):
    _, found = judged(1.02, stated={"f": StatedValue(1.02, 0.015)})
    assert found.equation.wrong == ()


def test_a_wrong_damping_ratio_that_decides_leaves_the_verdict_open(judged):
    _, found = judged(damping_ratio=0.031)
    assert found.equation.wrong == ("xi",)
    assert found.verdict.word == "undecided"
    assert any("damping ratio of 0.0" in reason for reason in found.verdict.reasons)


@pytest.mark.parametrize(("sign", "words"), [(-1.0, "opposite sign"), (0.1, "does not belong to this test")])
def test_another_ground_acceleration_is_said(judged, sign, words):
    _, found = judged(sign=sign)
    assert any(words in warning for warning in found.warnings)


@pytest.mark.parametrize(("cubic", "open_"), [(0.0, False), (3000.0, True)])
def test_a_specimen_that_looks_nonlinear_leaves_the_verdict_open(judged, cubic, open_):
    _, found = judged(force=lambda moved: 39.5 * moved + cubic * moved**3)
    assert bool(found.equation.nonlinear) is open_
    assert (found.verdict.word == "undecided") is open_
    assert any("--model" in remedy for remedy in found.verdict.would_decide) is open_
