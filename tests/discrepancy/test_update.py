"""The updated model holds what a diagnosis found."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.adding import update_model
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, read_model, write_model
from reliab.simulation.hybrid_test.open_loop import Motion3, drive, load
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

RATE = 256.0
NOMINAL = HybridTest(
    structure=Structure(frequency=1.0, damping_ratio=0.03),
    mass=50.0,
    actuator=Actuator(gain=0.98, delay=0.004),
)
TRUTH = HybridTest(
    structure=NOMINAL.structure,
    mass=50.0,
    actuator=Actuator(gain=1.01, delay=0.006),
    specimen=Specimen(stiffness=1.04 * NOMINAL.specimen.stiffness),
    effects=(find_effect("viscous_damping")(damping_n_s_per_m=30.0),),
)


def measure_test(seed, held_out):
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 20.0, 1.0 / RATE)
    waves = [np.sin(2 * np.pi * f * t + rng.uniform(0, 7)) for f in rng.uniform(0.4, 2.0, 6)]
    command = 0.01 * np.sum(waves, axis=0) * np.sin(np.pi * t / t[-1]) ** 2
    piston = drive(TRUTH, Motion3.interpolate(command, 1.0 / RATE))
    force = load(TRUTH, piston)
    channels = {
        Channel.COMMAND: command,
        Channel.MEASURED: piston.values[0] + 1e-5 * rng.standard_normal(t.size),
        Channel.FORCE: force + 0.3 * rng.standard_normal(t.size),
    }
    return MeasuredTest(file=f"{seed}.csv", motion="waves", held_out=held_out, channels=channels)


@pytest.fixture(scope="module")
def updated_model():
    campaign = Campaign(
        name="late and damped",
        structure=NOMINAL.structure,
        mass=50.0,
        actuator=NOMINAL.actuator,
        specimen=None,
        rate=RATE,
        tests=tuple(measure_test(seed, seed == 3) for seed in range(4)),
    )
    return update_model(diagnose(campaign))


@pytest.mark.slow
def test_calibrated_values_are_the_true_ones(updated_model):
    sd = updated_model.deviations
    assert abs(updated_model.test.actuator.gain - 1.01) < 4.0 * sd["gain"] < 0.01
    assert abs(updated_model.test.actuator.delay - 0.006) < 4.0 * sd["delay_s"] < 0.001
    off = abs(updated_model.test.specimen.stiffness - TRUTH.specimen.stiffness)
    assert off < 4.0 * sd["stiffness_n_per_m"] < 0.01 * TRUTH.specimen.stiffness


def test_the_effect_is_added(updated_model):
    (effect,) = updated_model.test.effects
    assert effect.name == "viscous_damping"
    assert (
        abs(effect.damping_n_s_per_m - 30.0)
        < 4.0 * updated_model.deviations["viscous_damping.damping_n_s_per_m"]
    )


def test_it_survives_its_file(updated_model, tmp_path):
    write_model(tmp_path / "model.toml", updated_model)
    assert read_model(tmp_path / "model.toml") == updated_model


@pytest.mark.parametrize(
    "kind", [*general_terms(Block.SPECIMEN), *general_terms(Block.ACTUATOR)], ids=lambda kind: str(kind.name)
)
def test_terms_of_a_general_kind_survive_the_file(kind, tmp_path):
    values = np.linspace(1.0, 1.5, len(kind.parameters))
    term = kind.from_values(values)
    model = UpdatedModel(
        name="terms",
        test=replace(NOMINAL, effects=(term,)),
        deviations={f"{kind.name}.{p.name}": 0.1 for p in kind.parameters},
    )
    write_model(tmp_path / "model.toml", model)
    assert read_model(tmp_path / "model.toml") == model


def test_limits_of_the_model_are_in_its_file(updated_model, tmp_path):
    limited_model = replace(updated_model, limits=("width_m of backlash\nlies on a bound",))
    write_model(tmp_path / "model.toml", limited_model)
    text = (tmp_path / "model.toml").read_text(encoding="utf-8")
    assert "\n# width_m of backlash lies on a bound\n" in text
    assert read_model(tmp_path / "model.toml") == updated_model


@pytest.mark.slow
def test_wrong_structure_is_corrected(sample_campaigns):
    truth = read_campaign(sample_campaigns / "rig_c")
    nominal = replace(truth.structure, frequency=1.02 * truth.structure.frequency)
    diagnosis = diagnose(replace(truth, structure=nominal))
    structure = update_model(diagnosis).test.structure
    assert structure.frequency == pytest.approx(truth.structure.frequency, rel=0.004)
    # f enters the damping coefficient too: a ratio within its tolerance is left as it was stated
    assert structure.damping_ratio == pytest.approx(truth.structure.damping_ratio, rel=0.06)
    assert any("natural frequency" in remark for remark in diagnosis.remarks)
    assert update_model(diagnose(truth)).test.structure == truth.structure
