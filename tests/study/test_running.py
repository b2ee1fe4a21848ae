"""A study ends in a report, and does nothing twice."""

import csv
import datetime as dt
import json
import shutil
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.files import UNFINISHED
from reliab.core.progress import shows_tasks
from reliab.criterion.laws.registry import FITTED_LAWS
from reliab.criterion.scope import read_versions
from reliab.report.document import Points, Section
from reliab.report.prose import plain_text
from reliab.study import stages
from reliab.study.kinds import KINDS
from reliab.study.running import run_study, study_from, write_report
from reliab.study.stages import RunFolder, Stage
from reliab.study.steps import ELLIPSES, candidates
from reliab.sweep.ellipse_dataset import open_ellipses

pytestmark = pytest.mark.usefixtures("blank_figures")


@pytest.fixture(scope="module")
def progress_calls():
    """Tasks that a run has shown, with the calls of the progress of each."""
    return {}


@pytest.fixture(scope="module")
def complete_run(tmp_path_factory, small_study, progress_calls, blank_figures):  # noqa: ARG001 - before it
    @contextmanager
    def show(task):
        calls = progress_calls.setdefault(task, [])
        yield lambda *call: calls.append(call)

    folder = tmp_path_factory.mktemp("finished") / "run"
    with shows_tasks(show):
        run_study(small_study, folder)
    return folder


@pytest.fixture
def run_copy(complete_run, tmp_path):
    return shutil.copytree(complete_run, tmp_path / "run")


def stages_of(study, folder):
    finished_stages = {}
    run_study(study, folder, tell=finished_stages.__setitem__)
    return {name for name, success in finished_stages.items() if success}


@pytest.mark.slow
@pytest.mark.usefixtures("complete_run")
def test_every_long_task_is_shown_in_words_and_to_its_end(progress_calls):
    assert "Cross-validating, k fold" in progress_calls
    assert not [task for task in progress_calls if "_" in task]
    assert all(calls[-1][0] == calls[-1][1] > 0 for calls in progress_calls.values() if calls)
    assert progress_calls["Cross-validating, k fold"]


@pytest.mark.slow
def test_a_finished_study_is_not_run_again(run_copy, small_study):
    report = (run_copy / "report.pdf").read_bytes()
    assert stages_of(small_study, run_copy) == set()
    assert (run_copy / "report.pdf").read_bytes() == report


@pytest.mark.slow
def test_only_dependents_of_a_change_run_again(run_copy, small_study):
    criterion = small_study.criterion.model_copy(update={"confidences": (0.7,)})
    variant = small_study.model_copy(update={"criterion": criterion})
    assert stages_of(variant, run_copy) == {"derive", "validate", "real motions", "report"}


@pytest.mark.slow
def test_damaged_file_is_made_again(run_copy, small_study):
    (run_copy / "ellipses.nc").write_bytes(b"")
    assert "trace" in stages_of(small_study, run_copy)


@pytest.mark.slow
def test_the_report_can_be_made_again_from_the_folder_alone(run_copy):
    first = (run_copy / "report.pdf").read_bytes()
    (run_copy / "report.pdf").unlink()
    assert write_report(run_copy).read_bytes() == first


def copies_lacking_a_key(content, levels=3):
    """Copies of nested JSON without one key of the uppermost levels; of a list the first entry is tried."""
    if isinstance(content, list) and levels:
        yield from (
            ([first, *content[1:]] for first in copies_lacking_a_key(content[0], levels - 1))
            if content
            else ()
        )
    elif isinstance(content, dict) and levels:
        for key, value in content.items():
            yield {name: part for name, part in content.items() if name != key}
            yield from ({**content, key: part} for part in copies_lacking_a_key(value, levels - 1))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["criteria.json", "validation.json"])
def test_a_file_of_a_run_without_one_of_its_keys_is_refused_or_does_without(run_copy, monkeypatch, name):
    """No other error than `InputError` ends a report, whatever key of a file somebody left out."""
    text = []
    monkeypatch.setattr("reliab.study.running.write_pdf", lambda document, *_, **__: text.append(document))
    content = json.loads((run_copy / name).read_text())
    refusal = 0
    for variant in copies_lacking_a_key(content):
        (run_copy / name).write_text(json.dumps(variant))
        try:
            write_report(run_copy)
        except InputError:
            refusal += 1
    (run_copy / name).write_text("7")
    with pytest.raises(InputError):
        write_report(run_copy)
    assert refusal or name == "validation.json"  # which is empty where nothing was refused


def test_a_missing_key_is_named(run_copy):
    (run_copy / "criteria.json").write_text('{"criteria": []}')
    with pytest.raises(InputError, match=r"files of a run must be as .* found no 'refusals'"):
        write_report(run_copy)


@pytest.mark.slow
def test_resumed_run_has_the_same_bytes(run_copy, tmp_path, small_study, monkeypatch):
    from reliab.study import steps

    def kill(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(steps, "write_ellipses", kill)
        with pytest.raises(KeyboardInterrupt):
            run_study(small_study, tmp_path / "again")
    assert stages_of(small_study, tmp_path / "again") == {
        "trace",
        "derive",
        "validate",
        "real motions",
        "report",
    }
    assert (tmp_path / "again" / "report.pdf").read_bytes() == (run_copy / "report.pdf").read_bytes()


@pytest.mark.slow
def test_boundaries_of_shipped_records_keep_their_ratios(run_copy, small_study, monkeypatch):
    """A study of such records ended in an error of xarray: the ratios were measured once more and merged."""

    def ratios_of(ellipses):
        structures = ("motion", "f", "xi", "length")
        ratios = np.ones([*(ellipses.sizes[name] for name in structures[:3]), 1])
        return ellipses.assign(a_cut=(structures, ratios), b_cut=(structures, ratios), length=[10.0])

    monkeypatch.setattr("reliab.sweep.results_accessor.add_known_cut_records", ratios_of)
    (run_copy / ELLIPSES).unlink()
    assert "trace" in stages_of(small_study, run_copy)
    with open_ellipses(run_copy / ELLIPSES) as ellipses:
        assert (ellipses["a_cut"] == 1.0).all()


def test_a_folder_with_other_files_is_left_alone(tmp_path, small_study):
    (tmp_path / "thesis.docx").write_bytes(b"precious")
    with pytest.raises(InputError, match="no run of a study wrote"):
        run_study(small_study, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.docx"]


def test_a_report_needs_a_run(tmp_path):
    with pytest.raises(InputError, match="reliab run"):
        write_report(tmp_path)


@pytest.mark.parametrize(
    "name", ["criteria.json", "manifest.json", "report.pdf", "results.zarr/rms", ".lock"]
)
def test_link_in_a_run_folder_is_not_written_through(tmp_path, small_study, name):
    """A run folder may come from somewhere else, with a link to any file of whoever goes on with it."""
    run, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    elsewhere.write_text("a file that is not the run's", encoding="utf-8")
    link = tmp_path / "run.lock" if name == ".lock" else run / name
    link.parent.mkdir(parents=True, exist_ok=True)
    link.symlink_to(elsewhere)
    with pytest.raises(InputError, match="must not contain links"):
        run_study(small_study, run)
    if name != ".lock":
        with pytest.raises(InputError, match="must not contain links"):
            write_report(run)
    assert elsewhere.read_text(encoding="utf-8") == "a file that is not the run's"


@pytest.mark.slow
def test_stored_results_answer_only_for_their_structures(tmp_path, small_study):
    archive = small_study.motions.model_copy(update={"sources": None, "results": "real_suite"})
    structures = small_study.structures.model_copy(update={"f": (7.0,)})
    study = small_study.model_copy(update={"motions": archive, "structures": structures})
    with pytest.raises(InputError, match="stored results hold no such structures"):
        run_study(study, tmp_path / "run")


@pytest.mark.slow
def test_results_keep_their_day_and_packages(run_copy, small_study, monkeypatch):
    manifest = json.loads((run_copy / "manifest.json").read_text(encoding="utf-8"))
    for entry in manifest["stages"].values():
        entry["packages"], entry["date"] = {"numpy": "1.2.3"}, "2020-02-03"
    (run_copy / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    assert stages.software_provenance(run_copy) == {"packages": {"numpy": "1.2.3"}}
    assert stages.date_of(run_copy) == dt.date(2020, 2, 3)
    document = KINDS["criterion"].report(small_study, run_copy)
    assert document.provenance["packages"] == "numpy 1.2.3"
    (run_copy / "criteria.json").unlink()
    monkeypatch.setattr("reliab.study.running.write_pdf", lambda _, path, **_options: path.touch())
    run_study(small_study, run_copy)
    assert set(stages.software_provenance(run_copy)["packages"]) == {
        "simulate",
        "trace",
        "derive",
        "validate",
        "real motions",
    }


def test_drawing_stage_reports_packages_of_earlier_stages(tmp_path):
    """A stage has no packages of its own while it works; the report that it draws names the others'."""
    folder = RunFolder(tmp_path / "run", study={})
    message = []
    first = Stage(name="diagnose", inputs={}, writes=(), work=lambda _: None)
    folder.perform(first)
    folder.perform(
        Stage(
            name="draw",
            inputs={},
            writes=(),
            work=lambda run: message.append(stages.software_provenance(run)),
        )
    )
    assert message == [{"packages": read_versions()}]


def test_run_of_other_code_is_not_resumed(tmp_path):
    folder = RunFolder(tmp_path / "run", study={})
    observation = []

    def work(path):
        observation.append((path / "half").exists())
        (path / "half").write_text("x", encoding="utf-8")
        if len(observation) < 3:
            raise KeyboardInterrupt

    def attempt(code):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(stages, "code_digest", lambda: code)
            folder.perform(Stage(name="s", inputs={}, writes=("half",), work=work))

    for code in ("a", "a"):
        with pytest.raises(KeyboardInterrupt):
            attempt(code)
    attempt("b")
    attempt("b")
    assert observation == [False, True, False]  # resumed, removed since the code differs, then done for good


def test_study_judges_its_reported_law(small_study):
    fit = small_study.criterion.model_copy(update={"law": "dimensionless", "method": "dirichlet"})
    original: Any = candidates(small_study.errors, fit)[0]
    assert original.law is FITTED_LAWS["dimensionless"]
    assert original.name == "dirichlet, dimensionless"
    samples = small_study.criterion.model_copy(update={"method": "hierarchical"})
    assert candidates(small_study.errors, samples)[0].method.name == "hierarchical"  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.of_studies
def test_report_of_two_earthquakes_states_its_limits(tmp_path, suite_folder):
    study = study_from(
        {
            "title": "Two earthquakes",
            "kind": "validation",
            "date": "2026-01-01",
            "motions": {"sources": [str(suite_of(2, suite_folder, tmp_path))]},
            "criterion": {"confidences": [0.99]},
            "validation": {
                "schemes": ["k_fold", "random_halves"],
                "confidences": [0.9],
                "trials": 64,
                "rebuilt_error_trials": 0,
            },
        }
    )
    assert run_study(study, tmp_path / "run").read_bytes().startswith(b"%PDF")
    document = KINDS["validation"].report(study, tmp_path / "run")
    text = plain(document)
    assert "at least 5 earthquakes" in text
    assert "at least 4 earthquakes" in text
    assert (tmp_path / "run" / "ellipses.nc").exists()


@pytest.mark.slow
def test_a_report_is_titled_after_its_data_and_dated_today(run_copy, small_study):
    dateless = small_study.model_copy(update={"date": None})
    document = KINDS["criterion"].report(dateless, run_copy)
    assert document.title == "A small study: ground motions"
    assert stages.date_of(run_copy) == dt.datetime.now(tz=dt.UTC).date()
    synthetic = small_study.on(["synthetic"], None)
    verdict = plain_text(KINDS["criterion"].report(synthetic, run_copy).verdict)
    assert "80 % of synthetic ground motions" in verdict
    assert "real motions of" in plain_text(document.facts["On real motions"])


def suite_of(events, suite_folder, tmp_path):
    """A small suite whose motions are of few earthquakes."""
    rows = list(csv.DictReader((suite_folder / "catalog.csv").read_text(encoding="utf-8").splitlines()))[:6]
    folder = shutil.copytree(suite_folder, tmp_path / "suite")
    with (folder / "catalog.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows({**row, "event": f"E{number % events}"} for number, row in enumerate(rows))
    return folder


def plain(document):
    """Text of the points of a report."""
    sections = [block for block in document.blocks if isinstance(block, Section)]
    points = [block for section in sections for block in section.blocks if isinstance(block, Points)]
    return " ".join(plain_text(item) for point in points for item in point.items)


def test_partial_files_are_removed_on_resuming(tmp_path):
    run = tmp_path / "run"
    with RunFolder.open(run, study={"kind": "criterion"}):
        pass
    (run / "folder").mkdir()
    for place in (run, run / "folder"):
        (place / f"{UNFINISHED}0").write_text("half")
    with RunFolder.open(run, study={"kind": "criterion"}):
        pass
    assert not [path for path in run.rglob("*") if path.name.startswith(UNFINISHED)]
