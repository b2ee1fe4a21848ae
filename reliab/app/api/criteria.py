"""`derive_criteria`: how much amplitude error and delay a test may have under the coming earthquake."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any, Unpack

import numpy as np
import xarray as xr

from reliab.app import questions
from reliab.app.api.derived_criteria import Criteria, draw_criteria
from reliab.app.api.sources import (
    FIVE_PERCENT,
    ONE_HERTZ,
    TWO_PERCENT,
    EllipseSource,
    as_list,
    require_thresholds,
    select_rows_with_room,
    select_structures,
)
from reliab.app.declaration import asks
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import CurveName, Metric, Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, carry_to_suite, protect_over_lengths
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation, published_criterion
from reliab.criterion.ellipse_table import drop_copies
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, find_law
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.registry import RECOMMENDED_METHOD, method_of
from reliab.motions.loading import load_motions
from reliab.sweep.ellipse_table import measure_responses
from reliab.sweep.labels import select_share, share_of, shares_of
from reliab.sweep.netcdf import read_netcdf
from reliab.tracking.indices.window import Window

POPULATION = "real_suite"
"""Ellipses from which a case is answered unless others are given."""

_MEASURES = "real_suite/first_order.nc"


_NINETY_FIVE = 0.95


@asks(questions.CriterionQuestion)
def derive_criteria(**request: Unpack[questions.CriterionQuestion]) -> Criteria:
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
    return _Question({**request}).answer()


_RECORD_OPTIONS = ("sets", "model", "window", "alpha", "structure", "actuator")
_EARTHQUAKE_OPTIONS = ("duration", "motion", "suite")
"""What is known of the earthquake, at most one of: length of the records, a record, a few of them."""
_METHOD_OPTIONS = ("assurance", "distribution", "steps")


class _Question:
    """What is asked of a criterion; see :func:`derive_criteria`."""

    def __init__(self, question: dict[str, Any]) -> None:
        self.asked = question
        self.law, self.f, self.xi = question["law"], question["f"], question["xi"]
        self.errors, self.confidences = as_list(question["threshold"]), as_list(question["confidence"])
        self.metric = str(question["metric"] or Metric.RMS)
        self.chains, self.figures = (
            None if question[name] is None else Path(question[name]) for name in ("chains", "figures")
        )
        self.earthquake = [name for name in _EARTHQUAKE_OPTIONS if question[name] is not None]
        if len(self.earthquake) > 1:
            raise InputError(
                "Only one of `motion`, `suite` and `duration` can be given",
                value=" and ".join(f"`{name}`" for name in self.earthquake),
                remedy="Give the most specific one you know: `motion`, else `suite`, else `duration`",
            )
        if not self.has_source and self._is_of_the_population():
            question["ellipses"] = POPULATION
        require_thresholds(self.errors)
        if self.figures is not None and self.figures.exists() and not self.figures.is_dir():
            raise InputError("This is no folder for figures", value=self.figures, remedy="Name a folder")

    @property
    def has_source(self) -> bool:
        """Whether ellipses come from somewhere."""
        return any(self.asked[name] for name in ("motions", "results", "ellipses"))

    def _is_of_the_population(self) -> bool:
        """Whether the shipped ellipses answer a question that names none."""
        needs_motions = any(self.asked[name] for name in ("sets", "model", "structure", "actuator"))
        is_fitted = self.law not in MANY_MOTION_LAWS and not needs_motions
        return is_fitted or bool(self.earthquake)

    def source(self) -> EllipseSource:
        """Take the source of the ellipses; what is fitted over structures needs all of them."""
        needs_all = not self.asked["motions"] and (self.law != "table" or self.asked["motion"] is not None)
        return EllipseSource.from_question(self.asked, **({"f": None, "xi": None} if needs_all else {}))

    def derive_from_published_law(self) -> tuple[list[Criterion], xr.Dataset | None, list[Derivation]]:
        """Take the criterion of a printed law, with the ellipses beside which it is shown."""
        criterion = published_criterion(self.law)
        for error in self.errors or [criterion.threshold]:
            criterion.law.validity.require_error(error, self.metric)
        self._refuse_promises(criterion)
        self._refuse_idle_source()
        return [criterion], self.source().dataset() if self.has_source else None, []

    def _refuse_promises(self, published: Criterion) -> None:
        """Refuse what a printed law does not promise."""
        method, chains = self.asked["method"], self.chains
        settings = {name: self.asked[name] for name in _METHOD_OPTIONS} | {"chains": chains}
        unsupported_options = [
            *(f"`confidence={share:g}`" for share in self.confidences or [] if share != published.confidence),
            *(["`joint`"] if self.asked["joint"] else []),
            *([f"`method={method}`"] if method not in {None, published.method} else []),
            *(f"`{name}={value}`" for name, value in settings.items() if value is not None),
        ]
        if unsupported_options:
            raise InputError(
                f"A published law is for {percent(published.confidence)}, by the quantile of each limit",
                value=", ".join(unsupported_options),
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def _refuse_idle_source(self) -> None:
        """Refuse figures without motions, and motions or their arguments that a printed law would not use."""
        options = (*_RECORD_OPTIONS, *_EARTHQUAKE_OPTIONS)
        idle = [f"`{name}`" for name in options if self.asked[name] is not None]
        if self.has_source:
            if self.figures is None:
                raise InputError(
                    "A published law needs no motions",
                    value=f"{self.law} with a source of ellipses",
                    remedy="Leave the source out, or give `figures`",
                )
        elif self.figures is not None:
            raise InputError(
                "`figures` needs a source of ellipses",
                remedy="Give `motions`, `results` or `ellipses` too, real_suite for example",
            )
        elif idle:
            raise InputError(
                "A published law holds for whole records and all stiffness in the laboratory",
                value=f"{self.law} with {', '.join(idle)}",
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def derive_from_ellipses(self) -> tuple[list[Criterion], xr.Dataset | None, list[Derivation]]:
        """Derive a criterion for each share of the stiffness, error and confidence."""
        law = find_law(FITTED_LAWS, self.law)
        settings = {name: self.asked[name] for name in _METHOD_OPTIONS}
        method = method_of(self.asked["method"] or RECOMMENDED_METHOD, **settings)
        if self.chains is not None and not method.samples_chains:
            raise InputError(
                "Only the hierarchical methods have chains",
                value=f"`chains` with {method.name}",
                remedy="Leave it out, or choose a hierarchical `method`",
            )
        confidences = self.confidences or [_NINETY_FIVE]
        dataset = self._population(method)
        stored_thresholds: list[float] = dataset["threshold"].values.tolist()
        errors = self.errors or ([FIVE_PERCENT] if FIVE_PERCENT in stored_thresholds else stored_thresholds)
        shares = shares_of(dataset)
        self._require_one_share(shares)
        self._require_one_criterion(len(shares) * len(errors) * len(confidences))
        derivations = []
        for share, error in itertools.product(shares, errors):
            ellipses = select_share(dataset, share)
            learned: dict[str, Any] = {
                "method": method,
                "law": law,
                "threshold": error,
                "metric": self.metric,
            }
            with show_task(f"Learning at {error:g}") as progress:
                derivations.append(
                    Derivation.from_ellipses(ellipses, **learned, chains=self.chains, progress=progress)
                )
        criteria = [
            derivation.criterion(confidence, joint=self.asked["joint"])
            for derivation in derivations
            for confidence in confidences
        ]
        return criteria, dataset, derivations

    def _population(self, method: Method) -> xr.Dataset:
        """Ellipses behind the criteria."""
        source = self.source()
        population = drop_copies(select_rows_with_room(source.dataset()))
        if self.earthquake:
            window, share = str(population.attrs.get("window", "record")), share_of(population)
            if window != "record" or share != 1.0:
                raise InputError(
                    "For a motion or suite, a criterion holds for whole records and all stiffness in the "
                    "laboratory",
                    value=f"window {window}, α = {share:g}",
                    remedy="Leave `window` and `alpha` out",
                )
            population = self._carry_ellipses(population.sel(metric=[source.metric]), source)
        protected_ellipses = protect_over_lengths(population, metric=self.metric, curve=method.curve)
        return (
            select_structures(protected_ellipses, self.f, self.xi)
            if self.law == "table"
            else protected_ellipses
        )

    def _carry_ellipses(self, population: xr.Dataset, source: EllipseSource) -> xr.Dataset:
        """Carry the ellipses of a population to the earthquake that is asked for."""
        if self.asked["duration"] is not None:
            return carry_to_length(population, self.asked["duration"])
        f, xi = (
            as_list(values) or population[name].values.tolist()
            for name, values in (("f", self.f), ("xi", self.xi))
        )
        if self.asked["motion"] is not None:
            with show_task("Measuring responses") as progress:
                record = load_motions(self.asked["motion"])[:1]
                response = measure_responses(record, f, xi, progress=progress)
            return carry_to_response(population, self._measures(population, source), response)
        thresholds = population["threshold"].values.tolist()
        suite = EllipseSource(
            motions=self.asked["suite"], f=f, xi=xi, threshold=thresholds, metric=source.metric
        )
        return carry_to_suite(population, suite.dataset())

    def _measures(self, population: xr.Dataset, source: EllipseSource) -> xr.Dataset:
        """Measure the responses of the population's own motions, or look them up."""
        if source.motions is not None:
            names = set(population["motion"].values.tolist())
            suite = source.suite()
            motions = [motion for motion in suite if motion.name in names]
            f, xi = (population[name].values.tolist() for name in ("f", "xi"))
            with show_task("Measuring responses of the population") as progress:
                return measure_responses(motions, f, xi, progress=progress)
        if POPULATION not in {str(source.ellipses), str(source.results)}:
            raise InputError(
                "This source has no responses of its motions, so it cannot be transferred to a record",
                value=f"{source.ellipses or source.results}, which holds none",
                remedy=f"Give the records as `motions`, or leave the source out; the default is {POPULATION}",
            )
        rule, remedy = "Measures of responses must be a NetCDF file", "Install the package again"
        return read_netcdf(shipped("datasets", _MEASURES), rule, remedy)

    def _trace_own_boundaries(self) -> dict[str, Any]:
        """Ellipses inscribed in the record's own boundaries, which hold for a test under this very record."""
        if self.asked["motion"] is None or self.f is None or self.xi is None:
            return {}
        source = self.source()
        error: dict[str, Any] = {"threshold": source.threshold, "metric": source.metric}
        record = EllipseSource(motions=self.asked["motion"], f=self.f, xi=self.xi, **error)
        ellipses = record.dataset().isel(motion=0, metric=0).sel(curve=str(CurveName.INSCRIBED))
        table: Any = ellipses[["a", "b"]].to_dataframe()[["a", "b"]].unstack("side")
        endings = {str(Side.LAG): "", str(Side.LEAD): "_lead"}
        table.columns = [f"{name}{endings[side]}" for name, side in table.columns]
        motion = {"motion": str(ellipses["motion"].item())}
        return {"own_boundary": [{**motion, **row} for row in table.reset_index().to_dict("records")]}

    def _require_one_share(self, shares: tuple[float, ...]) -> None:
        """Refuse what is of one share of the stiffness where there are several."""
        idle_options = [f"`{name}`" for name in ("figures", "chains") if self.asked[name]]
        if len(shares) > 1 and idle_options:
            raise InputError(
                f"{' and '.join(idle_options)} need one share of the stiffness",
                value=f"α = {', '.join(f'{share:g}' for share in shares)}",
                remedy="Give one `alpha`, or leave them out",
            )

    def _require_one_criterion(self, count: int) -> None:
        """Refuse a file for several criteria, before any of them is derived."""
        if self.asked["out"] is not None and count > 1:
            raise InputError(
                "A file holds one criterion",
                value=f"{count} of them",
                remedy="Give one threshold, one confidence and one share of the stiffness",
                where=str(self.asked["out"]),
            )

    def answer(self) -> Criteria:
        """Derive criteria, write the file of one, and add what is asked for beside them."""
        is_printed = self.law in MANY_MOTION_LAWS
        answers = self.derive_from_published_law() if is_printed else self.derive_from_ellipses()
        criteria, dataset, derivations = answers
        usual = {"f": [ONE_HERTZ], "xi": [TWO_PERCENT]}
        f, xi = (
            as_list(self.asked[name]) or (usual[name] if dataset is None else dataset[name].values.tolist())
            for name in usual
        )
        result = Criteria(
            criteria=tuple(criteria),
            structures=tuple(itertools.product(f, xi)),
            ellipses=dataset,
            derivations=tuple(derivations),
        )
        additions = self._trace_own_boundaries()
        has_converged = all(posterior["converged"] for posterior in result.posteriors)
        # Rows refuse structures for which a law is not valid.
        if result.rows and has_converged and (out := self.asked["out"]) is not None:
            rule = "Cannot write the criterion's file"
            with refuse_unwritable(rule, where=out), written_whole(out) as file:
                file.write_text(criteria[0].to_json(), encoding="utf-8")
        if self.figures is not None and (names := draw_criteria(self.figures, result)):
            additions["figures"] = names
        if dataset is not None and "frame" in dataset.attrs:
            neighbours = {name: dataset.attrs[name] for name in ("error_of", "erring_actuator")}
            additions["frame"] = {"name": dataset.attrs["frame"], **neighbours}
        return replace(result, additions=additions | self._limits_of_actuators())

    def _limits_of_actuators(self) -> dict[str, Any]:
        """Compute what the motions allow and do to the actuators that a frame's description states."""
        if self.asked["structure"] is None:
            return {}
        from reliab.simulation.frames.frame_file import read_structure
        from reliab.sweep.frame_table import errors_of_rig, limits_of_coupling, summary_of_rig

        frame, suite = read_structure(self.asked["structure"]), self.source().suite()
        window = Window.parse(self.asked["window"] or "record")
        results: dict[str, Any] = {}
        threshold, share = (self.errors or [FIVE_PERCENT])[0], (self.confidences or [_NINETY_FIVE])[0]
        error: dict[str, Any] = {"threshold": threshold, "metric": Metric(self.metric)}
        if frame.has_several and self.asked["actuator"] is None:
            with show_task("Coupling the actuators") as progress:
                limits = limits_of_coupling(frame, suite, **error, window=window, progress=progress)
            least = np.quantile(limits, 1.0 - share, axis=0)
            # by the actuator, and by each other one whose command alone moves it
            rows = [
                [None if i == j else float(value) for j, value in enumerate(row)]
                for i, row in enumerate(least)
            ]
            results["cross_coupling"] = {"threshold": threshold, "share_of_motions": share, "limits": rows}
        if frame.transfer_system is not None:
            with show_task("Testing the rig") as progress:
                errors = errors_of_rig(frame, suite, window=window, progress=progress)
            results["rig"] = summary_of_rig(errors, self.metric, threshold)
        return results
