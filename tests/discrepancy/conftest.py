"""Fixtures of the discrepancy room: small campaigns of known content, and blind ones."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

TOML = """name = "small"
[structure]
frequency_hz = 1.0
damping_ratio = 0.05
mass_kg = 1000.0
[actuator]
gain = 1.0
delay_s = 0.005
[sampling]
rate_hz = 256
[[tests]]
file = "a.csv"
[[tests]]
file = "b.csv"
"""


@pytest.fixture
def small_campaign(tmp_path):
    """A readable campaign folder of two tests, for a test to spoil."""
    (tmp_path / "campaign.toml").write_text(TOML, encoding="utf-8")
    time = np.arange(2048) / 256.0
    random = np.random.default_rng(5)
    for name in ("a.csv", "b.csv"):
        command = 0.01 * np.sin(2.0 * np.pi * time)
        measured = 0.01 * np.sin(2.0 * np.pi * (time - 0.005)) + 1e-5 * random.normal(size=time.size)
        table = pd.DataFrame({"time_s": time, "command_m": command, "measured_m": measured})
        table.to_csv(tmp_path / name, index=False)
    return tmp_path


@pytest.fixture
def sample_campaigns():
    """The folder of the campaigns that ship."""
    return ROOT / "datasets" / "campaigns"


@pytest.fixture(scope="session")
def blind(tmp_path_factory):
    """Make a blind campaign of given kind; returns its folder and its label."""
    from blind_campaigns.campaign import Options, generate
    from blind_campaigns.case import Observation
    from blind_campaigns.kinds import Kind

    def make(seed, kind, observation, effect=None, noise="white", snr=35.0):
        folder = tmp_path_factory.mktemp("blind") / f"campaign_{seed}"
        options = Options(
            kind=Kind(kind), observation=Observation(observation), effect=effect, noise_kind=noise,
            snr_db=snr, with_rivals=False,
        )  # fmt: skip
        return folder, generate(seed, folder, options=options)

    return make
