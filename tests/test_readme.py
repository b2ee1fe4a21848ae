"""Every recipe of the README runs as it is printed."""

import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from reliab.app.cli import run
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.laws.guo_2017 import Equation18

ROOT = Path(__file__).parents[1]
from written_commands import blocks, command_blocks, parameters, reliab_lines  # noqa: E402

README = (ROOT / "README.md").read_text(encoding="utf-8")
RECIPES = README.split("## Recipes")[1].split("## Studies")[0]
LONG = ("--method hierarchical", "--scheduler", "reliab diagnose", "--rebuilt-error")  # 10 s and more


def is_long(line: str) -> bool:
    return any(words in line for words in LONG)


def recipes() -> Iterator:
    """Every recipe; one with long lines runs whole among the slow tests, without them by default."""
    for lines in command_blocks(RECIPES):
        marks = pytest.mark.slow if any(map(is_long, lines)) else ()
        yield pytest.param(lines, id=lines[0][:40], marks=marks)
        short = [line for line in lines if not is_long(line)]
        if 0 < len(short) < len(lines) and all(line.startswith("reliab ") for line in lines):
            yield pytest.param(short, id=f"{lines[0][:40]} without its long lines")


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    shutil.copytree(ROOT / "datasets" / "campaigns" / "rig_a", tmp_path / "datasets" / "campaigns" / "rig_a")
    shutil.copytree(ROOT / "datasets" / "sample_test", tmp_path / "datasets" / "sample_test")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("lines", list(recipes()))
def test_recipe_runs(lines, checkout):
    if all(line.startswith("reliab ") for line in lines):
        for line in lines:
            assert run(shlex.split(line)[1:]) == 0, line
    else:
        run_in_a_shell(lines, checkout)


def run_in_a_shell(lines, folder):
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    printed = folder / "printed.txt"
    with (
        printed.open("w", encoding="utf-8") as output,
        subprocess.Popen(  # noqa: S603
            ["bash", "-e", "-c", "\n".join(lines)],  # noqa: S607 - the shell of the reader
            cwd=folder,
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
    assert code == 0, printed.read_text(encoding="utf-8")


@pytest.mark.parametrize("line", reliab_lines(RECIPES))
def test_every_command_of_a_recipe_is_understood(line):
    """Also those of the recipes that only the slow tests run: each option exists and takes its value."""
    assert parameters(line)


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("block", blocks(RECIPES, "python"))
def test_python_recipe_runs(block, capsys):
    exec(block, {})  # noqa: S102 - our own README
    assert float(capsys.readouterr().out) > 0.0


@pytest.mark.of_studies
def test_each_shipped_folder_says_where_it_came_from():
    for folder in ("datasets", "studies", "reports"):
        assert (ROOT / folder / "README.md").exists()


def test_every_report_of_the_folder_is_listed_with_what_makes_it():
    listed = (ROOT / "reports/README.md").read_text(encoding="utf-8")
    for path in (ROOT / "reports").iterdir():
        if path.suffix in {".pdf", ".svg", ".png"}:
            assert f"`{path.name}`" in listed


def test_the_caption_counts_what_the_figure_draws():
    """Beside how many boundaries of the hundred lie outside of the criterion and of the published one."""
    ellipses = read_ellipses("real_suite")
    derived = derive_criterion(ellipses, f=1.0, xi=0.02)
    drawn = {"frequency": 1.0, "damping_ratio": 0.02, "threshold": 0.05, "metric": "rms"}
    sample = sample_of(ellipses, **drawn, curve=derived.provenance.curve)
    pairs = (derived.limits(1.0, 0.02), Equation18().limits(1.0, 0.02))
    ours, published = (int(((sample.a >= a) & (sample.b >= b)).sum()) for a, b in pairs)
    for page in (ROOT / "README.md", ROOT / "reports/site/index.md"):
        caption = " ".join(page.read_text(encoding="utf-8").split())
        assert f"lies inside {ours} of these {sample.n_motions}" in caption
        assert re.search(rf"inside {published}\b", caption)
