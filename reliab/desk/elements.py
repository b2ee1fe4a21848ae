"""Parts that several pages share: fields, texts, progress, downloads, lines to copy."""

import json
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any, ClassVar, Final

import panel as pn
import param
from panel.custom import JSComponent

from reliab.core.files import LIMITS
from reliab.core.significant_digits import percent
from reliab.desk.jobs import Job, PageMemory

WEB: Final = Path(__file__).parent / "web"
"""Style, scripts and template."""

_CSS: Final = (WEB / "parts.css").read_text(encoding="utf-8")
_MEGABYTE: Final = 1e6
_FIELDS: Final[Mapping[str, tuple[str, str]]] = {
    "f": ("Natural frequency f [Hz]", "1±0.01"),
    "xi": ("Damping ratio ξ", "0.02±0.002"),
    "alpha": ("Share of the stiffness in the laboratory α", "1"),
    "threshold": ("Largest error of a good test", "0.05"),
    "confidence": ("Confidence of the criterion", "0.95"),
    "mass": ("Mass of the structure [kg]", "only with a recorded force"),
    "scale": ("Scale of the displacement sensor", "1±0.005"),
    "skew": ("Measured channel is late by [ms]", "0±0.2"),
    "feedback_lag": ("Force is fed back late by [ms]", "0±0.1"),
}
METRICS: Final = {"root mean square (RMS)": "rms", "largest (MTE)": "mte"}
KNOWING: Final = (
    "<details><summary>How do I know f and ξ?</summary><p class='hint'>Pull the specimen in its frame, let "
    "go, and record the free vibration: the period gives f, the decay gives ξ. Write how well you know them "
    "behind ±, as one standard deviation: <b>1±0.01</b>. If you leave the ± out, a typical uncertainty is "
    "used.</p></details>"
)


class Slider(JSComponent):  # type: ignore[misc]  # Panel is read without its types
    """The browser's own range input, which has a name and which keyboards move; shown times a factor."""

    title = param.String(default="")
    value = param.Number(default=0.0)
    start = param.Number(default=0.0)
    end = param.Number(default=1.0)
    step = param.Number(default=0.1)
    factor = param.Number(default=1.0)
    unit = param.String(default="")

    _esm = WEB / "slider.js"
    _stylesheets: ClassVar[list[str]] = [_CSS]


def html(text: str = "") -> pn.pane.HTML:
    """Show HTML in the style of the desk; whatever comes from a user must be escaped in it."""
    return pn.pane.HTML(text, stylesheets=[_CSS], sizing_mode="stretch_width", margin=(2, 5))


def refusal(sentence: str) -> str:
    """Write why something was refused."""
    return f'<p class="refusal" role="alert">{escape(sentence)}</p>' if sentence else ""


def write_list(sentences: Any) -> str:  # noqa: ANN401 - any iterable of texts
    """Write sentences as a list."""
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    return f"<ul>{items}</ul>" if items else ""


def field(memory: PageMemory, name: str, label: str = "", example: str = "") -> pn.widgets.TextInput:
    """Ask for a text, which the page remembers."""
    usual = _FIELDS.get(name, (name, ""))
    widget = pn.widgets.TextInput(
        name=label or usual[0], placeholder=example or usual[1], value=memory.values.get(name, ""),
        max_length=200,
    )  # fmt: skip
    return _remember_value(memory, name, widget)


def choice(
    memory: PageMemory, name: str, label: str, options: Mapping[str, str] | list[str], usual: str = ""
) -> pn.widgets.Select:
    """Ask for one of several, which the page remembers."""
    values = list(options.values()) if isinstance(options, Mapping) else options
    value = memory.values.get(name, usual)
    widget = pn.widgets.Select(name=label, options=options, value=value if value in values else values[0])
    memory.values[name] = widget.value
    return _remember_value(memory, name, widget)


def _remember_value(memory: PageMemory, name: str, widget: Any) -> Any:  # noqa: ANN401 - a widget
    def remember(event: Any) -> None:  # noqa: ANN401 - Panel's
        memory.values[name] = event.new

    widget.sizing_mode = "stretch_width"
    widget.param.watch(remember, "value")
    return widget


def button(name: str, callback: Callable[[], None], kind: str = "default") -> pn.widgets.Button:
    """Offer an action."""
    widget = pn.widgets.Button(name=name, button_type=kind, sizing_mode="stretch_width")
    widget.on_click(lambda _event: callback())
    return widget


def dropper(
    name: str, dropped_files: Callable[[dict[str, bytes | str]], None], *, multiple: bool = False
) -> pn.Column:
    """Take files that are dropped or chosen; they are handed on and forgotten."""
    limit = int(LIMITS["test"].bytes / _MEGABYTE)
    widget = pn.widgets.FileDropper(
        multiple=multiple, max_file_size=f"{limit}MB", max_total_file_size=f"{limit}MB",
        sizing_mode="stretch_width", width=None, margin=(0, 5), stylesheets=[_CSS],
    )  # fmt: skip

    def take(event: Any) -> None:  # noqa: ANN401 - Panel's
        if event.new:
            content = dict(event.new)
            with param.parameterized.discard_events(widget):
                widget.value, widget.mime_type = {}, {}
            dropped_files(content)

    widget.param.watch(take, "value")
    return pn.Column(html(f"<h2>{escape(name)}</h2>"), widget, sizing_mode="stretch_width")


def fold_card(title: str, *parts: Any, is_open: bool = False) -> pn.Card:  # noqa: ANN401 - of Panel
    """Fold parts away below a title."""
    return pn.Card(
        *parts,
        header=html(f"<h2>{escape(title)}</h2>"),
        collapsed=not is_open,
        sizing_mode="stretch_width",
        margin=(6, 0),
    )


def progress_html(job: Job | None) -> str:
    """Show how far a job is."""
    if job is None or job.is_over:
        return refusal(job.refusal) if job else ""
    task = job.task or ("Waiting for another calculation" if job.state == "waiting" else "Starting")
    share = f'value="{job.progress:.3f}"' if job.progress > 0.0 else ""
    share_in_words = f" {percent(job.progress)}" if job.progress > 0.0 else ""
    return (
        f'<p role="status">{escape(task)} …{share_in_words}</p>'
        f'<progress max="1" {share} aria-label="{escape(task)}"></progress>'
    )


def downloads(files: Mapping[str, str]) -> pn.FlexBox:
    """Offer files that were written."""
    return pn.FlexBox(
        *(
            pn.widgets.FileDownload(
                file=path, filename=Path(path).name, label=name, auto=True, embed=False, width=210,
            )
            for name, path in files.items()
        )
    )  # fmt: skip


def copyable(name: str, text: str) -> pn.Column:
    """Show a line with a button that copies it."""
    copy = pn.widgets.Button(name=f"Copy the {name}", width=210)
    copy.js_on_click(code=f"navigator.clipboard.writeText({json.dumps(text)})")
    return pn.Column(html(f"<code>{escape(text)}</code>"), copy, sizing_mode="stretch_width")
