import pytest

pytest.importorskip("panel", reason="the desk needs Panel, and it is not installed")
from reliab.desk.folder import DeskFolder


@pytest.fixture
def folder(tmp_path):
    desk_folder = DeskFolder.open_folder(tmp_path)
    yield desk_folder
    desk_folder.close()
