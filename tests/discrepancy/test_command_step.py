"""Commands are simulated at steps as fine as the frequencies in them ask for, and no finer."""

import numpy as np
import pytest

from reliab.discrepancy.blocks import actuator
from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.segment import motions_of, scales_of
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import HybridTest

RATE = 200.0
TIME = np.arange(0.0, 10.0, 1.0 / RATE)


def campaign(frequency):
    command = 0.01 * np.sin(2.0 * np.pi * frequency * TIME) * np.sin(np.pi * TIME / 10.0) ** 2
    channels = {Channel.COMMAND: command, Channel.MEASURED: command}
    tests = tuple(
        MeasuredTest(file=name, motion=name, held_out=name == "b", channels=channels) for name in "ab"
    )
    return Campaign(
        name="sines", structure=None, mass=1.0, actuator=None, specimen=None, rate=RATE, tests=tests
    )


def steps_per_sample(campaign_read):
    block = ActuatorBlock(campaign_read, scales_of(campaign_read, motions_of(campaign_read)))
    return block._parts  # noqa: SLF001 - what is tested


def test_slow_commands_take_few_steps_and_fast_ones_at_most_two_thousand_a_second():
    assert steps_per_sample(campaign(0.5)) <= 2
    assert 4 <= steps_per_sample(campaign(5.0)) <= 12
    assert steps_per_sample(campaign(45.0)) == 2000.0 / RATE


@pytest.mark.parametrize("frequency", [0.5, 2.0, 5.0])
@pytest.mark.parametrize(
    ("effect", "values", "error"),
    [
        ("first_order_lag", [0.02], 1e-4),
        ("second_order_dynamics", [4.0, 0.5], 1e-4),
        ("rate_limit", [0.4], 4e-3),  # whose corners lie between the ends of steps
    ],
)
def test_prediction_equals_one_with_a_finer_step(monkeypatch, frequency, effect, values, error):
    campaign_read = campaign(frequency)
    scales = scales_of(campaign_read, motions_of(campaign_read))
    size = scales.velocity if effect == "rate_limit" else 1.0
    model = HybridTest().adding(find_effect(effect).from_values(size * np.array(values)))
    coarse = ActuatorBlock(campaign_read, scales).predict(model, 0)
    monkeypatch.setattr(actuator, "_LARGEST_ERROR", 1e-8)
    monkeypatch.setattr(actuator, "_FINEST_RATE", 40_000.0)
    fine = ActuatorBlock(campaign_read, scales).predict(model, 0)
    assert np.std(coarse - fine) < error * np.std(fine)
