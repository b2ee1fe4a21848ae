"""What was recorded or stated wrongly is told as such, and not as an effect that happens to look like it."""

import numpy as np
import pytest

from reliab.discrepancy import diagnose
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.terms.late_force import LateForce
from reliab.structures import Specimen

RATE, STIFFNESS = 200.0, 4.0e4
TIME = np.arange(0.0, 8.0, 1.0 / RATE)


def campaign_of(*, stated=1.0, unit=1.0, lag=0.0):
    """Tests of a linear spring: its stated stiffness over the true one, unit of the force, lag [s]."""
    tests = []
    for k in range(3):
        rng = np.random.default_rng(k)
        waves = [(f, rng.uniform(0.0, 7.0)) for f in rng.uniform(0.5, 2.5, 6)]

        def moved(time, waves=waves):
            return 0.005 * sum(np.sin(2.0 * np.pi * f * time + phase) for f, phase in waves)

        force = unit * STIFFNESS * moved(TIME - lag)
        channels = {Channel.MEASURED: moved(TIME), Channel.FORCE: force}
        noisy = {name: x + 0.003 * x.std() * rng.standard_normal(x.size) for name, x in channels.items()}
        tests.append(MeasuredTest(file=f"{k}.csv", motion="", held_out=k == 2, channels=noisy))
    return Campaign(
        name="c", structure=None, mass=1.0, actuator=None, specimen=Specimen(stiffness=stated * STIFFNESS),
        rate=RATE, tests=tuple(tests),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("stated", [0.5, 1.3])
def test_a_stiffness_that_is_stated_wrongly_is_no_hysteresis(stated):
    found = diagnose(campaign_of(stated=stated))
    assert found.effects == ()
    assert found.statement.startswith("The tests did not run with what was stated (stiffness of the specimen")
    (item,) = found.blocks[0].misstated
    assert item.value == pytest.approx(1.0 / stated, rel=2e-3)


@pytest.mark.slow
def test_pounds_force_are_called_so():
    found = diagnose(campaign_of(unit=0.2248))
    assert found.effects == ()
    assert "0.2248" in found.remarks[0]
    assert "as pounds-force for newtons, or newtons for pounds-force would have" in found.remarks[0]


@pytest.mark.slow
def test_a_force_that_lags_is_a_clock_offset():
    found = diagnose(campaign_of(lag=0.004))
    assert found.effects == ()
    assert "the force lags the displacement" in found.unknown.description
    assert float(found.unknown.expression.split("lag_s = ")[1].split()[0]) == pytest.approx(0.004, rel=0.05)


@pytest.mark.parametrize("lag", [0.001, 0.0025, 0.02])
def test_a_late_force_is_that_of_earlier(lag):
    late = LateForce(lag_s=lag).delayed(np.sin(3.0 * TIME), 1.0 / RATE)
    assert late[10:] == pytest.approx(np.sin(3.0 * (TIME - lag))[10:], abs=1e-4)
    assert late[0] == 0.0
