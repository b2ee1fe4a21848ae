"""Draws of what is not known, each tolerance alone, against the response to its own disturbance."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from rebuilt_error.by_transform import respond_spectrally
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    Histories,
    StandardDeviations,
    draw_unknown,
    samples_in_step,
    sweep,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.parts import divide, part_of, part_of_tracking
from reliab.assessment.rebuilt_error.readings import lag_of_reading
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.widenings import _deviation_for_half, widenings, widenings_of_draws
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0
TIME = STEP * np.arange(2048)
W0, XI, SHARE = 2.0 * np.pi * 1.5, 0.05, 0.6
STRUCTURE = Partition.from_structure(Structure(frequency=1.5, damping_ratio=XI, experimental_fraction=SHARE))
DRAWS = 128


@pytest.fixture(scope="module")
def histories():
    command = 0.02 * np.sin(2.0 * np.pi * 1.2 * TIME) * np.sin(0.4 * TIME) ** 2
    measured_displacement = 0.98 * np.interp(TIME - 0.005, TIME, command)
    return Histories(
        command=command,
        measured=measured_displacement,
        fed_back=command - measured_displacement,
        time_step=STEP,
    )


def swept(histories, stride=1, structure=STRUCTURE, offset=0.0, start_values=0.0, draws=DRAWS, **tolerances):
    unknown = StandardDeviations(
        tolerances=Tolerances(**tolerances), offset=offset, error_at_start=start_values
    )
    differences = histories.difference[::stride][np.newaxis]
    return sweep(histories, structure, unknown, differences, stride, draws=draws, seed=1).spread


def response(difference, structure=STRUCTURE):
    return respond_spectrally(structure, difference, STEP)


def disturbances(histories):
    """What one standard deviation of each tolerance adds to x_m − x_I."""
    rate = np.gradient(histories.measured, STEP)
    lasting = np.ones(TIME.size)
    return {
        "sensor_scale": (0.01, response(histories.measured) - histories.measured),
        "time_shift": (1e-3, response(rate) - rate),
        "sensor_offset": (2e-4, response(lasting) - 1.0),
        "feedback_lag": (5e-4, response(rate)),
        "filter_delay": (1e-3, response(rate) - rate),
        "sensor_drift": (1e-3, response(slope := np.linspace(-0.5, 0.5, TIME.size)) - slope),
    }


@pytest.mark.parametrize("delay", [0.005, 0.06])
def test_errors_are_relative_to_the_peak_of_the_command_less_the_error_of_the_command(histories, delay):
    """x_I = x_c − H(x_c − x_m), and x_m − x_I = H(x_c − x_m) − (x_c − x_m)."""
    command = histories.command
    measured_displacement = np.interp(TIME - delay, TIME, command)
    late = Histories(
        command=command,
        measured=measured_displacement,
        fed_back=command - measured_displacement,
        time_step=STEP,
    )
    spread = swept(late, draws=2)
    error = response(late.difference)
    deviation, ideal = error - late.difference, np.abs(command - error).max()
    assert spread.rms == pytest.approx(np.full(2, np.sqrt(mean_square(deviation)) / ideal), rel=0.005)
    assert spread.mte == pytest.approx(np.full(2, np.abs(deviation).max() / ideal), rel=0.005)


@pytest.mark.parametrize(
    "name",
    ["sensor_scale", "time_shift", "sensor_offset", "feedback_lag", "filter_delay", "sensor_drift"],
)
def test_a_linear_tolerance_moves_the_error_by_its_own_response(histories, name):
    deviation, effect = disturbances(histories)[name]
    spread = swept(histories, **{name: deviation})
    stated_values = response(histories.difference) - histories.difference
    assert spread.deviation == pytest.approx(deviation * np.abs(effect), rel=0.02, abs=1e-7)
    assert spread.mean == pytest.approx(stated_values, abs=0.02 * deviation * np.abs(effect).max() + 1e-7)


@pytest.mark.parametrize(
    ("name", "factor"),
    [("frequency", "frequency"), ("damping_ratio", "damping_ratio"), ("experimental_fraction", "share")],
)
def test_a_tolerance_of_the_structure_moves_the_error_by_its_derivative(histories, name, factor):
    by_factor = [response(histories.difference, STRUCTURE.scale(**{factor: 1.0 + d})) for d in (1e-4, -1e-4)]
    derivative = (by_factor[0] - by_factor[1]) / 2e-4
    spread = swept(histories, **{name: 0.002})
    assert spread.deviation == pytest.approx(0.002 * np.abs(derivative), rel=0.05, abs=1e-6)


def test_stated_and_estimated_offsets_add_as_variances(histories):
    _, effect = disturbances(histories)["sensor_offset"]
    spread = swept(histories, sensor_offset=3e-4, offset=4e-4)
    assert spread.deviation == pytest.approx(5e-4 * np.abs(effect), rel=0.02, abs=1e-7)


def test_an_unknown_start_is_a_free_vibration(histories):
    """Displacement and velocity over ω₀ of the error at the first sample have Student's t of four degrees."""
    decay, damped_frame = np.exp(-XI * W0 * TIME), W0 * np.sqrt(1.0 - XI**2)
    slow = decay * (np.cos(damped_frame * TIME) + XI * W0 / damped_frame * np.sin(damped_frame * TIME))
    fast = decay * np.sin(damped_frame * TIME) * W0 / damped_frame
    spread = swept(histories, start_values=1e-3)
    deviation = 1.4e-3 * np.sqrt(4.0 / (4.0 - 2.0))
    assert spread.deviation == pytest.approx(deviation * np.hypot(slow, fast), rel=0.05)


def test_unknown_quantities_are_independent(histories):
    """Variances of all unknowns together are the sum of those of each alone."""
    deviations = {"sensor_scale": 0.004, "time_shift": 4e-4, "frequency": 0.002, "damping_ratio": 0.05}
    deviations |= {"experimental_fraction": 0.005, "sensor_offset": 1e-4, "feedback_lag": 3e-4}
    separate = [swept(histories, draws=1024, **{name: value}).deviation for name, value in deviations.items()]
    separate.append(swept(histories, start_values=2e-4).deviation)
    joint = swept(histories, start_values=2e-4, draws=1024, **deviations).deviation
    assert joint == pytest.approx(np.linalg.norm(separate, axis=0), rel=0.15)
    two = swept(histories, start_values=1e-4, draws=1024, damping_ratio=0.1).deviation
    start_values = swept(histories, start_values=1e-4).deviation
    parts = [start_values, swept(histories, draws=1024, damping_ratio=0.1).deviation]
    expected = np.linalg.norm(parts, axis=0)
    assert two == pytest.approx(expected, rel=0.2, abs=0.02 * expected.max())


def test_damping_ratios_are_drawn_by_factors_with_the_tails_of_student():
    unknown = StandardDeviations(tolerances=Tolerances(damping_ratio=0.15), offset=0.0, error_at_start=0.0)
    factors = 1.0 + draw_unknown(unknown, 4096, 0)[0]["damping_ratio"]
    expected = np.exp(0.15 * scipy.stats.t.ppf([0.05, 0.5, 0.95], 4))
    assert np.quantile(factors, [0.05, 0.5, 0.95]) == pytest.approx(expected, rel=0.01)


def test_parts_of_no_error_have_no_share(histories):
    perfect = replace(histories, measured=histories.command, fed_back=np.zeros(TIME.size))
    for part in divide(perfect, STRUCTURE).by_name.values():
        assert np.abs(part.history).max() < 1e-12
    nothing = part_of(np.zeros(5), np.zeros(5), 1.0)
    assert (nothing.share, nothing.rms, nothing.remaining_mte) == (0.0, 0.0, 0.0)


def test_structure_at_rest_under_an_offset_stays_there():
    """x_c − x_m = 2 mm for ever: the error is 2 mm times the specimen's share, and nothing vibrates."""
    command = 0.01 * np.sin(2.0 * np.pi * TIME) * (TIME > 4.0)
    still = Histories(
        command=command,
        measured=command - 2e-3,
        fed_back=np.full(TIME.size, 2e-3),
        time_step=STEP,
        standing=2e-3,
    )
    spread = swept(still)
    assert spread.mean == pytest.approx(np.full(TIME.size, (SHARE - 1.0) * 2e-3))
    assert spread.deviation == pytest.approx(np.zeros(TIME.size), abs=1e-9)
    # a structure of another frequency stands elsewhere under the same force, where its share is as stated
    loose = swept(still, frequency=0.01)
    assert loose.deviation[:10] == pytest.approx(np.zeros(10), abs=1e-6)


@pytest.mark.parametrize("stride", [1, 3, 8])
def test_motion_between_swept_samples_counts(histories, stride):
    error = response(histories.difference) - histories.difference
    ideal = np.abs(histories.command - error - histories.difference).max()
    spread = swept(histories, stride)
    assert spread.rms == pytest.approx(np.full(DRAWS, np.sqrt(mean_square(error)) / ideal), rel=1e-4)
    assert spread.mte == pytest.approx(np.full(DRAWS, np.abs(error).max() / ideal), rel=1e-3)
    assert spread.mean[: 1 - stride or None : stride] == pytest.approx(
        error[: 1 - stride or None : stride], abs=0.02 * np.abs(error).max()
    )
    assert spread.mean.size == TIME.size


def test_a_step_of_the_sweep_resolves_structure_and_motion():
    """64 samples in a period of the structure; a quarter of the motion's period for up to 4096 samples."""
    stiff = Partition.from_structure(Structure(frequency=0.5, damping_ratio=0.05))
    noise = SensorNoise(time_step=1.0 / 1024.0, weights=np.zeros(6), band=32.0)
    of_structure = samples_in_step_of_structure(stiff, noise.time_step)
    assert samples_in_step(of_structure, noise, 20_000) == 8
    assert samples_in_step(of_structure, replace(noise, band=128.0), 4096) == 2
    assert samples_in_step(of_structure, replace(noise, band=128.0), 4096 * 5 + 1) == 6
    assert samples_in_step(of_structure, replace(noise, band=2.0), 100) == 32
    assert samples_in_step(of_structure, replace(noise, band=400.0), 100) == 1


def widest(histories, unknown, differences, draws):
    """What widens the interval of RMS^R."""
    every_one, noisy = (
        sweep(histories, STRUCTURE, single, differences, 1, draws=draws, seed=3)
        for single in (unknown, EXACT)
    )
    return widenings(every_one.spread, every_one.drawn, unknown.deviations(), noisy.spread, Metric.RMS)


def test_tolerances_of_equal_effect_widen_equally_and_half_of_one_halves(histories):
    unknown = StandardDeviations(tolerances=Tolerances(sensor_scale=0.02), offset=0.0, error_at_start=0.0)
    differences = np.stack([0.999 * histories.difference, 1.001 * histories.difference])
    first, *rivals = widest(histories, unknown, differences, DRAWS)
    assert (first.name, first.deviation) == ("sensor_scale", 0.02)

    def interval(unknown):
        return sweep(histories, STRUCTURE, unknown, differences, 1, draws=DRAWS, seed=3).spread.interval(
            Metric.RMS
        )

    full_test = interval(unknown)
    assert first.width == pytest.approx(full_test[1] - full_test[0])
    exact = StandardDeviations(tolerances=Tolerances(), offset=0.0, error_at_start=0.0)
    remainder = interval(exact)
    assert first.width_without == pytest.approx(remainder[1] - remainder[0], abs=0.07 * first.width)
    halved = replace(unknown, tolerances=Tolerances(sensor_scale=first.deviation_for_half))
    half = interval(halved)
    assert (half[1] - half[0]) / first.width == pytest.approx(0.5, abs=0.03)
    for second in rivals:
        assert second.name == "sensor_noise"
        assert second.deviation == 0.0
        assert first.width_without < second.width_without
        assert first.contribution > second.contribution


def test_half_the_width_is_found_by_halving():
    """Where the width is the deviation's square, half of it is at √½ of the deviation, to 1/4096 below."""
    result = _deviation_for_half(5.0, 0.5, lambda factor: factor**2)
    assert np.sqrt(0.5) - 1.0 / 4096.0 <= result / 5.0 <= np.sqrt(0.5)
    assert _deviation_for_half(5.0, -1.0, lambda factor: factor**2) is None


@pytest.mark.slow
def test_a_contribution_is_that_of_the_quantity_alone(histories):
    """Against the error with each value of the quantity, computed one by one."""
    unknown = StandardDeviations(
        tolerances=Tolerances(sensor_scale=0.004, time_shift=2e-4, hysteresis=0.002),
        offset=0.0,
        error_at_start=0.0,
    )
    still = histories.difference[np.newaxis]
    shares = widest(histories, unknown, still, 128)
    parts = {share.name: share for share in shares}
    lag = -lag_of_reading(histories.command, 0.0016)
    columns = {
        "sensor_scale": histories.measured,
        "time_shift": np.gradient(histories.measured, STEP),
        "hysteresis": lag,
    }
    for name, column in columns.items():
        sizes = []
        for place in scipy.special.ndtri((np.arange(200) + 0.5) / 200.0):
            difference = histories.difference + place * unknown.deviations()[name] * column
            error = response(difference)
            ideal = np.abs(histories.command - error).max()
            sizes.append(np.sqrt(mean_square(error - difference)) / ideal)
        assert parts[name].contribution == pytest.approx(np.std(sizes), rel=0.15)


def test_a_part_over_time_keeps_its_mean_square(histories):
    parts = divide(histories, STRUCTURE)
    for name, part in parts.by_name.items():
        square = np.mean(part.history**2)
        stretches = parts.rms_over_time(STEP, 2.0)[name]
        assert stretches.size == 4
        assert np.mean(stretches**2) == pytest.approx(square)
    uneven = parts.rms_over_time(STEP, 3.0)["delay"]
    history = parts.by_name["delay"].history
    assert uneven == pytest.approx([np.sqrt(np.mean(h**2)) for h in np.split(history, [768, 1536])])


def test_parts_are_gain_delay_and_rest_of_least_squares(histories):
    parts = divide(histories, STRUCTURE)
    rate = np.gradient(histories.command, STEP)
    basis = np.stack([histories.command, -rate, np.ones(TIME.size)])
    gain, delay, _ = np.linalg.lstsq(basis.T, histories.measured, rcond=None)[0]
    assert (parts.gain, parts.delay) == pytest.approx((gain, delay))
    error = response(histories.difference) - histories.difference
    ideal = np.abs(histories.measured - error).max()
    for name, wrong in (("amplitude", (1.0 - gain) * histories.command), ("delay", delay * rate)):
        piece, part = response(wrong) - wrong, parts.by_name[name]
        assert part.history == pytest.approx(piece, abs=1e-6)
        assert part.rms == pytest.approx(np.sqrt(mean_square(piece)) / ideal, rel=1e-3)
        assert part.share == pytest.approx(piece @ error / (error @ error), rel=1e-3)
        remainder = error - piece
        assert part.remaining_rms == pytest.approx(np.sqrt(mean_square(remainder)) / ideal, rel=1e-3)
        assert part.remaining_mte == pytest.approx(np.abs(remainder).max() / ideal, rel=1e-3)


def test_exactly_described_actuator_accounts_for_the_whole_error(histories):
    part = part_of_tracking(histories, STRUCTURE, histories.measured)
    assert part.share == pytest.approx(1.0)
    assert part.remaining_rms == pytest.approx(0.0, abs=1e-12)
    half = part_of_tracking(histories, STRUCTURE, 0.5 * (histories.measured + histories.command))
    assert half.share == pytest.approx(0.5)
    assert half.rms == pytest.approx(0.5 * part.rms)
    ideal = np.abs(histories.measured - part.history).max()
    assert half.remaining_mte == pytest.approx(0.5 * np.abs(part.history).max() / ideal)


def test_joint_effects_of_two_sensors_are_no_effect_of_others():
    """A rotation feels the difference of two skews, whose squares hold their product."""
    names = ("time_shift_1", "time_shift_2", "damping_ratio")
    draws = dict(zip(names, normal_points(3, 256, seed=1), strict=True))
    first, second, ratio = draws.values()
    errors = np.sqrt(4.0 + (first - second) ** 2 + 0.2 * ratio)
    spread = Spread(rms=errors, mte=errors, mean=np.zeros(1), deviation=np.zeros(1))
    sizes = {
        single.name: single
        for single in widenings_of_draws(spread, draws, dict.fromkeys(names, 1.0), Metric.RMS)
    }
    assert sizes["damping_ratio"].contribution == pytest.approx(0.05, rel=0.02)
    assert sizes["time_shift_1"].width_without < 0.8 * sizes["time_shift_1"].width
