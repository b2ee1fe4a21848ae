"""The verdict on a test: in words, as a bar against the threshold, over time, and what it rests on."""

from collections.abc import Mapping
from html import escape
from typing import Any, Final

import panel as pn

from reliab.assessment.verdict import next_steps
from reliab.core.significant_digits import (
    decimals_of_uncertainty,
    percent,
    percent_with_interval,
    significant,
)
from reliab.core.vocabulary import ERROR_NAMES, PERCENT, Metric
from reliab.desk.drawings import draw_error
from reliab.desk.elements import button, downloads, html, write_list
from reliab.desk.work import Filed, Judgement

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
