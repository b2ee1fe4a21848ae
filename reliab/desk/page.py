"""What all pages of the desk are: a form, its arguments, and an answer whose progress they show."""

import json
import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, ClassVar, Final

import panel as pn

from reliab.core.errors import InputError
from reliab.desk.elements import button, downloads, html, progress_html, refusal
from reliab.desk.folder import DeskFolder
from reliab.desk.jobs import Job, Jobs, PageMemory

_PARTS: Final = ("command", "measured", "time", "force", "ground")
_NUMBERS: Final = ("threshold", "wait")  # arguments without a standard deviation


def select_filled(values: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Take the arguments of these names that are filled in; those that are plain numbers as such.

    >>> select_filled({"f": " 1±0.01 ", "xi": "", "threshold": "0,05"}, ("f", "xi", "threshold"))
    {'f': '1±0.01', 'threshold': 0.05}
    """
    entries = {name: values.get(name) for name in names}
    texts = {name: value.strip() if isinstance(value, str) else value for name, value in entries.items()}
    return {
        name: number(value, name) if name in _NUMBERS else value
        for name, value in texts.items()
        if value not in ("", None)
    }


def number(text: str, name: str) -> float:
    """Read a number of a form."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        raise InputError(
            f"The value of `{name}` must be a number", value=repr(text), remedy="Correct it"
        ) from None


def command_line(command: str, files: Iterable[str], arguments: Mapping[str, Any]) -> str:
    """Write a question as the command that asks it.

    >>> command_line("assess", ["my test.csv"], {"f": "1±0.01", "test_name": "run 2"})
    "reliab assess 'my test.csv' --f '1±0.01' --test 'run 2'"
    """
    options = [
        text
        for name, value in arguments.items()
        for text in (
            f"--{_OPTIONS.get(name, name.replace('_', '-'))}",
            *(() if value is True else (str(value),)),
        )
    ]
    return shlex.join(["reliab", *command.split(), *map(_as_file, files), *options])


_OPTIONS: Final = {"test_name": "test"}


def _as_file(name: str) -> str:
    """Keep a name that begins with a dash from being taken for an option."""
    return f"./{name}" if name.startswith("-") else name


def python_line(function: str, files: Iterable[str], arguments: Mapping[str, Any]) -> str:
    """Write a question as a line of Python.

    >>> python_line("assess", ["test.csv"], {"f": "1±0.01", "threshold": 0.05})
    "reliab.assess('test.csv', f='1±0.01', threshold=0.05)"
    """
    names = list(files)
    first = repr(names[0]) if len(names) == 1 else repr(names)
    return f"reliab.{function}({', '.join([first, *(f'{n}={v!r}' for n, v in arguments.items())])})"


def channels_toml(corrections: Mapping[str, Mapping[str, Any]], rate: float | None = None) -> str:
    """Write corrections of channels as the file `channels.toml`; empty where nothing is corrected.

    >>> print(channels_toml({"measured": {"column": "LVDT", "unit": "mm", "sign": -1}}, 256.0))
    [channels.measured]
    column = "LVDT"
    unit = "mm"
    sign = -1
    <BLANKLINE>
    [sampling]
    rate_hz = 256.0
    <BLANKLINE>
    """
    tables = [
        "\n".join(
            [f"[channels.{channel}]", *(f"{name} = {_toml(value)}" for name, value in table.items()), ""]
        )
        for channel, table in corrections.items()
        if channel in _PARTS and table
    ]
    return "\n".join([*tables, *([f"[sampling]\nrate_hz = {rate!r}\n"] if rate else [])])


def _toml(value: str | int) -> str:
    """Write a value as TOML does; its texts are those of JSON but for one letter."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


REFRESH: Final = 150  # ms between two looks at the work of a page


@dataclass(frozen=True, kw_only=True)
class Desk:
    """What the pages share."""

    folder: DeskFolder
    jobs: Jobs
    write_as_options: Callable[[str], str]  # Writes the arguments that a message names as options


class Page:
    """A page, for one tab of a browser."""

    name: ClassVar[str]
    title: ClassVar[str]
    heading: ClassVar[str]
    about: ClassVar[str]

    def __init__(self, desk: Desk, memory: PageMemory) -> None:
        self.desk, self.memory = desk, memory
        self.form = pn.Column(sizing_mode="stretch_width")
        self.result = pn.Column(sizing_mode="stretch_width")
        self.status = html()
        self.stop = button("Cancel", self.cancel)
        self.stop.visible = False
        self._seen: dict[str, tuple[object, ...]] = {}
        self.build()
        self.refresh()

    def build(self) -> None:
        """Fill form and result."""
        raise NotImplementedError

    def show(self, kind: str, job: Job) -> None:
        """Show what has become of a job."""
        raise NotImplementedError

    def refresh(self) -> None:
        """Look at the jobs, and show those that went on."""
        for kind, job in tuple(self.memory.jobs.items()):
            state = (id(job), job.state, job.task, job.progress, len(job.news))
            if self._seen.get(kind) != state:
                self._seen[kind] = state
                self.show(kind, job)
        waiting = [job for job in self.memory.jobs.values() if not job.is_over]
        refusals = [job for job in self.memory.jobs.values() if job.refusal]
        texts = (refusal(self.desk.write_as_options(job.refusal)) for job in refusals)
        text = progress_html(waiting[0]) if waiting else "".join(texts)
        if self.status.object != text:
            self.status.object = text
        self.stop.visible = bool(waiting)

    def start(self, kind: str, work: Callable[..., Any], **arguments: Any) -> None:  # noqa: ANN401
        """Start work; earlier work of the same kind is given up."""
        if kind in self.memory.jobs:
            self.desk.jobs.cancel(self.memory.jobs[kind])
        self.memory.jobs[kind] = self.desk.jobs.start(work, **arguments)

    def cancel(self) -> None:
        """Give up all work of the page."""
        for job in self.memory.jobs.values():
            self.desk.jobs.cancel(job)

    def forget(self, kinds: Iterable[str]) -> None:
        """Forget what came of work whose question has changed."""
        for kind in kinds:
            job = self.memory.jobs.pop(kind, None)
            self._seen.pop(kind, None)
            if job is not None:
                self.desk.jobs.cancel(job)

    def attempt(self, act: Callable[[], None]) -> None:
        """Do what a user asks, and say why it is refused where it is."""
        try:
            act()
        except InputError as error:
            self.memory.jobs["form"] = Job(state="refused", refusal=str(error))
        else:
            self.memory.jobs.pop("form", None)
        self.refresh()

    def new_place(self) -> Path:
        """Make a folder for the files of an answer."""
        self.memory.place = self.desk.folder.new_place()
        return self.memory.place


class FiledPage(Page):
    """A page with one kind of work, which ends in a report."""

    work_kind: ClassVar[str]

    def lay_out_answer(self) -> None:
        """Put status, news, files and report below one another."""
        self.names, self.news, self.report = html(), html(), html()
        self.list_files()
        self.files = pn.Column(sizing_mode="stretch_width")
        self.lines = pn.Column(sizing_mode="stretch_width")
        self.result[:] = [self.status, self.news, self.files, self.report, self.lines]

    def list_files(self) -> None:
        """Name the files that were dropped."""
        items = "".join(f"<li>{escape(path.name)}</li>" for path in self.memory.files)
        self.names.object = f"<ul>{items}</ul>" if items else "<p class='hint'>No file yet.</p>"

    def take_files(self, dropped_files: Mapping[str, bytes | str]) -> None:
        """Keep dropped files together in one folder; one of a name that is there takes its place."""

        def keep() -> None:
            files = self.memory.files
            place = files[0].parent if files else self.desk.folder.new_place()
            for name, content in dropped_files.items():
                path = self.desk.folder.keep(name, content, place=place)
                if path not in files:
                    files.append(path)
            self.list_files()

        self.attempt(keep)

    def remove_files(self) -> None:
        """Forget the files and what came of them."""
        self.memory.files.clear()
        self.forget((self.work_kind, "form"))
        self.show_nothing()
        self.list_files()
        self.refresh()

    def show_nothing(self) -> None:
        """Empty the answer."""
        self.news.object = self.report.object = ""
        self.files.clear()
        self.lines.clear()

    def ask(self, work: Callable[..., Any], **arguments: Any) -> None:  # noqa: ANN401 - of the work
        """Start the page's work."""
        self.forget((self.work_kind,))
        self.show_nothing()
        self.start(self.work_kind, work, folder=str(self.new_place()), **arguments)

    def show(self, kind: str, job: Job) -> None:
        """Show the report and offer the files."""
        if kind == self.work_kind and job.outcome is not None:
            self.report.object = job.outcome.html
            self.files[:] = [downloads(job.outcome.files)]
