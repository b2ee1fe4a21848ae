import pytest

from reliab.app.cli import run


@pytest.fixture
def empty_folder(tmp_path, monkeypatch):
    """Stand in a folder that holds what `reliab samples` writes, as the first page tells its readers."""
    monkeypatch.chdir(tmp_path)
    assert run(["samples"]) == 0
    return tmp_path
