"""Kernels are compiled also where no folder can be written."""

import os
import subprocess
import sys
from pathlib import Path


def test_kernels_need_no_folder_for_their_cache(tmp_path):
    (tmp_path / "kernel.py").write_text(
        "from reliab.compiled import compiled\n@compiled\ndef half(x):\n    return x / 2\nprint(half(3.0))\n"
    )
    (tmp_path / "__pycache__").touch()
    nowhere = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "NUMBA_CACHE_DIR": ""}
    done = subprocess.run(  # noqa: S603 - this very package
        [sys.executable, "-B", str(tmp_path / "kernel.py")],
        env={**os.environ, **nowhere, "PYTHONPATH": str(Path(__file__).resolve().parents[1])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "1.5\n", done.stderr
