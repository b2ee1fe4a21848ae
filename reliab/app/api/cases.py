"""The earthquake for which a criterion is asked: a length, a record, or a suite of a few motions."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from reliab.app.api.sources import EllipseSource, paths
from reliab.app.declaration import Files
from reliab.core.errors import InputError
from reliab.core.progress import Show
from reliab.core.shipped import shipped
from reliab.core.vocabulary import CurveName, Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, carry_to_suite
from reliab.motions.loading import load_motions
from reliab.sweep.netcdf import read_netcdf
from reliab.sweep.response_measures import measure_responses
from reliab.sweep.several import Numbers, several
from reliab.sweep.shares import share_of

POPULATION = "real_suite"
"""Ellipses from which a case is answered unless others are given."""

_MEASURES = "real_suite/first_order.nc"


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is known of the earthquake; at most one of the three."""

    duration: float | None = None  # Length of the records [s]
    motion: str | Path | None = None  # A record
    suite: Files | None = None  # A few records, pooled with the population

    def __post_init__(self) -> None:
        if len(self.stated) > 1:
            raise InputError(
                "Only one of `motion`, `suite` and `duration` can be given",
                value=" and ".join(f"`{name}`" for name in self.stated),
                remedy="Give the most specific one you know: `motion`, else `suite`, else `duration`",
            )

    @property
    def stated(self) -> list[str]:
        """Names of what is stated."""
        names = ("duration", "motion", "suite")
        return [name for name in names if getattr(self, name) is not None]

    def carried(
        self, ellipses: xr.Dataset, source: EllipseSource, f: Numbers | None, xi: Numbers | None, show: Show
    ) -> xr.Dataset:
        """Carry the ellipses of a population to the case; as they are where nothing is known of it."""
        if not self.stated:
            return ellipses
        _require_whole_records(ellipses)
        population = ellipses.sel(metric=[source.metric])
        if self.duration is not None:
            return carry_to_length(population, self.duration)
        places = {
            name: list(several(population[name].values.tolist() if values is None else values))
            for name, values in (("f", f), ("xi", xi))
        }
        if self.motion is not None:
            with show("Measuring responses") as progress:
                response = measure_responses(
                    load_motions(self.motion)[:1], **_structures(places), progress=progress
                )
            return carry_to_response(population, self._measures(population, source, show), response)
        records = EllipseSource(
            motions=self.suite,
            f=places["f"],
            xi=places["xi"],
            threshold=population["threshold"].values.tolist(),
            metric=source.metric,
        )
        return carry_to_suite(population, records.dataset(show))

    def own_boundaries(
        self, source: EllipseSource, f: Numbers | None, xi: Numbers | None, show: Show
    ) -> dict[str, Any]:
        """Ellipses inscribed in the record's own boundaries, which hold for a test under this very record."""
        if self.motion is None or f is None or xi is None:
            return {}
        records = EllipseSource(
            motions=self.motion, f=f, xi=xi, threshold=source.threshold, metric=source.metric
        )
        traced = records.dataset(show).isel(motion=0).sel(curve=str(CurveName.INSCRIBED))
        rows = traced[["a", "b"]].stack(cell=("f", "xi", "threshold", "metric"))
        return {
            "own_boundary": [
                {
                    "motion": str(traced["motion"].item()),
                    **{name: float(cell[name]) for name in ("f", "xi", "threshold")},
                    **{
                        f"{name}{'' if side == Side.LAG else '_lead'}": float(cell[name].sel(side=str(side)))
                        for name in ("a", "b")
                        for side in Side
                    },
                }
                for cell in (rows.isel(cell=place) for place in range(rows.sizes["cell"]))
            ]
        }

    def _measures(self, population: xr.Dataset, source: EllipseSource, show: Show) -> xr.Dataset:
        """Measure the responses of the population's own motions, or look them up."""
        if source.motions is not None:
            behind = set(population["motion"].values.tolist())
            suite = load_motions(*paths(source.motions), sets=source.sets)
            motions = [motion for motion in suite if motion.name in behind]
            places = {name: population[name].values.tolist() for name in ("f", "xi")}
            with show("Measuring responses of the population") as progress:
                return measure_responses(motions, **_structures(places), progress=progress)
        if POPULATION not in {str(source.ellipses), str(source.results)}:
            raise InputError(
                "This source has no responses of its motions, so it cannot be transferred to a record",
                value=f"{source.ellipses or source.results}, which holds none",
                remedy=f"Give the records as `motions`, or leave the source out; the default is {POPULATION}",
            )
        rule, remedy = "Measures of responses must be a NetCDF file", "Install the package again"
        return read_netcdf(shipped("datasets", _MEASURES), rule, remedy)


def _structures(places: dict[str, list[float]]) -> dict[str, Sequence[float]]:
    return {"frequencies": places["f"], "damping_ratios": places["xi"]}


def _require_whole_records(ellipses: xr.Dataset) -> None:
    window, share = str(ellipses.attrs.get("window", "record")), share_of(ellipses)
    if window != "record" or share != 1.0:
        raise InputError(
            "For a motion or suite, a criterion holds for whole records and all stiffness in the laboratory",
            value=f"window {window}, α = {share:g}",
            remedy="Leave `window` and `alpha` out",
        )
