"""What commands under faults start from, and how many faults happened."""

from collections import Counter

import pytest

from faults.commands import material
from faults.crashing import Forks

_COUNTER = pytest.StashKey[Counter]()


def pytest_configure(config):
    config.stash[_COUNTER] = Counter()


@pytest.fixture(scope="session")
def counter(pytestconfig):
    """Faults that happened, by command and kind; printed at the end of a run in one process (`-n 0`)."""
    return pytestconfig.stash[_COUNTER]


@pytest.fixture(scope="session")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    material(folder)
    return folder


@pytest.fixture(scope="session")
def forks():
    running = Forks()
    yield running
    running.close()


def pytest_terminal_summary(terminalreporter, config):
    faults = config.stash[_COUNTER]
    for (name, kind), count in sorted(faults.items()):
        terminalreporter.write_line(f"{name:12} {kind:24} {count:4}")
    if faults:
        terminalreporter.write_line(f"{faults.total()} injected faults")
