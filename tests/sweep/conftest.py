"""A small suite and a small sweep."""

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.run import run_sweep
from reliab.tracking.indices.window import Window


@pytest.fixture(scope="session")
def suite() -> MotionSuite:
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 12.0, 0.01)
    envelope = (t / 4.0) ** 2 * np.exp(-t / 2.0)
    return MotionSuite.from_motions(
        Motion(
            name=f"E{k // 2}/H{k % 2}",
            acceleration=np.convolve(rng.standard_normal(t.size), np.ones(4) / 4, "same") * envelope,
            time_step=0.01,
            event=f"E{k // 2}",
        )
        for k in range(6)
    )


@pytest.fixture(scope="session")
def request_() -> SweepRequest:
    return SweepRequest(
        frequencies=(0.5, 1.0),
        damping_ratios=(0.02, 0.05),
        grid=ScaledGrid(gain_steps=14, delay_steps=20),
        windows=(Window(), Window.parse("arias")),
    )


@pytest.fixture(scope="session")
def store(tmp_path_factory, suite, request_):
    """The sweep in a store, which is only read."""
    return run_sweep(suite, request_, tmp_path_factory.mktemp("sweep") / "results.zarr")


@pytest.fixture
def own_store(tmp_path, store):
    """The same store for a test to change."""
    return Path(shutil.copytree(store, tmp_path / "results.zarr"))


@pytest.fixture(scope="session")
def contents() -> Callable[[Path], dict[str, str]]:
    """Digest of every file of a folder."""
    return lambda path: {
        str(file.relative_to(path)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(path.rglob("*"))
        if file.is_file()
    }
