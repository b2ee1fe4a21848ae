"""Where ellipses come from: a file of them, stored results, or ground motions that are simulated."""

import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar
from reliab.cli.stored_ellipses import among, of_fractions, require_column
from reliab.errors import InputError
from reliab.vocabulary import Metric

if TYPE_CHECKING:
    import xarray as xr

_RECORD, _WHOLE = "record", 1.0


@dataclass(frozen=True, kw_only=True)
class SourceOptions:
    """Options of several commands that say where ellipses come from; see :class:`EllipseSource`."""

    motions: list[str] | None
    sets: list[str] | None
    results: Path | None
    ellipses: Path | None
    f: list[float] | None
    xi: list[float] | None
    metric: str
    window: str | None
    alpha: list[float] | None

    def ellipse_source(self, **options: Any) -> "EllipseSource":  # noqa: ANN401 - as EllipseSource takes them
        """Say where the ellipses come from."""
        shared = {field.name: getattr(self, field.name) for field in fields(SourceOptions)}
        return EllipseSource(**(shared | options))


@dataclass(frozen=True, kw_only=True)
class EllipseSource:
    """Where the ellipses that a command is about come from."""

    motions: list[str] | None = None  # motions, sets: Sources of ground motions and sets of their catalogue
    sets: list[str] | None = None
    results: Path | None = None  # Stored results instead
    ellipses: Path | None = None  # A file of ellipses instead, CSV or NetCDF
    # f, xi: Natural frequencies [Hz] and damping ratios [-]; of stored results and ellipses all that they
    # hold, by default and where one that is asked for is not among them
    f: list[float] | None = None
    xi: list[float] | None = None
    threshold: list[float] | None = None  # Errors on the boundary [-]
    metric: str  # Error of the whole test
    # Part of the record over which the error is computed; None leaves it to the source, which is the whole
    # record for records
    window: str | None = None
    # Experimental fractions [-]; 1 for records unless given. Stored results and files must be of these
    # fractions, or of 1, from which a law carries them
    alpha: list[float] | None = None
    model: Path | None = None  # Model with effects instead of structures, for records
    structure: Path | None = None  # Description of a partitioned frame instead of structures, for records
    first_order: bool = False  # Whether ellipses are predicted from the spectra of records instead of traced

    def __post_init__(self) -> None:
        given = [source for source in (self.motions, self.results, self.ellipses) if source is not None]
        if len(given) != 1:
            raise InputError(
                "Ellipses come from one source: ground motions, stored results or a file of ellipses",
                value=f"{len(given)} of them",
                remedy="Give --motions (records or 'synthetic'), --results or --ellipses",
            )
        if self.motions is None:
            self._refuse_options_of_motions()
        check_thresholds(self.threshold)
        Metric.parse(self.metric)

    def _refuse_options_of_motions(self) -> None:
        """Refuse what only ground motions can serve."""
        sets = None if self.sets is None else f"--sets {' '.join(self.sets)}"
        options = (
            (
                "--model" if self.model else None,
                "A model is simulated under ground motions",
                "Give --motions; a results store names the model that it was simulated with",
            ),
            (
                "--first-order" if self.first_order else None,
                "Ellipses are predicted from the spectra of ground motions",
                "Give --motions, or leave --first-order out",
            ),
            (
                sets,
                "Sets are those of a catalogue of ground motions",
                "Give the folder of the catalogue with --motions",
            ),
            (
                "--structure" if self.structure else None,
                "A frame is simulated under ground motions",
                "Give --motions",
            ),
        )
        for option, rule, remedy in options:
            if option is not None:
                raise InputError(rule, value=f"{option} without --motions", remedy=remedy)

    @property
    def _thresholds(self) -> tuple[float, ...]:
        return tuple(self.threshold or (FIVE_PERCENT,))

    def dataset(self) -> "xr.Dataset":
        """Trace the ellipses, or look them up."""
        if self.ellipses is not None:
            return of_fractions(self._read(self.ellipses), self.alpha, self.ellipses)
        if self.results is not None:
            return of_fractions(self._traced_in(self.results), self.alpha, self.results)
        if self.structure is not None:
            return self._of_frame(self.structure)
        from reliab.api import ellipses
        from reliab.motions import load_motions

        suite = load_motions(*(self.motions or []), sets=self.sets)
        with progress_bar("Reading spectra" if self.first_order else "Tracing boundaries") as progress:
            return ellipses(
                suite,
                f=self.f,
                xi=self.xi,
                threshold=self._thresholds,
                metric=[self.metric],
                window=self.window or _RECORD,
                alpha=[_WHOLE] if self.alpha is None else self.alpha,
                model=self.model,
                first_order=self.first_order,
                progress=progress,
            )

    def _read(self, path: Path) -> "xr.Dataset":
        """Read a file of ellipses."""
        from reliab.criterion import read_ellipses
        from reliab.shipped import or_shipped
        from reliab.sweep import open_ellipses

        path = or_shipped(path, "datasets", "ellipses.nc")
        if path.suffix == ".nc":
            return among(open_ellipses(path, window=self.window), self.f, self.xi)
        if self.window is not None:
            raise InputError(
                "A CSV table of ellipses does not state over which window its errors were computed",
                value=f"--window {self.window}",
                remedy="Leave it out, or give --motions, --results or a file of ellipses in NetCDF",
            )
        dataset = read_ellipses(path)
        require_column(dataset, "f", self.f, path)
        require_column(dataset, "xi", self.xi, path)
        require_column(dataset, "threshold", self.threshold, path)
        require_column(dataset, "metric", [self.metric], path)
        return among(dataset, self.f, self.xi)

    def _traced_in(self, path: Path) -> "xr.Dataset":
        """Trace the boundaries in stored results."""
        from reliab.sweep import open_results, stored_results

        stored = open_results(stored_results(path, self.f, self.xi), window=self.window or _RECORD)
        chosen = among(stored, self.f, self.xi)
        with progress_bar("Tracing boundaries") as progress:
            traced: xr.Dataset = chosen.reliab.ellipses(
                self._thresholds, (Metric(self.metric),), progress=progress
            )
        return traced

    def _of_frame(self, path: Path) -> "xr.Dataset":
        """Trace the boundaries of a frame under records."""
        from reliab.indices import Window
        from reliab.motions import load_motions
        from reliab.simulation.frames import read_frame
        from reliab.sweep import FrameRequest, trace_frame_ellipses

        excluded = {"--f": self.f, "--xi": self.xi, "--alpha": self.alpha, "--model": self.model}
        given = [name for name, value in excluded.items() if value is not None]
        if given:
            raise InputError(
                "The file of a frame states its frequencies, damping ratios and shares",
                value=f"--structure with {', '.join(given)}",
                remedy="Leave them out",
            )
        request = FrameRequest(
            frame=read_frame(path),
            thresholds=self._thresholds,
            metrics=(Metric(self.metric),),
            window=Window.parse(self.window or _RECORD),
        )
        suite = load_motions(*(self.motions or []), sets=self.sets)
        with progress_bar("Tracing boundaries") as progress:
            return trace_frame_ellipses(suite, request, progress=progress)


def check_thresholds(threshold: list[float] | None) -> None:
    """Refuse errors that are not positive and finite.

    `threshold` [-].
    """
    for error in threshold or []:
        if not 0.0 < error < math.inf:
            raise InputError(
                "The error threshold must be positive and finite",
                value=f"--threshold {error:g}",
                remedy="Give a fraction, 0.05 for 5 %",
            )
