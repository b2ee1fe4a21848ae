"""A page whose answer is a report: its text and figures, and its files."""

from collections.abc import Callable
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
        self.news, self.report = html(), html()
        self.files = pn.Column(sizing_mode="stretch_width")
        self.lines = pn.Column(sizing_mode="stretch_width")
        self.result[:] = [self.status, self.news, self.files, self.report, self.lines]

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
