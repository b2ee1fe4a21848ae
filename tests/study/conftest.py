"""A small suite on disk and a study of it."""

import numpy as np
import pytest

from reliab.motions.catalogue import write_suite
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.study.running import study_from


@pytest.fixture(scope="session")
def suite_folder(tmp_path_factory):
    """Both components of six earthquakes, short ones: every study simulates them."""
    rng = np.random.default_rng(16)
    t = np.arange(0.0, 8.0, 0.02)
    suite = MotionSuite.from_motions(
        Motion(
            name=f"E{number // 2}/H{number % 2}",
            event=f"E{number // 2}",
            acceleration=np.convolve(rng.standard_normal(t.size), np.ones(8), "same")
            * np.sin(np.pi * t / t[-1]) ** 2,
            time_step=0.02,
        )
        for number in range(12)
    )
    folder = tmp_path_factory.mktemp("study") / "suite"
    write_suite(suite, folder)
    return folder


@pytest.fixture(scope="session")
def small_study(suite_folder):
    return study_from(
        {
            "title": "A small study",
            "kind": "criterion",
            "date": "2026-01-01",
            "motions": {"sources": [str(suite_folder)]},
            "structures": {"f": [1.0], "xi": [0.02, 0.05]},
            "criterion": {"confidences": [0.8, 0.6], "method": "quantile", "joint": False},
            "validation": {"schemes": ["k_fold"], "confidences": [0.6, 0.8], "trials": 64},
        }
    )
