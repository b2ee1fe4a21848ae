"""The posterior of a test: what its channels show of everything that is uncertain about it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from reliab.assessment.inference.evidence import (
    EquationOfMotion,
    EquationWithoutGround,
    Evidence,
    ImpliedGroundMotion,
    SpecimenForce,
)
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.quantities import UncertainQuantity, list_unknowns
from reliab.assessment.inference.randomized_optimization import Draws, LeastSquares
from reliab.assessment.inference.uncertain_quantity import Circumstances, Shape
from reliab.core.arrays import Array, Spectrum
from reliab.core.stated_value import StatedValue

DRAWS = 256
"""Draws of a posterior."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TestModel:
    """What is uncertain about a test, and the evidence that shows it."""

    circumstances: Circumstances
    unknowns: tuple[UncertainQuantity, ...]
    evidence: tuple[Evidence, ...]

    def experiment(self, z: Array) -> Experiment:
        """Possible world at standard normal values z, shape (d,)."""
        experiment = Experiment.as_stated(self.circumstances.partition.degrees)
        experiment.feedback_lag = self.circumstances.feedback_lag
        experiment.slip = self.circumstances.slip
        for unknown, normal in zip(self.unknowns, z.tolist(), strict=True):
            quantity, value = unknown.quantity, unknown.prior.value(normal)
            experiment.change(quantity.changes, value, unknown.actuator, by_factor=quantity.by_factor)
        return experiment

    def change(self, **circumstances: Any) -> "TestModel":  # noqa: ANN401 - of any field
        """Return the model in other circumstances, with evidence whose variances are estimated anew."""
        changed = replace(self.circumstances, **circumstances)
        evidence = tuple(replace(item) for item in self.evidence)
        return TestModel(circumstances=changed, unknowns=list_unknowns(changed), evidence=evidence)

    def least_squares(self, start: Array | None = None) -> LeastSquares:
        """Residuals of all evidence; `start` of the search for the mode, that as stated by default."""

        def residuals(z: Array) -> Array:
            experiment = self.experiment(z)
            return np.concatenate([np.zeros(0), *(item.whiten(experiment) for item in self.evidence)])

        def update(z: Array) -> None:
            experiment = self.experiment(z)
            for item in self.evidence:
                item.update(experiment)

        def determinant(z: Array) -> float:
            experiment = self.experiment(z)
            return sum(item.determinant(experiment) for item in self.evidence)

        return LeastSquares(
            residuals=residuals,
            update=update,
            determinant=determinant,
            start=np.zeros(len(self.unknowns)) if start is None else start,
            positive=np.array([one.prior.shape is Shape.POSITIVE for one in self.unknowns], dtype=bool),
        )

    def fit_mode(self) -> LeastSquares:
        """Find the most probable world."""
        fit = self.least_squares()
        fit.fit()
        return fit

    def log_evidence_of(self, fit: LeastSquares) -> float:
        """Logarithm of the probability of the channels, by Laplace's approximation, but for a constant."""
        mode = self.experiment(fit.mode)
        return sum(item.log_likelihood(mode) for item in self.evidence) + fit.log_volume

    def holds(self, item: Evidence, mode: Array) -> bool:
        """Return whether what some evidence assumes of the test holds, also with the damping ratio as stated.

        A harmonic motion at resonance looks like that of an earthquake with one ratio, which says nothing of
        it.
        """
        as_stated = mode.copy()
        for place, unknown in enumerate(self.unknowns):
            if unknown.name == "frequency" and abs(mode[place]) > item.farthest:
                return False
            if unknown.name == "damping_ratio":
                as_stated[place] = 0.0
        values = [mode] if np.array_equal(as_stated, mode) else [mode, as_stated]
        return all(item.holds(self.experiment(z)) for z in values)


@dataclass(frozen=True, kw_only=True, eq=False)
class TestPosterior(TestModel):
    """What the channels of a test show of everything that is uncertain."""

    fit: LeastSquares
    draws: Draws

    @property
    def mode(self) -> Experiment:
        """Most probable world."""
        return self.experiment(self.fit.mode)

    def experiments(self) -> Iterator[Experiment]:
        """Possible worlds, draw by draw."""
        return (self.experiment(z) for z in self.draws.values)

    @property
    def log_evidence(self) -> float:
        """Logarithm of the probability of the channels, by Laplace's approximation, but for a constant."""
        return self.log_evidence_of(self.fit)

    @cached_property
    def values(self) -> Array:
        """Differences of the quantities from their stated values, shape (draws, d)."""
        return np.array(
            [
                [unknown.prior.value(float(z)) for unknown, z in zip(self.unknowns, row, strict=True)]
                for row in self.draws.values
            ]
        )

    @cached_property
    def means(self) -> dict[str, float]:
        """Mean difference of each quantity from its stated value."""
        mean = self.draws.weights @ self.values
        return dict(zip((unknown.name for unknown in self.unknowns), mean.tolist(), strict=True))

    @cached_property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each quantity."""
        spread = self.values - self.draws.weights @ self.values
        deviation = np.sqrt(self.draws.weights @ spread**2)
        return dict(zip((unknown.name for unknown in self.unknowns), deviation.tolist(), strict=True))

    def identified_value(self, name: str, stated: float) -> StatedValue:
        """Posterior mean and standard deviation of a quantity with a relative uncertainty."""
        return StatedValue(stated * (1.0 + self.means[name]), stated * self.deviations[name])

    def conflict(self, unknown: UncertainQuantity, stated_share: float = 1.0) -> float:
        """How far the channels show a quantity from its stated value, over what both leave open.

        `stated_share`: deviation with which it is stated, over that of its prior. A likelihood at a with the
        deviation s, both over that of the prior, gives the mode a/(1 + s²) and the variance s²/(1 + s²); the
        distance is a/√(s² + stated_share²). A quantity of which the channels show nothing has no conflict.
        """
        place = self.unknowns.index(unknown)
        variance = float(self.fit.covariance[place, place])
        shrunk = 1.0 - variance
        if shrunk <= _INFORMED_SHARE:
            return 0.0
        open_variance = variance / shrunk + stated_share**2
        return float(self.fit.mode[place]) / shrunk / math.sqrt(open_variance)


_INFORMED_SHARE = 0.25  # of the variance a priori, that the channels take away


def infer(
    circumstances: Circumstances,
    *,
    draws: int = DRAWS,
    seed: int = 0,
    evidence: tuple[Evidence, ...] | None = None,
) -> TestPosterior:
    """Infer what is uncertain about a test from some evidence, by default that of all of its channels."""
    evidence = collect_evidence(circumstances) if evidence is None else evidence
    unknowns = list_unknowns(circumstances)
    model = TestModel(circumstances=circumstances, unknowns=unknowns, evidence=evidence)
    fit = model.fit_mode()
    holding = tuple(item for item in evidence if model.holds(item, fit.mode))
    if len(holding) < len(evidence):
        model = replace(model, evidence=holding)
        fit = model.fit_mode()
    return TestPosterior(**vars(model), fit=fit, draws=fit.draw(draws, seed))


def favours_frequency(posterior: TestPosterior, frequency: float) -> bool:
    """Return whether the channels are likelier with natural frequencies that are a factor of those stated."""
    uncertain = next((unknown for unknown in posterior.unknowns if unknown.name == "frequency"), None)
    if uncertain is None or not posterior.evidence:
        return True
    shifted_prior = replace(uncertain.prior, mean=uncertain.prior.mean + math.log(frequency))
    model = posterior.change(learned={"frequency": shifted_prior})
    return model.log_evidence_of(model.fit_mode()) > posterior.log_evidence


def log_evidence_ratio(posterior: TestPosterior, slip: Spectrum) -> float:
    """Logarithm of how much likelier the channels are if the specimen's spring lost a displacement.

    `slip`: what it lost [m], shape (p, K).
    """
    model = posterior.change(slip=slip)
    fit = model.least_squares(posterior.fit.mode)
    fit.fit(updates=_UPDATES_OF_RATIO, iterations=_STEPS_OF_RATIO)
    return model.log_evidence_of(fit) - posterior.log_evidence


_UPDATES_OF_RATIO, _STEPS_OF_RATIO = 3, 2


def collect_evidence(circumstances: Circumstances) -> tuple[Evidence, ...]:
    """Collect the evidence that the channels hold."""
    channels, partition = circumstances.channels, circumstances.partition
    evidence: list[Evidence] = []
    if channels.ground is not None:
        evidence.append(EquationOfMotion(channels=channels, partition=partition))
    else:
        kind = ImpliedGroundMotion if partition.degrees == 1 else EquationWithoutGround
        evidence.append(kind(channels=channels, partition=partition))
    if circumstances.specimen_force:
        evidence.append(SpecimenForce(channels=channels, partition=partition))
    return tuple(evidence)
