"""Ctrl-C, which no library must lose."""

import contextlib
import signal
import sys
import threading
from _thread import interrupt_main
from collections.abc import Iterator
from typing import TYPE_CHECKING

from reliab.core.errors import INTERRUPTED

if TYPE_CHECKING:
    from types import FrameType

_REPEAT_DELAY = 0.2  # s, after which a Ctrl-C that was lost is repeated


@contextlib.contextmanager
def notice_interruption() -> Iterator[None]:
    """Notice Ctrl-C inside, also where a library loses it or makes another error of it.

    Compilers and the interpreter's own imports call Python back. What is raised there is lost, and they go on
    with half of their work or fail for a reason of their own. A Ctrl-C that was lost is repeated.
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
    else:
        if any(repetition.is_alive() for repetition in repetitions):
            raise KeyboardInterrupt
    finally:
        for repetition in repetitions:
            repetition.cancel()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.unraisablehook = previous_hook
