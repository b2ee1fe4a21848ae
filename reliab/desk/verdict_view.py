"""The verdict on a test: in words and in drawings that answer to the mouse."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, Final

import numpy as np
import panel as pn
from bokeh.models import BoxAnnotation, ColumnDataSource, Label, Span
from bokeh.plotting import figure

from reliab.assessment.verdict import next_steps
from reliab.core.arrays import Array
from reliab.core.significant_digits import (
    decimals_of_uncertainty,
    percent,
    percent_with_interval,
    significant,
)
from reliab.core.vocabulary import ERROR_NAMES, PERCENT, Metric
from reliab.desk.elements import button, downloads, html, write_list
from reliab.desk.work import Filed, Judgement, Mark, Trace

BLUE, RED, INK = "#0b5a94", "#a3320b", "#202020"
_COLOURS: Final = (BLUE, RED, "#1b6e3c", "#6a3d9a", "#7a5a00")
_ANGLES: Final = 181


def _blank(height: int, x_label: str, y_label: str, **settings: Any) -> Any:  # noqa: ANN401 - Bokeh's
    place = figure(
        height=height, sizing_mode="stretch_width", tools="xbox_zoom,xpan,reset", toolbar_location="above",
        x_axis_label=x_label, y_axis_label=y_label, **settings,
    )  # fmt: skip
    place.toolbar.logo = None
    place.xgrid.grid_line_color = place.ygrid.grid_line_color = "#e3e3e3"
    for axis in (place.xaxis, place.yaxis):
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_color = axis.major_label_text_color = INK
    return place


def draw_traces(traces: Sequence[Trace]) -> pn.Column:
    """Draw the recognised channels over one scale of time; displacements together."""
    traces_by_unit: dict[str, list[Trace]] = {}
    for trace in traces:
        traces_by_unit.setdefault(trace.unit, []).append(trace)
    places: list[Any] = []
    for unit, group in traces_by_unit.items():
        shared = {"x_range": places[0].x_range} if places else {}
        place = _blank(190, "Time [s]", f"[{unit}]" if unit else "", **shared)
        for rank, trace in enumerate(group):
            place.line(
                trace.time, trace.values, color=_COLOURS[rank % 5], legend_label=trace.name, line_width=1.2
            )
        place.legend.orientation, place.legend.location = "horizontal", "top_right"
        places.append(place)
    return pn.Column(*map(pn.pane.Bokeh, places), sizing_mode="stretch_width")


def draw_error(
    histories: tuple[Array, Array, Array, Array], bound: float, marks: Sequence[Mark]
) -> pn.pane.Bokeh:
    """Draw time, error and ends of its band, the threshold, and where the recording is faulty."""
    time, error, low, high = histories
    place = _blank(260, "Time [s]", "Error [mm]")
    place.varea(time, low, high, color=BLUE, alpha=0.25, legend_label="90 % band")
    place.line(time, error, color=BLUE, legend_label="error")
    for sign in (-1.0, 1.0):
        place.add_layout(Span(location=sign * bound, dimension="width", line_dash="dashed", line_color=INK))
    for mark in marks:
        place.add_layout(BoxAnnotation(left=mark.begin, right=mark.end, fill_color=RED, fill_alpha=0.2))
    note = "measured minus exact displacement; dashed: threshold times the peak of the exact response"
    place.add_layout(Label(x=8, y=4, x_units="screen", y_units="screen", text=note, text_font_size="11px"))
    place.legend.orientation, place.legend.location = "horizontal", "top_right"
    return pn.pane.Bokeh(place, sizing_mode="stretch_width")


def half_ellipse(a: float, b: float, *, lead: bool = False) -> tuple[Array, Array]:
    """Return amplitude error [%] and delay [ms] along the boundary of one side."""
    angle = np.linspace(0.0, np.pi, _ANGLES) * (-1.0 if lead else 1.0)
    return PERCENT * np.sqrt(max(a, 0.0)) * np.cos(angle), np.sqrt(max(b, 0.0)) * np.sin(angle)


class RegionDrawing:
    """The plane of amplitude error and delay: the tolerable region over the motions' own boundaries."""

    def __init__(self) -> None:
        names = ("region", "motions", "record", "tests")
        self.sources = {name: ColumnDataSource({"x": [], "y": []}) for name in names}
        place = _blank(430, "Amplitude error A − 1 [%]", "Delay d [ms]", match_aspect=False)
        place.multi_line("x", "y", source=self.sources["motions"], color="#9a9a9a", line_width=0.6,
                         legend_label="single motions")  # fmt: skip
        place.patch("x", "y", source=self.sources["region"], fill_color=BLUE, fill_alpha=0.3, line_color=BLUE,
                    line_width=2, legend_label="tolerable")  # fmt: skip
        place.line(
            "x", "y", source=self.sources["record"], color=RED, line_width=2, legend_label="own record"
        )
        place.scatter("x", "y", source=self.sources["tests"], color=INK, size=7, marker="diamond",
                      legend_label="tests of the rig")  # fmt: skip
        place.legend.location = "top_right"
        self.pane = pn.pane.Bokeh(place, sizing_mode="stretch_width")

    def update(self, region: Mapping[str, tuple[float, float]], motions: tuple[Array, Array]) -> None:
        """Draw the region by side, and the motions' boundaries of late actuators."""
        x, y = _close_region(region)
        self.sources["region"].data = {"x": x, "y": y}
        pairs = [half_ellipse(a, b) for a, b in zip(*motions, strict=True)]
        self.sources["motions"].data = {"x": [x for x, _ in pairs], "y": [y for _, y in pairs]}

    def mark_record(self, boundary: Mapping[str, Any] | None) -> None:
        """Draw the boundary of an own record."""
        sides = {} if boundary is None else {
            side: (boundary[f"a{end}"], boundary[f"b{end}"])
            for side, end in (("lag", "_inscribed"), ("lead", "_lead_inscribed"))
            if boundary.get(f"a{end}") and boundary.get(f"b{end}")
        }  # fmt: skip
        x, y = _close_region(sides)
        self.sources["record"].data = {"x": x, "y": y}

    def mark_tests(self, tests: Sequence[tuple[str, float, float]]) -> None:
        """Draw the tests of a rig."""
        self.sources["tests"].data = {
            "x": [PERCENT * (amplitude - 1.0) for _, amplitude, _ in tests],
            "y": [delay for _, _, delay in tests],
        }


def _close_region(sides: Mapping[str, tuple[float, float]]) -> tuple[Array, Array]:
    halves = [half_ellipse(a, b, lead=side == "lead") for side, (a, b) in sides.items()]
    if not halves:
        return np.zeros(0), np.zeros(0)
    first, *other_halves = halves
    return (
        np.concatenate([first[0], *(half[0][::-1] for half in other_halves)]),
        np.concatenate([first[1], *(half[1][::-1] for half in other_halves)]),
    )


class LiveDrawing:
    """The error of a running test with its band, and the damping that the loop adds."""

    def __init__(self) -> None:
        self._error = ColumnDataSource({name: [] for name in ("time", "value", "low", "high")})
        self._damping = ColumnDataSource({"time": [], "ratio": []})
        self._bound = Span(location=0.0, dimension="width", line_dash="dashed", line_color=RED, line_width=2)
        error_figure = _blank(
            240, "Time [s]", "RMS error so far [%]", x_range=(0.0, 10.0), y_range=(0.0, 10.0)
        )
        damping_figure = _blank(
            190, "Time [s]", "Net damping ratio [%]", x_range=error_figure.x_range, y_range=(0.0, 5.0)
        )
        self._above, self._below = error_figure, damping_figure
        error_figure.varea(
            "time", "low", "high", source=self._error, color=BLUE, alpha=0.25, legend_label="90 % interval"
        )
        error_figure.line(
            "time", "value", source=self._error, color=BLUE, line_width=2, legend_label="error so far"
        )
        error_figure.add_layout(self._bound)
        error_figure.legend.location = "top_left"
        damping_figure.line("time", "ratio", source=self._damping, color="#1b6e3c", line_width=2)
        damping_figure.add_layout(Span(location=0.0, dimension="width", line_color=RED, line_dash="dashed"))
        self.column = pn.Column(
            *(pn.pane.Bokeh(place, sizing_mode="stretch_width") for place in (error_figure, damping_figure)),
            sizing_mode="stretch_width",
        )

    def update(self, messages: Sequence[Mapping[str, Any]], threshold: float) -> None:
        """Draw all messages so far."""
        sizes = [(message["time_s"], message["error"]["rms"]) for message in messages if message.get("error")]
        self._error.data = {
            "time": [time for time, _ in sizes],
            **{end: [_percent(size[end]) for _, size in sizes] for end in ("value", "low", "high")},
        }
        dampings = [
            (message["time_s"], PERCENT * message["net_damping_ratio"])
            for message in messages
            if message.get("net_damping_ratio") is not None
        ]
        self._damping.data = {
            "time": [time for time, _ in dampings],
            "ratio": [ratio for _, ratio in dampings],
        }
        self._bound.location = PERCENT * threshold
        latest = [_percent(size["high"]) for _, size in sizes[len(sizes) // 2 :] if size["high"] is not None]
        self._above.x_range.end = max(10.0, messages[-1]["time_s"])
        self._above.y_range.end = 1.2 * max([PERCENT * threshold, *latest])
        ratios = [ratio for _, ratio in dampings[len(dampings) // 2 :]]
        self._below.y_range.update(start=min([0.0, *ratios]) - 0.2, end=1.2 * max([1.0, *ratios]))


def _percent(value: float | None) -> float:
    return float("nan") if value is None else PERCENT * value


_WIDTH: Final = 640.0  # of the bar, in its own units


def verdict_html(content: Mapping[str, Any]) -> str:
    """Write the verdict with its reasons, and what to do next."""
    word = str(content["verdict"])
    steps = next_steps(content["would_decide"], content["error"].get("would_decide", ()))
    return (
        f'<div class="verdict {escape(word)}" role="status"><b>{word.replace("_", " ").capitalize()}</b>'
        f"<br>{'<br>'.join(escape(reason) for reason in content['reasons'])}</div>{write_list(steps)}"
    )


def interval_html(content: Mapping[str, Any]) -> str:
    """Draw the interval of the error against the threshold."""
    size, threshold = content["error"][content["metric"]], float(content["threshold"])
    if size["value"] is None:
        return ""
    low, value, high = (float(size[end]) for end in ("low", "value", "high"))
    scale = (_WIDTH - 40.0) / (1.15 * max(high, threshold))
    ends = [20.0 + scale * number for number in (low, value, high, threshold)]
    error_name = ERROR_NAMES[Metric(content["metric"])]
    name, interval = error_name[0].upper() + error_name[1:], percent_with_interval(value, low, high)
    label = f"{name} {interval}; the threshold is {percent(threshold)}"
    return (
        f'<svg class="scale" viewBox="0 0 {_WIDTH:g} 66" role="img" aria-label="{escape(label)}">'
        f'<line x1="20" x2="{_WIDTH - 20:g}" y1="36" y2="36" stroke="#8a8a8a"/>'
        f'<rect x="{ends[0]:.1f}" y="29" width="{max(ends[2] - ends[0], 2.0):.1f}" height="14" fill="#0b5a94"'
        ' fill-opacity="0.45"/>'
        f'<circle cx="{ends[1]:.1f}" cy="36" r="5" fill="#0b5a94"/>'
        f'<line x1="{ends[3]:.1f}" x2="{ends[3]:.1f}" y1="20" y2="50" stroke="#a3320b" stroke-width="3"/>'
        f'<text x="{ends[3]:.1f}" y="14" text-anchor="middle">threshold {percent(threshold)}</text>'
        f'<text x="20" y="63">{escape(name)} with its 90 % interval: {interval}</text>'
        "</svg>"
    )


class VerdictView:
    """Shows a judgement, and its report and files when they are written."""

    def __init__(self) -> None:
        self.column = pn.Column(sizing_mode="stretch_width")
        self._details = html()
        self._files = pn.Column(sizing_mode="stretch_width")
        self._knowing = html()

    def clear(self) -> None:
        """Show nothing."""
        self.column.clear()

    def show(self, judgement: Judgement) -> None:
        """Show the verdict."""
        content = judgement.content
        parts = [html(verdict_html(content) + interval_html(content)), self._files]
        if judgement.contradictions:
            sentences = write_list(dict.fromkeys(judgement.contradictions))
            parts.append(html(f'<h2>What contradicts</h2><div class="warning">{sentences}</div>'))
        if judgement.histories is not None:
            places = "".join(
                f"<li>{mark.begin:.2f} to {mark.end:.2f} s: {escape(mark.finding)}</li>"
                for mark in judgement.marks
            )
            shading_text = f"<p>Shaded in red:</p><ul>{places}</ul>" if places else ""
            parts += [
                html(f"<h2>The error over the test</h2>{shading_text}"),
                draw_error(judgement.histories, judgement.bound, judgement.marks),
            ]
        parts += self._contributions(content)
        warnings = [text for text in content["warnings"] if text not in content["reasons"]]
        if warnings:
            parts.append(html(f"<h2>Read before you rely on it</h2>{write_list(warnings)}"))
        self._details.object = ""
        self._files.clear()
        self.column[:] = [*parts, self._details]

    def file(self, files: Filed) -> None:
        """Show the report, and offer the files."""
        self._details.object = f"<details><summary>The whole report</summary>{files.html}</details>"
        self._files[:] = [downloads(files.files)]

    def _contributions(self, content: Mapping[str, Any]) -> list[Any]:
        budget = content.get("budget", [])
        if not budget:
            return []
        largest = max(float(item["contribution"]) for item in budget) or 1.0
        self._knowing.object = (
            '<p class="hint">Choose a quantity to see what knowing it better would change.</p>'
        )
        decimals = decimals_of_uncertainty(PERCENT * largest, digits=2)
        rows = [
            pn.Row(
                button(
                    item["quantity"].capitalize(), lambda item=item: self._explain(item, content)  # type: ignore[misc]
                ),
                html(
                    f'<div class="bar"><i style="flex-grow:{item["contribution"] / largest:.3f}"></i></div>'
                    f"<small>±{percent(item['contribution'], decimals=decimals)} in the error</small>"
                ),
                sizing_mode="stretch_width",
            )
            for item in budget
            if item["contribution"] > 0.0
        ]  # fmt: skip
        return [html("<h2>What makes the interval wide</h2>"), self._knowing, *rows]

    def _explain(self, item: Mapping[str, Any], content: Mapping[str, Any]) -> None:
        self._knowing.object = knowing_html(item, content)


def knowing_html(item: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    """Say what is known of a quantity, what knowing it exactly would change, and how to learn it."""
    size = (
        "" if item["size"] is None else f" (±{significant(item['size'], 2)} {item['unit']}, {item['source']})"
    )
    widths = {entry["name"]: entry for entry in content["error"].get("widest", ())}
    entry = widths.get(item["name"])
    change = ""
    if entry is not None and entry["width"] is not None and entry["width_without"] is not None:
        now, then = float(entry["width"]), float(entry["width_without"])
        change = (
            f"If you knew it exactly, the 90 % interval would be {percent(then, 2)} wide instead of "
            f"{percent(now, 2)}."
            if then < 0.99 * now
            else "Knowing it exactly would not make the interval narrower."
        )
    return (
        f'<div class="warning" role="status"><b>{escape(item["quantity"].capitalize())}</b>{escape(size)}<br>'
        f"{change} {escape(item['remedy'])}</div>"
    )
