"""A slider made of the browser's own range input: it has a name, and keyboards move it."""

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent

WEB = Path(__file__).parent / "web"


class Slider(JSComponent):  # type: ignore[misc]  # Panel carries no types
    """A number in a range; it is shown times a factor, with a unit."""

    title = param.String(default="")
    value = param.Number(default=0.0)
    start = param.Number(default=0.0)
    end = param.Number(default=1.0)
    step = param.Number(default=0.1)
    factor = param.Number(default=1.0)
    unit = param.String(default="")

    _esm = WEB / "slider.js"
    _stylesheets: ClassVar[list[str]] = [(WEB / "parts.css").read_text(encoding="utf-8")]
