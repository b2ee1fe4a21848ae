"""What a command says when Ctrl-C ends it: what is kept, and how to go on."""

from collections.abc import Sequence
from typing import Final

_GOES_ON: Final = {
    "simulate": ("--out", "The motions that are finished are kept; go on with --resume."),
    "run": ("", "The stages that are finished are kept; the same command goes on from them."),
    "criterion": ("--chains", "The chains are kept; the same command goes on with them."),
    "diagnose": ("--out", "The chains are kept; the same command goes on with them."),
}
"""By command the option that must have been given, and what goes on then."""

_NOTHING_HALF = "No file is half written; run the command again."


def interruption(arguments: Sequence[str]) -> str:
    """Say what Ctrl-C has left.

    Parameters
    ----------
    arguments : sequence of str
        What stands after `reliab`.

    Returns
    -------
    str
        One sentence or two.

    Examples
    --------
    >>> interruption(["simulate", "--out", "results.zarr"])
    'Interrupted. The motions that are finished are kept; go on with --resume.'
    >>> interruption(["explore"])
    'Interrupted. No file is half written; run the command again.'
    """
    command = arguments[0] if arguments else ""
    option, kept = _GOES_ON.get(command, ("", ""))
    given = any(argument.partition("=")[0] == option for argument in arguments)
    return f"Interrupted. {kept if kept and (given or not option) else _NOTHING_HALF}"
