"""The study of nonlinear specimens: simulated, from stored results, and refused where these are of others."""

import numpy as np
import pandas as pd
import pytest
from reliab_studies.ductility.kind import KIND, LEVELS, LIMITS, TESTS
from reliab_studies.ductility.specimens import SPECIMENS
from reliab_studies.ductility.tolerances import DIRECTIONS, compare_levels, compare_limits

from reliab.core.errors import InputError
from reliab.report.document import Table


def study_of(**tables):
    structures = {"f": [1.0], "xi": [0.02]}
    content = {"title": "Ductility", "kind": "ductility", "structures": structures, **tables}
    return KIND.tables.model_validate(content)


@pytest.fixture
def results_folder(tmp_path):
    """Results of 40 motions under which a specimen tolerates half of the delay and twice the gain."""
    names = [f"m{number}" for number in range(40)]
    tests = pd.DataFrame(
        {
            "motion": names,
            "event": names,
            "f": 1.0,
            "xi": 0.02,
            "specimen": "cubic",
            "level": 0.1,
            "ductility": float("nan"),
            "linear_delay_ms": 1.5,
            "linear_large": 0.01,
            "linear_small": 0.01,
            **dict.fromkeys(DIRECTIONS, 2.0),
            "late": 0.5,
        }
    )
    compare_levels(tests).to_csv(tmp_path / LEVELS, index=False)
    compare_limits(tests).assign(alpha=1.0, threshold=0.05).to_csv(tmp_path / LIMITS, index=False)
    return tmp_path


def tables_of(document):
    sections = {section.title: section for section in document.blocks if hasattr(section, "title")}
    return {
        block.label: block.frame
        for section in sections.values()
        for block in section.blocks
        if isinstance(block, Table)
    }


def test_a_report_of_stored_results_tells_their_content(results_folder, tmp_path):
    study = study_of(motions={"results": str(results_folder)})
    (stage,) = KIND.stages(study)
    folder = tmp_path / "run"
    folder.mkdir()
    stage.work(folder)
    document = KIND.report(study, folder)
    tables = tables_of(document)
    (row,) = tables["tab:levels"].to_dict(orient="records")
    assert (row["late"], row["large"], row["narrower"], row["tests"]) == (0.5, 2.0, 1.0, 40)
    (row,) = tables["tab:limits"].to_dict(orient="records")
    assert row["delay_least"] == row["delay_most"] == pytest.approx(0.5)
    assert row["gain_least"] == pytest.approx(2.0)
    assert "100.0 %" in document.verdict[0]
    assert "not the worst case" in document.verdict[0]


@pytest.mark.parametrize(
    "tables",
    [
        {"structures": {"f": [2.0], "xi": [0.02]}},
        {"structures": {"f": [1.0], "xi": [0.02], "experimental_fraction": 0.5}},
        {"ductility": {"threshold": 0.1}},
    ],
)
def test_stored_results_of_others_are_refused(results_folder, tables):
    with pytest.raises(InputError, match="answer for the structures and the error of their own run"):
        KIND.stages(study_of(motions={"results": str(results_folder)}, **tables))


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(InputError, match="no levels"):
        KIND.stages(study_of(motions={"results": str(tmp_path)}))


@pytest.mark.slow
def test_a_study_of_few_motions_simulates_and_states_no_limit(tmp_path):
    times = np.arange(0.0, 6.0, 0.02)
    shaking = np.sin(2.0 * np.pi * times) * np.exp(-0.5 * times)
    record = pd.DataFrame({"time_s": times, "acceleration_m/s2": shaking})
    record.to_csv(tmp_path / "record.csv", index=False)
    study = study_of(motions={"sources": [str(tmp_path / "record.csv")]})
    (stage,) = KIND.stages(study)
    stage.work(tmp_path)
    tests = pd.read_csv(tmp_path / TESTS)
    assert len(tests) == len(SPECIMENS)
    assert pd.read_csv(tmp_path / LIMITS)["delay_ms"].isna().all()
    assert "tab:limits" not in tables_of(KIND.report(study, tmp_path))
