"""What every command prints: JSON for programs, tables and progress for people."""

import codecs
import io
import json
import os
import sys
import time
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from threading import Condition, Thread
from typing import TYPE_CHECKING, Any, Final, TextIO

import typer

from reliab.core.columns import Columns, side, write_cells
from reliab.core.errors import CLOSED_PIPE
from reliab.core.files import write_json_file
from reliab.core.progress import Progress, quietly, shows_tasks

if TYPE_CHECKING:
    from rich.console import Console
    from typing_extensions import Buffer


_WIDTH_OF_PIPES = 160


def console() -> "Console":
    """Return a console for results: as wide as the terminal; in a pipe of a fixed width for sentences."""
    from reliab.app.cli.literal_console import LiteralConsole

    terminal = LiteralConsole()
    return terminal if terminal.is_terminal else LiteralConsole(width=_WIDTH_OF_PIPES)


def say(*sentences: str, style: str | None = None, soft_wrap: bool = False) -> None:
    """Print sentences, each from the beginning of a line, with the arguments that they name as options."""
    terminal = console()
    for sentence in sentences:
        terminal.print(_WRITE_AS_OPTIONS.get()(sentence), style=style, highlight=False, soft_wrap=soft_wrap)


LINES: Final = 10
"""Of an answer that is not asked for with all details."""


def say_briefly(
    headline: str,
    findings: Sequence[str],
    actions: Sequence[str],
    *,
    hidden: Callable[[int], str],
    style: str = "bold",
) -> None:
    """Print an outcome, the findings that fit into ten lines, and what to do last.

    `hidden`: says by the number of findings that are shown where the others are.
    """
    shown = list(findings)
    while shown and sum(map(_height, [headline, *shown, hidden(len(shown)), *actions])) > LINES:
        shown.pop()
    say(headline, style=style)
    say(*shown, hidden(len(shown)), *actions)


def _height(sentence: str) -> int:
    """Lines of the terminal that a sentence takes."""
    from rich.text import Text

    terminal = console()
    return len(Text(sentence).wrap(terminal, terminal.width))


_WRITE_AS_OPTIONS: ContextVar[Callable[[str], str]] = ContextVar("write_as_options", default=str)


@contextmanager
def speaking(write_as_options: Callable[[str], str]) -> Iterator[None]:
    """Write arguments that printed sentences name as options of the command line."""
    token = _WRITE_AS_OPTIONS.set(write_as_options)
    try:
        yield
    finally:
        _WRITE_AS_OPTIONS.reset(token)


def say_population(promises: Iterable[tuple[float | None, str]], position: str) -> None:
    """Print for which ground motions criteria are valid, and where the case asked for lies outside of these.

    `stated`: the share [-] and the population of each.
    """
    from reliab.criterion.scope import Position, populations_in_words

    valid_for = populations_in_words(promises)
    say(*valid_for)
    if valid_for and position != Position.INSIDE:
        say(f"The case asked for lies {position} of these motions.", style="yellow")


def write_line(text: str) -> None:
    """Print a line, in characters that the terminal or pipe has; `typer.echo` alone would not ask it."""
    typer.echo(text, file=sys.stdout)


def takes_any_character(stream: TextIO) -> bool:
    """Tell whether a stream can write every character, which only UTF encodings can."""
    return (getattr(stream, "encoding", None) or "utf-8").lower().startswith("utf")


def replace_unwritable_characters(stream: TextIO) -> TextIO:
    """Replace characters that a terminal or pipe cannot show, "ξ" by "xi", and end where nobody reads on."""
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    stream = _ending_with_its_reader(stream)
    if takes_any_character(stream):
        stream.reconfigure(errors="backslashreplace")  # for names of files that are no text
    else:
        codecs.register_error(_SUBSTITUTION, _substitute)
        stream.reconfigure(errors=_SUBSTITUTION)
    return stream


def _ending_with_its_reader(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """Return the same stream, on which a closed pipe ends the command; terminals cannot be closed."""
    try:
        number = stream.fileno()
    except io.UnsupportedOperation:
        return stream
    if stream.isatty():
        return stream
    return io.TextIOWrapper(
        io.BufferedWriter(_ReadPipe(number, "wb", closefd=False)),
        encoding=stream.encoding,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


class _ReadPipe(io.FileIO):
    """A pipe or file. Libraries turn a closed pipe into exit code 1, which is an answer of ours."""

    def write(self, data: "Buffer", /) -> int:
        try:
            return super().write(data)
        except OSError as error:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())  # what is still held back would fail once more at the end
            os.close(nowhere)
            if isinstance(error, BrokenPipeError):
                raise SystemExit(CLOSED_PIPE) from None
            raise


def _substitute(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    missing = error.object[error.start : error.end]
    text = "".join(_ASCII_SUBSTITUTES.get(character) or _remove_marks(character) for character in missing)
    return text, error.end


def _remove_marks(character: str) -> str:
    """Nearest plain text of a character, "R" for "ᴿ", "xi" for "ξ"; "?" where there is none."""
    parts = unicodedata.normalize("NFKD", character)
    plain = "".join(
        _ASCII_SUBSTITUTES.get(part) or _greek(part) for part in parts if not unicodedata.combining(part)
    )
    return plain.encode("ascii", "ignore").decode() or ("" if unicodedata.combining(character) else "?")


def _greek(letter: str) -> str:
    """Name of a Greek letter, as it is said; every other character as it is."""
    name = unicodedata.name(letter, "")
    return name.split()[-1].lower() if name.startswith("GREEK ") else letter


_SUBSTITUTION = "reliab"
_ASCII_SUBSTITUTES: Final = {
    "Σ": "sum",
    "λ": "lambda",
    "±": "+-",
    "°": " degrees",
    "µ": "u",
    "′": "'",
    "∝": "~",
    "█": "#",
    "√": "sqrt ",
    "≤": "<=",
    "≥": ">=",
    "≈": "~",
    "≠": "!=",
    "×": "x",
    "·": "*",
    "⋅": "*",
    "ß": "ss",
    "−": "-",
    "–": "-",
    "—": "-",
    "…": "...",
    "→": "->",
    "“": '"',
    "”": '"',
    "‘": "'",
    "’": "'",
    "∞": "inf",
}


def show_table(
    title: str, headings: Sequence[str] | Mapping[str, str], rows: Iterable[Sequence[str]]
) -> None:
    """Print a table of texts; a mapping says which headings stand "left" and which "right"."""
    from reliab.report.document import text_table
    from reliab.report.terminal import print_blocks

    print_blocks((text_table(rows, headings, caption=title),), console())


def show_rows(title: str, columns: Columns, rows: Iterable[Mapping[str, Any]]) -> None:
    """Print a table of rows."""
    sides = {heading: side(column) for heading, column in columns.items()}
    show_table(title, sides, write_cells(columns, rows))


def write_json(content: Mapping[str, Any] | Sequence[Any], target: str | None) -> bool:
    """Write JSON if it is asked for; return whether it went to standard output, which then is complete."""
    if target is None:
        return False
    if target == "-":
        ascii_only = not takes_any_character(sys.stdout)
        write_line(json.dumps(content, indent=2, ensure_ascii=ascii_only, allow_nan=False))
        return True
    write_json_file(content, target)
    return False


@contextmanager
def progress_bar(task: str) -> Iterator[Progress]:
    """Show a bar with the time left on a terminal, and lines that state it in a pipe or a file."""
    show = _bar if sys.stderr.isatty() else progress_lines
    with show(task) as report, shows_tasks(quietly):  # a task inside another is a part of it
        yield report


@contextmanager
def _bar(title: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress as Bar, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(compact=True),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)

        def report(count: int, total: int) -> None:
            bar.update(task, completed=count, total=total)

        yield report


FIRST_LINE = 10.0
"""Time [s] after which work is long enough for a line."""

_RAREST = 300.0  # s, between lines
_UNITS = ((3600.0, "hour"), (60.0, "minute"), (1.0, "second"))


@contextmanager
def progress_lines(task: str) -> Iterator[Progress]:
    """Write lines to the stream of errors while work goes on; none of short work.

    Lines become rarer; one comes as soon as the time that is left is known.
    """
    lines = _Lines(task)
    writer = Thread(target=lines.write, daemon=True)
    writer.start()
    try:
        yield lines.report
    finally:
        lines.end()
        writer.join()


class _Lines:
    """What is known of the work, and when the next line is due."""

    def __init__(self, task: str) -> None:
        self._what, self._pause = task, FIRST_LINE
        self._begin = self._clock = time.monotonic()
        self._done, self._before, self._total = 0, 0, 0
        self._changed, self._ended = Condition(), False

    def report(self, count: int, total: int) -> None:
        """Take the number of pieces that are done; what a first call states was done before."""
        with self._changed:
            if not self._total:
                self._before = count if count > 1 else 0
                self._clock = time.monotonic() if count > 1 else self._begin
            is_first = self._done == self._before < count
            self._done, self._total = count, total
            if is_first:
                self._changed.notify()

    def end(self) -> None:
        """Write no further line."""
        with self._changed:
            self._ended = True
            self._changed.notify()

    def write(self) -> None:
        """Write lines until the work ends."""
        due, is_estimated = self._begin + self._pause, True
        with self._changed:
            while not self._ended:
                now = time.monotonic()
                if now < due and (is_estimated or self._time_left is None):
                    self._changed.wait(due - now)
                    continue
                is_estimated = self._time_left is not None
                with suppress(OSError, ValueError):  # nobody reads on
                    sys.stderr.write(f"{self._line(now)}\n")
                    sys.stderr.flush()
                self._pause = min(2.0 * self._pause, _RAREST)
                due = now + self._pause

    @property
    def _time_left(self) -> float | None:
        """Time that is left [s], once a piece has shown how long one takes."""
        new = self._done - self._before
        if new <= 0:
            return None
        return (time.monotonic() - self._clock) / new * (self._total - self._done)

    def _line(self, now: float) -> str:
        remaining_time, elapsed_time = self._time_left, duration(now - self._begin)
        if remaining_time is None:
            return f"{self._what}: still at work after {elapsed_time}"
        duration_left = duration(remaining_time)
        return f"{self._what}: {self._done} of {self._total} after {elapsed_time}, about {duration_left} left"


def duration(seconds: float) -> str:
    """Write a duration in words.

    >>> duration(3.2), duration(95.0), duration(8000.0)
    ('3 seconds', '2 minutes', '2 hours')
    """
    size, unit = next((row for row in _UNITS if seconds >= 1.5 * row[0]), _UNITS[-1])
    count = max(round(seconds / size), 1)
    return f"{count} {unit}{'s' if count > 1 else ''}"
