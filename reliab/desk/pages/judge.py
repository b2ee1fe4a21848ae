"""Judge a test that was dropped, follow one while its file is written, or compare several."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any, Final

import pandas as pd
import panel as pn

from reliab.core.errors import InputError
from reliab.core.files import written_whole
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent, percent_with_interval
from reliab.desk.elements import (
    KNOWING,
    METRICS,
    button,
    choice,
    copyable,
    dropper,
    field,
    fold_card,
    html,
    refusal,
    write_list,
)
from reliab.desk.jobs import Job
from reliab.desk.page import FiledPage, Page, channels_toml, command_line, number, python_line, select_filled
from reliab.desk.verdict_view import LiveDrawing, VerdictView, draw_traces
from reliab.desk.work import Judgement, Look, compare, follow, judge, look_at

PARTS: Final = ("command", "measured", "time", "force", "ground")
_UNITS: Final = {
    "command": ["", "m", "cm", "mm", "in"],
    "measured": ["", "m", "cm", "mm", "in"],
    "time": ["", "s", "ms"],
    "force": ["", "N", "kN", "kgf", "lbf", "kip"],
    "ground": ["", "m/s2", "cm/s2", "g"],
}
_AUTOMATIC: Final = "as recognised"
_STRUCTURE_FIELDS: Final = ("f", "xi", "alpha", "mass")
ARGUMENTS: Final = (
    *("f", "xi", "alpha", "specimen", "threshold", "metric"),
    *("mass", "scale", "skew", "feedback_lag"),
)
"""Fields of the form, which are arguments of `reliab.assess`."""


def corrections_of(values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Read what a form corrects of the channels.

    >>> corrections_of({"column_measured": "LVDT", "sign_measured": "-1", "unit_time": ""})
    {'measured': {'column': 'LVDT', 'sign': -1}}
    """
    corrections = {}
    for channel in PARTS:
        choices = {name: values.get(f"{name}_{channel}") for name in ("column", "unit")}
        table = select_filled(choices, choices)
        if values.get(f"sign_{channel}") == "-1":
            table["sign"] = -1
        if table:
            corrections[channel] = table
    return corrections


def channels_html(look: Look) -> str:
    """Tabulate the recognised channels, and why each was recognised."""
    columns = {"channel": "Channel", "column": "Column", "unit": "Unit", "reason": "Recognised by"}
    table = pd.DataFrame(look.channels)[[*columns, "applied"]].rename(columns=columns)
    table["Applied"] = table.pop("applied").map("; ".join)
    rate = f"<p>{look.rate:.5g} samples a second</p>" if look.rate else ""
    rows = table.to_html(index=False, border=0, escape=True)
    return f"{rate}<div class='wide' tabindex='0' role='group' aria-label='Channels'>{rows}</div>"


class JudgePage(Page):
    """One test."""

    name = "judge"
    title = "Judge"
    heading = "Judge a test"
    about = "Drop the file of a test. See what was recognised in it, then get the error of this very test."

    def build(self) -> None:
        """Lay out the form, what was recognised, and the verdict."""
        memory = self.memory
        self._channels = pn.Column(sizing_mode="stretch_width")
        self._file = html()
        self._menus: tuple[object, ...] = ()
        self._looked = pn.Column(sizing_mode="stretch_width")
        self._lines = pn.Column(sizing_mode="stretch_width")
        self._verdict = VerdictView()
        further_fields = [field(memory, name) for name in ("mass", "scale", "skew", "feedback_lag")]
        self.form[:] = [
            dropper("1. Drop a test", self._take_test),
            html("<h2>2. State the structure</h2>" + KNOWING),
            *(field(memory, name) for name in ("f", "xi", "alpha", "threshold")),
            choice(memory, "metric", "Error that counts", METRICS),
            choice(
                memory, "specimen", "Specimen",
                {"may have yielded": "", "stayed linear": "linear", "learned from its force": "measured"},
            ),
            button("Judge this test", lambda: self.attempt(self._judge), "primary"),
            self.stop,
            fold_card(
                "More about the laboratory",
                *further_fields, dropper("A frame instead of f and ξ (TOML)", self._take_frame),
            ),
            self._channels,
        ]  # fmt: skip
        self.result[:] = [self.status, self._verdict.column, self._lines, self._looked]
        if not memory.files:
            self._looked[:] = [
                html("<p>No test yet. Drop one at the left, or try the one that comes with reliab.</p>"),
                button("Show me with the shipped test", self._take_sample),
            ]

    def _take_sample(self) -> None:
        path = shipped("datasets", "sample_test/test.csv")
        self.memory.values |= {"f": "1±0.01", "xi": "0.02±0.002"}
        self.build()
        self._take_test({path.name: path.read_bytes()})

    def _take_test(self, dropped_files: Mapping[str, bytes | str]) -> None:
        def keep() -> None:
            self.memory.files = [self.desk.folder.keep_last(dropped_files)]
            about_structure = {*ARGUMENTS, "structure"} & self.memory.values.keys()
            self.memory.values = {name: self.memory.values[name] for name in about_structure}
            self._look()

        self.attempt(keep)

    def _take_frame(self, dropped_files: Mapping[str, bytes | str]) -> None:
        def keep() -> None:
            self.memory.values["structure"] = str(self.desk.folder.keep_last(dropped_files))

        self.attempt(keep)

    def _look(self) -> None:
        self.forget(("look", "judge"))
        self._verdict.clear()
        self._lines.clear()
        self.start("look", look_at, path=str(self.memory.files[0]), **self._reading())
        self.refresh()

    def _reading(self) -> dict[str, Any]:
        """State a test's name, and corrections as a file of channels."""
        values = self.memory.values
        rate = number(values["rate"], "rate") if values.get("rate") else None
        text = channels_toml(corrections_of(values), rate)
        reading = select_filled(values, ("test_name",))
        if text:
            place = self.memory.files[0].parent / "channels"
            place.mkdir(exist_ok=True)
            with written_whole(place / "channels.toml") as file:
                file.write_text(text, encoding="utf-8")
            reading["channels"] = str(place / "channels.toml")
        return reading

    def _arguments(self) -> dict[str, Any]:
        values = self.memory.values
        arguments = select_filled(values, ARGUMENTS)
        if arguments.get("metric") == "rms":
            del arguments["metric"]
        frame = select_filled(values, ("structure",))
        for name in _STRUCTURE_FIELDS if frame else ():
            arguments.pop(name, None)
        return {**arguments, **frame, **self._reading()}

    def _judge(self) -> None:
        if not self.memory.files:
            raise InputError("A test's file is needed", value="none", remedy="Drop it on the page first")
        self.forget(("judge",))
        self._verdict.clear()
        self._lines.clear()
        test = str(self.memory.files[0])
        self.start("judge", judge, test=test, folder=str(self.new_place()), arguments=self._arguments())

    def show(self, kind: str, job: Job) -> None:
        """Show what was recognised, or the verdict."""
        if kind == "look" and job.outcome is not None:
            self._show_look(job.outcome)
        elif kind == "judge":
            if job.news and not self._verdict.column.objects:
                self._verdict.show(job.news[-1])
                self._show_lines()
            if job.outcome is not None:
                self._verdict.file(job.outcome)

    def _show_lines(self) -> None:
        arguments = self._arguments()
        for name in ("channels", "structure"):
            if name in arguments:
                arguments[name] = Path(arguments[name]).name
        file = [self.memory.files[0].name]
        self._lines[:] = [
            html("<h2>The same without the desk</h2>"),
            copyable("command", command_line("assess", file, arguments)),
            copyable("line of Python", python_line("assess", file, arguments)),
        ]

    def _show_look(self, look: Look) -> None:
        channels = refusal(self.desk.write_as_options(look.refusal)) if look.refusal else channels_html(look)
        self._looked[:] = [
            html(f"<h2>What was recognised in {escape(self.memory.files[0].name)}</h2>{channels}"),
            html(write_list(look.notes)),
            draw_traces(look.traces),
        ]
        values = self.memory.values
        text = channels_toml(corrections_of(values))
        self._file.object = (
            f"<p class='hint'>As channels.toml:</p><code>{escape(text)}</code>" if text else ""
        )
        menus = (str(self.memory.files[0]), look.columns, look.tests)
        if menus == self._menus:  # a menu that is in use stays as it is
            return
        self._menus = menus
        widgets = self._corrections(look)
        for widget in widgets:
            widget.param.watch(lambda _event: self.attempt(self._look), "value")
        is_open = bool(look.refusal or text or values.get("rate") or look.tests)
        hint = html("<p class='hint'>Choose what a column is; the drawing follows.</p>")
        self._channels[:] = [
            fold_card("Correct what was recognised", hint, *widgets, self._file, is_open=is_open)
        ]

    def _corrections(self, look: Look) -> list[Any]:
        """Menus for the test, the column, unit and sign of each channel, and the rate."""
        memory, columns = self.memory, {_AUTOMATIC: "", **{column: column for column in look.columns}}
        menus = [choice(memory, "test_name", "Test in this file", list(look.tests))] if look.tests else []
        for channel in PARTS:
            units = {unit or "unit as recognised": unit for unit in _UNITS[channel]}
            menus.append(choice(memory, f"column_{channel}", f"Column of {channel}", columns))
            menus.append(choice(memory, f"unit_{channel}", f"Unit of {channel}", units))
            if channel != "time":
                signs = {"as recorded": "", "reversed": "-1"}
                menus.append(choice(memory, f"sign_{channel}", f"Sign of {channel}", signs))
        return [*menus, field(memory, "rate", "Sampling rate [Hz], if there is no time", "as in the file")]


_ARGUMENTS = ("f", "xi", "alpha", "threshold")


class ComparePage(FiledPage):
    """Several tests."""

    name = "compare"
    title = "Compare"
    heading = "Compare tests"
    about = "Drop tests of one structure and rig, such as one with each compensator, to rank them by error."
    work_kind = "compare"

    def build(self) -> None:
        """Lay out the form and the ranking."""
        self.lay_out_answer()
        self.form[:] = [
            dropper("1. Drop two tests or more", self.take_files, multiple=True),
            self.names,
            button("Remove all tests", self.remove_files),
            html("<h2>2. State their structure</h2>" + KNOWING),
            *(field(self.memory, name) for name in _ARGUMENTS),
            button("Compare", lambda: self.attempt(self._compare), "primary"),
            self.stop,
        ]

    def _compare(self) -> None:
        if len(self.memory.files) < 2:  # noqa: PLR2004 - a comparison is of two
            raise InputError(
                "A comparison needs two tests or more", value=len(self.memory.files), remedy="Drop another"
            )
        arguments = select_filled(self.memory.values, _ARGUMENTS)
        names = [path.name for path in self.memory.files]
        self.ask(compare, tests=list(map(str, self.memory.files)), arguments=arguments)
        self.lines[:] = [copyable("command", command_line("compare", names, arguments))]


_LIVE_ARGUMENTS = ("f", "xi", "alpha", "scale", "feedback_lag")
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
            *(field(self.memory, name) for name in (*_LIVE_ARGUMENTS[:3], "threshold", *_LIVE_ARGUMENTS[3:])),
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
        arguments = select_filled(values, (*_LIVE_ARGUMENTS, "threshold", "wait"))
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
