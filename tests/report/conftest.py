"""Small results from which reports are made."""

import datetime as dt
import json
import unicodedata

import numpy as np
import pandas as pd
import pytest
import typst
import xarray as xr

from reliab.report.content import CONTENT_FILE, files_of
from reliab.report.pdf import templates

DATE = dt.date(2026, 1, 1)


@pytest.fixture(scope="session")
def ellipses_of():
    """Function that makes ellipses of motions of several earthquakes over a grid of structures."""

    def make(frequencies=(0.5, 1.0, 2.0), damping_ratios=(0.02, 0.05), motions=24, events=8, names=None):
        rng = np.random.default_rng(1)
        event = np.arange(motions) % events
        scatter = 0.3 * rng.normal(size=events)[event] + 0.5 * rng.normal(size=motions)
        f, xi = np.array(frequencies), np.array(damping_ratios)
        thresholds = np.array([0.02, 0.05])
        shape = (motions, f.size, xi.size, thresholds.size, 1, 1)
        size = (
            np.exp(scatter).reshape(-1, 1, 1, 1, 1, 1) * (thresholds / 0.05).reshape(1, 1, 1, -1, 1, 1) ** 2
        )
        noise = np.exp(0.1 * rng.normal(size=(2, *shape)))
        of_xi = (xi / 0.02).reshape(1, 1, -1, 1, 1, 1) ** 2
        a = 1.5e-4 * size * of_xi * noise[0]
        b = 2.5 * size * of_xi / f.reshape(1, -1, 1, 1, 1, 1) ** 2 * noise[1]
        dimensions = ("motion", "f", "xi", "threshold", "metric", "curve")
        names = [f"E{each}/M{rank}" for rank, each in enumerate(event)] if names is None else names
        return xr.Dataset(
            {"a": (dimensions, np.broadcast_to(a, shape)), "b": (dimensions, np.broadcast_to(b, shape))},
            coords={
                "motion": np.array(names),
                "event": ("motion", np.array([f"E{each}" for each in event])),
                "duration": ("motion", np.full(motions, 40.0)),
                "f": f,
                "xi": xi,
                "threshold": thresholds,
                "metric": ["rms"],
                "curve": ["ellipse"],
            },
            attrs={"window": "record", "experimental_fraction": 1.0},
        )

    return make


@pytest.fixture(scope="session")
def rates():
    """Rates of two criteria at three confidences, over all structures and at two frequencies."""
    rows = [
        {
            "measure": measure,
            "candidate": name,
            "confidence": confidence,
            "f": f,
            "rate": rate,
            "low": max(rate - 0.05, 0.0),
            "high": min(rate + 0.04, 1.0),
        }
        for measure, factor in (("containment", 1.0), ("false_safe", 0.02), ("accepted_share", 0.5))
        for name in ("ours", "printed #1")
        for confidence in (0.8, 0.9, 0.95)
        for f in (np.nan, 0.5, 1.0)
        for rate in (factor * confidence,)
    ]
    return pd.DataFrame(rows)


@pytest.fixture(scope="session")
def set_without_warnings():
    """Function that sets a report as PDF, of which typst has nothing to warn."""

    def check(document):
        files = {**templates(), **files_of(document)}
        inputs = {"date": DATE.isoformat(), "version": "0"}
        pdf, warnings = typst.compile_with_warnings(
            files, ignore_system_fonts=True, format="pdf", sys_inputs=inputs
        )
        assert warnings == []
        return pdf

    return check


@pytest.fixture(scope="session")
def text_of(set_without_warnings):
    """Function that sets a report as PDF and returns what a reader reads in it, pieces joined by blanks."""

    def read(document):
        set_without_warnings(document)
        content = json.loads(files_of(document)[CONTENT_FILE])
        words = " ".join(_words(content))
        return " ".join(unicodedata.normalize("NFKC", words).replace("\u200b", "").split())

    return read


def _words(content):
    """Every text of a report's content, in its order; a sentence with formulas stays one."""
    if isinstance(content, list):
        if content and all(isinstance(piece, dict) and piece.get("kind") in _PIECES for piece in content):
            yield "".join(piece.get("text", piece.get("source", "")) for piece in content)
        else:
            for part in content:
                yield from _words(part)
    elif isinstance(content, dict):
        for name, part in content.items():
            if name in _READ or isinstance(part, list | dict):
                yield from _words(part)
    elif isinstance(content, str):
        yield content


_PIECES = ("text", "math", "strong", "source", "reference")
_READ = ("text", "digits", "title", "unit", "math", "heading", "caption", "verdict")
