"""What to change so that nearly all coming tests are good."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import scipy

from reliab.assessment.default_criterion import ellipses_of_motions
from reliab.core.arrays import Array
from reliab.core.significant_digits import significant
from reliab.rig.drawing import Draws, draw_tests, learn_tests
from reliab.rig.memory import Memory, NextTest
from reliab.rig.rig_table import RigTable
from reliab.structures.structure import Structure

SHARE: Final = 0.95
_SMALLEST_FACTOR, _LARGEST_FACTOR = 0.02, 50.0
_STEPS = 60
_LARGEST_DAMPING = 0.5
_SOBOL_DRAWS = 512
_SCALES = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)
_REMAINING = np.array([0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0])


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """One thing to change."""

    change: str  # In words
    value: float | None  # To what; None where no value suffices
    share_of_good_tests: float  # With it, or at best
    sentence: str

    @property
    def suffices(self) -> bool:
        """Whether nearly all tests are good with it."""
        return self.value is not None


@dataclass(frozen=True, kw_only=True, eq=False)
class Plan:
    """Which changes would make a rig's tests good."""

    threshold: float
    share: float
    share_now: float  # Of coming tests whose error stays below the threshold
    remedies: tuple[Remedy, ...]
    sobol: Mapping[str, Mapping[str, float]]  # First-order and total index of the logarithm of the error

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "threshold": self.threshold,
            "share": self.share,
            "share_now": self.share_now,
            "remedies": [{**vars(remedy), "suffices": remedy.suffices} for remedy in self.remedies],
            "sobol": {name: dict(indices) for name, indices in self.sobol.items()},
        }


def plan_tests(
    table: RigTable, structure: Structure, coming: NextTest, *, threshold: float, share: float = SHARE
) -> Plan:
    """Search each remedy alone for the least change with which a share of coming tests is good.

    The coming motion is any of those that ship; actuators are drawn from what the tests teach.
    """
    memory = Memory.remembered(table)
    drawn = draw_tests(memory, learn_tests(memory, coming), coming, structure)
    question = _Question(structure=structure, drawn=drawn, threshold=threshold, share=share)
    remedies = (
        question.share_in_laboratory(),
        question.damping(),
        question.frequency(),
        question.compensation(),
        _scale_of_motion(memory, coming, question),
    )
    return Plan(
        threshold=threshold,
        share=share,
        share_now=question.share_of_good(structure, drawn),
        remedies=remedies,
        sobol=_sobol(question),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Question:
    structure: Structure
    drawn: Draws
    threshold: float
    share: float

    def errors(self, structure: Structure, drawn: Draws) -> Array:
        """Errors of drawn tests under any of the motions that ship."""
        of_a, of_b = ellipses_of_motions(structure)
        places = np.random.default_rng(2).integers(of_a.size, size=drawn.amplitude.size)
        return drawn.errors(of_a[places], of_b[places])

    def share_of_good(self, structure: Structure, drawn: Draws) -> float:
        """Share of tests whose error stays below the threshold."""
        return float((self.errors(structure, drawn) <= self.threshold).mean())

    def _least(self, vary: Callable[[float], Structure], values: Array) -> tuple[float | None, float]:
        """First of several values with which enough tests are good, and the share with it or at best."""
        shares = [self.share_of_good(vary(float(value)), self.drawn) for value in values]
        for value, good in zip(values.tolist(), shares, strict=True):
            if good >= self.share:
                return value, good
        return None, max(shares)

    def share_in_laboratory(self) -> Remedy:
        """Have a smaller share of the stiffness in the laboratory."""
        now = self.structure.experimental_fraction
        value, good = self._least(
            lambda share: replace(self.structure, experimental_fraction=share),
            now * np.geomspace(1.0, _SMALLEST_FACTOR, _STEPS),
        )
        return _remedy(
            "share in the laboratory",
            value,
            good,
            "have a share of {} of the stiffness in the laboratory",
            now,
        )

    def damping(self) -> Remedy:
        """Have more damping."""
        now = self.structure.damping_ratio
        ratios = now * np.geomspace(1.0, _LARGEST_FACTOR, _STEPS)
        value, good = self._least(
            lambda ratio: replace(self.structure, damping_ratio=ratio), ratios[ratios < _LARGEST_DAMPING]
        )
        return _remedy("damping ratio", value, good, "have a specimen with a damping ratio of {}", now)

    def frequency(self) -> Remedy:
        """Have a lower natural frequency, at which a delay matters less."""
        now = self.structure.frequency
        value, good = self._least(
            lambda frequency: replace(self.structure, frequency=frequency),
            now * np.geomspace(1.0, _SMALLEST_FACTOR, _STEPS),
        )
        return _remedy(
            "natural frequency", value, good, "have a structure of {} Hz (softer, or heavier)", now
        )

    def compensation(self) -> Remedy:
        """Gain and delay compensated, with so much of the delay left over."""
        gain, delay = float(np.median(self.drawn.amplitude)), float(np.median(self.drawn.delay_ms))
        shares = []
        for remaining in _REMAINING:
            compensated = replace(
                self.drawn,
                amplitude=self.drawn.amplitude / gain,
                delay_ms=self.drawn.delay_ms - delay + float(remaining),
            )
            shares.append(self.share_of_good(self.structure, compensated))
        enough = [float(value) for value, good in zip(_REMAINING, shares, strict=True) if good >= self.share]
        what = f"compensate {delay:.2f} ms and a gain of {gain:.4f}"
        if not enough:
            return Remedy(
                change="compensation",
                value=None,
                share_of_good_tests=shares[0],
                sentence=f"To {what} is not enough: {shares[0]:.2f} of the tests would be good.",
            )
        most = max(enough)
        return Remedy(
            change="compensation",
            value=delay - most,
            share_of_good_tests=shares[_REMAINING.tolist().index(most)],
            sentence=f"It is enough to {what}, of which up to {most:g} ms may remain.",
        )


def _remedy(change: str, value: float | None, good: float, what: str, now: float) -> Remedy:
    if value is None:
        sentence = f"No {change} that was tried is enough: at best {good:.2f} of the tests would be good."
    elif value == now:
        sentence = f"The {change} may stay as it is."
    else:
        sentence = f"It is enough to {what.format(significant(value, 3))}."
    return Remedy(change=change, value=value, share_of_good_tests=good, sentence=sentence)


def _scale_of_motion(memory: Memory, coming: NextTest, question: _Question) -> Remedy:
    """Another scale of the motion, as far as the tests show that the rig depends on the displacement."""
    peak = float(np.median(memory.table.numbers("peak_mm")))
    learned = learn_tests(memory, replace(coming, peak=peak))
    shares = {}
    for scale in _SCALES:
        drawn = draw_tests(memory, learned, replace(coming, peak=scale * peak), question.structure)
        shares[scale] = question.share_of_good(question.structure, drawn)
    best = max(shares, key=lambda scale: (min(shares[scale], question.share), -abs(np.log(scale))))
    if shares[best] >= question.share:
        sentence = f"It is enough to scale the motion by {best:g}."
        return Remedy(
            change="scale of the motion", value=best, share_of_good_tests=shares[best], sentence=sentence
        )
    return Remedy(
        change="scale of the motion",
        value=None,
        share_of_good_tests=shares[best],
        sentence=f"No scale of the motion from {_SCALES[0]:g} to {_SCALES[-1]:g} is enough: at best "
        f"{shares[best]:.2f} of the tests would be good, at {best:g}.",
    )


class _Drawn:
    """A marginal distribution by its draws."""

    def __init__(self, values: Array) -> None:
        self._ordered = np.sort(values)

    def ppf(self, probability: Array) -> Array:
        """Quantiles."""
        return np.asarray(np.interp(probability, np.linspace(0.0, 1.0, self._ordered.size), self._ordered))


def _sobol(question: _Question) -> dict[str, dict[str, float]]:
    """Sobol indices of the logarithm of the error, its causes taken as independent (Saltelli 2010)."""
    of_a, of_b = ellipses_of_motions(question.structure)
    order = np.argsort(of_a)
    of_a, of_b = of_a[order], of_b[order]
    drawn = question.drawn

    def log_error(x: Array) -> Array:
        places = np.clip(x[4].astype(int), 0, of_a.size - 1)
        draws = Draws(amplitude=x[0], delay_ms=x[1], remainder=x[2], ratio=x[3])
        return np.log(np.maximum(draws.errors(of_a[places], of_b[places]), 1e-12))[None]

    marginals = [drawn.amplitude, drawn.delay_ms, drawn.remainder, drawn.ratio]
    dists = [*map(_Drawn, marginals), _Drawn(np.arange(of_a.size + 1.0))]
    indices = scipy.stats.sobol_indices(
        func=log_error, n=_SOBOL_DRAWS, dists=dists, random_state=np.random.default_rng(3)
    )
    names = ("amplitude", "delay", "remainder", "what these do not explain", "motion")
    return {
        name: {"first_order": float(first), "total": float(total)}
        for name, first, total in zip(
            names, np.ravel(indices.first_order), np.ravel(indices.total_order), strict=True
        )
    }
