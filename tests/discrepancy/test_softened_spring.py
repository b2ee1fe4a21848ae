"""Rubber that is softer below its largest displacement so far, in this test or in an earlier one."""

import numpy as np
import pytest
from discrepancy.test_specimen_forms import RATE, STIFFNESS, TESTS, write_tests
from scipy import optimize

from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import Verdict
from reliab.discrepancy.segment import motions_of, scales_of
from reliab.effects.degrading_hysteresis import DegradingHysteresis
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.softening import Softening
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen

SPRING = Specimen(stiffness=1000.0)
RUBBER = HybridTest(specimen=SPRING, effects=(Softening(lost_n_per_m=400.0, power=2.0),))
TIME = np.arange(0.0, 3.0, 0.002)
GROWING = np.sin(2.0 * np.pi * TIME) * TIME / TIME[-1] * 0.1


def force_of(displacement, earlier_peak=0.0):
    test = HybridTest(specimen=SPRING, effects=RUBBER.effects, moved_before=earlier_peak)
    return load(test, Motion3.interpolate(displacement, TIME[1]))


def test_at_a_new_largest_displacement_it_is_as_stiff_as_ever():
    largest = np.maximum.accumulate(np.abs(GROWING))
    new = np.abs(GROWING) == largest
    assert new.sum() > 100
    np.testing.assert_allclose(force_of(GROWING)[new], 1000.0 * GROWING[new], rtol=1e-12)


def test_lost_stiffness_returns_with_the_power_below_an_earlier_peak():
    force = force_of(0.5 * GROWING, earlier_peak=0.1)
    reference = (1000.0 - 400.0 * (1.0 - (np.abs(0.5 * GROWING) / 0.1) ** 2)) * 0.5 * GROWING
    np.testing.assert_allclose(force, reference, rtol=1e-12, atol=1e-12)


def test_it_remembers_the_tests_before_in_the_order_of_the_campaign(tmp_path):
    sizes = iter([1.0, 0.3, 2.0, 0.3])
    campaign = write_tests(
        tmp_path, f"stiffness_n_per_m = {STIFFNESS}", lambda displacement: STIFFNESS * displacement
    )
    displacement = tuple(
        Motion3.interpolate(next(sizes) * test.channels["measured_m"][::8], 8.0 / RATE)
        for test in campaign.tests
    )
    block = SpecimenBlock(campaign, scales_of(campaign, motions_of(campaign)), displacement)
    peaks = [np.abs(motion.values[0]).max() for motion in displacement]
    for test, earlier_peak in enumerate([0.0, peaks[0], peaks[0], peaks[2]]):
        single = HybridTest(specimen=SPRING, effects=RUBBER.effects, moved_before=earlier_peak)
        np.testing.assert_allclose(block.predict(RUBBER, test), load(single, displacement[test]), atol=1e-9)


def cut_campaign(tmp_path, cut, law):
    """A recording of a slowly growing motion, cut at a sample into two tests."""
    time = np.arange(4000) / 200.0
    displacement = 0.02 * np.sin(2.0 * np.pi * 0.7 * time) * time / time[-1]
    described = "[specimen]\nstiffness_n_per_m = 1000.0\ndamping_n_s_per_m = 0.0\nmass_kg = 0.0\n"
    lines = ["[sampling]\nrate_hz = 200\n"]
    for name, part in (("a.csv", slice(0, cut)), ("b.csv", slice(cut, None))):
        lines.append(f'[[tests]]\nfile = "{name}"\nmotion = "growing"\n')
        moved = displacement[part]
        np.savetxt(
            tmp_path / name, np.column_stack([moved, law(displacement)[part]]), delimiter=",",
            header="measured_m,force_n", comments="",
        )  # fmt: skip
    (tmp_path / "campaign.toml").write_text(f'name = "cut"\n{described}{"".join(lines)}', encoding="utf-8")
    return read_campaign(tmp_path), displacement


@pytest.mark.parametrize("cut", [1500, 2100])
def test_a_hysteresis_goes_on_where_one_recording_was_cut(tmp_path, cut):
    model = HybridTest(
        specimen=SPRING, effects=(DegradingHysteresis(force_n=5.0, displacement_m=0.003, stiffness_loss=0.1),)
    )
    campaign, displacement = cut_campaign(tmp_path, cut, lambda moved: 1000.0 * moved)
    whole = Motion3.interpolate(displacement, 1.0 / 200.0)
    pistons = [
        Motion3(values=whole.values[:, part], step=whole.step) for part in (slice(cut), slice(cut, None))
    ]
    block = SpecimenBlock(campaign, scales_of(campaign, motions_of(campaign)), pistons)
    forces = np.concatenate([block.predict(model, test) for test in (0, 1)])
    np.testing.assert_allclose(forces, load(model, whole), atol=1e-9)


def test_a_hysteresis_begins_anew_in_a_test_of_its_own(tmp_path):
    model = HybridTest(specimen=SPRING, effects=(Hysteresis(force_n=5.0, displacement_m=0.003),))
    campaign = write_tests(
        tmp_path, f"stiffness_n_per_m = {STIFFNESS}", lambda displacement: STIFFNESS * displacement
    )
    motions = motions_of(campaign)
    block = SpecimenBlock(campaign, scales_of(campaign, motions), motions)
    for test, motion in enumerate(motions):
        np.testing.assert_allclose(block.predict(model, test), load(model, motion), atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("power", [0.5, 2.5])
def test_a_spring_without_memory_is_not_named_softening(tmp_path, power):
    peak = 0.02

    def spring(displacement):
        return STIFFNESS * displacement * (1.0 + 0.5 * (np.abs(displacement) / peak) ** power)

    diagnosis = diagnose(write_tests(tmp_path, f"stiffness_n_per_m = {STIFFNESS}", spring))
    assert "softening" not in {effect.name for effect in (*diagnosis.effects, *diagnosis.doubtful)}


@pytest.mark.slow
def test_rubber_of_another_law_is_named_softening_and_predicted_better_than_by_it_alone(tmp_path):
    """The stiffness returns along a straight line, and not with a power of the displacement.

    Least squares on force and displacement without noise say how close softening alone comes. A spring that
    bends beside it may come closer.
    """
    largest = 0.0
    moved_by_test, ratios = [], []

    def rubber(displacement):
        nonlocal largest
        so_far = np.maximum(np.maximum.accumulate(np.abs(displacement)), largest)
        largest = so_far[-1]
        moved_by_test.append(displacement)
        ratios.append(np.abs(displacement) / np.maximum(so_far, 1e-12))
        return STIFFNESS * displacement * (1.0 - 0.5 * np.minimum(2.0 * (1.0 - ratios[-1]), 1.0))

    diagnosis = diagnose(write_tests(tmp_path, f"stiffness_n_per_m = {STIFFNESS}", rubber))
    (effect,) = diagnosis.effects
    assert (diagnosis.verdict, effect.name) == (Verdict.NAMED, "softening")
    assert diagnosis.unknown is None

    def miss(parameters, tests=slice(TESTS - 1)):
        stiffness, loss, power = parameters
        displacement, ratio = (np.concatenate(values[tests]) for values in (moved_by_test, ratios))
        force = STIFFNESS * (1.0 - np.minimum(1.0 - ratio, 0.5)) * displacement
        return ((stiffness - loss * (1.0 - ratio**power)) * displacement - force) / force.std()

    closest = optimize.least_squares(miss, [STIFFNESS, 0.4 * STIFFNESS, 2.0], x_scale=[1e4, 1e4, 1.0]).x
    remainder = float(np.sqrt(np.mean(miss(closest, slice(TESTS - 1, None)) ** 2)))
    assert diagnosis.gap.after < remainder
    assert diagnosis.gap.after < 0.2 * diagnosis.gap.before
