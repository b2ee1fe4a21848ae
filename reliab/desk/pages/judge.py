"""Judge: drop a test, see what was recognised in it, and get its verdict."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any, Final

import panel as pn

from reliab.desk.drawings import draw_traces
from reliab.desk.elements import (
    KNOWING,
    button,
    choice,
    copyable,
    dropper,
    field,
    folded,
    html,
    listed,
    refusal,
)
from reliab.desk.jobs import Job
from reliab.desk.page import Page
from reliab.desk.questions import channels_toml, command_line, filled, number, python_line
from reliab.desk.verdict_view import VerdictView
from reliab.desk.work import Look, judge, look_at
from reliab.errors import InputError

PARTS: Final = ("command", "measured", "time", "force", "ground")
_UNITS: Final = {
    "command": ["", "m", "cm", "mm", "in"],
    "measured": ["", "m", "cm", "mm", "in"],
    "time": ["", "s", "ms"],
    "force": ["", "N", "kN", "kgf", "lbf", "kip"],
    "ground": ["", "m/s2", "cm/s2", "g"],
}
_RECOGNISED: Final = "as recognised"
STATED: Final = (
    "f",
    "xi",
    "alpha",
    "specimen",
    "threshold",
    "metric",
    "mass",
    "scale",
    "skew",
    "feedback_lag",
)
"""Fields of the form, which are arguments of `reliab.assess`."""


def corrections_of(values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Read what a form corrects of the channels.

    >>> corrections_of({"column_measured": "LVDT", "sign_measured": "-1", "unit_time": ""})
    {'measured': {'column': 'LVDT', 'sign': -1}}
    """
    corrected = {}
    for part in PARTS:
        table = filled({name: values.get(f"{name}_{part}") for name in ("column", "unit")})
        if values.get(f"sign_{part}") == "-1":
            table["sign"] = -1
        if table:
            corrected[part] = table
    return corrected


class JudgePage(Page):
    """One test."""

    name = "judge"
    title = "Judge"
    heading = "Judge a test"
    about = "Drop the file of a test. The desk shows what it recognised, then computes the error of this very test."

    def build(self) -> None:
        """Lay out the form, what was recognised, and the verdict."""
        memory = self.memory
        self._channels = pn.Column(sizing_mode="stretch_width")
        self._looked = pn.Column(sizing_mode="stretch_width")
        self._lines = pn.Column(sizing_mode="stretch_width")
        self._verdict = VerdictView()
        further = [field(memory, name) for name in ("mass", "scale", "skew", "feedback_lag")]
        self.form[:] = [
            dropper("1. Drop a test", self._take_test),
            html("<h2>2. State the structure</h2>" + KNOWING),
            *(field(memory, name) for name in ("f", "xi", "alpha", "threshold")),
            choice(memory, "metric", "Error that counts", {"root mean square (RMS)": "rms", "largest (MTE)": "mte"}),
            choice(
                memory, "specimen", "Specimen",
                {"may have yielded": "", "stayed linear": "linear", "learned from its force": "measured"},
            ),
            button("Judge this test", lambda: self.attempt(self._judge), "primary"),
            self.stop,
            folded(
                "More about the laboratory",
                *further, dropper("A frame instead of f and ξ (TOML)", self._take_frame),
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
        from reliab.shipped import shipped

        path = shipped("datasets", "sample_test/test.csv")
        self.memory.values |= {"f": "1±0.01", "xi": "0.02±0.002"}
        self.build()
        self._take_test({path.name: path.read_bytes()})

    def _take_test(self, dropped: Mapping[str, bytes | str]) -> None:
        def keep() -> None:
            self.memory.files = [self.desk.folder.keep(*next(reversed(dropped.items())))]
            kept = {*STATED, "structure"}
            self.memory.values = {name: self.memory.values[name] for name in kept & self.memory.values.keys()}
            self._look()

        self.attempt(keep)

    def _take_frame(self, dropped: Mapping[str, bytes | str]) -> None:
        def keep() -> None:
            self.memory.values["structure"] = str(self.desk.folder.keep(*next(iter(dropped.items()))))

        self.attempt(keep)

    def _look(self) -> None:
        self.forget(("look", "judge"))
        self._verdict.clear()
        self._lines.clear()
        self.start("look", look_at, path=str(self.memory.files[0]), **self._reading())
        self.refresh()

    def _reading(self) -> dict[str, Any]:
        """What is stated of the file: a test's name, and corrections as a file of channels."""
        values = self.memory.values
        rate = number(values["rate"], "rate") if values.get("rate") else None
        text = channels_toml(corrections_of(values), rate)
        reading = filled({"test_name": values.get("test_name")})
        if text:
            place = self.memory.files[0].parent / "channels"
            place.mkdir(exist_ok=True)
            (place / "channels.toml").write_text(text, encoding="utf-8")
            reading["channels"] = str(place / "channels.toml")
        return reading

    def _arguments(self) -> dict[str, Any]:
        values = self.memory.values
        stated = filled({name: values.get(name) for name in STATED})
        if stated.get("metric") == "rms":
            del stated["metric"]
        if "threshold" in stated:
            stated["threshold"] = number(stated["threshold"], "threshold")
        structure = filled({"structure": values.get("structure")})
        if structure:
            stated = {
                name: value for name, value in stated.items() if name not in ("f", "xi", "alpha", "mass")
            }
        return {**stated, **structure, **self._reading()}

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
            if job.news:
                if not self._verdict.column.objects:
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
        name, values = escape(self.memory.files[0].name), self.memory.values
        rows = "".join(
            f"<tr><td>{escape(one['channel'])}</td><td>{escape(one['column'])}</td><td>{escape(one['unit'] or 'no unit')}"
            f"</td><td>{escape(one['reason'])}</td><td>{escape('; '.join(one['applied']))}</td></tr>"
            for one in look.channels
        )
        heads = "".join(
            f'<th scope="col">{head}</th>'
            for head in ("Channel", "Column", "Unit", "Recognised by", "Applied")
        )
        table = (
            f"<div class='wide' tabindex='0' role='group' aria-label='Channels'><table><thead><tr>{heads}</tr></thead>"
            f"<tbody>{rows}</tbody></table></div>"
        )
        rate = f"{look.rate:.5g} samples a second" if look.rate else ""
        self._looked[:] = [
            html(f"<h2>What was recognised in {name}</h2>"),
            html(refusal(self.desk.in_options(look.refusal)) if look.refusal else f"<p>{rate}</p>{table}"),
            html(listed(look.notes)),
            draw_traces(look.traces),
        ]
        columns = {_RECOGNISED: "", **{column: column for column in look.columns}}
        fields: list[Any] = [html("<p class='hint'>Choose what a column is; the drawing follows.</p>")]
        if look.tests:
            fields.append(choice(self.memory, "test_name", "Test in this file", list(look.tests)))
        for part in PARTS:
            fields.append(choice(self.memory, f"column_{part}", f"Column of {part}", columns))
            units = {unit or "unit as recognised": unit for unit in _UNITS[part]}
            pair = [choice(self.memory, f"unit_{part}", f"Unit of {part}", units)]
            if part != "time":
                signs = {"as recorded": "", "reversed": "-1"}
                pair.append(choice(self.memory, f"sign_{part}", f"Sign of {part}", signs))
            fields.append(pn.Row(*pair, sizing_mode="stretch_width"))
        rate_field = field(self.memory, "rate", "Sampling rate [Hz], if there is no time", "as in the file")
        for widget in (*fields[1:], rate_field):
            for one in widget if isinstance(widget, pn.Row) else (widget,):
                one.param.watch(lambda _event: self.attempt(self._look), "value")
        opened = bool(look.refusal or corrections_of(values) or values.get("rate") or look.tests)
        self._channels[:] = [
            folded("Correct what was recognised", *fields, rate_field, opened=opened)
        ]  # fmt: skip
