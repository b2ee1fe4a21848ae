"""Help is told panel by panel, everyday options first; its whole text is kept in `help.txt`.

`python tests/app/cli/test_help.py` keeps it anew; what differs is then read in the commit.
"""

import re
from pathlib import Path

import pytest
import typer

from reliab.app.cli import application, run
from reliab.app.options import PANELS

GOLDEN_HELP = Path(__file__).with_name("help.txt")
ROOT = typer.main.get_command(application())
LONGEST = 110  # characters of a line of help


def leaves(command=ROOT, path=()):
    """Yield each command with its path."""
    inner = getattr(command, "commands", {})
    for name, item in inner.items():
        yield from leaves(item, (*path, name))
    if not inner:
        yield path, command


LEAVES = [pytest.param(command, id=" ".join(path)) for path, command in leaves()]


def help_lines(path, command):
    """Give the lines of a command's help: a title for each panel, and a + before what --help-all adds."""
    yield f"reliab {' '.join(path)}"
    yield from (f"    {line}".rstrip() for line in (command.help or "").splitlines())
    panel = None
    for parameter in command.params:
        if getattr(parameter, "hidden", False):
            continue
        if parameter.param_type_name == "argument":
            yield f"    {parameter.metavar}  {parameter.help}"
            continue
        if parameter.rich_help_panel != panel:
            panel = parameter.rich_help_panel
            yield f"  {panel}"
        mark = "+" if parameter.name in command.advanced_names else " "
        flags = ",".join([*parameter.opts, *parameter.secondary_opts])
        yield f"  {mark} {flags} {parameter.metavar or ''}  {parameter.help}"


def whole_help():
    return "\n".join(line for leaf in leaves() for line in (*help_lines(*leaf), "")) + "\n"


def test_help_of_every_command_equals_the_golden_text():
    assert whole_help() == GOLDEN_HELP.read_text(encoding="utf-8")


@pytest.mark.parametrize("asked", [[], ["assess"], ["record"], ["rig"], ["rig", "list"]])
def test_help_names_no_types_of_python(asked, capsys):
    assert run([*asked, "--help-all"] if asked == ["assess"] else [*asked, "--help"]) == 0
    assert not re.search(r"<(bool|str|path|list)", capsys.readouterr().out)


@pytest.mark.parametrize("command", LEAVES)
def test_panels_stand_in_their_order_and_everyday_options_before_others(command):
    titles = [panel.title for panel in PANELS]
    places = [
        (titles.index(parameter.rich_help_panel), parameter.name in command.advanced_names)
        for parameter in command.params
        if parameter.param_type_name == "option"
    ]
    assert places == sorted(places)


@pytest.mark.parametrize("command", LEAVES)
def test_one_line_tells_each_option(command):
    for parameter in command.params:
        if parameter.param_type_name == "option":
            assert parameter.help.endswith(".")
            assert len(parameter.help) <= LONGEST


def test_help_all_adds_advanced_options_and_help_stays_short(capsys):
    output = {}
    for arguments in ("--help", "--help-all", "--help"):
        assert run(["assess", arguments]) == 0
        output[arguments] = capsys.readouterr().out
    assert "--f,--frequency" in output["--help"]
    assert "--skew" not in output["--help"]
    assert "--help-all" in output["--help"]
    assert "--skew" in output["--help-all"]
    subset, complete = (len(output[arguments].splitlines()) for arguments in ("--help", "--help-all"))
    assert subset < 0.65 * complete


def test_commands_stand_in_groups(capsys):
    assert run(["--help"]) == 0
    output = capsys.readouterr().out
    order = [
        output.index(word) for word in ("Judge a test", "assess", "Prepare", "design", "Research", "ellipses")
    ]
    assert order == sorted(order)


if __name__ == "__main__":
    GOLDEN_HELP.write_text(whole_help(), encoding="utf-8")
