"""What a kind of study is: the tables that it knows, its stages, and the report of their results."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.core.progress import Show
from reliab.report.document import Document
from reliab.study.description import Study
from reliab.study.stages import Stage


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of study.

    Parameters
    ----------
    name : str
        What a study's file calls it.
    tables : type of Study
        The study with exactly the tables and keys that the kind knows.
    stages : callable
        Takes such a study and a function that shows progress; returns the stages before the report, in their
        order. What cannot be run is refused here, before the first stage.
    report : callable
        Takes such a study and its run folder; gives the report, or its content as
        :func:`reliab.report.content.saved_content` reads it. Nothing is simulated any more.
    """

    name: str
    tables: type[Study]
    stages: Callable[[Any, Show], Sequence[Stage]]
    report: Callable[[Any, Path], Document | Mapping[str, bytes]]
