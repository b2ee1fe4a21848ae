"""What a study works on: its ground motions, or results of theirs that are stored."""

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Final

import xarray as xr

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.study.description import RecordsStudy, SimulatedStudy
from reliab.study.stages import digest
from reliab.sweep.results import REAL, open_results, stored_results
from reliab.sweep.shares import at_share
from reliab.tracking.indices.window import Window
from reliab.validation.cross_validation.truth import StoredTruth

RESULTS: Final = "results.zarr"
SYNTHETIC: Final = "synthetic"


class Records:
    """Ground motions of a study, loaded when they are first needed."""

    def __init__(self, study: RecordsStudy) -> None:
        self._asked = study.motions

    @cached_property
    def motions(self) -> MotionSuite:
        """The ground motions."""
        return load_motions(*(self._asked.sources or (SYNTHETIC,)), sets=self._asked.sets)

    @cached_property
    def checksums(self) -> list[str]:
        """What the ground motions are known by."""
        return [motion.checksum for motion in self.motions]

    @property
    def population(self) -> str:
        """What the ground motions are, in words: "ground motions" where the user brought them."""
        sources = self._asked.sources or (SYNTHETIC,)
        return "synthetic ground motions" if sources == (SYNTHETIC,) else "ground motions"


class Material(Records):
    """Ground motions of a study that simulates, or stored results.

    `results`: a store of results, or the name of one that ships, that takes the place of simulations.
    """

    def __init__(self, study: SimulatedStudy, *, results: str | None = None) -> None:
        super().__init__(study)
        self._study = study
        self._results = results

    @cached_property
    def stored(self) -> Path | None:
        """Stored results, once they are known to hold the structures; a report never asks for them."""
        if self._results is None:
            return None
        structures = self._study.structures
        stored = stored_results(Path(self._results), structures.f, structures.xi)
        self._check(stored)
        return stored

    @cached_property
    def checksums(self) -> list[str]:
        """What the ground motions, or the stored results, are known by."""
        return [digest(self.stored)] if self.stored is not None else super().checksums

    @property
    def population(self) -> str:
        """What the ground motions are, in words."""
        if self._results is None:
            return super().population
        return "real ground motions" if self.is_real_suite else "ground motions"

    @property
    def is_real_suite(self) -> bool:
        """Whether the study works on the results of real ground motions that ship."""
        return self._results == REAL

    def results(self, folder: Path) -> xr.Dataset:
        """Results of the study's structures, stored or simulated in its run folder."""
        window = Window.parse(self._study.errors.window).label
        return self._select(open_results(self.stored or folder / RESULTS, window=window))

    def truth(self, folder: Path, motions: Sequence[str]) -> StoredTruth:
        """Return the true errors of tests under motions of these names, read from the results."""
        return StoredTruth(self.results(folder).sel(motion=list(motions)))

    def _select(self, results: xr.Dataset) -> xr.Dataset:
        structures = self._study.structures
        f, xi = list(structures.f), list(structures.xi)
        of_share = at_share(results, structures.experimental_fraction)
        return of_share.sel(f=f, xi=xi, method="nearest", tolerance=1e-9)

    def _check(self, stored: Path) -> None:
        results = open_results(stored, window=Window.parse(self._study.errors.window).label)
        structures = self._study.structures
        try:
            self._select(results)
        except KeyError:
            raise InputError(
                "The stored results hold no such structures",
                value=f"f = {list(structures.f)}, xi = {list(structures.xi)}",
                remedy=f"Choose among f = {results['f'].values.tolist()}, "
                f"xi = {results['xi'].values.tolist()}, or give ground motions",
            ) from None


def motion_by_name(motions: MotionSuite, name: str) -> Motion:
    """Take a motion by its name, or say that it is missing."""
    if name not in motions.names:
        raise InputError(
            f"This study needs the motion {name}",
            value=f"{len(motions)} motions without it",
            remedy="Give a folder whose catalogue names it, with `motions`",
        )
    return motions[motions.names.index(name)]
