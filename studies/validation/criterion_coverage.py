"""True coverage of a criterion's limits: the share of motions above them, over many synthetic suites.

The logarithms of a and b of a suite are drawn from a known population, in which motions of one earthquake
are alike; a method derives limits from the suite, and the share of the *population* that contains them is
known. Its mean over suites says what the method promises on average, and the share of suites in which it
reaches the stated confidence says how often the promise is kept.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reliab.core.progress import Progress, silent
from reliab.criterion.methods.method import BoundMethod, limits
from reliab.criterion.population import EllipseSample

_FURTHER = 200_000  # motions that stand for the population


@dataclass(frozen=True, kw_only=True)
class Truth:
    """A population of motions and the size of the suites that are drawn from it."""

    n_events: int  # n_events, motions_per_event: Size of a suite
    motions_per_event: int
    event_share: float = 0.15  # Share of the variance that lies between earthquakes [-]
    correlation: float = 0.98  # Correlation of ln a and ln b [-]
    # k of the transformation (e^{kz} − 1)/k of a normal variable z; 0 is a lognormal population, and 0.25
    # about as skewed as a and b of real records
    skewness: float = 0.0

    def draw(self, events: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.float64]:
        """Draw ln a and ln b of motions of given earthquakes, shape (motions, 2)."""
        covariance = np.array([[1.0, self.correlation], [self.correlation, 1.0]])
        factor = np.linalg.cholesky(covariance).T
        between = rng.standard_normal((int(events.max()) + 1, 2)) @ factor
        within = rng.standard_normal((events.size, 2)) @ factor
        z = np.sqrt(self.event_share) * between[events] + np.sqrt(1.0 - self.event_share) * within
        return np.asarray(z if self.skewness == 0.0 else np.expm1(self.skewness * z) / self.skewness)

    def suite(self, rng: np.random.Generator) -> EllipseSample:
        """Draw a suite."""
        events = np.repeat(np.arange(self.n_events), self.motions_per_event)
        a, b = np.exp(self.draw(events, rng).T)
        return EllipseSample(
            a=a,
            b=b,
            motions=np.arange(events.size).astype(np.str_),
            events=events.astype(np.str_),
            frequency=1.0,
            damping_ratio=0.02,
            threshold=0.05,
            metric="rms",
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Coverage:
    """True content of a method's limits over synthetic suites."""

    confidence: float  # Stated share of the motions
    # Share of the population that exceeds the limits of each suite: in a alone, or in a and b together for
    # joint limits, shape (suites,)
    contents: NDArray[np.float64]

    @property
    def mean(self) -> float:
        """Share of further motions that the limits of a suite contain, on average."""
        return float(self.contents.mean())

    @property
    def kept_share(self) -> float:
        """Share of suites whose limits contain at least the stated share."""
        return float((self.contents >= self.confidence).mean())


def simulate_coverage(
    method: BoundMethod,
    truth: Truth,
    confidence: float,
    *,
    joint: bool = False,
    suites: int = 1000,
    seed: int = 2017,
) -> Coverage:
    """Derive limits from many synthetic suites and find their true content.

    >>> from reliab.criterion.methods.predictive import Predictive

    >>> from reliab.criterion.methods.quantile import Quantile
    >>> truth = Truth(n_events=20, motions_per_event=1, event_share=0.0)
    >>> for method in (Quantile(), Predictive()):
    ...     print(round(simulate_coverage(method, truth, 0.95, suites=200).mean, 2))
    0.93
    0.95
    """
    rng = np.random.default_rng(seed)
    population = truth.draw(np.arange(_FURTHER), rng)
    contents = np.empty(suites)
    for number in range(suites):
        with np.errstate(divide="ignore"):
            least = np.log(limits(truth.suite(rng), method, confidence, joint=joint))
        above = population >= least
        contents[number] = (above.all(axis=1) if joint else above[:, 0]).mean()
    return Coverage(confidence=confidence, contents=contents)


def coverage_table(
    methods: Iterable[tuple[BoundMethod, bool]],
    truths: Iterable[Truth],
    confidences: Iterable[float] = (0.80, 0.90, 0.95, 0.99),
    *,
    suites: int = 1000,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Tabulate the true content of methods beside what they state.

    Returns columns method, joint, n_events, motions_per_event, event_share, skewness, confidence (stated),
    content (true, mean over suites) and kept (share of suites that contain at least the stated share).
    """
    combinations = [
        (method, joint, truth, confidence)
        for truth in truths
        for method, joint in methods
        for confidence in confidences
    ]
    rows = []
    for count, (method, joint, truth, confidence) in enumerate(combinations, start=1):
        coverage = simulate_coverage(method, truth, confidence, joint=joint, suites=suites)
        rows.append(
            {
                "method": method.name,
                "joint": joint,
                "n_events": truth.n_events,
                "motions_per_event": truth.motions_per_event,
                "event_share": truth.event_share,
                "skewness": truth.skewness,
                "confidence": confidence,
                "content": coverage.mean,
                "kept": coverage.kept_share,
            }
        )
        progress(count, len(combinations))
    return pd.DataFrame(rows)
