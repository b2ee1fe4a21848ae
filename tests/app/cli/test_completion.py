"""The shell completes names of what ships and what is registered."""

import pytest
import typer

from reliab.app.cli import application
from reliab.criterion.methods.registry import METHODS
from reliab.study.description import folders_of_studies

COMMANDS = typer.main.get_group(application()).commands
CASES = [
    ("assess", "tests", "sa", ["sample_test"]),
    ("assess", "tests", "", []),  # left to the shell, which offers files
    ("monitor", "source", "sa", ["sample_test"]),
    ("diagnose", "campaign", "rig_b", ["rig_b"]),
    ("assess", "metric", "", ["rms", "mte"]),
    ("report", "paper", "l", ["letter"]),
    ("simulate", "motions", "syn", ["synthetic"]),
    ("criterion", "results", "r", ["real_suite"]),
    ("criterion", "law", "dim", ["dimensionless"]),
    ("validate", "method", "", list(METHODS)),
    pytest.param("run", "study", "", sorted(folders_of_studies()), marks=pytest.mark.of_studies),
    pytest.param("run", "study", "quick", ["quick"], marks=pytest.mark.of_studies),
]


@pytest.mark.parametrize(("command", "option", "prefix", "names"), CASES)
def test_names_are_completed(command, option, prefix, names):
    (parameter,) = [item for item in COMMANDS[command].params if item.name == option]
    context = typer.Context(COMMANDS[command], info_name=command)
    assert [item.value for item in parameter.shell_complete(context, prefix)] == names


def test_advanced_options_are_completed():
    command = COMMANDS["assess"]
    completions = {
        item.value for item in command.shell_complete(typer.Context(command, info_name="assess"), "--")
    }
    assert {"--f", "--skew", "--help-all"} <= completions
