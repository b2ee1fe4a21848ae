"""Count the faults that happened."""

from collections import Counter

import pytest

_COUNTED = pytest.StashKey[Counter]()


def pytest_configure(config):
    config.stash[_COUNTED] = Counter()


@pytest.fixture(scope="session")
def counted(pytestconfig):
    """Faults that happened, by command and kind; printed at the end of a run in one process (`-n 0`)."""
    return pytestconfig.stash[_COUNTED]


def pytest_terminal_summary(terminalreporter, config):
    faults = config.stash[_COUNTED]
    for (name, kind), count in sorted(faults.items()):
        terminalreporter.write_line(f"{name:12} {kind:24} {count:4}")
    if faults:
        terminalreporter.write_line(f"{faults.total()} injected faults")
