"""The alarm of a loop that gains energy: raised where it diverges, and not by a gain, an offset or play."""

from functools import cache

import numpy as np
import pytest

from rebuilt_error.laboratory import BACKLASH, DELAY, LEAD, RATE, Lab, run, synthetic_ground
from reliab.assessment.monitor import Monitor
from reliab.structures.structure import Structure

XI = 0.03
CRITICAL = 2.0 * XI / (2.0 * np.pi)  # delay at which the damping of 1 Hz is used up [s]


@cache
def exact_peak() -> float:
    """Largest exact response [m]."""
    return float(np.abs(run(Lab(1.0, XI), synthetic_ground(3, 20.0)).ideal).max())


def first_alarm(lab: Lab, offset: float = 0.0) -> tuple[float, float]:
    """Times [s] of the first alarm, and at which the command is three times the peak it should have."""
    outcome = run(lab, synthetic_ground(3, 20.0))
    large = np.abs(outcome.command) > 3.0 * exact_peak()
    end = int(np.argmax(large)) if large.any() else outcome.command.size
    monitor = Monitor(Structure(frequency=1.0, damping_ratio=XI), 1.0 / RATE)
    for begin in range(0, end, 256):
        stretch = slice(begin, min(begin + 256, end))
        monitor.feed(outcome.command[stretch], outcome.measured[stretch] + offset)
        if monitor.gains_energy_since is not None:
            return monitor.gains_energy_since, end / RATE
    return np.inf, end / RATE


def test_diverging_loop_is_reported_in_advance():
    alarm, diverged = first_alarm(Lab(1.0, XI, 1.0, DELAY, (1.0, 2.0 * CRITICAL, 0.0, 0.0)))
    assert alarm < diverged - 2.0


@pytest.mark.parametrize(
    "lab",
    [
        Lab(1.0, XI, 1.0, DELAY, (0.95, 0.8 * CRITICAL, 0.0, 0.0)),
        Lab(1.0, XI, 1.0, DELAY, (1.05, 0.8 * CRITICAL, 0.0, 0.0)),
        Lab(1.0, XI, 1.0, LEAD, (1.02, CRITICAL, 0.0, 0.0)),
    ],
)
def test_a_stable_loop_raises_no_alarm(lab):
    assert first_alarm(lab, offset=0.1 * exact_peak())[0] == np.inf


@pytest.mark.parametrize("share", [0.001, 0.003, 0.01, 0.03])
def test_play_raises_no_alarm(share):
    lab = Lab(1.0, XI, 1.0, BACKLASH, (share * exact_peak(), 0.0, 0.0, 0.0))
    assert first_alarm(lab, offset=0.1 * exact_peak())[0] == np.inf
