"""Every recipe of the README runs as it is printed."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
RECIPES = README.split("## Recipes")[1].split("## Studies")[0]
INSTALL = "$ python -m pip install"  # what the test's own environment has already


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", RECIPES, flags=re.DOTALL)


def name(block: str) -> str:
    lines = [line for line in block.splitlines() if not line.startswith(INSTALL)]
    return lines[0].removeprefix("$ ")[:40]


@pytest.fixture
def checkout(tmp_path):
    shutil.copytree(ROOT / "datasets", tmp_path / "datasets")
    return tmp_path


@pytest.mark.parametrize("block", blocks("console"), ids=name)
def test_recipe_runs(block, checkout):
    lines = [line.removeprefix("$ ") for line in block.splitlines() if not line.startswith(INSTALL)]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    said = checkout / "said.txt"
    with (
        said.open("w", encoding="utf-8") as output,
        subprocess.Popen(  # noqa: S603
            ["bash", "-e", "-c", "\n".join(lines)],  # noqa: S607 - the shell of the reader
            cwd=checkout,
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as process,
    ):
        try:
            code = process.wait(timeout=300)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)  # a scheduler that was left running
    assert code == 0, said.read_text(encoding="utf-8")


@pytest.mark.parametrize("block", blocks("python"))
def test_python_recipe_runs(block, checkout):
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", block], cwd=checkout, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) > 0.0


def test_each_shipped_folder_says_where_it_came_from():
    for room in ("datasets", "studies", "reports"):
        assert (ROOT / room / "README.md").exists()
