"""Whatever happens to `reliab rig add`, the tests that a rig held are held, and adding again completes it."""

import json
import shutil
import subprocess
import sys

import pytest

from reliab.rig.rig_folder import RigFolder


@pytest.fixture(scope="module")
def files(sources, tmp_path_factory):
    """Two tests."""
    folder = tmp_path_factory.mktemp("tests")
    lines = (sources / "campaign/a.csv").read_text().splitlines(keepends=True)
    (folder / "a.csv").write_text("".join(lines))
    (folder / "b.csv").write_text("".join(lines[:-20]))
    return folder


def adding(files, out, *names):
    """Arguments that add tests."""
    tests = [files / name for name in names]
    return ("rig", "add", out / "rig", *tests, "--f", 1, "--xi", 0.05, "--json", out / "answer.json")


def content_of_rig(out):
    """Rows of a rig's tests by name, and the bytes of their records, without what says when."""
    folder = RigFolder.open(out / "rig")
    table = folder.table()
    assert not table.faults
    rows = {}
    for row in table.rows:
        content = folder.read(row["sha256"])["test"]
        del content["added"]  # when
        rows[row["name"]] = content, folder.record_path(row["sha256"]).stat().st_size
    return rows


@pytest.fixture(scope="module")
def rig_with_one_test(files, forks, tmp_path_factory):
    """A folder with a rig that holds the first test."""
    out = tmp_path_factory.mktemp("begun")
    assert forks.run(adding(files, out, "a.csv"), out).code == 0
    return out


@pytest.fixture(scope="module")
def complete_rig(rig_with_one_test, files, forks, tmp_path_factory):
    """A rig of two tests that nothing happened to, and how often the second one was written."""
    out = tmp_path_factory.mktemp("whole")
    shutil.copytree(rig_with_one_test, out, dirs_exist_ok=True)
    second = forks.run(adding(files, out, "a.csv", "b.csv"), out)
    assert second.code == 0, second.errors
    assert content_of_rig(out).keys() == {"a.csv", "b.csv"}
    return content_of_rig(out), second.writes


@pytest.fixture
def rig(rig_with_one_test, tmp_path):
    """Function that makes a folder with a rig that holds the first test."""

    def make(name):
        return shutil.copytree(rig_with_one_test, tmp_path / str(name))

    return make


def check_nothing_is_lost(files, forks, out, complete_rig):
    """The first test is there, the second whole or not at all, and adding again completes the rig."""
    now = content_of_rig(out)
    assert {"a.csv"} <= now.keys()
    assert all(now[name] == complete_rig[0][name] for name in now)
    repetition = forks.run(adding(files, out, "a.csv", "b.csv"), out)
    assert repetition.code == 0, repetition.errors
    assert content_of_rig(out) == complete_rig[0]
    assert not [*out.rglob(".unfinished-*")]


@pytest.mark.slow
@pytest.mark.parametrize("action", ["kill", "full", "terminate"])
def test_a_fault_at_any_write_loses_no_test(action, files, forks, rig, complete_rig, counter):
    for instant in range(1, complete_rig[1] + 1):
        out = rig(instant)
        outcome = forks.run(adding(files, out, "a.csv", "b.csv"), out, instant=instant, action=action)
        assert "Traceback" not in outcome.errors, outcome.errors
        counter["rig add", action] += outcome.code != 0
        check_nothing_is_lost(files, forks, out, complete_rig)


@pytest.mark.slow
def test_a_quota_loses_no_test(files, forks, rig, complete_rig, counter):
    for quota in (2000, 8000, 16_000):
        out = rig(quota)
        outcome = forks.run(adding(files, out, "a.csv", "b.csv"), out, instant=quota, action="quota")
        assert "Traceback" not in outcome.errors, outcome.errors
        counter["rig add", "quota"] += outcome.code != 0
        check_nothing_is_lost(files, forks, out, complete_rig)


@pytest.mark.slow
def test_a_read_only_rig_is_refused(files, forks, rig, complete_rig, counter, tmp_path_factory):
    out = rig("read_only")
    for folder in (files, *out.parents):
        if folder.is_relative_to(tmp_path_factory.getbasetemp().parent):
            folder.chmod(0o755)
    places = [out, *(path for path in out.rglob("*") if path.is_dir())]
    for place in places:
        place.chmod(0o555)
    try:
        outcome = forks.run(adding(files, out, "b.csv"), out, action="readonly")
    finally:
        for place in places:
            place.chmod(0o755)
    counter["rig add", "read-only folder"] += 1
    assert outcome.code == 2, outcome.errors
    assert "Traceback" not in outcome.errors
    check_nothing_is_lost(files, forks, out, complete_rig)


@pytest.mark.slow
def test_two_commands_adding_the_same_tests_both_succeed(files, rig, complete_rig, counter):
    out = rig("two")
    program = "import sys; from reliab.app.cli import run; sys.exit(run(sys.argv[1:]))"
    running = []
    for number in range(2):
        arguments = [str(argument) for argument in adding(files, out, "a.csv", "b.csv")]
        arguments[-1] = str(out / f"answer_{number}.json")
        running.append(subprocess.Popen([sys.executable, "-c", program, *arguments]))  # noqa: S603
    assert [process.wait() for process in running] == [0, 0]
    counter["rig add", "two at once"] += 1
    assert content_of_rig(out) == complete_rig[0]
    answers = [json.loads((out / f"answer_{number}.json").read_text()) for number in range(2)]
    assert all(len(answer["added"]) + len(answer["present"]) == 2 for answer in answers)
