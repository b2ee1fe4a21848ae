"""When, and on which commit, each slow test last passed: `pytest -m slow --record` writes slow_tests.json.

A test that fails keeps its line, so that the record says since when it fails. A pass counts only on a commit:
with changes that are not committed nothing is written, and pytest says so before it starts.
"""

import json
import subprocess
from datetime import UTC, datetime
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "tests" / "slow_tests.json"


def read(file=RECORD):
    """Record by the name of the test: `passed` (date, UTC) and `commit`."""
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def commit(root=ROOT):
    """Commit that is checked out; an error where files differ from it, the record apart."""
    differences = _git(
        root, "status", "--porcelain", "--untracked-files=no", "--", ".", f":!tests/{RECORD.name}"
    )
    if differences:
        raise pytest.UsageError(f"--record needs a commit; these files differ from it:\n{differences}")
    return _git(root, "rev-parse", "--short=12", "HEAD").strip()


def _git(root, *arguments):
    call = ["git", "-C", str(root), *arguments]
    return subprocess.run(call, capture_output=True, text=True, check=True).stdout  # noqa: S603 - git


class SlowRecord:
    """Plugin that notes the slow tests that pass."""

    def __init__(self, file, commit_name):
        self.file, self.commit = file, commit_name
        self.passed, self.failed = set(), set()

    def pytest_runtest_logreport(self, report):
        if "slow" not in report.keywords:
            return
        if report.failed:
            self.failed.add(report.nodeid)
        elif report.when == "call" and report.passed:
            self.passed.add(report.nodeid)
        if report.when == "teardown" and report.nodeid in self.passed - self.failed:
            self._note(report.nodeid)

    def _note(self, name):
        """Write the record at once: a run of hours may be stopped."""
        line = {"passed": datetime.now(UTC).date().isoformat(), "commit": self.commit}
        text = json.dumps(read(self.file) | {name: line}, indent=1, sort_keys=True, ensure_ascii=False)
        new = self.file.with_suffix(".new")
        new.write_text(text + "\n", encoding="utf-8")
        new.replace(self.file)

    def pytest_terminal_summary(self, terminalreporter):
        number = len(self.passed - self.failed)
        terminalreporter.write_line(f"{number} slow tests passed on {self.commit}, noted in {self.file.name}")
