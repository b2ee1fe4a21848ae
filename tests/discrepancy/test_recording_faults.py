"""What was recorded or stated wrongly is told as such, and not as an effect that happens to look like it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.discrepancy.blocks.balance import BalanceBlock
from reliab.discrepancy.blocks.loop import apply_damping
from reliab.discrepancy.blocks.observed import lag_of
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import _is_slightly_late, _possible_lag, diagnose
from reliab.discrepancy.segment import motions_of, scales_of
from reliab.effects.added_mass import AddedMass
from reliab.effects.clock_offset import ClockOffset, LateGround, LeadingReading
from reliab.effects.stated_damping import StatedDamping
from reliab.signals.late_reading import record_late
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

RATE, STIFFNESS = 200.0, 4.0e4
TIME = np.arange(0.0, 8.0, 1.0 / RATE)


def campaign_of(*, factor=1.0, unit=1.0, lag=0.0, damping=0.0):
    """Tests of a linear spring: its stated stiffness over the true one, unit of the force, lag [s].

    `damping` [N·s/m].
    """
    tests = []
    for k in range(3):
        rng = np.random.default_rng(k)
        waves = [(f, rng.uniform(0.0, 7.0)) for f in rng.uniform(0.5, 2.5, 6)]

        def moved(time, waves=waves):
            return 0.005 * sum(np.sin(2.0 * np.pi * f * time + phase) for f, phase in waves)

        late = TIME - lag
        speed = (moved(late + 1e-4) - moved(late - 1e-4)) / 2e-4
        force = unit * (STIFFNESS * moved(late) + damping * speed)
        channels = {Channel.MEASURED: moved(TIME), Channel.FORCE: force}
        noisy = {name: x + 0.003 * x.std() * rng.standard_normal(x.size) for name, x in channels.items()}
        tests.append(MeasuredTest(file=f"{k}.csv", motion="", held_out=k == 2, channels=noisy))
    return Campaign(
        name="c", structure=None, mass=1.0, actuator=None, specimen=Specimen(stiffness=factor * STIFFNESS),
        rate=RATE, tests=tuple(tests),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.5, 1.3])
def test_wrong_stiffness_is_no_hysteresis(factor):
    diagnosis = diagnose(campaign_of(factor=factor))
    assert diagnosis.effects == ()
    assert diagnosis.statement.startswith(
        "The tests did not run with what was stated (stiffness of the specimen"
    )
    (item,) = diagnosis.blocks[0].misstated
    assert item.value == pytest.approx(1.0 / factor, rel=2e-3)


@pytest.mark.slow
def test_pounds_force_are_refused_by_their_name():
    with pytest.raises(
        InputError, match=r"0\.225 times .* as pounds-force for newtons, or newtons for pounds"
    ):
        diagnose(campaign_of(unit=0.2248))


def names_of(result):
    return {effect.name for effect in (*result.effects, *result.doubtful)}


def rivals_of(result):
    return {rival.name for effect in result.doubtful for rival in effect.rivals if rival.probability > 0.1}


@pytest.mark.slow
def test_lagging_force_is_a_clock_offset():
    diagnosis = diagnose(campaign_of(lag=0.004))
    (effect,) = diagnosis.effects
    assert effect.name == "clock_offset"
    assert effect.estimates[0].value == pytest.approx(0.004, rel=0.05)
    assert "ms later than the displacement" in " ".join(diagnosis.remarks)


@pytest.mark.slow
@pytest.mark.parametrize("lag", [-0.001, -0.002])
def test_slightly_early_force_is_a_clock_offset_or_a_damper(lag):
    diagnosis = diagnose(campaign_of(lag=lag))
    assert diagnosis.verdict == "not_identifiable"
    assert names_of(diagnosis) | rivals_of(diagnosis) >= {"clock_offset", "viscous_damping"}


@pytest.mark.slow
def test_early_force_differs_from_a_damper_by_the_missing_mass():
    diagnosis = diagnose(campaign_of(lag=-0.016))
    (effect,) = diagnosis.effects
    assert effect.name == "clock_offset"
    assert effect.estimates[0].value == pytest.approx(-0.016, rel=0.02)


@pytest.mark.slow
def test_a_damper_without_an_offset_is_a_damper():
    diagnosis = diagnose(campaign_of(damping=0.016 * STIFFNESS))
    assert [effect.name for effect in diagnosis.effects] == ["viscous_damping"]


@pytest.mark.slow
@pytest.mark.parametrize("lag", [-0.002, -0.001, 0.001, 0.002, 0.004])
def test_a_damper_is_stated_as_far_as_an_offset_of_the_clocks_leaves_it_open(lag):
    diagnosis = diagnose(campaign_of(lag=lag, damping=0.012 * STIFFNESS))
    damper = next(
        item for item in (*diagnosis.effects, *diagnosis.doubtful) if item.name == "viscous_damping"
    )
    (damping,) = damper.estimates
    assert abs(damping.value - 0.012 * STIFFNESS) < 2.5 * damping.sd


@pytest.mark.slow
def test_leading_displacement_is_a_clock_offset():
    def led(channels):
        return {Channel.COMMAND: channels[Channel.MEASURED], Channel.MEASURED: channels[Channel.FORCE]}

    recording = campaign_of(lag=-0.004, unit=1.0 / STIFFNESS)
    tests = tuple(replace(test, channels=led(test.channels)) for test in recording.tests)
    actuator = Actuator(gain=1.0, delay=0.001)
    diagnosis = diagnose(replace(recording, tests=tests, specimen=None, actuator=actuator))
    (effect,) = diagnosis.effects
    assert effect.name == "clock_offset"
    assert effect.estimates[0].value > 0.004 - 2.0 * effect.estimates[0].sd


@pytest.mark.parametrize("lag", [-0.02, -0.001, 0.001, 0.0025, 0.02])
def test_late_force_equals_an_earlier_one(lag):
    model = HybridTest(effects=(ClockOffset(lag_s=lag),))
    late = record_late(np.sin(3.0 * TIME), lag_of(model), 1.0 / RATE)
    inner = slice(10, -10)
    assert late[inner] == pytest.approx(np.sin(3.0 * (TIME - lag))[inner], abs=1e-7)


def test_leading_reading_equals_a_later_one():
    model = HybridTest(effects=(LeadingReading(lead_s=0.003),))
    early = record_late(np.sin(3.0 * TIME), lag_of(model), 1.0 / RATE)
    assert early[10:-10] == pytest.approx(np.sin(3.0 * (TIME + 0.003))[10:-10], abs=1e-7)
    step, slope = 1.0 / RATE, 3.0 * np.cos(3.0 * TIME[-1])
    assert early[-1] == pytest.approx(np.sin(3.0 * TIME[-1]) + 0.003 * slope, abs=1e-5)
    far = record_late(np.sin(3.0 * TIME), -0.2, step)
    assert far[-30:] == pytest.approx(np.sin(3.0 * TIME[-1]) + 2.0 * step * slope, abs=1e-5)


def delay_force(campaign, lag):
    """Forces that were recorded later than they acted [s]; the controller used them in time."""
    late = HybridTest(effects=(ClockOffset(lag_s=lag),))
    tests = (
        replace(
            test,
            channels={
                **test.channels,
                Channel.FORCE: record_late(test.channels[Channel.FORCE], lag_of(late), campaign.step),
            },
        )
        for test in campaign.tests
    )
    return replace(campaign, tests=tuple(tests))


@pytest.mark.slow
@pytest.mark.parametrize("lag", [-0.001, 0.001, 0.003])
def test_a_late_force_is_no_other_damping_ratio_of_the_structure(lag):
    """Beside the ground it looks like half of ω₀τ more damping, which would widen a criterion."""
    diagnosis = diagnose(delay_force(read_campaign("rig_c"), lag))
    assert [effect.name for effect in diagnosis.effects] == ["clock_offset"]
    assert "structure_damping" not in {item.name for block in diagnosis.blocks for item in block.misstated}


@pytest.mark.slow
@pytest.mark.parametrize("lag", [-0.004, 0.004, 0.02])
def test_a_late_ground_acceleration_is_no_integration_error(lag):
    campaign = read_campaign("rig_c")
    late = HybridTest(effects=(ClockOffset(lag_s=lag),))
    tests = tuple(
        replace(
            test,
            channels={
                **test.channels,
                Channel.GROUND: record_late(test.channels[Channel.GROUND], lag_of(late), campaign.step),
            },
        )
        for test in campaign.tests
    )
    diagnosis = diagnose(replace(campaign, tests=tests))
    (effect,) = diagnosis.effects
    (estimate,) = effect.estimates
    assert (effect.name, estimate.name) == ("clock_offset", "ground_lag_s")
    assert estimate.value == pytest.approx(lag, abs=1e-4)
    assert "structure_damping" not in {item.name for block in diagnosis.blocks for item in block.misstated}
    assert any("The ground acceleration was recorded" in remark for remark in diagnosis.remarks)


@pytest.mark.parametrize(("lag", "slight"), [(-0.0007, True), (0.001, True), (-0.002, False), (0.004, False)])
def test_slightly_late_ground_may_be_an_integration(lag, slight):
    late = HybridTest(effects=(LateGround(ground_lag_s=lag),))
    fit = SimpleNamespace(space=SimpleNamespace(model=lambda _coordinates: late), coordinates=None)
    assert _is_slightly_late(fit) is slight


def test_late_ground_equals_a_later_one():
    acceleration = LateGround(ground_lag_s=0.0125).applied(np.sin(3.0 * TIME), 1.0 / RATE)
    assert acceleration[10:-10] == pytest.approx(np.sin(3.0 * (TIME + 0.0125))[10:-10], abs=1e-7)


@pytest.mark.parametrize(
    ("effect", "rival", "lag"),
    [
        ("clock_offset", "viscous_damping", 0.002),
        ("viscous_damping", "clock_offset", 0.002),
        ("viscous_damping", "added_mass", 0.0),
    ],
)
def test_a_force_may_be_as_late_as_a_doubted_offset_says(effect, rival, lag):
    late = HybridTest(effects=(ClockOffset(lag_s=0.002),))
    space = SimpleNamespace(effects=(ClockOffset,), model=lambda _coordinates: late)
    fit = SimpleNamespace(space=space, coordinates=None)
    doubt = SimpleNamespace(name=effect, rivals=(SimpleNamespace(name=rival),))
    specimen = SimpleNamespace(effects=(), doubtful=(doubt,), ranked=(SimpleNamespace(fit=fit),))
    assert _possible_lag(specimen) == lag


def test_a_balance_reads_its_force_as_late_as_the_specimen_does():
    campaign = read_campaign("rig_c")
    block = BalanceBlock(campaign, scales_of(campaign, motions_of(campaign)))
    late = block.read_late(0.01)
    reference = record_late(block.predict(block.nominal, 0), 0.01, campaign.step)
    assert late.predict(late.nominal, 0) == pytest.approx(reference)
    assert block.nominal == campaign.nominal


def answers_of(*, damping_ratio=0.05, mass=0.0, gain=1.0, delay=0.004):
    """Displacement alone of a rig whose structure is stated with 5 % and without another mass."""
    tests, step = [], 0.002
    effects = (AddedMass(mass_kg=mass),) if mass else ()
    structure = Structure(frequency=1.0, damping_ratio=damping_ratio)
    rig = HybridTest(
        structure=structure, mass=1e3, actuator=Actuator(gain=gain, delay=delay), effects=effects
    )
    for k in range(3):
        rng = np.random.default_rng(k)
        time = np.arange(0.0, 12.0, step)
        waves = [(f, rng.uniform(0.0, 7.0)) for f in rng.uniform(0.5, 4.0, 12)]
        ground = np.sin(np.pi * time / 12.0) * sum(np.sin(2.0 * np.pi * f * time + p) for f, p in waves)
        piston = run_closed_loop(rig, ground, step).piston.values[0]
        noisy = piston + 0.01 * piston.std() * rng.standard_normal(piston.size)
        channels = {Channel.GROUND: ground[::2], Channel.MEASURED: noisy[::2]}
        tests.append(MeasuredTest(file=f"{k}.csv", motion="", held_out=k == 2, channels=channels))
    return Campaign(
        name="c", structure=Structure(frequency=1.0, damping_ratio=0.05), mass=1e3,
        actuator=Actuator(gain=1.0, delay=0.004), specimen=None, rate=250.0, tests=tuple(tests),
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("true", [{"damping_ratio": 0.04}, {"mass": 200.0, "gain": 1.05}])
def test_one_channel_cannot_separate_mass_and_gain_from_damping(true):
    diagnosis = diagnose(answers_of(**true))
    assert diagnosis.verdict == "not_identifiable"
    assert names_of(diagnosis) | rivals_of(diagnosis) >= {"added_mass", "structure_damping"}


@pytest.mark.slow
def test_one_channel_cannot_separate_a_damper_from_low_damping():
    diagnosis = diagnose(answers_of(damping_ratio=0.06))
    assert diagnosis.verdict == "not_identifiable"
    assert names_of(diagnosis) | rivals_of(diagnosis) >= {"viscous_damping", "structure_damping"}


@pytest.mark.slow
@pytest.mark.parametrize("true", [0.04, 0.06])
def test_damper_of_an_oscillator_may_be_a_wrong_damping_ratio(true):
    diagnosis = diagnose(replace(answers_of(damping_ratio=true, delay=0.0), actuator=None))
    assert diagnosis.verdict == "not_identifiable"
    assert names_of(diagnosis) | rivals_of(diagnosis) >= {"viscous_damping", "structure_damping"}


def test_stated_damping_acts_on_the_structure():
    model = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.05), mass=1e3)
    nominal_damping = model.mass * model.substructure.damping
    less_damping = apply_damping(model.adding(StatedDamping(damping_n_s_per_m=-0.2 * nominal_damping)))
    assert less_damping.structure.damping_ratio == pytest.approx(0.04)
    assert less_damping.effects == ()


def test_a_structure_keeps_some_damping_however_much_an_effect_takes():
    model = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.05), mass=1e3)
    nominal_damping = model.mass * model.substructure.damping
    least = apply_damping(model.adding(StatedDamping(damping_n_s_per_m=-1.2 * nominal_damping)))
    assert 0.0 < least.structure.damping_ratio <= 1e-6
