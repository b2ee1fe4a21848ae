"""Install the lowest versions that pyproject.toml allows and run the tests with them.

    python tests/lowest_versions.py [PYTEST ARGUMENT ...]

A virtual environment is made in a temporary folder. A bound that is not true shows itself as an
installation that fails or a test that does. Deprecations of old versions are no errors here.
"""

import os
import re
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_BOUND = re.compile(r"^([A-Za-z0-9_.\[\]-]+)\s*>=\s*([0-9][0-9.]*)")
_TEST_TOOLS = ("dask", "distributed", "hypothesis", "pytest")  # not mat-io, which needs newer ones


def lowest(requirement: str) -> str | None:
    """Pin a requirement to its lower bound; None where it has none.

    Examples
    --------
    >>> lowest("emcee>=3.1.6,<4"), lowest("pandas-stubs")
    ('emcee==3.1.6', None)
    """
    bound = _BOUND.match(requirement)
    return f"{bound[1]}=={bound[2]}" if bound else None


def pins() -> list[str]:
    """Lowest versions of what runs and of what tests it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    optional = [item for group in project["optional-dependencies"].values() for item in group]
    requirements = [*project["dependencies"], *(item for item in optional if item.startswith(_TEST_TOOLS))]
    return [pin for pin in map(lowest, requirements) if pin]


def main(arguments: list[str]) -> int:
    """Make the environment, install, run the tests; return their exit code."""
    with tempfile.TemporaryDirectory() as temporary:
        venv.create(temporary, with_pip=True)
        python = Path(temporary) / ("Scripts" if os.name == "nt" else "bin") / "python"
        subprocess.run(  # noqa: S603 - our own environment
            [python, "-m", "pip", "install", "--quiet", "--editable", ROOT, *pins()], check=True
        )
        subprocess.run([python, "-m", "pip", "check"], check=True)  # noqa: S603
        tests = [python, "-m", "pytest", "-W", "default", *arguments]
        return subprocess.run(tests, cwd=ROOT, check=False).returncode  # noqa: S603


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
