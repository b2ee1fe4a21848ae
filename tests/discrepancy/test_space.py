"""What the parameters of a model may be."""

import pytest

from reliab.discrepancy import read_campaign
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.spectra.scales import motions_of, scales_of
from reliab.loop.effects import find_effect


@pytest.mark.parametrize("name", ["viscous_damping", "added_mass"])
def test_no_more_is_missing_of_damping_and_mass_than_there_is(sample_campaigns, name):
    campaign = read_campaign(sample_campaigns / "rig_b")
    motions = motions_of(campaign)
    block = SpecimenBlock(campaign, scales_of(campaign, motions), motions)
    space = ModelSpace(block, (find_effect(name),))
    least = space.values(space.bounds[0])[space.places(find_effect(name))][0]
    specimen = block.nominal.specimen
    believed = {"viscous_damping": specimen.damping, "added_mass": specimen.mass}[name]
    assert least == pytest.approx(-believed)
