import json
import shutil
import subprocess
from pathlib import Path

import pytest

import reliab
from reliab.core.shipped import shipped
from reliab.explore.page import pack, sort_by_length
from reliab.sweep.ellipse_dataset import open_windows

WINDOWS = ("record", "20", "30", "40")
WEB = Path(reliab.__file__).parent / "explore" / "web"


@pytest.fixture(scope="session")
def shipped_ellipses():
    tables = sort_by_length(open_windows(shipped("datasets", "real_suite/ellipses.nc")))
    return {window: tables[window] for window in WINDOWS}


@pytest.fixture(scope="session")
def archive(shipped_ellipses):
    return pack(shipped_ellipses)


@pytest.fixture(scope="session")
def javascript(archive):
    """Answer questions by the scripts of the page, run by node."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("the page's scripts are run by node, and there is none here")

    def ask(*questions):
        table = archive if any(kind in ("limits", "band") for kind, _ in questions) else None
        job = json.dumps({"packed": table, "questions": questions})
        script = Path(__file__).with_name("numbers.mjs")
        process = subprocess.run(  # noqa: S603
            [node, str(script), str(WEB)], input=job, capture_output=True, text=True, check=True, timeout=120
        )
        return json.loads(process.stdout)

    return ask
