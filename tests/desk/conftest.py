import pytest

pytest.importorskip("panel", reason="the desk needs Panel, and it is not installed")
from reliab.desk.folder import DeskFolder
from reliab.desk.jobs import Jobs


@pytest.fixture
def folder(tmp_path):
    desk_folder = DeskFolder.open_folder(tmp_path)
    yield desk_folder
    desk_folder.close()


@pytest.fixture(scope="session")
def jobs(tmp_path_factory):
    workers = Jobs(str(tmp_path_factory.mktemp("workers")))
    yield workers
    workers.close()
