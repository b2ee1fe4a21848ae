"""Live: the error of a test while its file is written, and its verdict at the end."""

from collections.abc import Mapping
from html import escape
from typing import Any

import panel as pn

from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, percent_with_interval
from reliab.desk.drawings import LiveDrawing
from reliab.desk.elements import KNOWING, button, choice, field, html, write_list
from reliab.desk.jobs import Job
from reliab.desk.page import Page
from reliab.desk.questions import number, select_filled
from reliab.desk.verdict_view import VerdictView
from reliab.desk.work import Judgement, follow

_ARGUMENTS = ("f", "xi", "alpha", "scale", "feedback_lag")
_SAMPLE = "the test that comes with reliab"
_TEXTS = (".csv", ".txt", ".dat", ".tsv")


def moment_html(message: Mapping[str, Any]) -> str:
    """Say how a running test stands."""
    error = message.get("error") or {}
    size = error.get("rms") or {}
    so_far = (
        f"RMS error so far {percent_with_interval(size['value'], size['low'], size['high'])}, "
        f"{percent(error['probability'], decimals=0)} likely to be below the threshold."
        if size.get("value") is not None
        else "No interval yet."
        if message.get("rms") is None
        else f"RMS error so far {percent(message['rms'], 2)}."
    )
    alarms = message.get("sentences") or ()
    shown_alarms = f'<div class="refusal" role="alert">{write_list(alarms)}</div>' if alarms else ""
    return f'<p class="verdict"><b>{message["time_s"]:.1f} s</b> {escape(so_far)}</p>{shown_alarms}'


class LivePage(Page):
    """A running test."""

    name = "live"
    title = "Live"
    heading = "Follow a running test"
    about = (
        "Choose the text file that your controller writes. The desk follows it, and judges it when it ends."
    )

    def build(self) -> None:
        """Lay out the form, the drawing and the verdict."""
        self._moment, self._drawing, self._verdict = html(), LiveDrawing(), VerdictView()
        self._live = pn.Column(self._moment, self._drawing.column, sizing_mode="stretch_width", visible=False)
        files = {name: name for name in self.desk.folder.list_files(*_TEXTS)}
        self.form[:] = [
            choice(
                self.memory, "file", "File in the folder of the desk", {"": "", **files, _SAMPLE: _SAMPLE}
            ),
            field(self.memory, "coming", "or one that will be written there", "test_12.csv"),
            html("<h2>State the structure</h2>" + KNOWING),
            *(field(self.memory, name) for name in (*_ARGUMENTS[:3], "threshold", *_ARGUMENTS[3:])),
            field(self.memory, "wait", "It has ended when nothing comes for [s]", "10"),
            button("Follow", lambda: self.attempt(self._follow), "primary"),
            self.stop,
        ]
        self.result[:] = [self.status, self._verdict.column, self._live]

    def _follow(self) -> None:
        values = self.memory.values
        file = values.get("coming", "").strip() or values.get("file", "")
        if not file:
            raise InputError(
                "A file to follow is needed", value="none", remedy="Choose it, or name the coming one"
            )
        source = "sample_test" if file == _SAMPLE else str(self.desk.folder.within(file))
        arguments = select_filled(values, (*_ARGUMENTS, "threshold", "wait"))
        self.forget(("live",))
        self._verdict.clear()
        self.start("live", follow, source=source, folder=str(self.new_place()), arguments=arguments)

    def show(self, kind: str, job: Job) -> None:
        """Show how the test stands, and at its end the verdict."""
        messages = [news for news in job.news if isinstance(news, Mapping)]
        if messages:
            threshold = self.memory.values.get("threshold") or "0.05"
            self._live.visible = any(message.get("error") for message in messages)
            self._moment.object = moment_html(messages[-1])
            self._drawing.update(messages, number(threshold, "threshold"))
        judgements = [news for news in job.news if isinstance(news, Judgement)]
        if judgements and not self._verdict.column.objects:
            self._verdict.show(judgements[-1])
        if kind == "live" and job.outcome is not None:
            self._verdict.file(job.outcome)
