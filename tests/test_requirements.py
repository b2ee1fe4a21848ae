"""What the package imports is what pyproject.toml requires: neither less nor more."""

import ast
import re
import sys
import tomllib
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from parsed import nodes

import reliab

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OWN_PACKAGES = {"reliab", "reliab_studies"}
USER_GROUPS = ("cluster", "desk", "recordings", "records")  # groups of requirements that users choose
UNSEEN = {"matio": "mat-io"}  # where it has no wheel for this version of Python
INDIRECT = {"h5netcdf", "dask"}  # an engine of xarray, and what distributed runs


def normalise_name(requirement):
    """Normalised name of a distribution."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", requirement)[0]).lower()


def optional_requirements(*groups):
    """Distributions that groups of requirements name."""
    optional = PROJECT["optional-dependencies"]
    return {normalise_name(item) for group in groups for item in optional.get(group, ())}


def imports_of(path):
    """Top-level names that a module imports, wherever in it, also for type checkers alone."""
    for node in nodes(path):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield str(node.module).partition(".")[0]


homes_of_packages = cache(packages_distributions)


def imported_distributions(*folders):
    """Distributions that modules in folders import, each with one that does."""
    homes = homes_of_packages()
    distributions = {}
    for path in (path for folder in folders for path in sorted(folder.rglob("*.py*"))):
        if path.suffix in {".py", ".pyi"}:
            for name in set(imports_of(path)) - OWN_PACKAGES - sys.stdlib_module_names:
                places = homes.get(name) or [UNSEEN.get(name, name)]
                distributions.update({normalise_name(place): str(path.relative_to(ROOT)) for place in places})
    return distributions


@pytest.fixture(scope="module")
def package_imports():
    """Distributions that the package imports."""
    return imported_distributions(Path(reliab.__file__).parent)


def test_imports_of_the_package_are_required(package_imports):
    requirements = {normalise_name(item) for item in PROJECT["dependencies"]}
    missing = {
        name: path
        for name, path in package_imports.items()
        if name not in requirements | optional_requirements(*USER_GROUPS)
    }
    assert not missing


def test_requirements_of_the_package_are_imported(package_imports):
    requirements = {normalise_name(item) for item in PROJECT["dependencies"]} | optional_requirements(
        "cluster", "recordings"
    )
    assert requirements - INDIRECT <= set(package_imports)


def test_studies_need_nothing_beside_the_package(package_imports):
    assert set(imported_distributions(ROOT / "studies")) <= set(package_imports)
