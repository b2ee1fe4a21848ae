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


def held(out):
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
def begun(files, forks, tmp_path_factory):
    """A folder with a rig that holds the first test."""
    out = tmp_path_factory.mktemp("begun")
    assert forks.run(adding(files, out, "a.csv"), out).code == 0
    return out


@pytest.fixture(scope="module")
def whole(begun, files, forks, tmp_path_factory):
    """A rig of two tests that nothing happened to, and how often the second one was written."""
    out = tmp_path_factory.mktemp("whole")
    shutil.copytree(begun, out, dirs_exist_ok=True)
    second = forks.run(adding(files, out, "a.csv", "b.csv"), out)
    assert second.code == 0, second.errors
    assert held(out).keys() == {"a.csv", "b.csv"}
    return held(out), second.writes


@pytest.fixture
def rig(begun, tmp_path):
    """Function that makes a folder with a rig that holds the first test."""

    def make(name):
        return shutil.copytree(begun, tmp_path / str(name))

    return make


def check_nothing_is_lost(files, forks, out, whole):
    """The first test is there, the second whole or not at all, and adding again completes the rig."""
    now = held(out)
    assert {"a.csv"} <= now.keys()
    assert all(now[name] == whole[0][name] for name in now)
    again = forks.run(adding(files, out, "a.csv", "b.csv"), out)
    assert again.code == 0, again.errors
    assert held(out) == whole[0]
    assert not [*out.rglob(".unfinished-*")]


@pytest.mark.slow
@pytest.mark.parametrize("action", ["kill", "full", "terminate"])
def test_a_fault_at_any_write_loses_no_test(action, files, forks, rig, whole, counted):
    for at in range(1, whole[1] + 1):
        out = rig(at)
        stopped = forks.run(adding(files, out, "a.csv", "b.csv"), out, at=at, action=action)
        assert "Traceback" not in stopped.errors, stopped.errors
        counted["rig add", action] += stopped.code != 0
        check_nothing_is_lost(files, forks, out, whole)


@pytest.mark.slow
def test_a_quota_loses_no_test(files, forks, rig, whole, counted):
    for most in (2000, 8000, 16_000):
        out = rig(most)
        stopped = forks.run(adding(files, out, "a.csv", "b.csv"), out, at=most, action="quota")
        assert "Traceback" not in stopped.errors, stopped.errors
        counted["rig add", "quota"] += stopped.code != 0
        check_nothing_is_lost(files, forks, out, whole)


@pytest.mark.slow
def test_a_rig_that_may_not_be_written_to_is_refused(files, forks, rig, whole, counted, tmp_path_factory):
    out = rig("read_only")
    for folder in (files, *out.parents):
        if folder.is_relative_to(tmp_path_factory.getbasetemp().parent):
            folder.chmod(0o755)
    places = [out, *(path for path in out.rglob("*") if path.is_dir())]
    for place in places:
        place.chmod(0o555)
    try:
        stopped = forks.run(adding(files, out, "b.csv"), out, action="readonly")
    finally:
        for place in places:
            place.chmod(0o755)
    counted["rig add", "read-only folder"] += 1
    assert stopped.code == 2, stopped.errors
    assert "Traceback" not in stopped.errors
    check_nothing_is_lost(files, forks, out, whole)


@pytest.mark.slow
def test_two_commands_that_add_the_same_tests_at_once_both_succeed(files, rig, whole, counted):
    out = rig("two")
    program = "import sys; from reliab.app.cli import run; sys.exit(run(sys.argv[1:]))"
    running = []
    for number in range(2):
        arguments = [str(argument) for argument in adding(files, out, "a.csv", "b.csv")]
        arguments[-1] = str(out / f"answer_{number}.json")
        running.append(subprocess.Popen([sys.executable, "-c", program, *arguments]))  # noqa: S603
    assert [process.wait() for process in running] == [0, 0]
    counted["rig add", "two at once"] += 1
    assert held(out) == whole[0]
    answers = [json.loads((out / f"answer_{number}.json").read_text()) for number in range(2)]
    assert all(len(answer["added"]) + len(answer["present"]) == 2 for answer in answers)
