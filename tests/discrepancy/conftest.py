"""Fixtures of the discrepancy room: small campaigns of known content, and blind ones."""

from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose

ROOT = Path(__file__).resolve().parents[2]

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
        reading = 0.01 * np.sin(2.0 * np.pi * (time - 0.005)) + 1e-5 * random.normal(size=time.size)
        table = pd.DataFrame({"time_s": time, "command_m": command, "measured_m": reading})
        table.to_csv(tmp_path / name, index=False)
    return tmp_path


@pytest.fixture
def sample_campaigns():
    """The folder of the campaigns that ship."""
    return ROOT / "datasets" / "campaigns"


@pytest.fixture(scope="session")
def blas_threads():
    """Threads of linear algebra before, while and after `diagnosis_of` has diagnosed."""
    return {"before": [], "while": [], "after": []}


@pytest.fixture(scope="session")
def diagnosis_of(blas_threads):
    """Function that diagnoses a campaign that ships, each once."""

    def look(moment):
        pools = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
        blas_threads[moment].append([pool["num_threads"] for pool in pools])

    @cache
    def diagnose_sample(name):
        campaign = read_campaign(ROOT / "datasets" / "campaigns" / name)
        two_threads = patch.dict("os.environ", OMP_NUM_THREADS="2")
        with two_threads, threadpool_limits(2, user_api="blas"):
            look("before")
            diagnosis = diagnose(
                campaign, progress=lambda count, total: look("while") if count < total else None
            )
            look("after")
        return diagnosis

    return diagnose_sample


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
