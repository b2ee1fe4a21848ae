"""What a command answers, whole: its screen, its JSON, its files, and what its figures draw."""

import hashlib
import io
import json
import os
import re
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from importlib.metadata import version
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from unchanged.comparing import NUMBER

from reliab.app import cli
from reliab.version import __version__

QUESTIONS = tomllib.loads(Path(__file__).with_name("questions.toml").read_text(encoding="utf-8"))
DIGITS = 9
_OF_OTHERS = ("emcee", "matplotlib", "numba", "numpy", "pandas", "rich", "scipy", "seaborn", "typer")
_LONGEST = 24  # numbers of a list that are kept one by one
_MOVING = (  # what differs from run to run, or from release to release
    (re.compile(r"\d{4}-\d\d-\d\d(?:T[\d:.]+(?:\+00:00|Z)?)?"), "DATE"),
    (re.compile(r"\b\d{19}-\d+-[0-9a-f]{8}\b|\b(?:[0-9a-f]\u200b?){32,64}\b"), "DIGEST"),
    # of files whose last digits are a processor's own
    (re.compile(r"(?<=  )[0-9a-f]{8}(?=  )"), "CHECKSUM"),
    (re.compile(r"(?<=took )[\d.]+|[\d.]+(?= s on \d+ processors?)"), "TIME"),
    (re.compile(re.escape(__version__)), "VERSION"),
)


_PROPERTIES = (
    *("xdata", "ydata", "offsets", "array", "xy", "width", "height", "text", "position", "linestyle"),
    *("linewidth", "marker", "markersize", "rotation", "ha", "va"),
)


def versions() -> dict[str, str]:
    """Versions, without their last number, of what draws, optimises and sets tables."""
    return {name: ".".join(version(name).split(".")[:2]) for name in _OF_OTHERS}


def answers(question: str, folder: Path) -> list[Any]:
    """Answer commands one after the other; what they write goes when all have been asked."""
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    found = [_answer(command.split(), folder) for command in question.split(";")]
    written = [path for path in folder.rglob("*") if path.is_file() and _changed(path, before)]
    assert before.keys().isdisjoint(written), "an answer is written over a file that other questions name"
    for path in written:
        path.unlink()
    return found


def _answer(arguments: list[str], folder: Path) -> Any:
    """Run a command in a folder; what it says and writes, in a form that can be kept."""
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    out, err, here = io.StringIO(), io.StringIO(), Path.cwd()
    os.chdir(folder)
    try:
        with _described_pictures(), _one_motion(), redirect_stdout(out), redirect_stderr(err):
            code = cli.run(arguments)
    finally:
        os.chdir(here)
    written = [path for path in sorted(folder.rglob("*")) if path.is_file() and _changed(path, before)]
    return _plain(
        {
            "code": code,
            "screen": _lines(out.getvalue()),
            "errors": _lines(err.getvalue()),
            "files": [[str(path.relative_to(folder)), _content(path)] for path in written],
        },
        str(folder),
    )


def _changed(path: Path, before: dict[Path, int]) -> bool:
    return before.get(path) != path.stat().st_mtime_ns


def _lines(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return [line.rstrip() for line in text.splitlines()]


def _content(path: Path) -> Any:
    """Numbers and text of a file; of a page or what is no text, that it is there."""
    data = path.read_bytes()
    if path.suffix == ".html":
        return "a page"
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return "binary"
    if text.count("\n") > _LONGEST and path.suffix != ".json":
        return {
            "first": text.splitlines()[:3],
            "words": hashlib.sha256(NUMBER.sub("#", _without_moving(text)).encode()).hexdigest()[:16],
            "numbers": [float(number) for number in NUMBER.findall(text)],
        }
    return _lines(text)


@contextmanager
def _described_pictures() -> Iterator[None]:
    """Write the content of reports and what figures draw, in place of PDF and pictures."""

    def picture(figure: Figure, ending: str) -> bytes:
        return json.dumps({"ending": ending, "axes": _plain(described(figure), "")}).encode()

    def set_(content: dict[str, bytes], setting: Any, date: Any) -> bytes:
        pages = {name: json.loads(data) for name, data in content.items()}
        return json.dumps({**pages, "inputs": setting.inputs(), "date": str(date)}).encode()

    with (
        patch("reliab.report.style.picture", picture),
        patch("reliab.report.pdf._set", set_),
    ):
        yield


@contextmanager
def _one_motion() -> Iterator[None]:
    """Simulate one motion for what a diagnosis adds to a criterion."""
    with patch("reliab.discrepancy.adding._MOST_MOTIONS", 1):
        yield


def described(figure: Figure) -> list[dict[str, Any]]:
    """Everything that a figure draws, axes by axes."""
    return [
        {
            "place": axes.get_position().bounds,
            "words": [axes.get_title(loc) for loc in ("left", "center", "right")],
            "x": [axes.get_xlabel(), axes.get_xscale(), *axes.get_xlim()],
            "y": [axes.get_ylabel(), axes.get_yscale(), *axes.get_ylim()],
            "ticks": [axis.get_majorticklocs() for axis in (axes.xaxis, axes.yaxis)],
            "legend": [text.get_text() for text in axes.get_legend().get_texts()]
            if axes.get_legend()
            else [],
            "drawn": [
                _artist(artist) for artist in (*axes.lines, *axes.collections, *axes.patches, *axes.texts)
            ],
        }
        for axes in figure.axes
    ]


def _artist(artist: Artist) -> dict[str, Any]:
    """Form, data and look of one thing that is drawn."""
    found: dict[str, Any] = {"form": type(artist).__name__, "order": artist.get_zorder()}
    for name in _PROPERTIES:
        if name != "text" or isinstance(artist, Text):
            found |= {name: getattr(artist, f"get_{name}")()} if hasattr(artist, f"get_{name}") else {}
    for name in ("color", "facecolor", "edgecolor"):
        if hasattr(artist, f"get_{name}"):
            found[name] = _colours(getattr(artist, f"get_{name}")())
    if hasattr(artist, "get_paths"):
        found["paths"] = [path.vertices for path in artist.get_paths()][:3]
    return found


def _colours(given: Any) -> list[str]:
    if isinstance(given, str):
        return [given]
    return [to_hex(each, keep_alpha=True) for each in np.atleast_2d(given)[:3]]


def _plain(thing: Any, folder: str) -> Any:
    """Text without what differs from run to run; numbers with few digits; long lists as sums."""
    match thing:
        case dict():
            return {str(key): _plain(value, folder) for key, value in thing.items()}
        case np.ndarray():
            return _plain(np.ma.filled(np.ma.asarray(thing, dtype=float), np.nan).ravel().tolist(), folder)
        case list() | tuple():
            return _listed(thing, folder)
        case bool() | int() | None:
            return thing
        case float() | np.floating():
            return float(f"{thing:.{DIGITS}g}") if np.isfinite(thing) else str(thing)
        case _:
            text = str(thing).replace(folder, "FOLDER") if folder else str(thing)
            return _without_moving(text)


def _without_moving(text: str) -> str:
    for pattern, word in _MOVING:
        text = pattern.sub(word, text)
    return text


def _listed(things: Any, folder: str) -> Any:
    numbers = len(things) > _LONGEST and all(
        isinstance(each, int | float) and not isinstance(each, bool) for each in things
    )
    if not numbers:
        return [_plain(each, folder) for each in things]
    values = np.array(things, float)
    finite = values[np.isfinite(values)]
    weights = np.cos(np.arange(finite.size))
    sums = (finite.min(), finite.max(), finite.mean(), finite.std(), weights @ finite / finite.size)
    return {"numbers": [values.size, finite.size], "sums": [_plain(float(each), folder) for each in sums]}
