"""Results say with what they were computed."""

import platform
import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

from reliab.study import stages as module
from reliab.study.stages import environment

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def test_every_dependency_is_listed_with_its_version():
    requirements = tomllib.loads(PROJECT.read_text())["project"]["dependencies"]
    names = {re.match(r"[\w.-]+", line)[0] for line in requirements}
    listing = environment()["packages"]
    assert names <= set(listing)
    assert all(listing[name] == version(name) for name in names)


def test_the_processor_and_the_system_are_named():
    description = environment()
    assert all(description[name] for name in ("python", "system", "processor"))


@pytest.mark.parametrize("text", ["vendor: x\nmodel name\t: Quick  3000 \nflags\t: fpu", "no such line\n"])
def test_processor_has_the_name_of_the_system(tmp_path, monkeypatch, text):
    (tmp_path / "cpuinfo").write_text(text, encoding="utf-8")
    monkeypatch.setattr(module, "_PROCESSORS", tmp_path / "cpuinfo")
    labels = vars(module)["_processor"].__wrapped__()
    assert labels == ("Quick  3000" if "Quick" in text else platform.processor() or platform.machine())
