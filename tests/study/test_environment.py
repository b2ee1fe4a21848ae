"""Results say with what they were computed."""

import re
import tomllib
from importlib.metadata import version
from pathlib import Path

from reliab.study.environment import environment

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def test_every_dependency_is_listed_with_its_version():
    needed = tomllib.loads(PROJECT.read_text())["project"]["dependencies"]
    names = {re.match(r"[\w.-]+", line)[0] for line in needed}
    listed = environment()["packages"]
    assert names <= set(listed)
    assert all(listed[name] == version(name) for name in names)


def test_the_processor_and_the_system_are_named():
    described = environment()
    assert all(described[name] for name in ("python", "system", "processor"))
