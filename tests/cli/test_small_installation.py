"""What the documentation calls enough for `reliab assess` is enough; what is missing is named."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
WITHOUT = """
import sys
for name in {absent!r}:
    sys.modules[name] = None  # importing it fails as if it were not installed
from reliab.cli import run
sys.exit(run({arguments!r}))
"""


def absent_packages():
    """Dependencies of the project that the small installation does without."""
    page = (ROOT / "reports/site/getting_started.md").read_text(encoding="utf-8")
    small = set(re.search(r"^\$ python -m pip install (numpy .*)$", page, re.MULTILINE)[1].split())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = {re.match(r"[a-z0-9]+", item)[0] for item in project["dependencies"]}
    assert small < needed
    return sorted(needed - small)


def run_without(absent, *arguments):
    code = WITHOUT.format(absent=absent, arguments=[*arguments])
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)  # noqa: S603


def test_a_test_is_judged_without_reports_figures_samplers_and_stores(tmp_path):
    absent = absent_packages()
    assert {"typst", "arviz", "matplotlib", "emcee", "zarr"} <= set(absent)
    asked = ("assess", "sample_test", "--f", "1", "--xi", "0.02")
    judged = run_without(absent, *asked)
    assert judged.returncode == 0, judged.stderr
    assert "reliable" in judged.stdout
    refused = run_without(absent, *asked, "--report", str(tmp_path / "verdict.pdf"))
    assert refused.returncode == 2
    assert re.search(r"needs the package (typst|matplotlib|seaborn).*pip install", refused.stderr)
    assert "Traceback" not in refused.stderr
