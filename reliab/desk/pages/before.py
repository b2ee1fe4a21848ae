"""Before a test: what the structure tolerates, and what a rig of known history will do."""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import panel as pn

from reliab.assessment.design import boundaries_of_motions, tolerable_sides
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent, significant
from reliab.desk.elements import METRICS, Slider, button, choice, copyable, dropper, field, html, refusal
from reliab.desk.jobs import Job
from reliab.desk.page import FiledPage, Page, command_line, select_filled
from reliab.desk.verdict_view import RegionDrawing
from reliab.desk.work import points_of_rig, show_rig, trace_motion

_SAMPLE = "the rig that comes with reliab"
_ARGUMENTS = ("f", "xi", "alpha", "threshold")


def offer_rigs(page: Page, label: str, *, none: str = "") -> pn.widgets.Select:
    """Offer the rigs of the desk's folder, and the one that ships."""
    options = {
        **({none: ""} if none else {}),
        **{name: name for name in page.desk.folder.list_files(holding="tests/*.json")},
    }
    return choice(page.memory, "rig", label, {**options, _SAMPLE: _SAMPLE})


def path_of_rig(page: Page) -> str:
    """Return the folder of the rig that is chosen."""
    name = page.memory.values.get("rig", "")
    return (
        str(shipped("datasets", "sample_rig"))
        if name in ("", _SAMPLE)
        else str(page.desk.folder.within(name))
    )


class RigPage(FiledPage):
    """One rig."""

    name = "rig"
    title = "Rig"
    heading = "Follow a rig"
    about = "See what a rig has done, whether it drifts, and what its next test will be."
    work_kind = "rig"

    def build(self) -> None:
        """Lay out the form and the report."""
        self.form[:] = [
            html(
                "<p class='hint'>A rig is a folder that <b>reliab rig add</b> fills. Those in the folder "
                "of the desk are offered here.</p>"
            ),
            offer_rigs(self, "Rig"),
            html("<h2>The next test</h2><p class='hint'>Left empty: like the last one.</p>"),
            *(field(self.memory, name) for name in _ARGUMENTS),
            button("Show the rig", lambda: self.attempt(self._show), "primary"),
            self.stop,
        ]
        self.lay_out_answer()

    def _show(self) -> None:
        arguments = select_filled(self.memory.values, _ARGUMENTS)
        self.ask(show_rig, rig=path_of_rig(self), arguments=arguments)


_SETTINGS: Final = ("title", "start", "end", "step", "value", "factor", "unit")
_SLIDERS: Final[Mapping[str, tuple[str | float, ...]]] = {
    "f": ("Natural frequency f", 0.25, 5.0, 0.01, 1.0, 1.0, "Hz"),
    "xi": ("Damping ratio ξ", 0.01, 0.1, 0.001, 0.02, 100.0, "%"),
    "alpha": ("Share of the stiffness in the laboratory α", 0.1, 1.0, 0.05, 1.0, 1.0, ""),
    "threshold": ("Largest error of a good test", 0.01, 0.2, 0.005, 0.05, 100.0, "%"),
    "confidence": ("Confidence", 0.5, 0.99, 0.01, 0.95, 100.0, "%"),
    "duration": ("Length of the record (0 for any)", 0.0, 90.0, 5.0, 0.0, 1.0, "s"),
}


class DesignPage(Page):
    """The tolerable region."""

    name = "before"
    title = "Before a test"
    heading = "Before a test"
    about = "Move the sliders to see how much amplitude error and delay the test may have."

    def build(self) -> None:
        """Lay out sliders, region and limits."""
        memory, self._is_due = self.memory, False
        self._limits, self._drawing = html(), RegionDrawing()
        self._line = pn.Column(sizing_mode="stretch_width")
        sliders = []
        for name, values in _SLIDERS.items():
            settings = dict(zip(_SETTINGS, values, strict=True))
            value = memory.values.setdefault(name, settings["value"])
            slider = Slider(**{**settings, "value": value}, sizing_mode="stretch_width")
            slider.param.watch(lambda event, name=name: self._move(name, event.new), "value")
            sliders.append(slider)
        metric = choice(memory, "metric", "Error that counts", METRICS)
        metric.param.watch(lambda _event: self._draw(), "value")
        rigs = offer_rigs(self, "Show the tests of a rig", none="none")
        rigs.param.watch(lambda _event: self.attempt(self._mark_rig), "value")
        self.form[:] = [
            *sliders,
            metric,
            rigs,
            dropper("Own ground motion", self._take_motion),
            self.stop,
        ]
        self.result[:] = [self.status, self._limits, self._drawing.pane, self._line]
        self._draw()
        if memory.values.get("rig"):
            self.attempt(self._mark_rig)

    def _move(self, name: str, value: float) -> None:
        """Draw once for all movements that have come by now."""
        self.memory.values[name] = value
        if not self._is_due:
            self._is_due = True
            pn.state.curdoc.add_next_tick_callback(self._draw)

    def _question(self) -> dict[str, Any]:
        values = self.memory.values
        return {
            **{name: float(values[name]) for name in ("f", "xi", "alpha", "threshold", "confidence")},
            "metric": values.get("metric", "rms"),
            "duration": float(values["duration"]) or None,
        }

    def _draw(self) -> None:
        self._is_due = False
        question = self._question()
        try:
            region = tolerable_sides(**question)
        except InputError as error:
            self._limits.object = refusal(str(error))
            self._drawing.update({}, (np.zeros(0), np.zeros(0)))
            return
        motions = boundaries_of_motions(
            **{name: question[name] for name in ("f", "xi", "alpha", "threshold", "metric")}
        )
        self._limits.object = limits_html(region, question)
        self._drawing.update({side: limits for side, limits in region.items() if all(limits)}, motions)
        options = {name: f"{question[name]:g}" for name in ("f", "xi", "alpha", "threshold", "confidence")}
        options |= {} if question["metric"] == "rms" else {"metric": question["metric"]}
        self._line[:] = [copyable("command", command_line("design", (), options))]

    def _mark_rig(self) -> None:
        self._drawing.mark_tests(points_of_rig(path_of_rig(self)) if self.memory.values.get("rig") else [])

    def _take_motion(self, dropped_files: Mapping[str, bytes | str]) -> None:
        def keep() -> None:
            self.memory.files = [self.desk.folder.keep_last(dropped_files)]
            self.memory.values["traced"] = None

        self.attempt(keep)

    def refresh(self) -> None:
        """Trace the own record anew when the sliders rest."""
        super().refresh()
        question = {
            name: value for name, value in self._question().items() if name not in ("confidence", "duration")
        }
        job = self.memory.jobs.get("record")
        if (
            self.memory.files
            and self.memory.values.get("traced") != question
            and (job is None or job.is_over)
        ):
            self.memory.values["traced"] = question
            self.start("record", trace_motion, motion=str(self.memory.files[0]), **question)

    def show(self, kind: str, job: Job) -> None:
        """Draw the boundary of the own record."""
        if kind == "record" and job.is_over:
            self._drawing.mark_record(job.outcome)


def limits_html(region: Mapping[str, tuple[float, float]], question: Mapping[str, Any]) -> str:
    """Say in numbers what is tolerable."""
    a, b = region["lag"]
    if not a or not b:
        return refusal("No test would be accepted: fewer motions, or a larger error, can be asked for.")
    lead = region.get("lead", (0.0, 0.0))[1]
    early = f" or {significant(lead**0.5)} ms early," if lead else ""
    share = percent(question["confidence"])
    return (
        f'<p class="verdict good" role="status">Up to <b>{significant(b**0.5)} ms</b> late,{early} or '
        f"<b>{percent(a**0.5, decimals=2)}</b> of amplitude error, but not both at once: inside the blue "
        f"region the error stays below {percent(question['threshold'])} for {share} of ground motions.</p>"
        f"<p class='hint'>Both in equal parts: {significant((b / 2.0) ** 0.5)} ms and "
        f"{percent((a / 2.0) ** 0.5, decimals=2)}.</p>"
    )
