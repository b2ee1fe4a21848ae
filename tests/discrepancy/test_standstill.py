"""A reading that is held now and then is an unknown effect; coarse steps of a converter are not."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.naming.unexplained import standstill
from reliab.simulation.hybrid_test.model import Actuator
from reliab.structures.frame import Specimen

RATE = 256.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)


STIFFNESS = 2.0e5


def campaign(*, holds=0, step=0.0, noise=2e-5, specimen=None):
    rng = np.random.default_rng(3)
    tests = []
    for k in range(4):
        waves = [np.sin(2.0 * np.pi * f * TIME + rng.uniform(0.0, 7.0)) for f in rng.uniform(0.4, 4.0, 6)]
        command = 0.002 * np.sum(waves, axis=0) * np.sin(np.pi * TIME / TIME[-1]) ** 2
        piston = np.interp(TIME - 0.004, TIME, command)
        read = piston + noise * rng.standard_normal(TIME.size)
        read = np.round(read / step) * step if step else read
        for begin in rng.integers(1000, TIME.size - 1000, holds):
            read[begin : begin + 20] = read[begin]
        channels = {Channel.COMMAND: command, Channel.MEASURED: read}
        if specimen is not None:
            channels[Channel.FORCE] = STIFFNESS * piston + 8.0 * rng.standard_normal(TIME.size)
        tests.append(MeasuredTest(file=f"{k}", motion="waves", held_out=k == 3, channels=channels))
    return Campaign(
        name="", structure=None, mass=1.0, actuator=Actuator(delay=0.003), specimen=specimen, rate=RATE,
        tests=tuple(tests),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("step", [pytest.param(0.0, marks=pytest.mark.slow), 1e-4])
def test_held_reading_is_unknown(step):
    diagnosis = diagnose(campaign(holds=8, step=step))
    assert str(diagnosis.verdict) == "unknown_effect"
    assert "stands still" in diagnosis.unknown.description


def test_specimen_is_not_blamed_for_a_failing_sensor():
    diagnosis = diagnose(campaign(holds=16, specimen=Specimen(stiffness=STIFFNESS)))
    actuator, specimen = diagnosis.blocks
    assert "stands still" in actuator.unknown.description
    assert str(specimen.verdict) == "no_missing_effect"
    assert specimen.leaves_noise


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("step", [0.0, 1e-4, 4e-4])
def test_coarse_steps_alone_are_nothing(step):
    assert str(diagnose(campaign(step=step)).verdict) == "no_missing_effect"


def test_expected_signal_above_the_band_is_no_movement():
    slow, step = np.sin(2.0 * np.pi * 0.2 * TIME), 0.05
    read = np.round(slow / step) * step
    jagged_reading = 20.0 * step * np.sin(2.0 * np.pi * 150.0 * TIME)
    problem = SimpleNamespace(
        residuals=lambda *_: {0: read - slow - jagged_reading},
        block=SimpleNamespace(is_narrow=False, measured=lambda _: read, rate=RATE, highest=45.0),
        steps={0: step},
    )
    assert standstill(problem, SimpleNamespace(space=None, coordinates=None)) is None
