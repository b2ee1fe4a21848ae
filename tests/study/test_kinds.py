"""Every kind of study ends in a report with its verdict."""

import json

import pytest

from reliab.errors import InputError
from reliab.study import open_study, run_study, study_from


def small(name, suite_folder, **tables):
    """A shipped study on few motions and structures."""
    study = open_study(name)
    validation = {"confidences": [0.5, 0.9], "trials": 64}
    if "schemes" in study.validation.model_dump():
        validation["schemes"] = ["k_fold"]
    changes = {
        "motions": {"sources": [str(suite_folder)]},
        "structures": {"f": [1.0], "xi": [0.02]},
        "validation": validation,
        "criterion": {**study.criterion.model_dump(), "confidences": [0.5]},
    }
    return study_from({**study.model_dump(), **changes, **tables})


@pytest.mark.parametrize("name", ["validation", "synthetic_vs_real"])
def test_shipped_studies_run_on_other_motions(name, suite_folder, tmp_path):
    report = run_study(small(name, suite_folder), tmp_path / "run")
    assert report.read_bytes().startswith(b"%PDF")


def test_a_campaign_is_diagnosed(tmp_path):
    report = run_study(open_study("hidden_effect"), tmp_path / "run")
    assert report.read_bytes().startswith(b"%PDF")
    found = json.loads((tmp_path / "run" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] in {"named", "no_missing_effect", "unknown_effect", "not_identifiable"}


def test_what_blind_campaigns_showed_is_reported(tmp_path):
    report = run_study(open_study("blind_evaluation"), tmp_path / "run")
    assert report.read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("name", ["paper2017", "table2_audit"])
def test_studies_of_the_paper_need_its_records(name, tmp_path):
    with pytest.raises(InputError, match="--motions"):
        run_study(open_study(name), tmp_path / "run")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper2017", "table2_audit"])
def test_studies_of_the_paper_run_on_its_records(name, real_motions_folder, tmp_path):
    study = open_study(name).on([str(real_motions_folder)], None)
    assert run_study(study, tmp_path / "run").read_bytes().startswith(b"%PDF")
