"""A study ends in a report, and does nothing twice."""

import shutil

import pytest

from reliab.errors import InputError
from reliab.study import run_study, write_report


@pytest.fixture(scope="module")
def finished_once(tmp_path_factory, small_study):
    folder = tmp_path_factory.mktemp("finished") / "run"
    run_study(small_study, folder)
    return folder


@pytest.fixture
def finished(finished_once, tmp_path):
    return shutil.copytree(finished_once, tmp_path / "run")


def stages_of(study, folder):
    done = {}
    run_study(study, folder, tell=done.__setitem__)
    return {name for name, worked in done.items() if worked}


def test_a_finished_study_is_not_run_again(finished, small_study):
    report = (finished / "report.pdf").read_bytes()
    assert report.startswith(b"%PDF")
    assert stages_of(small_study, finished) == set()
    assert (finished / "report.pdf").read_bytes() == report


def test_only_what_depends_on_a_change_is_done_again(finished, small_study):
    criterion = small_study.criterion.model_copy(update={"confidences": (0.7,)})
    changed = small_study.model_copy(update={"criterion": criterion})
    assert stages_of(changed, finished) == {"derive", "validate", "real motions", "report"}


def test_a_file_that_was_damaged_is_made_again(finished, small_study):
    (finished / "ellipses.nc").write_bytes(b"")
    assert "trace" in stages_of(small_study, finished)


def test_the_report_can_be_made_again_from_the_folder_alone(finished):
    first = (finished / "report.pdf").read_bytes()
    (finished / "report.pdf").unlink()
    assert write_report(finished).read_bytes() == first


def test_the_same_study_gives_the_same_bytes_elsewhere(finished, small_study, tmp_path):
    again = run_study(small_study, tmp_path / "again")
    assert again.read_bytes() == (finished / "report.pdf").read_bytes()


def test_a_run_that_was_killed_goes_on(tmp_path, small_study, monkeypatch):
    from reliab.study import steps

    def killed(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(steps, "ellipses", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(small_study, tmp_path / "run")
    assert stages_of(small_study, tmp_path / "run") == {"trace", "derive", "validate", "real motions", "report"}


def test_a_folder_with_other_files_is_left_alone(tmp_path, small_study):
    (tmp_path / "thesis.docx").write_bytes(b"precious")
    with pytest.raises(InputError, match="holds other files"):
        run_study(small_study, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.docx"]


def test_a_report_needs_a_run(tmp_path):
    with pytest.raises(InputError, match="reliab run"):
        write_report(tmp_path)


def test_stored_results_answer_only_for_their_structures(tmp_path, small_study):
    stored = small_study.motions.model_copy(update={"sources": None, "results": "real_suite"})
    structures = small_study.structures.model_copy(update={"f": (7.0,)})
    study = small_study.model_copy(update={"motions": stored, "structures": structures})
    with pytest.raises(InputError, match="Stored results answer"):
        run_study(study, tmp_path / "run")
