"""Folders of studies, with and without those that ship."""

import doctest
import os
import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import reliab
from reliab.app.api import studies
from reliab.core.errors import InputError
from reliab.core.shipped import find_shipped_folder
from reliab.study import description
from reliab.study.description import folders_of_studies, kind_of
from reliab.study.kinds import KINDS
from reliab.study.running import list_shipped, open_study, run_study

pytestmark = pytest.mark.of_studies

STUDIES = find_shipped_folder("studies")


def write_study(folder: Path) -> Path:
    """Write the study of one's own that studies/README.md shows."""
    text = (STUDIES / "README.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    (table,) = re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)
    folder.mkdir()
    (folder / "kind.py").write_text(code, encoding="utf-8")
    (folder / "study.toml").write_text(table, encoding="utf-8")
    return folder


def test_study_of_the_documentation_runs(tmp_path, text_of):
    study = open_study(write_study(tmp_path / "my_study"))
    run_study(study, tmp_path / "run")
    text = text_of(KINDS[study.kind].report(study, tmp_path / "run"))
    assert re.search(r"The strongest of \d+ motions has \d+\.\d m/s", text)


@pytest.mark.parametrize("name", [name for name, folder in folders_of_studies().items() if kind_of(folder)])
def test_a_copy_under_another_name_is_a_study_of_its_own(name, tmp_path):
    """Its modules import one another relatively, so that the copy's own code is used."""
    duplicate = tmp_path / f"my_{name}"
    shutil.copytree(STUDIES / name, duplicate, ignore=shutil.ignore_patterns("__pycache__"))
    kind = kind_of(duplicate)
    assert kind.name == KINDS[kind.name].name
    assert Path(kind.stages.__code__.co_filename).parent == duplicate.resolve()


@pytest.mark.parametrize(
    ("code", "messages"),
    [
        ("KIND = 1", "must define KIND"),
        ("import nothing_of_this_name", "cannot be imported"),
        ("KIND = (", "cannot be imported"),
    ],
)
def test_invalid_study_code_is_refused_with_its_place(code, messages, tmp_path):
    folder = write_study(tmp_path / "my_study")
    (folder / "kind.py").write_text(code, encoding="utf-8")
    with pytest.raises(InputError, match=messages) as refusal:
        open_study(folder)
    assert str(folder) in str(refusal.value)


@pytest.fixture
def study_folders(tmp_path, monkeypatch):
    """A sound study and one whose code raises, in place of those that ship; the folder of the studies."""
    studies = tmp_path / "studies"
    studies.mkdir()
    write_study(studies / "sound")
    broken = write_study(studies / "broken")
    (broken / "kind.py").write_text("raise RuntimeError('broken')", encoding="utf-8")
    (broken / "study.toml").write_text('kind = "broken"\ntitle = "Broken"', encoding="utf-8")
    monkeypatch.setattr(description, "_studies_root", lambda: studies)
    monkeypatch.setattr(description, "PACKAGE", f"studies_of_{tmp_path.name}")
    return studies


@pytest.mark.usefixtures("study_folders")
def test_a_broken_study_breaks_no_other():
    assert [row["name"] for row in list_shipped()] == ["broken", "sound"]
    assert open_study("sound").kind == "peaks"
    with pytest.raises(InputError, match="cannot be imported; found broken"):
        open_study("broken")


def test_broken_study_file_breaks_no_other(study_folders):
    (study_folders / "broken" / "study.toml").write_text("kind = ", encoding="utf-8")
    assert [row["kind"] for row in list_shipped()] == ["", "peaks"]
    assert open_study("sound").kind == "peaks"


@pytest.mark.usefixtures("study_folders")
def test_a_study_runs_twice_into_a_folder_of_its_own_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first, second = (studies.run_study("sound", out="sound").stages for _ in range(2))
    assert (set(first.values()), set(second.values())) == ({True}, {False})


def test_only_the_running_study_is_imported(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("reliab_studies.")]:
        monkeypatch.delitem(sys.modules, name)
    list_shipped()
    open_study("table2_audit")
    assert {name.split(".")[1] for name in sys.modules if name.startswith("reliab_studies.")} == {
        "table2_audit"
    }


@pytest.mark.parametrize("name", ["quick", "thresholds"])
def test_a_folder_of_its_name_does_not_hide_a_study(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path(name).mkdir()
    assert open_study(name).title == open_study(STUDIES / name).title


@pytest.mark.parametrize(
    "module",
    [
        ".".join(["reliab_studies", *file.relative_to(STUDIES).with_suffix("").parts])
        for file in sorted(STUDIES.rglob("*.py"))
        if ">>>" in file.read_text(encoding="utf-8")
    ],
)
def test_examples_in_studies_run(module):
    failure, trial = doctest.testmod(
        import_module(module), optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    )
    assert trial > 0
    assert failure == 0


SCRIPT = """
import sys
from reliab.app.cli import run
print([run(arguments.split()) for arguments in sys.argv[1:]], file=sys.stderr)
"""


@pytest.fixture
def answer(tmp_path, request):
    """What commands say in a checkout that has no folder of studies."""
    checkout, product = tmp_path, Path(reliab.__file__).parent
    for folder in (product, product.parent / "datasets"):
        (checkout / folder.name).symlink_to(folder)
    return subprocess.run(  # noqa: S603 - our own words
        [sys.executable, "-W", "error", "-c", SCRIPT, *request.param],
        cwd=checkout,
        env={**os.environ, "PYTHONPATH": str(checkout)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("answer", "word"),
    [
        (["assess sample_test --f 1 --xi 0.02"], "RELIABLE"),
        (["criterion --ellipses real_suite --f 1 --xi 0.02"], "confidence"),
    ],
    indirect=["answer"],
)
def test_verdicts_and_criteria_need_no_study(answer, word):
    assert answer.stderr.splitlines()[-1] == "[0]"
    assert word in answer.stdout


@pytest.mark.slow
@pytest.mark.parametrize("answer", [["run --list", "run"]], indirect=True)
def test_run_without_shipped_studies_gives_a_remedy(answer):
    assert answer.stderr.splitlines()[-1] == "[0, 2]"
    assert "none ships" in answer.stderr
    assert "No study" in answer.stderr
