"""What a release is made of beside the wheel says what the project says."""

import re
import tomllib
from pathlib import Path

from reliab.version import __version__

ROOT = Path(__file__).parents[2]
RELEASE = ROOT / ".ci/release"
ON_CONDA = {"seaborn": "seaborn-base", "matplotlib": "matplotlib-base", "typst": "typst-py"}


def test_the_recipe_requires_what_the_project_requires():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    pairs = (re.match(r"([\w-]+)>=([\d.]+)", item).groups() for item in project["dependencies"])
    expected = {f"{ON_CONDA.get(name, name)} >={least}" for name, least in pairs}
    recipe = (RELEASE / "conda/meta.yaml").read_text(encoding="utf-8")
    required = re.search(r"  run:\n((?:    - .*\n)+)", recipe)[1]
    stated = {line.removeprefix("    - ") for line in required.splitlines()}
    assert stated == expected | {f"python {project['requires-python']}"}


def test_the_recipe_has_this_version():
    recipe = (RELEASE / "conda/meta.yaml").read_text(encoding="utf-8")
    assert f'"RELIAB_VERSION", "{__version__}"' in recipe


def test_the_image_installs_the_wheel_and_runs_as_no_administrator():
    lines = (RELEASE / "Dockerfile").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith("USER ")] == ["USER laboratory"]
    assert lines.index("USER laboratory") < lines.index('ENTRYPOINT ["reliab"]')
