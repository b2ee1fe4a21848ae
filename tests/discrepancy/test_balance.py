"""The numerical substructure: a coarse integration is that and nothing else."""

from dataclasses import replace

import pytest
from blind_campaigns.campaign import Options, generate
from blind_campaigns.kinds import Kind

from reliab.discrepancy.blocks.balance import BalanceBlock
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.result.missing_effect import calibration
from reliab.discrepancy.segment import cut_segments, motions_of, scales_of


def search_balance(campaign):
    """The best model of a campaign's numerical substructure, and its calibrated values by name."""
    block = BalanceBlock(campaign, scales_of(campaign, motions_of(campaign)))
    segments = cut_segments(campaign.training, campaign.rate, block.highest_of)
    best = Search(Problem(block=block, segments=segments)).run()
    return best, {e.name: e for e in calibration(best)}


def change_force(campaign, change):
    """The same campaign with another recorded force."""
    tests = (
        replace(test, channels={**test.channels, Channel.FORCE: change(test.channels[Channel.FORCE])})
        for test in campaign.tests
    )
    return replace(campaign, tests=tuple(tests))


def test_offset_of_recorded_force_is_no_integration_error(sample_campaigns):
    campaign = read_campaign(sample_campaigns / "rig_c")
    best, calibration = search_balance(change_force(campaign, lambda force: force + 0.5))
    assert best.space.names == ()
    offset = calibration["force_not_fed_back_n"]
    assert offset.value == pytest.approx(0.5, abs=3.0 * offset.sd)


def test_wrong_mass_is_calibrated(sample_campaigns):
    campaign = read_campaign(sample_campaigns / "rig_c")
    best, calibration = search_balance(change_force(campaign, lambda force: 1.03 * force))
    assert best.space.names == ()
    mass = calibration["structure_mass"]
    assert mass.value == pytest.approx(1.03, abs=3.0 * mass.sd)
    assert abs(mass.value - 1.0) > 3.0 * mass.sd


@pytest.mark.slow
@pytest.mark.parametrize("seed", [710001, 710010])
def test_coarse_integration_is_named_alone_with_its_step(blind, seed):
    """Explicit Newmark with γ = 0.84, and forward Euler; a slightly late ground gives way to either."""
    folder, label = blind(seed, "single", "full", "integration_error", "white", 40.0)
    campaign = read_campaign(folder)
    block = BalanceBlock(campaign, scales_of(campaign, motions_of(campaign))).fix_ground_clock()
    segments = cut_segments(campaign.training, campaign.rate, block.highest_of)
    search = Search(Problem(block=block, segments=segments))
    best = search.run()
    assert best.space.names == ("integration_error",)
    assert [effect.name for effect in diagnose(campaign).effects] == ["integration_error"]
    *_calibration, damping, step = best.space.values(best.coordinates)
    truth = label.effects[0]
    # The curvature of the ground between samples is calibrated beside it and takes a part of it: 11 % here.
    assert step == pytest.approx(truth["parameters"]["step_s"]["value"], rel=0.15)
    assert damping == pytest.approx(truth["derived"]["numerical_damping_ratio"], rel=0.02)


def test_ground_thinned_to_every_second_sample_is_no_integration_error(sample_campaigns):
    """Between samples it runs in two straight lines, 1 − 2⁻² of the way from one line to a smooth curve."""
    campaign = read_campaign(sample_campaigns / "rig_c")
    block = BalanceBlock(campaign, scales_of(campaign, motions_of(campaign)))
    segments = cut_segments(campaign.training, campaign.rate, block.highest_of)
    search = Search(Problem(block=block, segments=segments))
    best = search.run()
    assert best.space.names == ()
    curvature, frequency, ratio, mass, offset = best.space.values(best.coordinates)
    assert frequency == pytest.approx(1.0, abs=0.002)
    assert ratio == pytest.approx(1.0, abs=0.02)
    assert curvature == pytest.approx(0.75, abs=0.05)
    assert mass == pytest.approx(1.0, abs=0.002)
    assert abs(offset) < 0.002 * block.scales.force


def test_wrong_structure_is_calibrated_and_no_integration_error(sample_campaigns):
    campaign = read_campaign(sample_campaigns / "rig_c")
    truth = campaign.structure
    wrong_structure = replace(
        truth, frequency=1.02 * truth.frequency, damping_ratio=1.2 * truth.damping_ratio
    )
    wrong = replace(campaign, structure=wrong_structure)
    block = BalanceBlock(wrong, scales_of(wrong, motions_of(wrong)))
    search = Search(Problem(block=block, segments=cut_segments(wrong.training, wrong.rate, block.highest_of)))
    best = search.run()
    assert best.space.names == ()
    _, frequency, ratio, _mass, _offset = best.space.values(best.coordinates)
    assert frequency * 1.02 == pytest.approx(1.0, abs=0.004)
    assert ratio * frequency * 1.2 * 1.02 == pytest.approx(1.0, abs=0.03)  # the damping coefficient


@pytest.mark.slow
@pytest.mark.parametrize("seed", [9500001, 9500254, 9500279])
def test_demands_above_half_of_the_controllers_rate_do_not_lengthen_its_step(tmp_path, seed):
    """A play lets the demand hold much above half of the controller's rate, which is folded below it.

    With models judged up to 45 Hz and to a record's end the steps came out 27 % too long, or as a third of
    their length, with a ratio of the time step of 0.9999 beside them.
    """
    label = generate(seed, tmp_path / "campaign", options=Options(with_rivals=False))
    effects = diagnose(read_campaign(tmp_path / "campaign")).to_dict()["effects"]
    assert {effect["name"] for effect in effects} == label.names
    wrong_structure = next(effect for effect in effects if effect["name"] == "integration_error")[
        "parameters"
    ]
    truth = next(effect for effect in label.effects if effect["name"] == "integration_error")
    assert wrong_structure["step_s"]["value"] == pytest.approx(
        truth["parameters"]["step_s"]["value"], rel=0.03
    )
    assert wrong_structure["numerical_damping_ratio"]["value"] == pytest.approx(
        truth["derived"]["numerical_damping_ratio"], rel=0.02
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [7100422, 7100503])
def test_forward_euler_in_a_narrow_band_is_neither_late_ground_nor_another_time_step(tmp_path, seed):
    """In the band that the command explains all three are delays; the first search, up to 45 Hz, tells them.

    Noise above that band must not speak against the model on held-out tests either.
    """
    options = Options(kind=Kind.SINGLE, effect="integration_error", with_rivals=False)
    generate(seed, tmp_path / "campaign", options=options)
    diagnosis = diagnose(read_campaign(tmp_path / "campaign"))
    assert [effect.name for effect in diagnosis.effects] == ["integration_error"]
    assert diagnosis.blocks[-1].gap.after < 0.8 * diagnosis.blocks[-1].gap.before
