"""The first run on a machine: nothing is cached, and perhaps nothing can be."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

IMPORT_ALL = """
import importlib, pkgutil, sys, reliab
for name in sys.argv[1:]:
    importlib.import_module(name)
for module in pkgutil.walk_packages(reliab.__path__, "reliab."):
    if module.name != "reliab.__main__":
        importlib.import_module(module.name)
"""


def run(arguments, folder=ROOT, **environment):
    """Run Python in the folder of a package, with a home and caches that only `environment` names."""
    elsewhere = ("XDG_", "MPLCONFIGDIR", "NUMBA_CACHE_DIR")
    environment_without_homes = {
        name: value for name, value in os.environ.items() if not name.startswith(elsewhere)
    }
    return subprocess.run(  # noqa: S603 - this very package
        [sys.executable, *arguments],
        env={**environment_without_homes, "PYTHONPATH": str(folder), **environment},
        cwd=folder,
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
    names = set()
    for path in (*(ROOT / "reliab").rglob("*.py"), *(ROOT / "tests").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add(node.module)
    return {name for name in names if name.partition(".")[0] in packages - {"reliab"}}


@pytest.mark.slow
def test_no_dependency_and_no_module_warns_when_it_is_imported_with_an_empty_home(tmp_path):
    modules = modules_of_dependencies()
    assert {"arviz_stats.base", "emcee.autocorr", "hypothesis", "matplotlib.figure"} <= modules
    process = run(["-W", "error", "-c", IMPORT_ALL, *sorted(modules)], HOME=str(tmp_path))
    slow = "Matplotlib is building the font cache; this may take a moment.\n"  # said after five seconds
    assert (process.returncode, process.stderr.replace(slow, "")) == (0, "")
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.parent.name for path in files} <= {"matplotlib"}, "a list of fonts only"


def test_packages_with_files_in_a_home_are_imported_without_one():
    packages = [
        "reliab.core.compiled",
        "reliab.app.cli.studies",
        "reliab.report",
        "matplotlib.pyplot",
        "numba",
    ]
    assert run(["-c", f"import {', '.join(packages)}"], HOME="/dev/null").returncode == 0


@pytest.mark.slow
def test_no_dependency_and_no_module_needs_a_home_to_be_imported():
    process = run(["-c", IMPORT_ALL, *sorted(modules_of_dependencies())], HOME="/dev/null")
    assert process.returncode == 0, process.stderr


@pytest.fixture
def read_only(tmp_path):
    """A copy of the package in which no compiled kernel can be kept, not even by the superuser."""
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "reliab", tmp_path / "installed/reliab", ignore=ignore)
    for folder in ("datasets", "studies"):
        (tmp_path / "installed" / folder).symlink_to(ROOT / folder)
    for path in (tmp_path / "installed/reliab").rglob("*.py"):
        (path.parent / "__pycache__").touch()
    return tmp_path / "installed"


@pytest.mark.slow
def test_info_states_the_folder_of_compiled_code(read_only, tmp_path):
    def cache_folder(**environment):
        process = run(["-B", "-m", "reliab", "info", "--json", "-"], read_only, **environment)
        assert process.returncode == 0
        return json.loads(process.stdout)["compiled code"], process.stderr

    home, named_folder = tmp_path / "home", tmp_path / "named"
    home_cache, silent = cache_folder(HOME=str(home))
    assert Path(home_cache).is_relative_to(home)
    assert silent == ""
    assert list(Path(home_cache).iterdir())
    assert cache_folder(HOME=str(home), NUMBA_CACHE_DIR=str(named_folder)) == (str(named_folder), "")
    assert cache_folder(HOME=str(home), NUMBA_CACHE_DIR="/proc/nowhere") == (home_cache, "")
    place, warning = cache_folder(HOME="/dev/null")
    assert place == "not kept"
    assert warning.count("Compiled code cannot be kept") == warning.count("NUMBA_CACHE_DIR") == 1
    assert len(warning.splitlines()) == 1


@pytest.mark.slow
def test_where_compiled_code_cannot_be_kept_a_command_says_so_once_and_answers(read_only):
    command = ["-B", "-m", "reliab", "assess", "sample_test", "--f", "1", "--xi", "0.02", "--json", "-"]
    process = run(command, read_only, HOME="/dev/null")
    assert process.returncode == 0
    assert json.loads(process.stdout)["verdict"] == "reliable"
    assert process.stderr.count("Compiled code cannot be kept") == len(process.stderr.splitlines()) == 1
