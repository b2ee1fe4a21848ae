"""The record of slow tests: passes are noted with their commit, failures are not, and no name is stale."""

import ast
import subprocess
from types import SimpleNamespace

import pytest
from parsed import nodes
from slow_record import ROOT, SlowRecord, commit, read

_BEFORE = '{"old::test": {"passed": "2020-01-01", "commit": "abc"}}'


def report(name, outcome, *, when="call", marks=("slow",)):
    return SimpleNamespace(
        nodeid=name,
        when=when,
        keywords=dict.fromkeys(marks, 1),
        passed=outcome == "passed",
        failed=outcome == "failed",
    )


def test_only_slow_tests_that_pass_are_noted(tmp_path):
    file = tmp_path / "slow_tests.json"
    file.write_text(_BEFORE)
    record = SlowRecord(file, "0123456789ab")
    for each in (
        report("a::passes", "passed"),
        report("a::passes", "passed", when="teardown"),
        report("a::fails", "failed"),
        report("a::fails", "passed", when="teardown"),
        report("a::leaves_a_mess", "passed"),
        report("a::leaves_a_mess", "failed", when="teardown"),
        report("a::skipped", "skipped"),
        report("a::skipped", "passed", when="teardown"),
        report("a::quick", "passed", marks=()),
        report("a::quick", "passed", when="teardown", marks=()),
        report("old::test", "failed"),
    ):
        record.pytest_runtest_logreport(each)
    noted = read(file)
    assert set(noted) == {"a::passes", "old::test"}
    assert noted["a::passes"]["commit"] == "0123456789ab"
    assert noted["old::test"]["passed"] == "2020-01-01"


def test_changes_that_are_not_committed_are_refused(tmp_path):
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
    recorded = {tuple(name.partition("[")[0].split("::")) for name in read()}
    for file in {file for file, *_ in recorded}:
        names = {node.name for node in nodes(ROOT / file) if isinstance(node, ast.FunctionDef)}
        assert {function for of, *_, function in recorded if of == file} <= names, file
