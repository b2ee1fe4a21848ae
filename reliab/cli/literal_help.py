"""Help that shows its texts as they are: a unit in brackets is no markup of Rich, which would swallow it."""

from typing import Any


def take_help_literally(command: Any) -> None:  # noqa: ANN401 - Typer hides its type
    """Escape the help of a command, of its options and of its own commands, once and for all."""
    from rich.markup import escape

    for shown in (command, *command.params):
        for name in ("help", "epilog"):
            if text := getattr(shown, name, None):
                setattr(shown, name, escape(text))
    for inner in getattr(command, "commands", {}).values():
        take_help_literally(inner)
