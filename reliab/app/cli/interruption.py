"""Ctrl-C: it is noticed wherever it falls, and a command says what is kept and how to go on."""

import contextlib
import signal
import sys
import threading
from _thread import interrupt_main
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from reliab.core.errors import INTERRUPTED

if TYPE_CHECKING:
    from types import FrameType

_GOES_ON: Final = {
    "simulate": ("--out", "The motions that are finished are kept; go on with --resume."),
    "run": ("", "The stages that are finished are kept; the same command goes on from them."),
    "criterion": ("--chains", "The chains are kept; the same command goes on with them."),
    "diagnose": ("--out", "The chains are kept; the same command goes on with them."),
}
"""By command the option that must have been given, and what goes on then."""

_REPEAT_DELAY = 0.2  # s after which a Ctrl-C that got lost is repeated
_NOTHING_HALF = "No file is half written; run the command again."


def interruption(arguments: Sequence[str]) -> str:
    """Say what Ctrl-C has left.

    >>> interruption(["simulate", "--out", "results.zarr"])
    'Interrupted. The motions that are finished are kept; go on with --resume.'
    >>> interruption(["explore"])
    'Interrupted. No file is half written; run the command again.'
    """
    command = arguments[0] if arguments else ""
    option, kept_work = _GOES_ON.get(command, ("", ""))
    is_given = any(argument.partition("=")[0] == option for argument in arguments)
    return f"Interrupted. {kept_work if kept_work and (is_given or not option) else _NOTHING_HALF}"


@contextlib.contextmanager
def notice_interruption() -> Iterator[None]:
    """Notice Ctrl-C while a command runs, also where a library loses it or makes another error of it.

    Compilers call Python back. What is raised there is lost, and they go on with half of their work or fail
    for a reason of their own. A Ctrl-C that was lost is repeated.
    """
    ctrl_c = threading.Event()
    is_main_thread = threading.current_thread() is threading.main_thread()
    if not is_main_thread or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return

    def press(number: int, frame: "FrameType | None") -> None:
        ctrl_c.set()
        signal.default_int_handler(number, frame)

    previous_hook = sys.unraisablehook
    repetitions: list[threading.Timer] = []

    def repeat_interruption(error: "sys.UnraisableHookArgs") -> None:
        if issubclass(error.exc_type, KeyboardInterrupt):
            repetitions.append(threading.Timer(_REPEAT_DELAY, interrupt_main))
            repetitions[-1].start()
        else:
            previous_hook(error)

    signal.signal(signal.SIGINT, press)
    sys.unraisablehook = repeat_interruption
    try:
        yield
    except Exception:
        if ctrl_c.is_set():
            raise SystemExit(INTERRUPTED) from None
        raise
    finally:
        for repetition in repetitions:
            repetition.cancel()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.unraisablehook = previous_hook
