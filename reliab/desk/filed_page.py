"""A page whose answer is a report: its text and figures, and its files."""

from collections.abc import Callable, Mapping
from html import escape
from typing import Any, ClassVar

import panel as pn

from reliab.desk.elements import downloads, html
from reliab.desk.jobs import Job
from reliab.desk.page import Page


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
