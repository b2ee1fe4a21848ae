"""Every kind of study ends in a report with its verdict."""

import json
import shutil
from typing import Any

import pandas as pd
import pytest

from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.study.kinds import KINDS
from reliab.study.kinds.discrepancy import CampaignTable
from reliab.study.running import open_study, run_study, study_from, write_report

pytestmark = pytest.mark.of_studies


def small(name, suite_folder, **tables):
    """A shipped study on few motions and structures."""
    study: Any = open_study(name)
    validation = {"confidences": [0.5, 0.9], "trials": 64}
    if "schemes" in study.validation.model_dump():
        validation["schemes"] = ["k_fold"]
    if name == "validation":
        validation["rebuilt_error_trials"] = 0  # its section and its stage have tests of their own
    changes = {
        "motions": {"sources": [str(suite_folder)]},
        "structures": {"f": [1.0], "xi": [0.02]},
        "validation": validation,
        "criterion": {**study.criterion.model_dump(), "confidences": [0.5]},
    }
    return study_from({**study.model_dump(), **changes, **tables})


def text_of_run(study, folder, text_of):
    """What a reader reads in the report of a finished run."""
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF")
    return text_of(KINDS[study.kind].report(study, folder))


@pytest.mark.parametrize(
    ("name", "sentences"),
    [
        pytest.param(
            "validation",
            ("held-out earthquakes", "Actuators that are not a constant gain and delay"),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "synthetic_vs_real", ("Response spectra", "Criteria of the suites"), marks=pytest.mark.slow
        ),
    ],
)
def test_shipped_studies_run_on_other_motions(name, sentences, suite_folder, tmp_path, text_of):
    study = small(name, suite_folder)
    run_study(study, tmp_path / "run")
    text = text_of_run(study, tmp_path / "run", text_of)
    assert study.title in text
    assert all(sentence in text for sentence in sentences)


@pytest.mark.slow
def test_a_validation_rebuilds_the_errors_of_tests(suite_folder, tmp_path, text_of):
    study = small("validation", suite_folder)
    table = study.validation.model_copy(update={"rebuilt_error_trials": 1})
    study = study.model_copy(update={"validation": table})
    run_study(study, tmp_path / "run")
    assert "The error of the test itself" in text_of_run(study, tmp_path / "run", text_of)
    tests = pd.read_csv(tmp_path / "run" / "rebuilt_error_tests.csv")
    assert tests["test"].nunique() == 11


@pytest.mark.slow
def test_a_campaign_is_diagnosed_and_reported_from_the_folder_alone(tmp_path, text_of):
    campaign = tmp_path / "campaign"
    shutil.copytree(shipped("datasets", "campaigns/rig_c"), campaign)
    study = open_study("hidden_effect")
    study = study.model_copy(update={"campaign": CampaignTable(folder=str(campaign))})
    folder = tmp_path / "run"
    first = run_study(study, folder).read_bytes()
    diagnosis = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    assert diagnosis["verdict"] in {"named", "no_missing_effect", "unknown_effect", "not_identifiable"}
    shutil.rmtree(campaign)
    (folder / "report.pdf").unlink()
    assert write_report(folder).read_bytes() == first
    text = text_of_run(study, folder, text_of)
    assert study.title in text or study.purpose in text
    assert "held-out tests" in text


def test_failing_figures_leave_the_diagnosis(tmp_path, monkeypatch):
    def fail(*_args, **_kwargs):
        raise ValueError("Number of rows must be positive")

    monkeypatch.setattr("reliab.report.kinds.discrepancy_report.discrepancy_report", fail)
    monkeypatch.setattr("reliab.study.kinds.discrepancy._diagnose", lambda *_: Namespace())
    study = open_study("hidden_effect")
    with pytest.raises(ValueError, match="rows"):
        run_study(study, tmp_path / "run")
    assert json.loads((tmp_path / "run" / "diagnosis.json").read_text(encoding="utf-8")) == {
        "verdict": "named"
    }


class Namespace:
    """A diagnosis that is only its result."""

    diagnosis, posteriors = None, ()

    def to_dict(self):
        return {"verdict": "named"}


@pytest.mark.slow
def test_results_of_blind_campaigns_are_reported(tmp_path, text_of):
    study = open_study("blind_evaluation")
    run_study(study, tmp_path / "run")
    text = text_of_run(study, tmp_path / "run", text_of)
    assert study.title in text
    assert "campaigns" in text


@pytest.mark.parametrize("name", ["paper2017", "table2_audit"])
def test_studies_of_the_paper_need_its_records(name, tmp_path):
    with pytest.raises(InputError, match="`motions`"):
        run_study(open_study(name), tmp_path / "run")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper2017", "table2_audit"])
def test_studies_of_the_paper_run_on_its_records(name, real_motions_folder, tmp_path, text_of):
    study = open_study(name).replace_motions([str(real_motions_folder)], None)
    run_study(study, tmp_path / "run")
    text = text_of_run(study, tmp_path / "run", text_of)
    assert "74 of the 100 rows" in text or "74 of 100 rows" in text
    assert "3 rows" in text or "only 3" in text
