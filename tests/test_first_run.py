"""The first run on a machine: nothing is cached, and perhaps nothing can be."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

IMPORT_ALL = """
import importlib, pkgutil, sys, reliab
for name in sys.argv[1:]:
    importlib.import_module(name)
for module in pkgutil.walk_packages(reliab.__path__, "reliab."):
    if module.name != "reliab.__main__":
        importlib.import_module(module.name)
"""


def run(arguments, **environment):
    """Run Python with a home and caches that only `environment` names."""
    elsewhere = ("XDG_", "MPLCONFIGDIR", "NUMBA_CACHE_DIR")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(elsewhere)}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(  # noqa: S603 - this very package
        command,
        env={**kept, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def modules_of_dependencies():
    """What code and tests import of the packages in pyproject.toml, at their top or in a function."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    groups = (
        project["dependencies"],
        *(project["optional-dependencies"][name] for name in ("cluster", "test")),
    )
    packages = {re.match(r"[\w-]+", item)[0].replace("-", "_") for group in groups for item in group}
    imported = set()
    for path in (*(ROOT / "reliab").rglob("*.py"), *(ROOT / "tests").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module)
    return {name for name in imported if name.partition(".")[0] in packages - {"reliab"}}


def test_no_dependency_and_no_module_warns_when_it_is_imported_with_an_empty_home(tmp_path):
    modules = modules_of_dependencies()
    assert {"arviz_stats.base", "emcee.autocorr", "hypothesis", "matplotlib.figure"} <= modules
    done = run(["-W", "error", "-c", IMPORT_ALL, *sorted(modules)], HOME=str(tmp_path))
    assert (done.returncode, done.stderr) == (0, "")
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.parent.name for path in files} <= {"matplotlib"}, "a list of fonts only"
