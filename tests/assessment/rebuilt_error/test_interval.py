"""What is uncertain: noise, tolerances, offsets, beginnings."""

import numpy as np
import pytest

from rebuilt_error.laboratory import BACKLASH, BIAS, DELAY, RATE, Lab, noise, quantise, run, synthetic_ground
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.parts import parts_of
from reliab.assessment.rebuild import rebuild
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.signals.noise import converter_step
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
LAB = Lab(1.0, 0.03, 1.0, DELAY, (0.997, 0.0012, 0.0, 0.0))
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.03)


@pytest.fixture(scope="module")
def outcome():
    return run(LAB, synthetic_ground(4, 20.0))


@pytest.fixture(scope="module")
def noisy(outcome):
    rng = np.random.default_rng(0)
    level = 0.01 * np.sqrt(np.mean(outcome.measured**2))
    return outcome.measured + noise("white", outcome.measured.size, level, rng)


def test_white_noise_moves_the_error_by_less_than_two_per_cent(outcome, noisy):
    rebuilt = rebuild(outcome.command, noisy, STEP, STRUCTURE)
    assert rebuilt.rms.value == pytest.approx(outcome.rms, rel=0.02)
    assert rebuilt.rms.low < outcome.rms < rebuilt.rms.high
    assert rebuilt.mte.low < outcome.mte < rebuilt.mte.high
    assert rebuilt.readings.noises[0].white == pytest.approx(
        0.01 * np.sqrt(np.mean(outcome.measured**2)), rel=0.05
    )


def test_a_wrong_frequency_is_covered_by_its_tolerance(outcome):
    wrong = Structure(frequency=1.012, damping_ratio=0.03)
    exact = rebuild(outcome.command, outcome.measured, STEP, wrong)
    assert not exact.rms.low <= outcome.rms <= exact.rms.high
    loose = rebuild(
        outcome.command, outcome.measured, STEP, wrong, known=PriorKnowledge(tolerances={"frequency": 0.01})
    )
    assert loose.rms.low <= outcome.rms <= loose.rms.high


def test_the_band_holds_the_history(outcome, noisy):
    tolerances = PriorKnowledge(tolerances={"frequency": 0.005, "damping_ratio": 0.05, "sensor_scale": 0.002})
    rebuilt = rebuild(outcome.command, noisy, STEP, STRUCTURE, known=tolerances)
    true = outcome.measured - outcome.ideal
    is_inside = (rebuilt.displacements[0].low <= true) & (true <= rebuilt.displacements[0].high)
    assert is_inside.mean() > 0.85
    assert np.mean(rebuilt.displacements[0].high - rebuilt.displacements[0].low) < 4.0 * np.abs(true).max()


@pytest.mark.usefixtures("all_draws")
def test_probability_is_capped_by_the_draws_and_falls_with_the_threshold(outcome):
    rebuilt = rebuild(
        outcome.command,
        outcome.measured,
        STEP,
        STRUCTURE,
        known=PriorKnowledge(tolerances={"frequency": 0.01}),
    )
    assert rebuilt.probability(1.0) == pytest.approx(256.5 / 257.0)
    assert rebuilt.probability(1e-6) == pytest.approx(0.5 / 257.0)
    assert rebuilt.probability(rebuilt.mte.low, Metric.MTE) == pytest.approx(0.05, abs=0.01)
    assert rebuilt.probability(rebuilt.mte.high, Metric.MTE) == pytest.approx(0.95, abs=0.01)


def test_the_widest_tolerance_is_named_and_half_of_the_width_is_reached(outcome):
    tolerances = PriorKnowledge(tolerances={"damping_ratio": 0.15, "frequency": 0.001})
    rebuilt = rebuild(outcome.command, outcome.measured, STEP, STRUCTURE, known=tolerances)
    widest = rebuilt.budget(Metric.RMS)[0]
    assert widest.name == "damping_ratio"
    assert widest.width_without < 0.5 * widest.width
    assert 0.0 < widest.deviation_for_half < 0.15
    halved = rebuild(
        *(outcome.command, outcome.measured, STEP, STRUCTURE),
        known=PriorKnowledge(tolerances={"damping_ratio": widest.deviation_for_half, "frequency": 0.001}),
    )
    full_test, half = (single.rms.high - single.rms.low for single in (rebuilt, halved))
    assert half / full_test == pytest.approx(0.5, abs=0.1)


def test_a_sensor_offset_at_rest_is_taken_away(outcome):
    command = np.concatenate([np.zeros(1024), outcome.command])
    measured_displacement = np.concatenate([np.zeros(1024), outcome.measured]) + 0.02
    rebuilt = rebuild(command, measured_displacement, STEP, STRUCTURE)
    assert rebuilt.readings.starts[0].offset == pytest.approx(0.02, rel=1e-4)
    plain = rebuild(command, measured_displacement - 0.02, STEP, STRUCTURE)
    assert rebuilt.rms.value == pytest.approx(plain.rms.value, rel=1e-3)
    kept_part = rebuild(command, measured_displacement, STEP, STRUCTURE, sensor_offset=0.0)
    assert kept_part.rms.value > 1.5 * plain.rms.value


@pytest.mark.parametrize(("alpha", "stride"), [(1.0, 2), (0.5, 8)])
def test_offset_in_the_loop_is_part_of_the_error(alpha, stride):
    bias = 0.01 * np.abs(run(Lab(1.0, 0.03, alpha), synthetic_ground(7, 20.0)).ideal).max()
    felt_displacement = run(Lab(1.0, 0.03, alpha, BIAS, (0.998, bias, 0.0, 0.0)), synthetic_ground(7, 20.0))
    structure = Structure(frequency=1.0, damping_ratio=0.03, experimental_fraction=alpha)
    level = 0.01 * np.sqrt(np.mean(felt_displacement.measured**2))
    read = (
        felt_displacement.measured
        + noise("white", felt_displacement.measured.size, level, np.random.default_rng(1))
    )[::stride]
    rebuilt = rebuild(felt_displacement.command[::stride], read, stride * STEP, structure)
    assert rebuilt.readings.starts[0].offset == 0.0
    assert rebuilt.rms.value == pytest.approx(felt_displacement.rms, rel=0.05)
    # the same offset of a reading that the loop did not feel
    unfelt = run(Lab(1.0, 0.03, alpha, BIAS, (0.998, 0.0, 0.0, 0.0)), synthetic_ground(7, 20.0))
    shift = rebuild(unfelt.command[::stride], unfelt.measured[::stride] + bias, stride * STEP, structure)
    assert shift.readings.starts[0].offset == pytest.approx(bias, rel=0.05)
    assert shift.rms.value == pytest.approx(unfelt.rms, rel=0.05)


def test_beginning_in_motion_is_reported(outcome):
    begin = int(np.argmax(np.abs(outcome.command)))
    rebuilt = rebuild(outcome.command[begin:], outcome.measured[begin:], STEP, STRUCTURE)
    error = (outcome.measured - outcome.ideal)[begin:]
    true = np.sqrt(np.mean(error**2)) / np.abs(outcome.ideal[begin:]).max()
    assert not rebuilt.readings.starts[0].at_rest
    assert rebuilt.rms.low < true < rebuilt.rms.high
    assert "initial_state" in {single.name for single in rebuilt.budget(Metric.RMS)}


@pytest.mark.slow
def test_error_grown_before_the_record_is_held():
    """A late actuator makes the command larger than the exact response: its error is no chance direction."""
    coverage, tests = 0, 16
    for seed in range(tests):
        frequency = 0.6 + 0.08 * seed
        late = Lab(frequency, 0.035, 1.0, DELAY, (1.0, 0.6 * 0.035 / (np.pi * frequency), 0.0, 0.0))
        test = run(late, synthetic_ground(seed, 30.0), parts=1)
        command, measured_displacement, ideal = (
            values[int(0.45 * values.size) :: 8] for values in (test.command, test.measured, test.ideal)
        )
        structure = Structure(frequency=frequency, damping_ratio=0.035)
        rms = rebuild(command, measured_displacement, 8 * STEP, structure).rms
        coverage += (
            rms.low < np.sqrt(np.mean((measured_displacement - ideal) ** 2)) / np.abs(ideal).max() < rms.high
        )
    assert coverage >= 0.8 * tests


def test_actuator_like_slow_noise_keeps_its_peak():
    assembly = Lab(1.0, 0.03, 1.0, BACKLASH, (0.002, 0.0, 0.0, 0.0))
    play_output = run(assembly, synthetic_ground(5, 20.0))
    level = 0.01 * np.sqrt(np.mean(play_output.measured**2))
    read = play_output.measured + noise("white", play_output.measured.size, level, np.random.default_rng(2))
    rebuilt = rebuild(play_output.command, read, STEP, STRUCTURE)
    assert rebuilt.mte.low < play_output.mte < rebuilt.mte.high
    assert rebuilt.mte.value == pytest.approx(play_output.mte, rel=0.05)


def test_parts_add_up_and_name_the_fault(outcome):
    rebuilt = rebuild(outcome.command, outcome.measured, STEP, STRUCTURE)
    parts = rebuilt.division.parts()
    gain, delay = (value.item() for value in rebuilt.readings.tracking)
    assert gain == pytest.approx(0.997, abs=1e-4)
    assert delay == pytest.approx(0.0012, rel=0.01)
    assert sum(part.share for part in parts.by_name.values()) == pytest.approx(1.0)
    assert parts.first == "delay"
    better = run(Lab(1.0, 0.03, 1.0, DELAY, (0.997, 1e-9, 0.0, 0.0)), outcome.ground)
    assert parts.by_name["delay"].remaining_rms == pytest.approx(better.rms, rel=0.1)


def test_noise_is_no_part_to_improve(outcome):
    """A sensor with noise of 10 % of the motion, and an error of 2 % of its peak."""
    noise = (
        0.1
        * np.sqrt(np.mean(outcome.measured**2))
        * np.random.default_rng(8).standard_normal(outcome.measured.size)
    )
    quiet, noisy = (
        rebuild(outcome.command, measured_displacement, STEP, STRUCTURE).division.parts()
        for measured_displacement in (outcome.measured, outcome.measured + noise)
    )
    assert noisy.rms < 1.3 * quiet.rms
    freed = noisy.subtract_noise(quiet.rms)
    assert noisy.first == freed.first == quiet.first == "delay"


def test_cancelling_parts_leave_nothing_to_improve_first():
    """Two parts of opposite sign, each larger than their sum."""
    displacement = np.sin(0.1 * np.arange(500.0))
    parts = parts_of({"amplitude": 3.0 * displacement, "delay": -2.5 * displacement}, 1.0)
    assert parts.first is None


def test_a_late_force_is_a_part_of_its_own():
    late = run(
        Lab(1.0, 0.03, 1.0, DELAY, (1.0, 3e-4, 0.0, 0.0), feedback_lag=0.001), synthetic_ground(4, 15.0)
    )
    rebuilt = rebuild(late.command, late.measured, STEP, STRUCTURE, feedback_lag=0.001)
    parts = rebuilt.division.parts()
    assert parts.first == "fed_back_force"
    full_test = np.sum([part.history for part in parts.by_name.values()], axis=0)
    inside = slice(0, -int(0.5 / STEP))  # the motion goes on after the record
    assert (
        np.abs(full_test - rebuilt.displacements[0].smooth_error)[inside].max()
        < 0.025 * np.abs(full_test).max()
    )


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"measured_displacement": np.zeros(10)}, "the same length"),
        ({"command": np.full(20480, np.nan)}, "finite"),
        ({"command": np.zeros(20480)}, "must move"),
        ({"time_step": -1.0}, "time step must be"),
        ({"time_step": 0.2}, "at least 10 samples"),
        ({"feedback_lag": -1e-3}, "not negative"),
    ],
)
def test_bad_input_is_refused(outcome, change, rule):
    arguments = {
        "command": outcome.command,
        "measured_displacement": outcome.measured,
        "time_step": STEP,
        "structure": STRUCTURE,
    }
    with pytest.raises(InputError, match=rule):
        rebuild(**(arguments | change))


@pytest.mark.parametrize(
    ("value", "rule"), [(0.5, "below 0.333"), (-0.1, "0 or positive"), (np.nan, "found nan")]
)
def test_bad_tolerances_are_refused(outcome, value, rule):
    known = PriorKnowledge(tolerances={"frequency": value})
    with pytest.raises(InputError, match=rule):
        rebuild(outcome.command, outcome.measured, STEP, STRUCTURE, known=known)


def test_an_offset_from_before_the_record_starts_no_transient():
    bias = 0.01 * np.abs(run(Lab(1.0, 0.03), synthetic_ground(7, 20.0)).ideal).max()
    quiet = np.concatenate([np.zeros(int(60.0 * RATE)), synthetic_ground(7, 20.0)])
    felt_displacement = run(Lab(1.0, 0.03, 1.0, BIAS, (0.998, bias, 0.0, 0.0)), quiet)
    begin = int(58.0 * RATE)
    command, measured_displacement = felt_displacement.command[begin:], felt_displacement.measured[begin:]
    rebuilt = rebuild(command, measured_displacement, STEP, STRUCTURE)
    error, ideal = (
        (felt_displacement.measured - felt_displacement.ideal)[begin:],
        felt_displacement.ideal[begin:],
    )
    assert rebuilt.readings.starts[0].standing == pytest.approx(bias, rel=0.05)
    assert rebuilt.rms.value == pytest.approx(np.sqrt(np.mean(error**2)) / np.abs(ideal).max(), rel=0.02)
    inside = slice(0, -int(1.0 / STEP))  # the motion goes on after the record
    assert np.abs(rebuilt.displacements[0].error - error)[inside].max() < 0.025 * np.abs(error).max()
    parts = rebuilt.division.parts()
    full_test = np.sum([part.history for part in parts.by_name.values()], axis=0)
    assert (
        np.abs(full_test - rebuilt.displacements[0].smooth_error)[inside].max()
        < 0.025 * np.abs(full_test).max()
    )


@pytest.mark.parametrize("kind", ["white", "quantised"])
def test_a_nearly_perfect_actuator_is_not_overstated(kind):
    assembly = Lab(1.0, 0.03, 1.0, DELAY, (0.9999, 5e-5, 0.0, 0.0))
    near = run(assembly, synthetic_ground(9, 20.0))
    level = 0.01 * np.sqrt(np.mean(near.measured**2))
    generator = np.random.default_rng(3)
    read = (
        quantise(near.measured, level, generator)
        if kind == "quantised"
        else near.measured + noise(kind, near.measured.size, level, generator)
    )
    rebuilt = rebuild(near.command, read, STEP, STRUCTURE)
    assert near.rms < 0.004
    assert near.rms < rebuilt.rms.high < 3.0 * near.rms
    assert near.mte < rebuilt.mte.high


def test_rounding_is_told_from_white_noise():
    motion = np.sin(np.arange(0.0, 40.0, 0.01))
    assert converter_step(quantise(motion, 0.01, np.random.default_rng(1))) == pytest.approx(
        np.sqrt(12.0) * 0.01
    )
    assert converter_step(motion + noise("white", motion.size, 0.01, np.random.default_rng(1))) == 0.0
