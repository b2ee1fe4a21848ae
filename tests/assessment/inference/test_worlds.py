"""The error in possible worlds, each quantity alone, against the response to its own disturbance."""

import numpy as np
import pytest
from rebuilt_error.by_transform import respond_spectrally

from reliab.assessment.inference.channel_spectra import ChannelSpectra, rounding_noise
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.rebuilt import LinearTest
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0
TIME = STEP * np.arange(2048)
STRUCTURE = Partition.from_structure(Structure(frequency=1.5, damping_ratio=0.05, experimental_fraction=0.6))
COMMAND = 0.02 * np.sin(2.0 * np.pi * 1.2 * TIME) * np.sin(0.4 * TIME) ** 2
MEASURED = 0.98 * np.interp(TIME - 0.005, TIME, COMMAND)
INSIDE = slice(64, int(0.98 * TIME.size))  # the band of the analysis begins and ends within some samples


def error_in_world(**values):
    channels = ChannelSpectra.from_channels(COMMAND[np.newaxis], MEASURED[np.newaxis], STEP, STRUCTURE)
    test, world = LinearTest(channels=channels, partition=STRUCTURE), Experiment.as_stated(actuators=1)
    for name, value in values.items():
        setattr(world, name, np.array([value]) if np.ndim(getattr(world, name)) else value)
    return test.on_record(test.solve(world))[0, 0]


def response(difference, structure=STRUCTURE):
    return respond_spectrally(structure, difference, STEP)


def disturbances():
    """What each quantity adds to x_m − x_I."""
    rate, lasting, rise = np.gradient(MEASURED, STEP), np.ones(TIME.size), np.linspace(-0.5, 0.5, TIME.size)
    return {
        "scale": (1.01, 0.01, response(MEASURED) - MEASURED),
        "skew": (-1e-3, 1e-3, response(rate) - rate),
        "offset": (2e-4, 2e-4, response(lasting) - lasting),
        "drift": (1e-3, 1e-3, response(rise) - rise),
        "feedback_lag": (5e-4, 5e-4, response(rate)),
    }


@pytest.mark.parametrize("name", ["scale", "skew", "offset", "drift", "feedback_lag"])
def test_a_quantity_of_the_channels_moves_the_error_by_its_own_response(name):
    value, size, effect = disturbances()[name]
    change = error_in_world(**{name: value}) - error_in_world()
    assert change[INSIDE] == pytest.approx((size * effect)[INSIDE], abs=0.03 * size * np.abs(effect).max())


@pytest.mark.parametrize("name", ["frequency", "damping_ratio", "share"])
def test_a_quantity_of_the_structure_moves_the_error_by_its_derivative(name):
    difference = COMMAND - MEASURED
    by_factor = [response(difference, STRUCTURE.scale(**{name: 1.0 + d})) for d in (1e-4, -1e-4)]
    derivative = (by_factor[0] - by_factor[1]) / 2e-4
    change = error_in_world(**{name: 1.002}) - error_in_world()
    assert change[INSIDE] == pytest.approx(0.002 * derivative[INSIDE], abs=1e-4 * np.abs(derivative).max())


def test_an_error_at_the_first_sample_is_a_free_vibration():
    omega, ratio = 2.0 * np.pi * 1.5, 0.05
    decay, damped = np.exp(-ratio * omega * TIME), omega * np.sqrt(1.0 - ratio**2)
    slow = decay * (np.cos(damped * TIME) + ratio * omega / damped * np.sin(damped * TIME))
    fast = decay * np.sin(damped * TIME) * omega / damped
    world = {"initial_displacement": 1e-3, "initial_velocity": 2e-3}
    change, later = error_in_world(**world) - error_in_world(), slice(64, INSIDE.stop)
    assert change[later] == pytest.approx((1e-3 * slow + 2e-3 * fast)[later], abs=4e-5)


@pytest.mark.parametrize("step", [2e-5, 5e-4, 2e-3])
def test_rounding_is_noise_of_its_strength_within_the_band(step):
    """A white noise of this variance is about as strong below the highest frequency of the motion."""
    time = np.arange(0.0, 40.0, 1.0 / 1024.0)
    motion = 0.02 * np.sin(2.0 * np.pi * time) * np.sin(0.2 * time)
    read = step * np.round(motion / step)
    power = np.abs(np.fft.rfft(read - motion)) ** 2 / time.size
    is_inside = np.fft.rfftfreq(time.size, 1.0 / 1024.0) < 10.0
    strength = rounding_noise(read, 0.0)
    assert 0.3 < strength / power[is_inside].mean() < 3.0
    assert rounding_noise(motion, step) >= step**2 / 12.0
    assert rounding_noise(motion, 0.0) == 0.0
