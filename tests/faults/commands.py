"""Commands that write results, how they are taken up again, and what must be the same afterwards."""

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from fuzz import corpus
from fuzz.damage import write

from reliab.core.files import UNFINISHED
from reliab.motions.catalogue import write_suite
from reliab.sweep.ellipse_dataset import write_ellipses


@dataclass(frozen=True, kw_only=True)
class Work:
    """A command with its input.

    Parameters
    ----------
    arguments : callable
        Returns the arguments for a folder of input and one of results.
    again : tuple of str, optional
        What is added to take up an interrupted command.
    once : bool, optional
        Whether a command that is done refuses to be run again in the same place.
    """

    arguments: Callable[[Path, Path], Sequence[object]]
    resume_options: tuple[str, ...] = ()
    once: bool = False


def material(folder: Path) -> None:
    """Write the input of all commands."""
    write_suite(corpus.suite(), folder / "motions")
    write_ellipses(corpus.ellipse_dataset(), folder / "ellipses.nc")
    write({f"campaign/{name}": content for name, content in corpus.campaign()[0].items()}, folder)
    write({f"damped/{name}": content for name, content in damper_campaign().items()}, folder)
    (folder / "study.toml").write_text(
        f"""title = "Small"
kind = "criterion"
date = 2026-01-01
[motions]
sources = [{json.dumps(str(folder / "motions"))}]
[structures]
f = [1.0]
xi = [0.02]
[criterion]
confidences = [0.5]
method = "quantile"
joint = false
[validation]
schemes = ["k_fold"]
confidences = [0.5]
trials = 64
"""
    )


def damper_campaign() -> corpus.Case:
    """A campaign whose specimen has a damper that nobody stated, so that a posterior is sampled."""
    case = dict(corpus.campaign()[0])
    instants = np.arange(12 * corpus.RATE) / corpus.RATE
    for seed, name in enumerate(("a.csv", "b.csv")):
        random = np.random.default_rng(seed)
        waves = zip(random.uniform(0.5, 2.0, 4), random.uniform(0.0, 6.0, 4), strict=True)
        displacement = sum(np.sin(2.0 * np.pi * frequency * instants + phase) for frequency, phase in waves)
        displacement = 0.01 * np.sin(np.pi * instants / instants[-1]) ** 2 * displacement
        force = (
            4e4 * displacement
            + 400.0 * np.gradient(displacement, instants)
            + 0.5 * random.normal(size=displacement.size)
        )
        columns = {"time_s": instants, "measured_m": displacement, "force_n": force}
        case[name] = pd.DataFrame(columns).round(9).to_csv(index=False).encode()
    return case


WORKS = {
    "synthesize": Work(
        arguments=lambda _, out: ("motions", "synthesize", "--count", 4, "--out", out / "suite"),
        once=True,
    ),
    "simulate": Work(
        arguments=lambda material, out: (
            *("simulate", "--motions", material / "motions", "--f", 1, "--xi", 0.02, "--workers", 1),
            *("--out", out / "results.zarr", "--json", "-"),
        ),
        resume_options=("--resume",),
    ),
    "ellipses": Work(
        arguments=lambda material, out: (
            *("ellipses", "--motions", material / "motions", "--f", 1, "--xi", 0.02),
            *("--out", out / "ellipses.nc", "--json", out / "answer.json"),
        ),
    ),
    "criterion": Work(
        arguments=lambda material, out: (
            *("criterion", "--ellipses", material / "ellipses.nc", "--f", 1, "--confidence", 0.8),
            *("--out", out / "criterion.json", "--figures", out / "figures", "--json", out / "answer.json"),
        ),
    ),
    "chains": Work(
        arguments=lambda material, out: (
            *("criterion", "--ellipses", material / "ellipses.nc", "--confidence", 0.8, "--method"),
            *("hierarchical", "--steps", 400, "--chains", out / "chains.h5", "--json", out / "answer.json"),
        ),
    ),
    "assess": Work(
        arguments=lambda material, out: (
            *("assess", material / "campaign/a.csv", "--f", 1, "--xi", 0.05, "--date", "2026-01-01"),
            *("--report", out / "verdict.pdf", "--json", out / "verdict.json"),
        ),
    ),
    "explore": Work(
        arguments=lambda material, out: (
            *("explore", "--ellipses", material / "ellipses.nc", "--out", out / "page.html"),
        ),
    ),
    "run": Work(arguments=lambda material, out: ("run", material / "study.toml", "--out", out / "run")),
    "report": Work(arguments=lambda _, out: ("report", out / "run")),
    "diagnose": Work(
        arguments=lambda material, out: ("diagnose", material / "campaign", "--out", out / "diagnosis")
    ),
}


SAMPLING = {
    "chains": WORKS["chains"],
    "diagnose": Work(
        arguments=lambda material, out: ("diagnose", material / "damped", "--out", out / "diagnosis")
    ),
}
"""Commands that sample a posterior."""


def _posterior(material: Path, out: Path) -> Sequence[object]:
    """Figures and the kept draws of a posterior."""
    return (
        *("criterion", "--ellipses", material / "ellipses.nc", "--f", 1, "--xi", 0.02, "--confidence", 0.8),
        *("--method", "hierarchical", "--steps", 400, "--figures", out / "figures"),
    )


DRAWING = {
    f"design, {ending}": Work(
        arguments=lambda _, out, ending=ending: (
            *("design", "--figure", out / f"chart.{ending}", "--json", out / "chart.json"),
        )
    )
    for ending in ("svg", "pdf", "png")
}
"""Commands that draw a figure without a run."""

WRITING = WORKS | DRAWING | {"posterior": Work(arguments=_posterior)}
"""Every kind of file that a command writes."""


def results(folder: Path) -> dict[str, str]:
    """SHA-256 of every file of results; manifests hold the day, and what was being written is no result."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.suffix != ".lock"
        and path.name != "manifest.json"
        and not any(part.startswith(UNFINISHED) for part in path.relative_to(folder).parts)
    }
