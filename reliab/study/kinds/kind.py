"""What a kind of study is: stages, and a report of what they leave behind."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from reliab.report import Document
from reliab.study.description import Study
from reliab.study.stages import Stage
from reliab.study.steps import Material, Show


class Kind(ABC):
    """A kind of study.

    Attributes
    ----------
    name : str
        What a study's file calls it.
    """

    name: ClassVar[str]

    @staticmethod
    @abstractmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Stages before the report, in their order.

        Parameters
        ----------
        material : Material
            What the study works on.
        show : callable
            Shows progress.

        Returns
        -------
        sequence of Stage
            The stages.
        """

    @staticmethod
    @abstractmethod
    def report(study: Study, folder: Path) -> Document:
        """Report on a finished run; nothing is simulated any more.

        Parameters
        ----------
        study : Study
            The study.
        folder : pathlib.Path
            Its run folder.

        Returns
        -------
        Document
            The report.
        """
