"""Every command of the README runs, and prints what stands there."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from reliab.app.cli import run
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.laws.guo_2017 import Equation18
from reliab.criterion.population import sample_of

ROOT = Path(__file__).parents[1]
from written_commands import blocks, parameters, reliab_lines  # noqa: E402

README = (ROOT / "README.md").read_text(encoding="utf-8")
TABLE = re.findall(r"^\| .* \| `(reliab .*)` \|$", README, flags=re.MULTILINE)


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    shutil.copytree(ROOT / "datasets" / "sample_test", tmp_path / "datasets" / "sample_test")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("line", reliab_lines(README))
def test_command_prints_the_output_in_the_readme(line, capsys):
    assert run(shlex.split(line)[1:]) == 0
    text = blocks(README.split(line)[1], "text")[0]
    assert capsys.readouterr().out.split() == text.split()


@pytest.mark.parametrize("line", TABLE)
def test_command_of_the_table_takes_its_options(line):
    assert parameters(line)


def test_table_names_commands():
    assert len(TABLE) >= 8


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("block", blocks(README, "python"))
def test_lines_of_python_run(block, capsys):
    exec(block, {})  # noqa: S102 - our own README
    word, probability = capsys.readouterr().out.split()[:2]
    _, _, comment = block.partition("# ")
    assert comment.split()[:2] == [word, f"{float(probability):.2f}"]


@pytest.mark.of_studies
def test_each_shipped_folder_says_where_it_came_from():
    for folder in ("datasets", "studies", "reports"):
        assert (ROOT / folder / "README.md").exists()


def test_every_report_of_the_folder_is_listed_with_its_maker():
    readme_of_reports = (ROOT / "reports/README.md").read_text(encoding="utf-8")
    for path in (ROOT / "reports").iterdir():
        if path.suffix in {".pdf", ".svg", ".png"}:
            assert f"`{path.name}`" in readme_of_reports


def test_the_caption_counts_the_boundaries_of_the_figure():
    """Beside how many boundaries of the hundred lie outside of the criterion and of the published one."""
    ellipses = read_ellipses("real_suite")
    criterion = derive_criterion(ellipses, f=1.0, xi=0.02)
    case = {"frequency": 1.0, "damping_ratio": 0.02, "threshold": 0.05, "metric": "rms"}
    sample = sample_of(ellipses, **case, curve=criterion.provenance.curve)
    pairs = (criterion.limits(1.0, 0.02), Equation18().limits(1.0, 0.02))
    ours, published_count = (int(((sample.a >= a) & (sample.b >= b)).sum()) for a, b in pairs)
    for page in (ROOT / "README.md", ROOT / "reports/site/index.md"):
        caption = " ".join(page.read_text(encoding="utf-8").split())
        assert f"lies inside {ours} of these {sample.n_motions}" in caption
        assert re.search(rf"inside {published_count}\b", caption)
