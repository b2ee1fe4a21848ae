"""What all pages of the desk are: a form, an answer or report, and work whose progress they show."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, ClassVar, Final

import panel as pn

from reliab.core.errors import InputError
from reliab.desk.elements import button, downloads, html, progress_html, refusal
from reliab.desk.folder import DeskFolder
from reliab.desk.jobs import Job, Jobs
from reliab.desk.memory import PageMemory

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
