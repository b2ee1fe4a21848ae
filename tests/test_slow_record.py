"""The record of slow tests: passes are noted with their commit, failures are not, and no name is stale."""

import ast
import subprocess
from types import SimpleNamespace

import pytest
from parsed import nodes
from slow_record import ROOT, SlowRecord, commit, read

_EARLIER_RECORD = '{"old::test": {"passed": "2020-01-01", "commit": "abc"}}'


def report(name, outcome, *, phase="call", marks=("slow",)):
    return SimpleNamespace(
        nodeid=name,
        when=phase,
        keywords=dict.fromkeys(marks, 1),
        passed=outcome == "passed",
        failed=outcome == "failed",
    )


def test_only_passing_slow_tests_are_noted(tmp_path):
    file = tmp_path / "slow_tests.json"
    file.write_text(_EARLIER_RECORD)
    record = SlowRecord(file, "0123456789ab")
    for item in (
        report("a::passes", "passed"),
        report("a::passes", "passed", phase="teardown"),
        report("a::fails", "failed"),
        report("a::fails", "passed", phase="teardown"),
        report("a::leaves_a_mess", "passed"),
        report("a::leaves_a_mess", "failed", phase="teardown"),
        report("a::skipped", "skipped"),
        report("a::skipped", "passed", phase="teardown"),
        report("a::quick", "passed", marks=()),
        report("a::quick", "passed", phase="teardown", marks=()),
        report("old::test", "failed"),
    ):
        record.pytest_runtest_logreport(item)
    content = read(file)
    assert set(content) == {"a::passes", "old::test"}
    assert content["a::passes"]["commit"] == "0123456789ab"
    assert content["old::test"]["passed"] == "2020-01-01"


def test_uncommitted_changes_are_refused(tmp_path):
    def git(*arguments):
        user = ("-c", "user.name=a", "-c", "user.email=a@example.org")
        subprocess.run(["git", "-C", str(tmp_path), *user, *arguments], check=True, capture_output=True)  # noqa: S603, S607 - git

    git("init")
    (tmp_path / "code.py").write_text("x = 1\n")
    git("add", "code.py")
    git("commit", "-m", "first")
    assert len(commit(tmp_path)) == 12
    (tmp_path / "code.py").write_text("x = 2\n")
    with pytest.raises(pytest.UsageError, match=r"code\.py"):
        commit(tmp_path)


def test_every_recorded_test_exists():
    record = {tuple(name.partition("[")[0].split("::")) for name in read()}
    for file in {file for file, *_ in record}:
        names = {node.name for node in nodes(ROOT / file) if isinstance(node, ast.FunctionDef)}
        assert {function for path, *_, function in record if path == file} <= names, file
