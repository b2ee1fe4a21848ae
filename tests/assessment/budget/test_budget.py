"""What is not known of a test: its size and source, and what it contributes."""

from dataclasses import replace

import numpy as np
import pytest
from coupled_structures import described, two_storeys

from reliab.app.api.arguments import require_sound
from reliab.assessment.assess import assess
from reliab.assessment.budget.corrections import correct_recording
from reliab.assessment.budget.sizes import (
    PriorSource,
    exact_equipment,
    ordinary_equipment,
    read_equipment,
)
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.quantities import QUANTITIES
from reliab.assessment.inference.uncertain_quantity import Circumstances, Prior, Shape
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.channels_file import read_channels_file
from reliab.recordings.recording import Recording
from reliab.signals.filters import LowPass
from reliab.structures.partition import whole_structure
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.03)


def priors(stated, equipment, *, structure=ONE_HERTZ):
    """Priors of everything that is uncertain about a test that begins at rest, at 1024 Hz."""
    partition, step = whole_structure(structure), 1.0 / 1024.0
    times = step * np.arange(4096)
    command = (np.sin(2.0 * np.pi * times) * np.sin(np.pi * times / times[-1]) ** 2)[np.newaxis]
    channels = ChannelSpectra.from_channels(command, 0.99 * command, step, partition)
    channels = replace(channels, initial_size=0.0, offset_size=np.zeros(1), drift_size=np.zeros(1))
    circumstances = Circumstances(partition=partition, channels=channels, stated=stated, equipment=equipment)
    found = {quantity.name: quantity.prior(circumstances) for quantity in QUANTITIES}
    return {name: prior for name, prior in found.items() if prior is not None}


@pytest.fixture(scope="module")
def recording(ground_motions, simulate_rig):
    motion = ground_motions[3]
    test = simulate_rig(motion.acceleration, motion.time_step, seconds=30.0, delay=0.001, xi=0.03, db=45.0)
    return Recording(command=test.command, measured=test.measured, time_step=1.0 / 256.0)


@pytest.fixture(scope="module")
def assessment(recording):
    return assess(recording, ONE_HERTZ, equipment=ordinary_equipment())


def test_unstated_quantities_have_the_size_of_ordinary_equipment():
    stated_values = {"f": StatedValue(1.0, 0.002), "xi": StatedValue(0.03), "skew": StatedValue(0.1, 0.05)}
    found = priors(stated_values, ordinary_equipment())
    assert {name: prior.source for name, prior in found.items()} == {
        "frequency": PriorSource.STATED,
        "time_shift": PriorSource.STATED,
        **dict.fromkeys(
            ("damping_ratio", "sensor_scale", "feedback_lag", "filter_delay", "hysteresis"),
            PriorSource.DEFAULT,
        ),
    }
    deviations = {name: prior.deviation for name, prior in found.items()}
    assert (deviations["frequency"], deviations["time_shift"]) == (0.002, pytest.approx(5e-5))
    assert deviations["damping_ratio"] == ordinary_equipment().xi


def test_only_stated_deviations_are_unknown_without_equipment():
    found = priors({"xi": StatedValue(0.03, 0.003)}, exact_equipment())
    assert list(found) == ["damping_ratio"]
    assert found["damping_ratio"].deviation == pytest.approx(0.1)


def test_a_share_below_one_is_not_known_exactly():
    half = Structure(frequency=1.0, damping_ratio=0.03, experimental_fraction=0.5)
    assert "experimental_fraction" in priors({}, ordinary_equipment(), structure=half)


@pytest.mark.parametrize("rate", [100.0, 4096.0])
def test_a_skew_grows_with_the_sampling_period_unless_a_laboratory_knows_better(rate):
    equipment = ordinary_equipment()
    assert equipment.skew(1.0 / rate) == pytest.approx(equipment.skew_samples / rate)
    assert replace(equipment, skew_ms=0.05).skew(1.0 / rate) == pytest.approx(5e-5)


def test_what_is_known_of_all_actuators_holds_for_each():
    partition, _ = described(two_storeys)
    command = np.sin(0.02 * np.arange(2048)) * np.ones((2, 1))
    channels = ChannelSpectra.from_channels(command, 0.99 * command, 0.005, partition)
    filter_delay = next(quantity for quantity in QUANTITIES if quantity.name == "filter_delay")

    def deviations(**known):
        tests = (Circumstances(partition=partition, channels=channels, actuator=k, **known) for k in (0, 1))
        return [filter_delay.prior(test).deviation for test in tests]

    known = {"filter_delay": 0.001, "filter_delay_2": 0.002}
    assert deviations(tolerances=known) == [0.001, 0.002]
    assert deviations(left_by_faults=known) == [0.001, 0.002]
    stated = {"filter_delay": StatedValue(0.0, 3.0)}
    assert deviations(stated=stated, left_by_faults={"filter_delay": 0.004}) == pytest.approx([0.005, 0.005])


def test_a_laboratory_overrides_what_it_knows_better(tmp_path):
    file = tmp_path / "laboratory.toml"
    file.write_text("xi = 0.05\nscale = 0.001\n", encoding="utf-8")
    own_value = read_equipment(file)
    assert (own_value.xi, own_value.scale, own_value.f) == (0.05, 0.001, ordinary_equipment().f)


@pytest.mark.parametrize("text", ["zeta = 0.1", "xi = -0.1", 'xi = "small"', "xi = true"])
def test_a_file_of_other_names_or_numbers_is_refused(tmp_path, text):
    file = tmp_path / "laboratory.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"not negative|0 or positive"):
        read_equipment(file)


def test_verdict_carries_unknowns_of_its_laboratory(recording, assessment):
    exact = assess(recording, ONE_HERTZ)
    wide, narrow = (result.error.rebuilt.rms for result in (assessment, exact))
    assert wide.value == pytest.approx(narrow.value, rel=0.1)
    assert wide.high - wide.low > 5.0 * (narrow.high - narrow.low)
    assert exact.probability > 0.99
    assert assessment.probability <= 0.99


def test_the_budget_names_sizes_sources_and_remedies_largest_first(assessment):
    budget = assessment.to_dict()["budget"]
    contributions = [item["contribution"] for item in budget]
    assert contributions == sorted(contributions, reverse=True)
    parts = {item["name"]: item for item in budget}
    assert parts["damping_ratio"]["size"] == pytest.approx(100.0 * ordinary_equipment().xi, rel=0.1)
    assert (parts["time_shift"]["unit"], parts["time_shift"]["source"]) == ("ms", "default")
    assert parts["sensor_noise"]["source"] == "learned from this test"
    assert all(item["remedy"].endswith(".") for item in budget)


def test_contributions_add_up_to_the_interval(assessment):
    """Independent contributions add in squares, as far as the error is linear in them."""
    errors = assessment.error.displacements[0].draws.rms
    full_test = np.sqrt(sum(item.contribution**2 for item in assessment.error.budget))
    assert full_test == pytest.approx(np.std(errors), rel=0.3)


@pytest.mark.parametrize(("of_sensor", "expected"), [(None, 0.002), (StatedValue(1.0, 0.0015), 0.0025)])
@pytest.mark.parametrize("equipment", [exact_equipment(), ordinary_equipment()])
def test_both_stated_scales_make_one_deviation(of_sensor, expected, equipment):
    stated_values = {"command_scale": StatedValue(2.0, 0.004)} | (
        {} if of_sensor is None else {"scale": of_sensor}
    )
    prior = priors(stated_values, equipment)["sensor_scale"]
    assert prior.deviation == pytest.approx(expected)
    assert prior.source is PriorSource.STATED


def test_a_calibration_that_found_no_hysteresis_replaces_the_default(tmp_path):
    file = tmp_path / "channels.toml"
    file.write_text("[calibration]\nhysteresis = 0\nhysteresis_sd = 1e-4\n", encoding="utf-8")
    stated_values = read_channels_file(file).test_values
    require_sound(stated_values)
    expected = Prior(deviation=1e-4, source=PriorSource.STATED, shape=Shape.POSITIVE)
    assert priors(stated_values, ordinary_equipment())["hysteresis"] == expected


def test_a_slow_recording_whose_skew_was_not_stated_says_what_is_assumed():
    equipment = ordinary_equipment()
    assert equipment.doubt_of_skew(1.0 / 1000.0) == ""
    assert "the 512 Hz" in equipment.doubt_of_skew(1.0 / 512.0)
    assert "the 256 Hz" in equipment.doubt_of_skew(1.0 / 256.0)
    assert "±1.2 ms is assumed" in equipment.doubt_of_skew(1.0 / 256.0)
    assert replace(equipment, skew_ms=0.1).doubt_of_skew(1.0 / 256.0) == ""


def test_force_and_ground_motion_pass_the_stated_filter_of_the_displacement(recording):
    """Else the force of a spring leads the displacement, and its specimen is another one."""
    low_pass = LowPass(corner=20.0)
    smooth_values = low_pass.apply(recording.measured, recording.time_step)
    full_test = replace(
        recording, measured=smooth_values, force=3e5 * recording.measured, ground=recording.command
    )
    second = correct_recording(full_test, {}, {"measured": low_pass})
    np.testing.assert_allclose(second.force, 3e5 * second.measured, atol=1e-9 * np.abs(second.force).max())
    np.testing.assert_array_equal(second.ground, second.command)
