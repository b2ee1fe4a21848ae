"""A force of another sign or unit is refused, one of another stiffness is not."""

from contextlib import nullcontext

import numpy as np
import pandas as pd
import pytest

from reliab.assessment.recorded_force import require_restoring_force
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose

FACTORS = {"sign": -1.0, "none": 1.0}


@pytest.fixture
def damper(tmp_path):
    """Function that writes a campaign of a linear damper whose force is multiplied."""

    def write(factor):
        folder = tmp_path / "damper"
        folder.mkdir()
        rows = ['name = "damper"\n[specimen]\ndamping_n_s_per_m = 100.0\n[sampling]\nrate_hz = 200\n']
        source = shipped("datasets", "campaigns/rig_a")
        for place, path in enumerate(sorted(source.glob("*.csv"))):
            test = pd.read_csv(path)
            time = pd.Series(range(2000)) / 200.0
            displacement = test["measured_m"][:2000].rolling(21, center=True, min_periods=1).mean()
            force = factor * 100.0 * displacement.diff().fillna(0.0) * 200.0
            table = pd.DataFrame({"time_s": time, "measured_m": displacement, "force_n": force})
            table.to_csv(folder / path.name, index=False)
            rows.append(f'[[tests]]\nfile = "{path.name}"\nmotion = "{place}"\n')
        (folder / "campaign.toml").write_text("".join(rows), encoding="utf-8")
        return folder

    return write


def test_energy_delivering_specimen_is_refused(damper):
    with pytest.raises(InputError, match="does not resist the motion") as refusal:
        diagnose(read_campaign(damper(FACTORS["sign"])))
    assert refusal.value.where is not None
    assert "positive where the specimen resists" in str(refusal.value)


@pytest.mark.parametrize(("stated_value", "refusal"), [(9.8, True), (8.9, False), (0.2, False)])
def test_stated_stiffness_is_a_first_value_unless_it_is_off_by_a_unit(stated_value, refusal):
    """A force in kilograms-force makes it 9.81 times too large; a calibration finds any other factor."""
    time = np.arange(0.0, 20.0, 0.005)
    displacement = np.sin(6.0 * time) * np.sin(0.15 * time)
    with pytest.raises(InputError, match="kilograms-force") if refusal else nullcontext():
        require_restoring_force(
            displacement, 40.0 * displacement, 0.005, stiffness=40.0 * stated_value, is_stiffness_fitted=True
        )


@pytest.mark.slow
def test_resisting_specimen_raises_no_doubt_of_its_sign(damper):
    assert not any("sign of" in remark for remark in diagnose(read_campaign(damper(FACTORS["none"]))).remarks)
