"""The floor of a channel follows from the recordings alone, by whatever they offer, and is null otherwise."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.campaign.campaign import Channel, MeasuredTest
from reliab.discrepancy.proof import Source, floors, gap
from reliab.discrepancy.result.gap import Gap, HeldOutTest
from reliab.discrepancy.segment import Segment

RATE = 512.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)
NOISE = 0.01


def waves(seed, low=0.4, high=2.0):
    rng = np.random.default_rng(seed)
    return sum(np.sin(2.0 * np.pi * f * TIME + rng.uniform(0.0, 7.0)) for f in rng.uniform(low, high, 6))


def record_test(command, seed, *, noise=None, motion="", memory=0.0):
    """A channel that answers its command with a cube, and first-order noise of RMS `NOISE`."""
    rng = np.random.default_rng(seed)
    noise_added = (
        signal.lfilter([1.0], [1.0, -memory], rng.normal(size=TIME.size)) if noise is None else noise
    )
    reading = command + 0.1 * command**3 + NOISE * noise_added / noise_added.std()
    channels = {Channel.COMMAND: command, Channel.MEASURED: reading}
    return MeasuredTest(file=f"{seed}", motion=motion, held_out=True, channels=channels)


def floors_of(*tests):
    result = floors(tests, range(len(tests)), Channel.MEASURED, (Channel.COMMAND,), rate=RATE, highest=45.0)
    return {source: np.sqrt(square) for source, square in result.items()}


def test_white_noise_is_read_off_the_band_above_the_motion():
    assert floors_of(record_test(waves(1), 1))[Source.BAND_ABOVE] == pytest.approx(NOISE, rel=0.05)


@pytest.mark.parametrize("is_narrow", [True, False])
def test_floor_is_the_noise_at_the_frequencies_that_count(is_narrow):
    test = record_test(waves(1), 1)
    block = SimpleNamespace(
        tests=[test], channel=Channel.MEASURED, inputs=(Channel.COMMAND,), rate=RATE, highest=45.0,
        highest_signal=45.0, is_narrow=is_narrow, measured=lambda _test: test.channels[Channel.MEASURED],
    )  # fmt: skip
    segment = Segment(test=0, begin=0, end=TIME.size, rate=RATE, highest=45.0)
    command = test.channels[Channel.COMMAND]
    left = {0: test.channels[Channel.MEASURED] - command - 0.1 * command**3}
    found = gap(SimpleNamespace(block=block, segments=(segment,)), left, left)
    assert found.floors[Source.BAND_ABOVE] == pytest.approx(found.after, rel=0.05)


def test_coloured_noise_is_not_known_from_the_band_above():
    assert floors_of(record_test(waves(1), 1, memory=0.95)) == {}


def test_repeated_tests_tell_whatever_the_colour():
    result = floors_of(*(record_test(waves(1), k, motion="a", memory=0.95) for k in range(4)))
    assert next(iter(result)) is Source.REPEATED_TESTS
    assert result[Source.REPEATED_TESTS] == pytest.approx(NOISE, rel=0.1)


def test_tests_under_other_commands_are_no_repeats():
    assert Source.REPEATED_TESTS not in floors_of(*(record_test(waves(k), k, motion="a") for k in range(3)))


def test_repeated_cycles_tell_and_their_harmonics_are_no_noise():
    sine = np.sin(2.0 * np.pi * 2.0 * TIME)
    result = floors_of(record_test(sine, 1, memory=0.9))
    assert result[Source.REPEATED_CYCLES] == pytest.approx(NOISE, rel=0.15)


def test_a_converter_at_rest_hides_its_own_noise():
    """At rest nothing changes, and in motion the steps are as uneven as ever."""
    command = waves(1) * (TIME > 2.0)
    step = 0.05
    read = np.round(command / step) * step
    test = MeasuredTest(
        file="a", motion="", held_out=True, channels={Channel.COMMAND: command, Channel.MEASURED: read}
    )
    assert floors_of(test)[Source.AT_REST] == pytest.approx(step / np.sqrt(12.0), rel=1e-6)


def test_rest_before_the_motion_tells():
    late = np.where(TIME > 4.0, waves(1) * np.clip(TIME - 4.0, 0.0, 1.0), 0.0)
    assert floors_of(record_test(late, 1))[Source.AT_REST] == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("floor", [0.0, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("error_after", [0.0, 0.04, 0.3, 0.7])
def test_closed_fraction_stays_within_its_bounds(floor, error_after):
    gap = Gap(
        channel="force_n", before=0.5, after=error_after, floors={"rest": floor},
        tests=(HeldOutTest(file="a", before=0.5, after=error_after),),
    )  # fmt: skip
    assert gap.closed_fraction is None or 0.0 <= gap.closed_fraction <= 1.0
    floor_counted = (
        floor if floor <= 1.2 * error_after else 0.0
    )  # a floor far above what the model leaves is none
    assert gap.model_error == pytest.approx(np.sqrt(max(error_after**2 - floor_counted**2, 0.0)))
    assert gap.unexplained_share is None or 0.0 <= gap.unexplained_share <= 1.0
    if gap.closed_fraction is not None and not error_after <= 1.2 * floor_counted:
        assert gap.unexplained_share == pytest.approx(1.0 - gap.closed_fraction)


def test_without_a_floor_nothing_is_said_of_the_closed_fraction():
    gap = Gap(
        channel="force_n", before=0.5, after=0.1, floors={},
        tests=(HeldOutTest(file="a", before=0.5, after=0.1),),
    )  # fmt: skip
    assert gap.closed_fraction is gap.floor is gap.source is None
    assert gap.to_dict()["noise_floor"] is None


def quiet(error_before, error_after, *, floors=None, noise_like=("a",)):
    """Gap of one held-out test."""
    return Gap(
        channel="force_n", before=error_before, after=error_after, floors=floors or {},
        tests=(HeldOutTest(file="a", before=error_before, after=error_after, noise_like="a" in noise_like),),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("error_before", "error_after", "floors", "noise_like", "remainder"),
    [
        (0.00841, 0.00841, {"rest": 0.00806}, (), None),
        (0.00873, 0.00873, {}, ("a",), None),
        (0.00873, 0.00873, {}, (), 1.0),
        (0.0797, 0.0084, {"rest": 0.00806}, (), 0.0),
        (0.0797, 0.0084, {}, ("a",), 0.0),
        (0.0797, 0.0797, {"rest": 0.00806}, ("a",), 1.0),
        (0.2, 0.1, {}, (), 0.25),
    ],
)  # fmt: skip
def test_of_noise_nothing_is_unexplained(error_before, error_after, floors, noise_like, remainder):
    """Where the calibrated model is at the noise, there is nothing to explain and no share of it."""
    gap = quiet(error_before, error_after, floors=floors, noise_like=noise_like)
    (test_gap,) = gap.by_test
    assert (
        test_gap.unexplained_share == gap.worst_unexplained_share == (remainder and pytest.approx(remainder))
    )
    assert ("calibrated model is at the level of the noise" in gap.conclusion) is (remainder is None)
    assert ("cannot show the effect" in gap.conclusion) is (remainder is None)
    assert "nothing to explain" not in gap.conclusion
    assert ("nothing to explain" in dataclasses.replace(gap, missing=False).conclusion) is (remainder is None)
    assert gap.to_dict()["conclusion"] == gap.conclusion


def test_effects_of_a_small_gap_are_not_said_to_explain_nothing():
    gap = quiet(0.0502, 0.0451, floors={"band above the motion": 0.0452}, noise_like=())
    assert gap.conclusion == "what remains is at the level of the noise"


def test_where_nothing_is_missing_no_share_is_unexplained():
    gap = dataclasses.replace(quiet(0.0087, 0.0087, noise_like=()), missing=False)
    assert gap.unexplained_share is gap.worst_unexplained_share is gap.by_test[0].unexplained_share is None
    assert "too small to be called an effect" in gap.conclusion
