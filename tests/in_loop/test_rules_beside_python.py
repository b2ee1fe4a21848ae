"""Where the monitor in C has a rule of its own, and where it has that of Python."""

import numpy as np
import pytest
from compiled_monitor import ERROR, build, follow, needs_compiler

from reliab.app.api.monitor import export_monitor
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.monitor import Monitor
from reliab.structures.structure import Structure

pytestmark = needs_compiler
RATE, XI = 256, 0.05
STRUCTURE = Structure(frequency=1.0, damping_ratio=XI)
STILL = np.zeros(2 * RATE)


def loop(ground, *, input_motion=0.0, gain=0.97, late=0.006, begins=0.0):
    """Command and true displacement of a loop whose piston stands off its command by `input_motion` [m]."""
    w0, steps = STRUCTURE.circular_frequency, round(late * RATE)
    x, v = np.full(ground.size + 1, begins), 0.0
    displacement = np.full(ground.size, gain * begins + input_motion)
    for k in range(ground.size):
        displacement[k] = gain * (x[k - steps] if k >= steps else begins) + input_motion
        v += (-ground[k] - 2.0 * XI * w0 * v - w0**2 * displacement[k]) / RATE
        x[k + 1] = x[k] + v / RATE
    return x[:-1].copy(), displacement


def shaken(seed, seconds=16.0):
    return np.random.default_rng(seed).normal(size=int(seconds * RATE))


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("monitor")
    export_monitor(("c", folder), f=1, xi=XI, rate=RATE)
    return build(folder)


def follow_in_both(library, command, reading, seed=1):
    """C and Python's monitor, which looks at the whole test."""
    noise = 1e-6 * np.random.default_rng(seed).normal(size=command.size)
    theirs = Monitor(STRUCTURE, 1.0 / RATE)
    theirs.feed(command, reading + noise)
    theirs.ask()
    return follow(library, command, reading + noise), theirs


def test_an_offset_of_the_sensor_alone_is_learned_as_python_does(library):
    command, reading = loop(np.concatenate([STILL, shaken(1)]))
    ours, theirs = follow_in_both(library, command, reading + 2e-3)
    assert ours.offset[-1] == pytest.approx(theirs.result.readings.starts[0].offset, abs=1e-6)
    moving = slice(STILL.size + 8, None)
    assert np.abs(ours.error - theirs.error)[moving].max() < 2e-6


def test_offset_of_a_standing_loop_is_kept_as_in_python(library):
    input_motion = 2e-3
    command, reading = loop(
        np.concatenate([STILL, shaken(2)]), input_motion=input_motion, gain=1.0, begins=-input_motion
    )
    ours, theirs = follow_in_both(library, command, reading)
    assert ours.offset[-1] == theirs.result.readings.starts[0].offset == 0.0
    moving = slice(STILL.size + 8, None)
    assert np.abs(ours.error - theirs.error)[moving].max() < 2e-6


def test_offset_moving_the_loop_differs_from_python(library):
    """The command leaves its place within few samples; later its mean tells Python that the loop felt it."""
    input_motion = 2e-3
    command, reading = loop(shaken(3, 40.0), input_motion=input_motion, gain=1.0)
    ours, theirs = follow_in_both(
        library, np.append(np.zeros(8), command), np.append(np.full(8, input_motion), reading)
    )
    assert theirs.result.readings.starts[0].offset == 0.0
    assert ours.offset[-1] == pytest.approx(input_motion, rel=1e-2)
    declared_values = follow(
        library, np.append(np.zeros(8), command), np.append(np.full(8, input_motion), reading), (0.0, 0.0)
    )
    assert np.abs(declared_values.error - theirs.error).max() < 5e-6


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_the_alarm_of_the_error_comes_with_python_s_where_all_is_known_and_earlier_where_not(library, seed):
    """Python's is looked for each tenth of a second, its interval when the test has grown."""
    command, reading = loop(shaken(seed, 45.0))
    read = reading + 1e-3 * np.abs(command).max() * np.random.default_rng(seed).normal(size=command.size)
    error = follow(library, command, read, (0.0, 0.0)).status.astype(int) & ERROR > 0
    ours = np.argmax(error) / RATE
    exactly = alarm_of_python(command, read, PriorKnowledge())
    roughly = alarm_of_python(
        command,
        read,
        PriorKnowledge(tolerances={"frequency": 0.02, "damping_ratio": 0.1, "sensor_scale": 0.01}),
    )
    assert error.any()
    assert ours - 0.01 <= exactly < ours + 0.5
    assert exactly <= roughly


def alarm_of_python(command, read, tolerances):
    """Time at which Python's alarm is raised [s]; infinite where it is not."""
    monitor = Monitor(STRUCTURE, 1.0 / RATE, sensor_offset=0.0, known=tolerances)
    for begin in range(0, command.size, RATE // 10):
        stretch = slice(begin, begin + RATE // 10)
        monitor.feed(command[stretch], read[stretch])
        if monitor.due:
            monitor.ask()
        if monitor.exceeds(0.05):
            return monitor.now.time
    return np.inf
