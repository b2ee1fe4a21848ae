"""A force with the wrong sign is told by the energy that the specimen would deliver."""

import pandas as pd
import pytest

from reliab.discrepancy import diagnose, read_campaign
from reliab.shipped import shipped

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
            moved = test["measured_m"][:2000].rolling(21, center=True, min_periods=1).mean()
            force = factor * 100.0 * moved.diff().fillna(0.0) * 200.0
            table = pd.DataFrame({"time_s": time, "measured_m": moved, "force_n": force})
            table.to_csv(folder / path.name, index=False)
            rows.append(f'[[tests]]\nfile = "{path.name}"\nmotion = "{place}"\n')
        (folder / "campaign.toml").write_text("".join(rows), encoding="utf-8")
        return folder

    return write


@pytest.mark.parametrize(("fault", "told"), [("sign", True), ("none", False)])
def test_a_specimen_that_delivers_energy_is_told(damper, fault, told):
    campaign = read_campaign(damper(FACTORS[fault]))
    assert all((test.absorbed < -0.9) is told for test in campaign.tests)
    assert any("sign of force_n" in remark for remark in diagnose(campaign).remarks) is told
