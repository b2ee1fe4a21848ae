"""The requirements of reliab-core are enough for `reliab assess`; what is missing is named."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
BLOCKER = """
import sys
for name in {absent!r}:
    sys.modules[name] = None  # importing it fails as if it were not installed
from reliab.app.cli import run
asked = ["assess", "sample_test", "--f", "1", "--xi", "0.02"]
print("code", run(asked))
print("code", run([*asked, "--report", {report!r}]))
"""


def absent_packages():
    """Requirements of the project that reliab-core does without."""
    description = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    subset = {name.replace("-", "_") for name in description["tool"]["reliab"]["core"]}
    requirements = description["project"]["dependencies"]
    requirements = {re.match(r"[a-z0-9-]+", item)[0].replace("-", "_") for item in requirements}
    assert subset < requirements
    return sorted(requirements - subset)


@pytest.mark.slow
def test_a_test_is_judged_without_reports_figures_samplers_and_stores(tmp_path):
    absent = absent_packages()
    assert {"typst", "arviz_stats", "matplotlib", "emcee", "zarr", "pandas", "xarray"} <= set(absent)
    code = BLOCKER.format(absent=absent, report=str(tmp_path / "verdict.pdf"))
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)  # noqa: S603
    assert re.findall(r"^code (\d)$", process.stdout, re.MULTILINE) == ["0", "2"], process.stderr
    assert re.search(
        r"needs the package (typst|matplotlib|seaborn|xarray|pandas);.*pip install", process.stderr
    )
    assert "Traceback" not in process.stderr
