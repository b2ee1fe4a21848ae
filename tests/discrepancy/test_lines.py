"""A disturbance is found wherever it lies, and is no pickup and no answer of the spring."""

import numpy as np
import pytest

from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.structures.frame import Specimen

RATE = 200.0
TIME = np.arange(0.0, 40.0, 1.0 / RATE)
SPECIMEN = Specimen(stiffness=2000.0)


def campaign(*, frequency, amplitude, command_share=0.0, noise=2.0):
    """Specimen only: displacement and force with 26 dB of noise, and a wave in the force or in the motion."""
    rng = np.random.default_rng(11)
    tests = []
    for k in range(4):
        waves = [np.sin(2.0 * np.pi * f * TIME + rng.uniform(0.0, 7.0)) for f in rng.uniform(0.4, 2.0, 6)]
        displacement = 0.01 * np.sum(waves, axis=0) * np.sin(np.pi * TIME / TIME[-1]) ** 2
        wave = np.sin(2.0 * np.pi * frequency * TIME + 1.0)
        displacement = displacement + command_share * wave
        force = 2000.0 * displacement + amplitude * wave + noise * rng.standard_normal(TIME.size)
        reading = displacement + noise / 2000.0 * rng.standard_normal(TIME.size)
        channels = {Channel.MEASURED: reading, Channel.FORCE: force}
        tests.append(MeasuredTest(file=f"{k}", motion="waves", held_out=k == 3, channels=channels))
    return Campaign(
        name="", structure=None, mass=1.0, actuator=None, specimen=SPECIMEN, rate=RATE, tests=tuple(tests)
    )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("frequency", [3.0, 17.0, 33.3])
def test_a_disturbance_is_unknown_and_its_frequency_is_told(frequency):
    diagnosis = diagnose(campaign(frequency=frequency, amplitude=1.5))
    assert str(diagnosis.verdict) == "unknown_effect"
    assert f"{frequency:.0f}" in diagnosis.unknown.expression
    assert "disturbance" in diagnosis.unknown.description


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("frequency", [20.0, 40.0])
def test_folded_pickup_is_no_disturbance(frequency):
    diagnosis = diagnose(campaign(frequency=frequency, amplitude=1.5))
    assert str(diagnosis.verdict) == "no_missing_effect"


def test_a_line_in_the_motion_is_answered_by_the_spring():
    diagnosis = diagnose(campaign(frequency=17.0, amplitude=0.0, command_share=1.5 / 2000.0))
    assert str(diagnosis.verdict) == "no_missing_effect"
