"""What the package imports is what pyproject.toml requires: neither less nor more."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from parsed import nodes

import reliab

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OWN = {"reliab", "reliab_studies"}
OF_USERS = ("cluster", "desk", "recordings", "records")  # groups of requirements that users choose
UNSEEN = {"matio": "mat-io"}  # where it has no wheel for this version of Python
BY_NAME = {"h5netcdf", "dask"}  # an engine of xarray, and what distributed runs


def named(requirement):
    """Normalised name of a distribution."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", requirement)[0]).lower()


def declared(*groups):
    """Distributions that groups of requirements name."""
    optional = PROJECT["optional-dependencies"]
    return {named(item) for group in groups for item in optional.get(group, ())}


def imported_by(path):
    """Top-level names that a module imports, wherever in it, also for type checkers alone."""
    for node in nodes(path):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield str(node.module).partition(".")[0]


def imported(*folders):
    """Distributions that modules in folders import, each with one that does."""
    homes = packages_distributions()
    found = {}
    for path in (path for folder in folders for path in sorted(folder.rglob("*.py*"))):
        if path.suffix in {".py", ".pyi"}:
            for name in set(imported_by(path)) - OWN - sys.stdlib_module_names:
                places = homes.get(name) or [UNSEEN.get(name, name)]
                found.update({named(place): str(path.relative_to(ROOT)) for place in places})
    return found


@pytest.fixture(scope="module")
def of_package():
    """Distributions that the package imports."""
    return imported(Path(reliab.__file__).parent)


def test_package_requires_what_it_imports(of_package):
    required = {named(item) for item in PROJECT["dependencies"]}
    missing = {name: path for name, path in of_package.items() if name not in required | declared(*OF_USERS)}
    assert not missing


def test_package_imports_what_it_requires(of_package):
    required = {named(item) for item in PROJECT["dependencies"]} | declared("cluster", "recordings")
    assert required - BY_NAME <= set(of_package)


def test_studies_need_nothing_beside_the_package(of_package):
    assert set(imported(ROOT / "studies")) <= set(of_package)
