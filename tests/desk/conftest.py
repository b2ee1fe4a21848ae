import pytest

pytest.importorskip("panel", reason="the desk needs Panel, and it is not installed")
from reliab.desk.folder import DeskFolder
from reliab.desk.jobs import Jobs


@pytest.fixture
def folder(tmp_path):
    opened = DeskFolder.open_folder(tmp_path)
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def jobs(tmp_path_factory):
    started = Jobs(str(tmp_path_factory.mktemp("workers")))
    yield started
    started.close()
