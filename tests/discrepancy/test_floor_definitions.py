"""Floors by their definitions, and typical sizes of a campaign."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.proof import Source, _close, _period, floors
from reliab.discrepancy.segment import motions_of, scales_of
from reliab.structures.frame import Specimen

RATE = 400.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)


def noise_of(*shape):
    return np.random.default_rng(1).standard_normal(shape)


def driven(command, reading):
    channels = {Channel.COMMAND: command, Channel.MEASURED: reading}
    return MeasuredTest(file="t", motion="a", held_out=True, channels=channels)


def floors_of(*tests, held_out=None, highest=45.0):
    choice = range(len(tests)) if held_out is None else held_out
    return floors(tests, choice, Channel.MEASURED, (Channel.COMMAND,), rate=RATE, highest=highest)


def test_repeats_differ_by_twice_the_floor():
    command, noise = np.sin(3.0 * TIME), noise_of(2, TIME.size)
    tests = [driven(command, command + part) for part in noise]
    reference = 0.5 * np.var(noise[0] - noise[1])
    assert floors_of(*tests, held_out=())[Source.REPEATED_TESTS] == pytest.approx(reference)
    unnamed_tests = [replace(test, motion="") for test in tests]
    assert floors_of(*unnamed_tests, held_out=()) == {}
    assert floors_of(tests[0], replace(tests[1], motion="b"), held_out=()) == {}


@pytest.mark.parametrize(("share", "is_same"), [(0.019, True), (0.021, False)])
def test_inputs_are_the_same_within_two_per_cent(share, is_same):
    first = np.sin(3.0 * TIME)
    rival = np.cos(3.0 * TIME)
    second = first + share * np.std(first) / np.std(rival) * rival
    assert _close(first, second) is is_same
    assert not _close(np.zeros(5), np.arange(5.0))


@pytest.mark.parametrize("lag", [50, 80, 400])
def test_a_period_is_found_to_the_sample(lag):
    """Of what repeats itself exactly, to a whole number of periods."""
    turn = 2.0 * np.pi * np.arange(TIME.size) / lag
    values = np.sin(turn) + 0.3 * np.sin(3.0 * turn)
    assert _period(values) % lag == 0
    assert _period(np.ones(30)) is None


def test_cycles_differ_by_twice_the_floor():
    cycle = np.sin(2.0 * np.pi * np.arange(TIME.size) / 80)
    noise = noise_of(TIME.size)
    lag = _period(cycle)
    inner = noise[lag:]
    reference = 0.5 * np.mean((inner[lag:] - inner[:-lag]) ** 2)
    test = driven(cycle, cycle + noise)
    assert floors_of(test)[Source.REPEATED_CYCLES] == pytest.approx(reference)
    # a cycle has 80 samples; three are needed
    assert Source.REPEATED_CYCLES not in floors_of(driven(cycle[:239], (cycle + noise)[:239]))
    assert Source.REPEATED_CYCLES in floors_of(driven(cycle[:2000], (cycle + noise)[:2000]))


@pytest.mark.parametrize("amplitude", [0.0, 0.2])
def test_the_band_above_holds_white_noise_and_the_mains(amplitude):
    """White noise has its variance below the band too; a line of the mains half its squared amplitude."""
    noise = 0.1 * noise_of(TIME.size)
    mains = amplitude * np.sin(2.0 * np.pi * 60.0 * TIME)
    floor = floors_of(driven(np.sin(3.0 * TIME), np.sin(3.0 * TIME) + noise + mains))[Source.BAND_ABOVE]
    assert floor == pytest.approx(0.01 + 0.5 * amplitude**2, rel=0.05)


@pytest.mark.parametrize(("ratio", "white"), [(1.15, True), (1.45, False)])
def test_a_band_is_white_if_both_halves_have_one_level(ratio, white):
    """A level that steps by `ratio` in the middle of the band."""
    spectrum = np.fft.rfft(0.1 * noise_of(TIME.size))
    frequency = np.fft.rfftfreq(TIME.size, 1.0 / RATE)
    spectrum[frequency > 0.5 * (45.0 + 0.49 * RATE)] *= np.sqrt(ratio)
    assert (Source.BAND_ABOVE in floors_of(driven(np.sin(TIME), np.fft.irfft(spectrum)))) is white


def test_rest_at_both_ends_counts_from_a_quarter_of_a_second():
    command = np.zeros(TIME.size)
    command[130:-99] = np.sin(3.0 * TIME[130:-99]) + 2.0
    noise = noise_of(TIME.size)
    floor = floors_of(driven(command, command + noise), highest=199.0)[Source.AT_REST]
    ramp = np.polyfit(np.arange(130), noise[:130], 1)
    assert floor == pytest.approx(np.var(noise[:130] - np.polyval(ramp, np.arange(130))))


def test_rest_lasts_until_a_five_hundredth_of_the_range_is_reached():
    command = np.zeros(TIME.size)
    command[200:] = 0.5 * np.sin(0.5 * np.pi * np.minimum(np.arange(TIME.size - 200) / 4000, 1.0))
    command[-50:] = 0.3
    still = int(np.argmax(command > 0.002 * 0.5))
    assert still > 203
    noise = noise_of(TIME.size)
    ramp = np.polyfit(np.arange(still), noise[:still], 1)
    floor = floors_of(driven(command, command + noise), highest=199.0)[Source.AT_REST]
    reference = np.var(noise[:still] + command[:still] - np.polyval(ramp, np.arange(still)))
    assert floor == pytest.approx(reference, rel=1e-3)


@pytest.mark.parametrize(("size", "is_known"), [(400, False), (1500, True)])
def test_a_band_needs_128_frequencies(size, is_known):
    """Between 150 and 196 Hz, without the mains, a record of n samples has about 0.11 n."""
    noise = noise_of(size)
    assert (Source.BAND_ABOVE in floors_of(driven(np.sin(TIME[:size]), noise), highest=150.0)) is is_known


def campaign_of(*tests, specimen=None):
    return Campaign(
        name="c", structure=None, mass=1.0, actuator=None, specimen=specimen, rate=RATE, tests=tuple(tests)
    )


def moving(factor, held_out, force=None):
    command = factor * (0.02 * np.sin(2.0 * np.pi * TIME) + 0.005)
    channels = {Channel.COMMAND: command, Channel.MEASURED: command}
    if force is not None:
        channels[Channel.FORCE] = force
    return MeasuredTest(file="t", motion="", held_out=held_out, channels=channels)


def test_scales_are_peaks_of_fitted_tests():
    force = 30.0 * np.sin(2.0 * np.pi * TIME) + 100.0
    tests = (moving(1.0, held_out=False, force=force), moving(9.0, held_out=True, force=9.0 * force))
    campaign = campaign_of(*tests)
    scales = scales_of(campaign, motions_of(campaign))
    omega = 2.0 * np.pi
    peaks = (scales.displacement, scales.velocity, scales.acceleration)
    assert peaks == pytest.approx((0.02, 0.02 * omega, 0.02 * omega**2), rel=2e-3)
    assert scales.force == pytest.approx(np.abs(force - np.median(force)).max())
    assert scales.duration == pytest.approx(20.0)


def test_unmeasured_force_is_taken_from_the_nominal_specimen():
    arguments = campaign_of(moving(1.0, held_out=False), specimen=Specimen(stiffness=500.0))
    assert scales_of(arguments, motions_of(arguments)).force == pytest.approx(500.0 * 0.02, rel=2e-3)
    unknown = campaign_of(moving(1.0, held_out=False))
    assert scales_of(unknown, motions_of(unknown)).force == 1.0


def test_a_constant_displacement_has_no_scale():
    still = campaign_of(moving(0.0, held_out=False))
    with pytest.raises(InputError, match="must move"):
        scales_of(still, motions_of(still))
