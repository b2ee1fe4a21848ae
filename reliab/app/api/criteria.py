"""`derive_criteria`: how much amplitude error and delay a test may have under the coming earthquake."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Unpack

import numpy as np
import xarray as xr

from reliab.app import questions
from reliab.app.api.derived_criteria import Criteria, compare_candidates, draw_criteria, write_criterion
from reliab.app.api.sources import (
    FIVE_PERCENT,
    ONE_HERTZ,
    TWO_PERCENT,
    EllipseSource,
    as_list,
    paths,
    require_thresholds,
    select_rows_with_room,
    select_structures,
)
from reliab.app.declaration import Files, asks
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Show, quietly
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import CurveName, Metric, Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, carry_to_suite, protect_over_lengths
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation
from reliab.criterion.ellipse_table import drop_copies
from reliab.criterion.experimental_share import compare_shares
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, find_law
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.criterion.published import published_criterion
from reliab.motions.loading import load_motions
from reliab.sweep.netcdf import read_netcdf
from reliab.sweep.response_measures import measure_responses
from reliab.sweep.several import Numbers, as_names
from reliab.sweep.shares import select_share, share_of, shares_of
from reliab.tracking.indices.window import Window

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

    def carry_ellipses(
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
            name: list(as_names(population[name].values.tolist() if values is None else values))
            for name, values in (("f", f), ("xi", xi))
        }
        if self.motion is not None:
            with show("Measuring responses") as progress:
                response = measure_responses(
                    load_motions(self.motion)[:1],
                    frequencies=places["f"],
                    damping_ratios=places["xi"],
                    progress=progress,
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
        ellipses = records.dataset(show).isel(motion=0).sel(curve=str(CurveName.INSCRIBED))
        rows = ellipses[["a", "b"]].stack(cell=("f", "xi", "threshold", "metric"))
        return {
            "own_boundary": [
                {
                    "motion": str(ellipses["motion"].item()),
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
                return measure_responses(
                    motions, frequencies=places["f"], damping_ratios=places["xi"], progress=progress
                )
        if POPULATION not in {str(source.ellipses), str(source.results)}:
            raise InputError(
                "This source has no responses of its motions, so it cannot be transferred to a record",
                value=f"{source.ellipses or source.results}, which holds none",
                remedy=f"Give the records as `motions`, or leave the source out; the default is {POPULATION}",
            )
        rule, remedy = "Measures of responses must be a NetCDF file", "Install the package again"
        return read_netcdf(shipped("datasets", _MEASURES), rule, remedy)


def _require_whole_records(ellipses: xr.Dataset) -> None:
    window, share = str(ellipses.attrs.get("window", "record")), share_of(ellipses)
    if window != "record" or share != 1.0:
        raise InputError(
            "For a motion or suite, a criterion holds for whole records and all stiffness in the laboratory",
            value=f"window {window}, α = {share:g}",
            remedy="Leave `window` and `alpha` out",
        )


_NINETY_FIVE = 0.95


@asks(questions.CriterionQuestion)
def derive_criteria(*, show: Show = quietly, **request: Unpack[questions.CriterionQuestion]) -> Criteria:
    """Derive criteria from ground motions, stored results or ellipses, or take those of a printed law.

    :func:`reliab.derive_criterion` derives one from ellipses; this function also traces them, serves several
    structures, errors, confidences and shares of the stiffness at once, and learns once for all of them.
    Without a source it derives them from real_suite, the ellipses of 100 real ground motions that ship.
    `require_converged` refuses criteria of a posterior that has not converged; they are there to be seen.

    >>> asked = {"ellipses": "real_suite", "f": 1, "xi": 0.02, "method": "quantile"}
    >>> derived = derive_criteria(**asked, confidence=[0.9, 0.95])
    >>> [round(row["b"], 2) for row in derived.rows]
    [1.48, 1.2]
    """
    return _Question(request, show).answer()


_Derived = tuple[tuple[Criterion, ...], xr.Dataset | None, tuple[Derivation, ...]]


_OF_RECORDS = ("sets", "model", "window", "alpha", "structure", "actuator")
_OF_EARTHQUAKES = ("duration", "motion", "suite")
_OF_METHODS = ("assurance", "distribution", "steps")


class _Question:
    """What is asked of a criterion; see :func:`derive_criteria`."""

    def __init__(self, request: Mapping[str, Any], show: Show) -> None:
        self.asked, self.show = request, show
        self.law, self.method, self.joint, self.compare = (
            request[name] for name in ("law", "method", "joint", "compare")
        )
        self.case = Case(**{name: request[name] for name in _OF_EARTHQUAKES})
        self.structures = request["f"], request["xi"]
        self.of_source = {name: request[name] for name in _OF_RECORDS}
        self.settings = {name: request[name] for name in _OF_METHODS}
        self.errors, self.confidences = as_list(request["threshold"]), as_list(request["confidence"])
        self.metric, self.out = str(request["metric"] or Metric.RMS), request["out"]
        self.chains, self.figures = (
            None if request[name] is None else Path(request[name]) for name in ("chains", "figures")
        )
        self.origin = {name: request[name] for name in ("motions", "results", "ellipses")}
        if not self.has_source and self._is_of_the_population():
            self.origin["ellipses"] = POPULATION
        require_thresholds(self.errors)
        if self.figures is not None and self.figures.exists() and not self.figures.is_dir():
            raise InputError("This is no folder for figures", value=self.figures, remedy="Name a folder")

    @property
    def has_source(self) -> bool:
        """Whether ellipses come from somewhere."""
        return any(self.origin.values())

    def _is_of_the_population(self) -> bool:
        """Whether the shipped ellipses answer a question that names none."""
        needs_motions = any(self.of_source[name] for name in ("sets", "model", "structure", "actuator"))
        is_fitted = self.law not in MANY_MOTION_LAWS and not needs_motions
        return is_fitted or bool(self.case.stated)

    def source(self) -> EllipseSource:
        """Take the source of the ellipses; what is fitted over structures needs all of them."""
        asked_alone = self.origin["motions"] or (self.law == "table" and self.case.motion is None)
        every = {} if asked_alone else {"f": None, "xi": None}
        return EllipseSource.from_question(self.asked, **self.origin, **every)

    def derive_from_published_law(self) -> _Derived:
        """Take the criterion of a printed law, with the ellipses beside which it is shown."""
        criterion = published_criterion(self.law)
        for error in self.errors or [criterion.threshold]:
            criterion.law.validity.require_error(error, self.metric)
        self._refuse_promises(criterion)
        self._refuse_idle_source()
        dataset = self.source().dataset(self.show) if self.has_source else None
        return (criterion,), dataset, ()

    def _refuse_promises(self, printed: Criterion) -> None:
        """Refuse what a printed law does not promise."""
        strange = [
            f"`confidence={share:g}`" for share in self.confidences or [] if share != printed.confidence
        ]
        strange += ["`joint`"] if self.joint else []
        strange += [f"`method={self.method}`"] if self.method not in {None, printed.method} else []
        settings = {**self.settings, "chains": self.chains}
        strange += [f"`{name}={value}`" for name, value in settings.items() if value is not None]
        if strange:
            raise InputError(
                f"A published law is for {percent(printed.confidence)}, by the quantile of each limit",
                value=", ".join(strange),
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def _refuse_idle_source(self) -> None:
        """Refuse figures without motions, and motions or their arguments that a printed law would not use."""
        if self.figures is not None and not self.has_source:
            raise InputError(
                "`figures` needs a source of ellipses",
                remedy="Give `motions`, `results` or `ellipses` too, real_suite for example",
            )
        if self.has_source and self.figures is None and not self.compare:
            raise InputError(
                "A published law needs no motions",
                value=f"{self.law} with a source of ellipses",
                remedy="Leave the source out, or give `figures` or `compare`",
            )
        idle = [f"`{name}`" for name, value in self.of_source.items() if value is not None]
        idle += [f"`{name}`" for name in self.case.stated]
        if idle and not self.has_source:
            raise InputError(
                "A published law holds for whole records and all stiffness in the laboratory",
                value=f"{self.law} with {', '.join(idle)}",
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def derive_from_ellipses(self) -> _Derived:
        """Derive a criterion for each share of the stiffness, error and confidence."""
        law, method = (
            find_law(FITTED_LAWS, self.law),
            method_of(self.method or RECOMMENDED_METHOD, **self.settings),
        )
        if self.chains is not None and not method.samples_chains:
            raise InputError(
                "Only the hierarchical methods have chains",
                value=f"`chains` with {method.name}",
                remedy="Leave it out, or choose a hierarchical `method`",
            )
        confidences = self.confidences or [_NINETY_FIVE]
        dataset = self._population(method)
        stored: list[float] = dataset["threshold"].values.tolist()
        errors = self.errors or ([FIVE_PERCENT] if FIVE_PERCENT in stored else stored)
        shares = shares_of(dataset)
        self._require_one_share(shares)
        self._require_one_criterion(len(shares) * len(errors) * len(confidences))
        learned = []
        for share, error in itertools.product(shares, errors):
            with self.show(f"Learning at {error:g}") as progress:
                derivation = Derivation.from_ellipses(
                    select_share(dataset, share),
                    method=method,
                    law=law,
                    threshold=error,
                    metric=self.metric,
                    chains=self.chains,
                    progress=progress,
                )
            learned.append(derivation)
        criteria = (
            derivation.criterion(confidence, joint=self.joint)
            for derivation in learned
            for confidence in confidences
        )
        return tuple(criteria), dataset, tuple(learned)

    def _population(self, method: Method) -> xr.Dataset:
        """Ellipses behind the criteria."""
        source = self.source()
        population = drop_copies(select_rows_with_room(source.dataset(self.show)))
        carried = self.case.carry_ellipses(population, source, *self.structures, self.show)
        protected = protect_over_lengths(carried, metric=self.metric, curve=method.curve)
        return select_structures(protected, *self.structures) if self.law == "table" else protected

    def _require_one_share(self, shares: tuple[float, ...]) -> None:
        """Refuse what is of one share of the stiffness where there are several."""
        of_one = {"figures": self.figures, "compare": self.compare or None, "chains": self.chains}
        unserved = [f"`{name}`" for name, value in of_one.items() if value is not None]
        if len(shares) > 1 and unserved:
            raise InputError(
                f"{' and '.join(unserved)} need one share of the stiffness",
                value=f"α = {', '.join(f'{share:g}' for share in shares)}",
                remedy="Give one `alpha`, or leave them out",
            )

    def _require_one_criterion(self, count: int) -> None:
        """Refuse a file for several criteria, before any of them is derived."""
        if self.out is not None and count > 1:
            raise InputError(
                "A file holds one criterion",
                value=f"{count} of them",
                remedy="Give one threshold, one confidence and one share of the stiffness",
                where=str(self.out),
            )

    def answer(self) -> Criteria:
        """Derive criteria, write the file of one, and add what is asked for beside them."""
        f, xi = self.structures
        criteria, dataset, derivations = (
            self.derive_from_published_law() if self.law in MANY_MOTION_LAWS else self.derive_from_ellipses()
        )
        derived = Criteria(
            criteria=criteria,
            structures=_structures(f, xi, dataset),
            ellipses=dataset,
            derivations=derivations,
        )
        neighbours = self.case.own_boundaries(self.source(), f, xi, self.show) if self.case.stated else {}
        converged = all(posterior["converged"] for posterior in derived.posteriors)
        # Rows refuse structures for which a law is not valid.
        if derived.rows and converged and self.out is not None:
            write_criterion(derived.criteria[0], self.out)
        if self.figures is not None and dataset is not None:
            drawn = draw_criteria(
                self.figures,
                dataset,
                derived.criteria,
                derived.structures,
                derived.derivations,
                self.show,
            )
            neighbours |= {"figures": drawn} if drawn else {}
        if self.compare:
            neighbours["comparison"] = compare_candidates(
                derived.ellipses, derived.structures, derived.criteria, self.show
            )
        neighbours |= {**_frame(dataset), **self._limits_of_actuators(), **_share_law(derived)}
        return replace(derived, beside=neighbours)

    def _limits_of_actuators(self) -> dict[str, Any]:
        """Compute what the motions allow and do to the actuators that a frame's description states."""
        structure = self.of_source["structure"]
        if structure is None:
            return {}
        from reliab.simulation.frames.frame_file import read_structure
        from reliab.sweep.frame_table import errors_of_rig, limits_of_coupling, summary_of_rig

        frame, source, found = read_structure(structure), self.source(), {}
        suite = load_motions(*paths(source.motions or ()), sets=source.sets)
        window = Window.parse(self.of_source["window"] or "record")
        threshold = (self.errors or [FIVE_PERCENT])[0]
        if frame.has_several and self.of_source["actuator"] is None:
            with self.show("Coupling the actuators") as progress:
                limits = limits_of_coupling(
                    frame,
                    suite,
                    threshold=threshold,
                    metric=Metric(self.metric),
                    window=window,
                    progress=progress,
                )
            found["cross_coupling"] = _coupling(limits, threshold, (self.confidences or [_NINETY_FIVE])[0])
        if frame.transfer_system is not None:
            with self.show("Testing the rig") as progress:
                tried = errors_of_rig(frame, suite, window=window, progress=progress)
            found["rig"] = summary_of_rig(tried, self.metric, threshold)
        return found


def _structures(
    f: Numbers | None, xi: Numbers | None, dataset: xr.Dataset | None
) -> tuple[tuple[float, float], ...]:
    """Structures that are asked for, or all that the ellipses are of."""
    all_f = [ONE_HERTZ] if dataset is None else dataset["f"].values.tolist()
    all_xi = [TWO_PERCENT] if dataset is None else dataset["xi"].values.tolist()
    return tuple(itertools.product(as_list(f) or all_f, as_list(xi) or all_xi))


def _frame(dataset: xr.Dataset | None) -> dict[str, Any]:
    """Say which frame the ellipses are of, whose error counts, and which of its actuators err."""
    if dataset is None or "frame" not in dataset.attrs:
        return {}
    neighbours = {name: dataset.attrs[name] for name in ("error_of", "erring_actuator")}
    return {"frame": {"name": dataset.attrs["frame"], **neighbours}}


def _coupling(limits: Array, threshold: float, share: float) -> dict[str, Any]:
    """Largest coupling of each actuator (rows) with the command of each other that most motions allow."""
    least = np.quantile(limits, 1.0 - share, axis=0)
    rows = [[None if i == j else float(value) for j, value in enumerate(row)] for i, row in enumerate(least)]
    return {"threshold": threshold, "share_of_motions": share, "limits": rows}


def _share_law(derived: Criteria) -> dict[str, Any]:
    """Compare criteria of several shares of the stiffness with the law, unless the law carried them."""
    dataset = derived.ellipses
    if dataset is None or "alpha" not in dataset.dims or "caution" in dataset.attrs:
        return {}
    return {"share_law": compare_shares(derived.criteria, derived.structures)}
