"""Blunders of a recording are refused by name before any model takes them for an effect."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from reliab.core.errors import InputError
from reliab.discrepancy.campaign import reading
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.campaign.contradictions import _cross_spectrum, require_consistent
from reliab.discrepancy.campaign.reading import read_campaign, read_channels
from reliab.discrepancy.diagnose import diagnose
from reliab.recordings.recording import StatedChannels
from reliab.structures.frame import Specimen

RIGS = ("rig_a", "rig_b", "rig_c")
read_rig = cache(read_campaign)
FORCE, GROUND, COMMAND, READING = Channel.FORCE, Channel.GROUND, Channel.COMMAND, Channel.MEASURED


def spoil_channel(campaign, channel, factor, tests=None):
    """The campaign with a channel of some tests, or of all, multiplied."""
    change = [
        replace(test, channels={**test.channels, channel: factor * test.channels[channel]})
        if tests is None or place in tests
        else test
        for place, test in enumerate(campaign.tests)
    ]
    return replace(campaign, tests=tuple(change))


def keep_channels(campaign, *channels):
    """The campaign with some of its channels only."""
    return replace(
        campaign,
        tests=tuple(
            replace(test, channels={channel: test.channels[channel] for channel in channels})
            for test in campaign.tests
        ),
    )


@pytest.mark.parametrize("name", RIGS)
def test_sound_campaigns_pass_without_a_word(name):
    assert require_consistent(read_rig(name)) == ()


@pytest.mark.slow
@pytest.mark.default_cases(8)
@pytest.mark.parametrize("factor", [-1.0, 1000.0, 0.001, -39.37])
@pytest.mark.parametrize("channel", Channel)
@pytest.mark.parametrize("name", RIGS)
def test_a_blunder_in_one_run_names_the_file_and_the_rule(name, channel, factor):
    campaign = read_rig(name)
    for place, test in enumerate(campaign.tests):
        with pytest.raises(InputError, match=r"sign|unit|resist|specimen") as refusal:
            require_consistent(spoil_channel(campaign, channel, factor, {place}))
        assert refusal.value.where == test.file


@pytest.mark.parametrize(
    ("channel", "factor", "rule"),
    [
        (FORCE, -1.0, "resist the motion"),
        (FORCE, 1000.0, "stated specimen"),
        (READING, -1.0, "opposite sign of the command"),
        (READING, 1000.0, "different units"),
        (COMMAND, 0.0254, "different units"),
    ],
)
@pytest.mark.parametrize("name", RIGS)
def test_a_blunder_in_every_run_is_refused_as_in_an_assessment(name, channel, factor, rule):
    with pytest.raises(InputError, match=rule) as refusal:
        diagnose(spoil_channel(read_rig(name), channel, factor))
    assert refusal.value.where == read_rig(name).tests[0].file


@pytest.mark.parametrize("times", [1.0, 0.06, 12.0, 28.0])
def test_no_specimen_is_refused_for_another_stiffness_than_the_stated_one(times):
    """The stiffness is fitted: what is stated of it is a first value, and no unit has these ratios."""
    displacement = 1e-3 * np.sin(np.linspace(0.0, 60.0, 3000)) * np.linspace(0.5, 1.0, 3000)
    force = 1e3 * (displacement + 0.1 * np.gradient(displacement))
    channels = {READING: displacement, FORCE: force}
    test = MeasuredTest(file="a.csv", motion="", held_out=False, channels=channels)
    campaign = replace(
        read_rig("rig_a"), structure=None, specimen=Specimen(stiffness=1e3 / times), tests=(test, test)
    )
    assert require_consistent(campaign) == ()


@pytest.mark.slow
@pytest.mark.default_cases(3)
@pytest.mark.parametrize("places", [{1}, {0, 1, 2}])
@pytest.mark.parametrize("unit", [9.80665, 1.0 / 9.80665])
@pytest.mark.parametrize("name", RIGS)
def test_a_ground_acceleration_in_another_unit_is_said_of_each_test(name, unit, places):
    faults = require_consistent(spoil_channel(read_rig(name), GROUND, unit, places))
    assert len(faults) == len(places)
    for place, sentence in zip(sorted(places), faults, strict=True):
        file = read_rig(name).tests[place].file
        assert sentence.startswith(f"{file}: The ground acceleration does not fit its unit")


@pytest.mark.parametrize("name", RIGS)
def test_unrecorded_ground_acceleration_is_refused(name):
    """It would be called an unknown effect of the numerical substructure."""
    with pytest.raises(InputError, match="is constant, although the test starts at rest; found 0 throughout"):
        require_consistent(spoil_channel(read_rig(name), GROUND, 0.0))


@pytest.mark.parametrize(("share", "is_told"), [(1e-4, False), (3e-3, True)])
def test_noisy_command_is_told(share, is_told):
    """Its noise was named a lag, an added mass and an error of the integration."""
    rig = read_rig("rig_a")
    rng = np.random.default_rng(1)
    tests = [
        replace(test, channels={**test.channels, COMMAND: command + share * command.std() * noise})
        for test in rig.tests
        for command in [test.channels[COMMAND]]
        for noise in [rng.standard_normal(command.size)]
    ]
    sentences = require_consistent(replace(rig, tests=tuple(tests)))
    assert len(sentences) == is_told
    assert all(f"% in {test.file}" in sentence for test in tests for sentence in sentences)
    assert all("holds noise (0." in sentence for sentence in sentences)


def test_followed_random_command_is_no_noise():
    rng, rate = np.random.default_rng(2), 50.0
    tests = []
    for place in range(2):
        command = 0.01 * rng.standard_normal(3000)
        reading = np.convolve(command, [0.7, 0.3])[:3000] + 1e-5 * rng.standard_normal(3000)
        channels = {COMMAND: command, READING: reading}
        tests.append(MeasuredTest(file=f"{place}.csv", motion="", held_out=place == 1, channels=channels))
    campaign = Campaign(
        name="", structure=None, mass=1.0, actuator=None, specimen=None, rate=rate, tests=tuple(tests)
    )
    assert require_consistent(campaign) == ()


def test_released_structure_needs_no_ground_acceleration():
    """A free vibration begins where the structure was held."""
    time = np.arange(0.0, 10.0, 1.0 / read_rig("rig_a").rate)
    displacement = (
        0.01 * np.exp(-0.3 * time) * np.cos(2.0 * np.pi * read_rig("rig_a").structure.frequency * time)
    )
    channels = {
        GROUND: np.zeros(time.size),
        COMMAND: displacement,
        READING: displacement + 1e-9 * np.sin(time),
    }
    released_test = MeasuredTest(file="a.csv", motion="", held_out=True, channels=channels)
    require_consistent(
        replace(read_rig("rig_a"), tests=(released_test, replace(released_test, held_out=False)))
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", RIGS)
def test_a_reversed_ground_acceleration_is_said_of_each_test(name):
    faults = require_consistent(spoil_channel(read_rig(name), GROUND, -1.0))
    assert faults == tuple(
        f"{test.file}: The ground acceleration has the opposite sign." for test in read_rig(name).tests
    )


@pytest.mark.parametrize(
    "channels", [(READING, FORCE), (COMMAND, READING), (GROUND, READING), (GROUND, COMMAND, FORCE)]
)
@pytest.mark.parametrize("factor", [-1.0, 1000.0])
def test_every_set_of_channels_shows_a_blunder_in_one_run(channels, factor):
    campaign = keep_channels(read_rig("rig_a"), *channels)
    require_consistent(campaign)
    for channel in channels:
        with pytest.raises(InputError) as refusal:
            require_consistent(spoil_channel(campaign, channel, factor, {1}))
        assert refusal.value.where == campaign.tests[1].file


def swept(frequency, *, seconds=20.0, rate=200.0, amplitude=1.0, answer=None):
    """A test of an actuator and a damper with friction, driven by a swelling sine."""
    time = np.arange(0.0, seconds, 1.0 / rate)
    command = 0.01 * amplitude * np.sin(2.0 * np.pi * frequency * time) * np.sin(np.pi * time / seconds)
    reading = command if answer is None else answer(command, rate)
    speed = np.gradient(reading, 1.0 / rate)
    force = 500.0 * speed + 40.0 * np.tanh(speed / 1e-3)
    noise = np.random.default_rng(1)
    channels = {COMMAND: command, READING: reading, FORCE: force}
    channels = {
        name: values + 1e-4 * values.std() * noise.normal(size=time.size) for name, values in channels.items()
    }
    return MeasuredTest(
        file=f"{frequency:.3g}_{amplitude:.3g}.csv", motion="", held_out=False, channels=channels
    )


def slow(time_constant, limit=np.inf):
    """An actuator with a first-order lag and a stroke."""

    def answer(command, rate):
        displacement = np.zeros_like(command)
        for k in range(1, command.size):
            displacement[k] = displacement[k - 1] + (command[k] - displacement[k - 1]) / (
                time_constant * rate
            )
        return np.clip(displacement, -limit, limit)

    return answer


@pytest.mark.slow
@given(
    frequencies=st.lists(st.floats(0.3, 20.0), min_size=2, max_size=4, unique=True),
    amplitudes=st.lists(st.floats(0.1, 3.0), min_size=4, max_size=4),
    time_constant=st.floats(0.006, 0.06),
    limit=st.sampled_from([0.004, np.inf]),
)
@settings(max_examples=25)
def test_slow_rig_with_stroke_and_friction_is_accepted(frequencies, amplitudes, time_constant, limit):
    tests = [
        swept(frequency, amplitude=amplitude, answer=slow(time_constant, limit))
        for frequency, amplitude in zip(frequencies, amplitudes, strict=False)
    ]
    campaign = Campaign(
        name="slow", structure=None, mass=1.0, actuator=None, specimen=None, rate=200.0, tests=tuple(tests)
    )
    require_consistent(campaign)


@pytest.mark.parametrize(("moves", "is_accepted"), [(0.1, True), (1.0, False)])
def test_a_test_within_a_gap_may_have_a_force_of_noise(moves, is_accepted):
    """A load cell that was lost in a test as large as the others has noise, too."""
    campaign = keep_channels(read_rig("rig_a"), READING, FORCE)
    first, *others = campaign.tests
    noise = np.random.default_rng(1).standard_normal(first.size)
    channels = {
        READING: moves * first.channels[READING],
        FORCE: 0.02 * first.channels[FORCE].std() * noise,
    }
    spoilt = replace(campaign, tests=(replace(first, channels=channels), *others))
    if is_accepted:
        require_consistent(spoilt)
    else:
        with pytest.raises(InputError, match="does not follow the measured displacement"):
            require_consistent(spoilt)


def test_a_copied_channel_is_told_beside_the_diagnosis():
    campaign = read_rig("rig_b")
    copied_test = replace(
        campaign.tests[0],
        channels={**campaign.tests[0].channels, READING: campaign.tests[0].channels[COMMAND]},
    )
    faults = require_consistent(replace(campaign, tests=(copied_test, *campaign.tests[1:])))
    (fault,) = faults
    assert fault.startswith(f"{copied_test.file}: Command and measured displacement are identical")


def test_whether_two_channels_move_together_depends_on_no_unit():
    random = np.random.default_rng(3)
    first, noise = random.normal(size=(2, 400)) + 1j * random.normal(size=(2, 400))
    band = np.arange(400) // 40
    for size, is_alike in ((0.2, True), (4.0, False)):
        for unit in (1e-6, 1.0, 1e6):
            result = _cross_spectrum(first, unit * (first + size * noise), band)
            assert (result is not None) is is_alike
            if result is not None:
                assert np.linalg.norm(result) == pytest.approx(1.0)


def test_times_at_another_rate_are_refused(tmp_path):
    time = np.arange(400) / 200.0
    table = np.column_stack([time, np.sin(9.0 * time), np.sin(9.0 * time - 0.1)])
    np.savetxt(tmp_path / "t.csv", table, delimiter=",", header="time,command_m,measured_m", comments="")
    channels, _ = read_channels(tmp_path / "t.csv", 200.0, StatedChannels())
    assert set(channels) == {Channel.COMMAND, Channel.MEASURED}
    with pytest.raises(InputError, match="200 Hz against 256 Hz"):
        read_channels(tmp_path / "t.csv", 256.0, StatedChannels())


@pytest.mark.parametrize(("test", "name"), [("", "a.h5"), ("run 2", "a.h5, run 2")])
def test_a_test_of_a_campaign_is_called_by_its_file_and_its_name_in_it(test, name):
    assert reading.TestTable(file="a.h5", test=test).name == name
