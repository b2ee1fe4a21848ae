"""`reliab.derive_criteria`: how much amplitude error and delay a test may have."""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from reliab.app.api.cases import POPULATION, Case
from reliab.app.api.derived_criteria import Criteria, compare_candidates, draw_criteria, write_criterion
from reliab.app.api.sources import (
    FIVE_PERCENT,
    ONE_HERTZ,
    TWO_PERCENT,
    EllipseSource,
    Files,
    at_structures,
    listed,
    paths,
    require_thresholds,
    with_room,
)
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Show, quietly
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.criterion.copies import without_copies
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation
from reliab.criterion.laws.registry import FITTED, OF_MANY_MOTIONS, known
from reliab.criterion.methods.method import Method
from reliab.criterion.methods.registry import RECOMMENDED, method_of
from reliab.criterion.protection import protect_over_lengths
from reliab.criterion.published import published_criterion
from reliab.criterion.share_comparison import compare_shares
from reliab.motions.loading import load_motions
from reliab.sweep.several import Names, Numbers
from reliab.sweep.shares import at_share, shares_of
from reliab.tracking.indices.window import Window

_NINETY_FIVE = 0.95


def derive_criteria(
    *,
    motions: Files | None = None,
    sets: Names | None = None,
    results: str | Path | None = None,
    ellipses: str | Path | None = None,
    f: Numbers | None = None,
    xi: Numbers | None = None,
    threshold: Numbers | None = None,
    confidence: Numbers | None = None,
    metric: str = "rms",
    window: str | None = None,
    alpha: Numbers | None = None,
    duration: float | None = None,
    motion: str | Path | None = None,
    suite: Files | None = None,
    model: str | Path | None = None,
    structure: str | Path | None = None,
    actuator: int | None = None,
    method: str | None = None,
    assurance: float | None = None,
    distribution: str | None = None,
    joint: bool | None = None,
    law: str = "table",
    steps: int | None = None,
    chains: str | Path | None = None,
    compare: bool = False,
    figures: str | Path | None = None,
    out: str | Path | None = None,
    show: Show = quietly,
) -> Criteria:
    """Derive criteria from ground motions, stored results or ellipses, or take those of a printed law.

    :func:`reliab.derive_criterion` derives one from ellipses; this function also traces them, serves several
    structures, errors, confidences and shares of the stiffness at once, and learns once for all of them.

    Parameters
    ----------
    motions : str, pathlib.Path or sequence of these, optional
        Ground motions: records, folders or a built-in suite.
    sets : str or sequence of str, optional
        Sets of their catalogue.
    results, ellipses : str or pathlib.Path, optional
        Stored results or a file of ellipses instead, or "real_suite".
    f, xi : float or sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-]; all that the source holds by default.
    threshold, confidence : float or sequence of float, optional
        Errors [-], 0.05 by default, and shares of the population's ground motions, 0.95 by default.
    metric : {"rms", "mte"}, optional
        Error of the whole test.
    window : str, optional
        Part of the record over which the error is computed; by default that of the source.
    alpha : float or sequence of float, optional
        Shares of the stiffness in the laboratory [-]; by default those of the source, or 1.
    duration : float, optional
        Length of the records of the tests [s]: the motions behind the criterion are carried to it.
    motion : str or pathlib.Path, optional
        Record under which the test will be run: the motions behind the criterion are carried to the
        structure's response under it.
    suite : str, pathlib.Path or sequence of these, optional
        A few records of the earthquakes that are expected, with which the population is pooled.
    model, structure : str or pathlib.Path, optional
        Model with effects, or frame with its part in the laboratory, in place of structures.
    actuator : int, optional
        Number of the actuator of a frame, from 1, that errs while the others are perfect; all err alike by
        default. The error is that of the interface displacement whose error is largest.
    method, law : str, optional
        What the confidence means, the recommended method by default; how the limits depend on the structure.
    assurance, distribution, steps, chains : optional
        Settings of the method, where it has them; see :func:`reliab.derive_criterion`.
    joint : bool, optional
        Whether the confidence holds for a and b together; by default as the method defines it.
    compare : bool, optional
        Whether distributions and laws are judged on earthquakes that they have not seen.
    figures : str or pathlib.Path, optional
        Folder for drawings of the criteria over the motions' ellipses.
    out : str or pathlib.Path, optional
        File for the criterion, where there is one; none is written of a posterior that has not converged.
    show : callable, optional
        Takes the name of a task and shows its progress.

    Returns
    -------
    Criteria
        The criteria, their limits at each structure, and what else was asked for. Those of a posterior
        that has not converged are there to be looked at; `require_converged` refuses them.

    Raises
    ------
    InputError
        If there is not one source, a value is not allowed, or an argument would have no effect.

    Examples
    --------
    >>> asked = {"ellipses": "real_suite", "f": 1, "xi": 0.02, "method": "quantile"}
    >>> derived = derive_criteria(**asked, confidence=[0.9, 0.95])
    >>> [round(row["b"], 2) for row in derived.rows]
    [1.48, 1.2]
    """
    case = Case(duration=duration, motion=motion, suite=suite)
    if case.stated and not any((motions, results, ellipses)):
        ellipses = POPULATION
    # What is fitted over structures needs all of them; nothing else does.
    asked_alone = motions or (law == "table" and motion is None)
    of_records = {"sets": sets, "model": model, "window": window, "alpha": alpha}
    question = _Question(
        case=case,
        structures=(f, xi),
        source=partial(
            EllipseSource,
            motions=motions,
            sets=listed(sets),
            results=results,
            ellipses=ellipses,
            threshold=threshold,
            metric=metric,
            window=window,
            alpha=alpha,
            model=model,
            structure=structure,
            actuator=actuator,
            f=f if asked_alone else None,
            xi=xi if asked_alone else None,
        ),
        of_source={**of_records, "structure": structure, "actuator": actuator},
        has_source=any((motions, results, ellipses)),
        law=law,
        method=method,
        settings={"assurance": assurance, "distribution": distribution, "steps": steps},
        chains=None if chains is None else Path(chains),
        joint=joint,
        errors=listed(threshold),
        confidences=listed(confidence),
        metric=metric,
        compare=compare,
        figures=None if figures is None else Path(figures),
        out=out,
        show=show,
    )
    return question.answered(f, xi)


_Derived = tuple[tuple[Criterion, ...], xr.Dataset | None, tuple[Derivation, ...]]


@dataclass(frozen=True, kw_only=True)
class _Question:
    """What is asked of a criterion; see :func:`derive_criteria`."""

    case: Case  # What is known of the earthquake
    structures: tuple[Numbers | None, Numbers | None]  # Natural frequencies [Hz] and damping ratios [-]
    source: Callable[[], EllipseSource]  # Where the ellipses come from, once they are needed
    of_source: Mapping[str, Any]  # Arguments that only a source of motions uses
    has_source: bool
    law: str
    method: str | None
    settings: Mapping[str, Any]  # Settings of the method; None where they are not stated
    chains: Path | None
    joint: bool | None
    errors: list[float] | None  # errors, confidences: [-]
    confidences: list[float] | None
    metric: str
    compare: bool
    figures: Path | None
    out: str | Path | None
    show: Show

    def __post_init__(self) -> None:
        require_thresholds(self.errors)
        if self.figures is not None and self.figures.exists() and not self.figures.is_dir():
            raise InputError("Figures go into a folder", value=self.figures, remedy="Name another folder")

    def printed(self) -> _Derived:
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
                f"A printed law states only {percent(printed.confidence)}, by the quantile of each limit",
                value=", ".join(strange),
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def _refuse_idle_source(self) -> None:
        """Refuse figures without motions, and motions or their arguments that a printed law would not use."""
        if self.figures is not None and not self.has_source:
            raise InputError(
                "A criterion is drawn over ellipses of motions",
                value="`figures` without a source of ellipses",
                remedy="Give `motions`, `results` or `ellipses` too, real_suite for example",
            )
        if self.has_source and self.figures is None and not self.compare:
            raise InputError(
                "A printed law needs no motions",
                value=f"{self.law} with a source of ellipses",
                remedy="Leave the source out, or give `figures` or `compare`",
            )
        idle = [f"`{name}`" for name, value in self.of_source.items() if value is not None]
        idle += [f"`{name}`" for name in self.case.stated]
        if idle and not self.has_source:
            raise InputError(
                "A printed law is for whole records and all stiffness in the laboratory, as in the paper",
                value=f"{self.law} with {', '.join(idle)}",
                remedy="Leave these out, or derive a criterion from ellipses",
            )

    def derived(self) -> _Derived:
        """Derive a criterion for each share of the stiffness, error and confidence."""
        law, method = known(FITTED, self.law), method_of(self.method or RECOMMENDED, **self.settings)
        if self.chains is not None and not method.samples_chains:
            raise InputError(
                "Only the hierarchical methods sample chains",
                value=f"`chains` with {method.name}",
                remedy="Leave it out, or choose a hierarchical `method`",
            )
        confidences = self.confidences or [_NINETY_FIVE]
        dataset = self._population(method)
        errors, shares = self.errors or _default_errors(dataset), shares_of(dataset)
        self._require_one_share(shares)
        self._require_one_criterion(len(shares) * len(errors) * len(confidences))
        learned = []
        for share, error in itertools.product(shares, errors):
            with self.show(f"Learning at {error:g}") as progress:
                derivation = Derivation.from_ellipses(
                    at_share(dataset, share),
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
        population = without_copies(with_room(source.dataset(self.show)))
        carried = self.case.carried(population, source, *self.structures, self.show)
        protected = protect_over_lengths(carried, metric=self.metric, curve=method.curve)
        return at_structures(protected, *self.structures) if self.law == "table" else protected

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
                "A criterion's file can hold one criterion only",
                value=f"{count} of them",
                remedy="Give one threshold, one confidence and one share of the stiffness",
                where=str(self.out),
            )

    def answered(self, f: Numbers | None, xi: Numbers | None) -> Criteria:
        """Derive criteria, write the file of one, and add what is asked for beside them."""
        criteria, dataset, derivations = self.printed() if self.law in OF_MANY_MOTIONS else self.derived()
        derived = Criteria(
            criteria=criteria,
            structures=_structures(f, xi, dataset),
            ellipses=dataset,
            derivations=derivations,
        )
        beside = self.case.own_boundaries(self.source(), f, xi, self.show) if self.case.stated else {}
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
            beside |= {"figures": drawn} if drawn else {}
        if self.compare:
            beside["comparison"] = compare_candidates(
                derived.ellipses, derived.structures, derived.criteria, self.show
            )
        beside |= {**_frame(dataset), **self._of_actuators(), **_share_law(derived)}
        return replace(derived, beside=beside)

    def _of_actuators(self) -> dict[str, Any]:
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
        if frame.several and self.of_source["actuator"] is None:
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


def _default_errors(dataset: xr.Dataset) -> list[float]:
    """Return 5 % where the ellipses hold it, else all their thresholds."""
    stored: list[float] = dataset["threshold"].values.tolist()
    return [FIVE_PERCENT] if FIVE_PERCENT in stored else stored


def _structures(
    f: Numbers | None, xi: Numbers | None, dataset: xr.Dataset | None
) -> tuple[tuple[float, float], ...]:
    """Structures that are asked for, or all that the ellipses are of."""
    all_f = [ONE_HERTZ] if dataset is None else dataset["f"].values.tolist()
    all_xi = [TWO_PERCENT] if dataset is None else dataset["xi"].values.tolist()
    return tuple(itertools.product(listed(f) or all_f, listed(xi) or all_xi))


def _frame(dataset: xr.Dataset | None) -> dict[str, Any]:
    """Say which frame the ellipses are of, whose error counts, and which of its actuators err."""
    if dataset is None or "frame" not in dataset.attrs:
        return {}
    beside = {name: dataset.attrs[name] for name in ("error_of", "erring_actuator")}
    return {"frame": {"name": dataset.attrs["frame"], **beside}}


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
