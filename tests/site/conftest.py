import shutil
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """Stand in a folder that holds what the commands on the site name."""
    for name in ("campaigns/rig_a", "sample_test", "frames"):
        shutil.copytree(ROOT / "datasets" / name, tmp_path / "datasets" / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path
