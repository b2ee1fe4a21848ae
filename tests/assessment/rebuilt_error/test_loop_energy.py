"""The motion of modes in their bands, and which of them is named where a loop diverges."""

import numpy as np
import pytest
import scipy.signal

from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuilt_error.loop_energy import LoopEnergy, select_modes
from reliab.structures.partition import Partition

STEP = 1.0 / 512.0
STIFFNESS = (2.0 * np.pi * 2.0) ** 2 * np.array([[2.0, -1.0], [-1.0, 1.0]])
FRAME = Partition(
    mass=np.eye(2),
    damping=np.eye(2) * 0.4,  # the second mode is damped less than the first one, and diverges first
    stiffness=STIFFNESS,
    interface=np.array([1.0, 0.0]),
    specimen_stiffness=0.5 * float(STIFFNESS[0, 0]),
)


def modes():
    return select_modes(FRAME, STEP)


def loop(delay, seconds=12.0, seed=1):
    """Command and measured displacement of a loop whose actuator is late by whole samples."""
    ground = np.random.default_rng(seed).normal(size=int(seconds / STEP))
    gamma, x, v = FRAME.interface[:, 0], np.zeros(2), np.zeros(2)
    command = np.zeros(ground.size)
    for k in range(ground.size):
        command[k] = gamma @ x
        error = (command[k - delay] if k >= delay else 0.0) - command[k]
        force = FRAME.stiffness @ x + gamma * FRAME.specimen_stiffness[0, 0] * error
        v = v + STEP * (-ground[k] - FRAME.damping @ v - force)
        x = x + STEP * v
    measured_displacement = np.concatenate([np.zeros(delay), command[: command.size - delay]])
    return command, measured_displacement


@pytest.mark.parametrize("cuts", [(), (1,), (700, 701), (5, 1499)])
def test_products_in_the_band_forget_the_past_by_one_weight_a_step(cuts):
    command, measured_displacement = (0.01 + values[:2000] for values in loop(2))
    measured_displacement = measured_displacement + 5e-3  # an offset of the sensor
    energy = LoopEnergy(modes())
    for parts in zip(*(np.split(history, cuts) for history in (command, measured_displacement)), strict=True):
        energy.feed(*parts)
    for mode, motion in zip(modes(), energy._motions, strict=True):  # noqa: SLF001
        b, a1, a2 = mode.band
        filtered_values = [
            scipy.signal.lfilter([b, 0.0, -b], [1.0, a1, a2], mode.projection[0] * (values - values[0]))
            for values in (command, measured_displacement - command)
        ]
        rows = np.stack(
            [
                0.5 * (filtered_values[0][1:] + filtered_values[0][:-1]),
                np.diff(filtered_values[0]) / STEP,
                0.5 * (filtered_values[1][1:] + filtered_values[1][:-1]),
            ]
        )
        weight = mode.forgetting ** np.arange(command.size - 2, -1, -1)
        steps = np.diff(rows, prepend=0.0)
        moments = np.stack([(weight * rows) @ rows.T, (weight * steps) @ steps.T])
        assert motion._moments == pytest.approx(moments, rel=1e-9, abs=1e-12)  # noqa: SLF001
        assert motion.totals[0] == pytest.approx(weight.sum())


def test_a_mode_passes_its_band_as_it_is_and_another_one_is_held_back():
    for mode in modes():
        b, a1, a2 = mode.band
        places = np.array([1.0, 1.0 / 3.0, 3.0]) * mode.circular_frequency * STEP
        _, filtered_values = scipy.signal.freqz([b, 0.0, -b], [1.0, a1, a2], worN=places)
        assert filtered_values[0] == pytest.approx(1.0)
        assert np.abs(filtered_values[1:]).max() < 0.2


def follow_loop(delay, cuts=()):
    """The monitor after a loop, until its command is fifty times that of a sound one."""
    command, measured_displacement = loop(delay)
    stop = int(np.argmax(np.abs(command) > 0.5)) or command.size
    monitor = Monitor(FRAME, STEP)
    for parts in zip(*(np.split(h[:stop], cuts) for h in (command, measured_displacement)), strict=True):
        monitor.feed(*parts)
    return monitor


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("cuts", [(1000,), tuple(range(64, 4600, 64))])
def test_a_higher_mode_that_diverges_is_named_however_the_samples_arrive(cuts):
    full_test, monitor = follow_loop(10), follow_loop(10, cuts)
    assert monitor.gains_energy_since == full_test.gains_energy_since < 3.0
    assert monitor.gaining_frequency == pytest.approx(FRAME.natural_frequencies[1])
    assert monitor.now.damping.ratio < 0.0


def test_a_loop_with_half_of_the_critical_delay_is_not_named():
    monitor = follow_loop(1)
    assert monitor.gains_energy_since is None
    assert monitor.gaining_frequency is None
    assert monitor.now.damping.ratio > 0.0
