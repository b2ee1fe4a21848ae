"""An actuator far beyond its limits is named, though a small gain and a long delay mend much of it."""

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose

RATE, DURATION, TESTS = 512.0, 15.0, 4
GAIN = 1.02
SHARE = 0.2
"""Of the largest velocity, or displacement, of all commands."""


def command(rng):
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    band = signal.butter(2, [0.4, 2.5], "band", fs=RATE, output="sos")
    displacement = signal.sosfiltfilt(band, rng.standard_normal(time.size))
    return 0.02 * displacement * np.exp(-(((time - 6.0) / 4.0) ** 2)) / np.abs(displacement).max()


def slow(commands, sent):
    reach = SHARE * max(np.abs(np.diff(command_history)).max() for command_history in commands)
    piston = np.zeros_like(sent)
    for i in range(1, sent.size):
        piston[i] = piston[i - 1] + np.clip(GAIN * sent[i] - piston[i - 1], -reach, reach)
    return piston


def short(commands, sent):
    reach = SHARE * max(np.abs(command_history).max() for command_history in commands)
    return np.clip(GAIN * sent, -reach, reach)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("actuator", "name"),
    [pytest.param(slow, "rate_limit", marks=pytest.mark.slow), (short, "stroke_saturation")],
)
def test_an_actuator_at_its_limit_is_named(tmp_path, actuator, name):
    rng = np.random.default_rng(2)
    commands = [command(rng) for _ in range(TESTS)]
    say = 'name = "limit"\n[actuator]\ngain = 1.0\ndelay_s = 0.0\n[sampling]\nrate_hz = 512\n'
    for k, sent in enumerate(commands):
        piston = actuator(commands, sent)
        noisy = piston + 0.01 * piston.std() * rng.standard_normal(sent.size)
        columns = np.column_stack([np.arange(sent.size) / RATE, sent, noisy])
        np.savetxt(
            tmp_path / f"{k}.csv", columns, delimiter=",", header="time_s,command_m,measured_m", comments=""
        )
        say += f'[[tests]]\nfile = "{k}.csv"\nmotion = "record {k}"\n'
    (tmp_path / "campaign.toml").write_text(say)
    diagnosis = diagnose(read_campaign(tmp_path)).to_dict()
    assert diagnosis["verdict"] == "named"
    assert [effect["name"] for effect in diagnosis["effects"]] == [name]
