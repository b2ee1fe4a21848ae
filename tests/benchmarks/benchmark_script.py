"""What benchmarks share: options of their command lines, and the shortest time of some work."""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

_Answer = TypeVar("_Answer")


def argument_parser(
    documentation: str | None, *positional: str, **options: object
) -> argparse.ArgumentParser:
    """Parse positional paths, and options by their defaults: False for a flag, else a number or a text.

    An option has a type where it has no default: `Path` may be left out, all others are required.
    """
    parser = argparse.ArgumentParser(
        description=documentation, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    for name in positional:
        parser.add_argument(name, type=Path)
    for name, default in options.items():
        flag = f"--{name.replace('_', '-')}"
        if default is False:
            parser.add_argument(flag, action="store_true")
        elif isinstance(default, type):
            parser.add_argument(flag, type=default, required=default is not Path)
        else:
            parser.add_argument(flag, type=type(default), default=default)
    return parser


def shortest_time(
    work: Callable[[], _Answer], repetitions: int, clock: Callable[[], float] = time.process_time
) -> tuple[_Answer, float]:
    """Return the answer of some work and its shortest time [s], without the first run, which compiles."""
    answer, times = work(), []
    for _ in range(repetitions):
        start = clock()
        answer = work()
        times.append(clock() - start)
    return answer, min(times)
