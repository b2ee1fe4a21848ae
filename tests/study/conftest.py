"""A small suite on disk and a study of it."""

import pytest

from reliab.motions.synthetic import synthetic_suite
from reliab.motions.writing import write_suite
from reliab.study import study_from


@pytest.fixture(scope="session")
def suite_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study") / "suite"
    write_suite(synthetic_suite(count=16), folder)
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
