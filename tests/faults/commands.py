"""Commands that write results, how they are taken up again, and what must be the same afterwards."""

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzz import corpus
from fuzz.damage import write

from reliab.motions.writing import write_suite
from reliab.sweep import write_ellipses


@dataclass(frozen=True, kw_only=True)
class Work:
    """A command with its input.

    Parameters
    ----------
    arguments : callable
        Returns the arguments for a folder of input and one of results.
    again : tuple of str, optional
        What is added to take up an interrupted command.
    """

    arguments: Callable[[Path, Path], Sequence[object]]
    again: tuple[str, ...] = ()


def material(folder: Path) -> None:
    """Write the input of all commands."""
    write_suite(corpus.suite(), folder / "motions")
    write_ellipses(corpus.ellipse_dataset(), folder / "ellipses.nc")
    write({f"campaign/{name}": content for name, content in corpus.campaign()[0].items()}, folder)
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


WORKS = {
    "simulate": Work(
        arguments=lambda material, out: (
            *("simulate", "--motions", material / "motions", "--f", 1, "--xi", 0.02, "--workers", 1),
            *("--out", out / "results.zarr", "--json", "-"),
        ),
        again=("--resume",),
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
    "run": Work(arguments=lambda material, out: ("run", material / "study.toml", "--out", out / "run")),
    "diagnose": Work(
        arguments=lambda material, out: ("diagnose", material / "campaign", "--out", out / "diagnosis")
    ),
}


def results(folder: Path) -> dict[str, str]:
    """SHA-256 of every file of results; chains and manifests hold times or a layout of their own."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.suffix not in {".h5", ".lock"}
        and path.name != "manifest.json"
        and not path.name.startswith(".unfinished-")
    }
