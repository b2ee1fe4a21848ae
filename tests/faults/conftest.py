"""What commands under faults start from, and how many faults happened."""

from collections import Counter

import pytest

from faults.commands import material
from faults.crashing import Forks

_COUNTED = pytest.StashKey[Counter]()


def pytest_configure(config):
    config.stash[_COUNTED] = Counter()


@pytest.fixture(scope="session")
def counted(pytestconfig):
    """Faults that happened, by command and kind; printed at the end of a run in one process (`-n 0`)."""
    return pytestconfig.stash[_COUNTED]


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
    faults = config.stash[_COUNTED]
    for (name, kind), count in sorted(faults.items()):
        terminalreporter.write_line(f"{name:12} {kind:24} {count:4}")
    if faults:
        terminalreporter.write_line(f"{faults.total()} injected faults")
