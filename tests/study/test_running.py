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
from reliab.criterion.laws.registry import FITTED_LAWS
from reliab.criterion.provenance import read_versions
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
def shown():
    """Tasks that a run has shown, with the calls of the progress of each."""
    return {}


@pytest.fixture(scope="module")
def finished_once(tmp_path_factory, small_study, shown, blank_figures):  # noqa: ARG001 - before it
    @contextmanager
    def show(task):
        calls = shown.setdefault(task, [])
        yield lambda *call: calls.append(call)

    folder = tmp_path_factory.mktemp("finished") / "run"
    run_study(small_study, folder, show=show)
    return folder


@pytest.fixture
def finished(finished_once, tmp_path):
    return shutil.copytree(finished_once, tmp_path / "run")


def stages_of(study, folder):
    done = {}
    run_study(study, folder, tell=done.__setitem__)
    return {name for name, worked in done.items() if worked}


@pytest.mark.slow
@pytest.mark.usefixtures("finished_once")
def test_every_long_task_is_shown_in_words_and_to_its_end(shown):
    assert "Cross-validating, k fold" in shown
    assert not [task for task in shown if "_" in task]
    assert all(calls[-1][0] == calls[-1][1] > 0 for calls in shown.values() if calls)
    assert shown["Cross-validating, k fold"]


@pytest.mark.slow
def test_a_finished_study_is_not_run_again(finished, small_study):
    report = (finished / "report.pdf").read_bytes()
    assert stages_of(small_study, finished) == set()
    assert (finished / "report.pdf").read_bytes() == report


@pytest.mark.slow
def test_only_what_depends_on_a_change_is_done_again(finished, small_study):
    criterion = small_study.criterion.model_copy(update={"confidences": (0.7,)})
    changed = small_study.model_copy(update={"criterion": criterion})
    assert stages_of(changed, finished) == {"derive", "validate", "real motions", "report"}


@pytest.mark.slow
def test_a_file_that_was_damaged_is_made_again(finished, small_study):
    (finished / "ellipses.nc").write_bytes(b"")
    assert "trace" in stages_of(small_study, finished)


@pytest.mark.slow
def test_the_report_can_be_made_again_from_the_folder_alone(finished):
    first = (finished / "report.pdf").read_bytes()
    (finished / "report.pdf").unlink()
    assert write_report(finished).read_bytes() == first


def without_a_key(content, levels=3):
    """Copies of nested JSON without one key of the uppermost levels; of a list the first entry is tried."""
    if isinstance(content, list) and levels:
        yield from (
            ([first, *content[1:]] for first in without_a_key(content[0], levels - 1)) if content else ()
        )
    elif isinstance(content, dict) and levels:
        for key, value in content.items():
            yield {name: part for name, part in content.items() if name != key}
            yield from ({**content, key: part} for part in without_a_key(value, levels - 1))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["criteria.json", "validation.json"])
def test_a_file_of_a_run_without_one_of_its_keys_is_refused_or_does_without(finished, monkeypatch, name):
    """No other error than `InputError` ends a report, whatever key of a file somebody left out."""
    written = []
    monkeypatch.setattr("reliab.study.running.write_pdf", lambda document, *_, **__: written.append(document))
    content = json.loads((finished / name).read_text())
    refused = 0
    for changed in without_a_key(content):
        (finished / name).write_text(json.dumps(changed))
        try:
            write_report(finished)
        except InputError:
            refused += 1
    (finished / name).write_text("7")
    with pytest.raises(InputError):
        write_report(finished)
    assert refused or name == "validation.json"  # which is empty where nothing was refused


def test_a_missing_key_is_named(finished):
    (finished / "criteria.json").write_text('{"criteria": []}')
    with pytest.raises(InputError, match=r"files of a run must be as .* found no 'refusals'"):
        write_report(finished)


@pytest.mark.slow
def test_a_run_that_was_killed_resumes_and_gives_the_same_bytes_elsewhere(
    finished, tmp_path, small_study, monkeypatch
):
    from reliab.study import steps

    def killed(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(steps, "write_ellipses", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(small_study, tmp_path / "again")
    assert stages_of(small_study, tmp_path / "again") == {
        "trace",
        "derive",
        "validate",
        "real motions",
        "report",
    }
    assert (tmp_path / "again" / "report.pdf").read_bytes() == (finished / "report.pdf").read_bytes()


@pytest.mark.slow
def test_boundaries_of_records_that_ship_keep_the_ratios_that_came_with_them(
    finished, small_study, monkeypatch
):
    """A study of such records ended in an error of xarray: the ratios were measured once more and merged."""

    def known(ellipses):
        structures = ("motion", "f", "xi", "length")
        ratios = np.ones([*(ellipses.sizes[name] for name in structures[:3]), 1])
        return ellipses.assign(a_cut=(structures, ratios), b_cut=(structures, ratios), length=[10.0])

    monkeypatch.setattr("reliab.sweep.results_accessor.add_known_cut_records", known)
    (finished / ELLIPSES).unlink()
    assert "trace" in stages_of(small_study, finished)
    with open_ellipses(finished / ELLIPSES) as ellipses:
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
def test_what_a_link_in_a_run_folder_names_is_not_written(tmp_path, small_study, name):
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
    stored = small_study.motions.model_copy(update={"sources": None, "results": "real_suite"})
    structures = small_study.structures.model_copy(update={"f": (7.0,)})
    study = small_study.model_copy(update={"motions": stored, "structures": structures})
    with pytest.raises(InputError, match="stored results hold no such structures"):
        run_study(study, tmp_path / "run")


@pytest.mark.slow
def test_results_keep_the_day_and_the_packages_with_which_they_were_made(finished, small_study, monkeypatch):
    manifest = json.loads((finished / "manifest.json").read_text(encoding="utf-8"))
    for entry in manifest["stages"].values():
        entry["packages"], entry["date"] = {"numpy": "1.2.3"}, "2020-02-03"
    (finished / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    assert stages.software_provenance(finished) == {"packages": {"numpy": "1.2.3"}}
    assert stages.date_of(finished) == dt.date(2020, 2, 3)
    document = KINDS["criterion"].report(small_study, finished)
    assert document.provenance["packages"] == "numpy 1.2.3"
    (finished / "criteria.json").unlink()
    monkeypatch.setattr("reliab.study.running.write_pdf", lambda _, path, **_options: path.touch())
    run_study(small_study, finished)
    assert set(stages.software_provenance(finished)["packages"]) == {
        "simulate",
        "trace",
        "derive",
        "validate",
        "real motions",
    }


def test_a_stage_that_draws_tells_the_packages_of_those_that_are_done(tmp_path):
    """A stage has no packages of its own while it works; the report that it draws names the others'."""
    folder = RunFolder(tmp_path / "run", study={})
    told = []
    first = Stage(name="diagnose", inputs={}, writes=(), work=lambda _: None)
    folder.perform(first)
    folder.perform(
        Stage(
            name="draw", inputs={}, writes=(), work=lambda run: told.append(stages.software_provenance(run))
        )
    )
    assert told == [{"packages": read_versions()}]


def test_what_was_begun_by_other_code_is_not_resumed(tmp_path):
    folder = RunFolder(tmp_path / "run", study={})
    seen = []

    def work(path):
        seen.append((path / "half").exists())
        (path / "half").write_text("x", encoding="utf-8")
        if len(seen) < 3:
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
    assert seen == [False, True, False]  # resumed, removed since the code differs, then done for good


def test_a_study_judges_the_law_that_it_reports(small_study):
    fitted = small_study.criterion.model_copy(update={"law": "dimensionless", "method": "dirichlet"})
    own: Any = candidates(small_study.errors, fitted)[0]
    assert own.law is FITTED_LAWS["dimensionless"]
    assert own.name == "dirichlet, dimensionless"
    sampled = small_study.criterion.model_copy(update={"method": "hierarchical"})
    assert candidates(small_study.errors, sampled)[0].method.name == "hierarchical"  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.of_studies
def test_two_earthquakes_end_in_a_report_that_says_what_they_do_not_carry(tmp_path, suite_folder):
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
def test_a_report_is_titled_after_its_data_and_dated_today(finished, small_study):
    undated = small_study.model_copy(update={"date": None})
    document = KINDS["criterion"].report(undated, finished)
    assert document.title == "A small study: ground motions"
    assert stages.date_of(finished) == dt.datetime.now(tz=dt.UTC).date()
    synthetic = small_study.on(["synthetic"], None)
    verdict = plain_text(KINDS["criterion"].report(synthetic, finished).verdict)
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
    return " ".join(plain_text(item) for each in points for item in each.items)


def test_what_a_killed_run_was_writing_is_removed_when_it_is_resumed(tmp_path):
    run = tmp_path / "run"
    with RunFolder.open(run, study={"kind": "criterion"}):
        pass
    (run / "folder").mkdir()
    for place in (run, run / "folder"):
        (place / f"{UNFINISHED}0").write_text("half")
    with RunFolder.open(run, study={"kind": "criterion"}):
        pass
    assert not [path for path in run.rglob("*") if path.name.startswith(UNFINISHED)]
