"""The program `reliab`, also as `python -m reliab`."""

import contextlib
import gc
import sys
import tempfile
import traceback

from reliab.core.errors import INTERRUPTED, UNEXPECTED
from reliab.core.interruption import notice_interruption

_ALLOCATED = 1_000_000  # objects after which cycles are looked for: imports make many, most of which stay


def main() -> None:
    """Run the command line; Ctrl-C and a fault of the program end it with a sentence, also during imports."""
    gc.set_threshold(_ALLOCATED, *gc.get_threshold()[1:])
    try:
        with notice_interruption():
            from reliab.app.cli import main as command_line
        command_line()
    except KeyboardInterrupt:
        sys.stderr.write("Interrupted.\n")
        sys.exit(INTERRUPTED)
    except Exception as error:  # noqa: BLE001 - whatever it is, its exit code must be no answer
        sys.stderr.write(_report(error))
        sys.exit(UNEXPECTED)
    finally:
        gc.freeze()  # the process ends: what it holds need not be searched for cycles


def _report(error: Exception) -> str:
    """Say how to report a fault, with its traceback in a file, or above where none can be written."""
    shown = "".join(traceback.format_exception(error))
    place = "the traceback above"
    with (
        contextlib.suppress(OSError),
        tempfile.NamedTemporaryFile(
            "w",
            prefix="reliab-fault-",
            suffix=".txt",
            encoding="utf-8",
            errors="backslashreplace",
            delete=False,
        ) as file,
    ):
        file.write(f"{' '.join(sys.argv)}\n\n{shown}")
        place, shown = f"the traceback in {file.name}", ""
    return (
        f"{shown}Error: reliab itself has failed ({type(error).__name__}); this says nothing about the test. "
        f"Please report it with the command, what `reliab info` prints, and {place}.\n"
    )


if __name__ == "__main__":
    main()
