"""The criterion: how much amplitude error and delay a test may have."""

import json
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.laws import OF_MANY_MOTIONS, Law, known, law_from_dict, law_to_dict
from reliab.criterion.methods.method import checked_share
from reliab.criterion.population import Population
from reliab.criterion.provenance import SCHEMA_VERSION, Provenance
from reliab.errors import InputError
from reliab.vocabulary import Metric

_MILLISECONDS = 1e3


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """An ellipse (A − 1)²/a + d²/b ≤ 1 for each structure, with what it promises.

    A test whose indices lie inside has an error below `threshold` for a share `confidence` of ground
    motions, in the sense of `method`.

    Parameters
    ----------
    law : Law
        Limits a [-] and b [ms²] of a structure.
    threshold : float
        Error of the whole test [-].
    metric : str
        Which error, "rms" or "mte".
    confidence : float
        Share of ground motions, in (0, 1).
    method : str
        What the confidence means, by the name of a method.
    joint : bool
        Whether a and b hold together with the stated confidence, or each for itself.
    provenance : Provenance
        Where the criterion comes from.
    population : Population, optional
        The motions behind it, from which probabilities follow; a published law has none.

    Examples
    --------
    >>> criterion = published_criterion("guo_2017_12")
    >>> round(float(criterion.index(1.004, 0.0005, 1.0, 0.02)), 3)
    0.542
    >>> Criterion.from_json(criterion.to_json()) == criterion
    True
    """

    law: Law
    threshold: float
    metric: str
    confidence: float
    method: str
    joint: bool
    provenance: Provenance
    population: Population | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        self.law.validity.require_error(self.threshold, self.metric)
        checked_share(self.confidence, "confidence")
        if not 0.0 < self.threshold < np.inf:
            raise InputError(
                "The error threshold must be positive",
                value=self.threshold,
                remedy="Give a fraction, 0.05 for 5 %",
            )

    def limits(
        self, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ellipse parameters of structures.

        Parameters
        ----------
        frequency, damping_ratio : array_like
            Structures [Hz, -], broadcast against each other.

        Returns
        -------
        a, b : numpy.ndarray
            Limits [-] and [ms²].

        Raises
        ------
        InputError
            If a structure lies where the law does not hold.
        """
        return self.law.limits(frequency, damping_ratio)

    def index(
        self, amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> NDArray[np.float64]:
        """Index of reliability (A − 1)²/a + d²/b; a test is reliable up to 1.

        Parameters
        ----------
        amplitude : array_like
            Amplitude index A [-].
        delay : array_like
            Equivalent delay d [s].
        frequency, damping_ratio : array_like
            The structure [Hz, -]; all four are broadcast against each other.

        Returns
        -------
        numpy.ndarray
            The index [-]; infinite where a limit is zero.

        Raises
        ------
        InputError
            If a structure lies where the law does not hold.
        """
        a, b = self.limits(frequency, damping_ratio)
        offset = np.asarray(amplitude, dtype=np.float64) - 1.0
        milliseconds = _MILLISECONDS * np.asarray(delay, dtype=np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            index = offset**2 / a + milliseconds**2 / b
        return np.where((a > 0.0) & (b > 0.0), index, np.inf)

    def probability(
        self, amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> NDArray[np.float64]:
        """Predictive probability that the error of a test stays below the threshold.

        Parameters
        ----------
        amplitude : array_like
            Amplitude index A [-].
        delay : array_like
            Equivalent delay d [s].
        frequency, damping_ratio : array_like
            The structure [Hz, -]; all four are broadcast against each other.

        Returns
        -------
        numpy.ndarray
            Probability [-] over ground motions of further earthquakes.

        Raises
        ------
        InputError
            If the structure lies outside of what was simulated, or no motions stand behind the criterion.
        """
        if self.population is None:
            raise InputError(
                "A probability needs the ellipses of ground motions",
                value=f"the published law {self.law.name}",
                remedy="Derive a criterion from motions, a results store or a table of ellipses",
            )
        return self.population.probability(amplitude, delay, frequency, damping_ratio)

    def to_json(self) -> str:
        """Serialise with provenance; `from_json` reads it back."""
        content = {
            "schema_version": SCHEMA_VERSION,
            **{
                name: getattr(self, name) for name in ("threshold", "metric", "confidence", "method", "joint")
            },
            "law": law_to_dict(self.law),
            "population": None if self.population is None else self.population.to_dict(),
            "provenance": asdict(self.provenance),
        }
        return json.dumps(content, indent=2, ensure_ascii=False)

    @classmethod
    def from_json(cls, text: str) -> "Criterion":
        """Read a criterion that `to_json` wrote.

        Parameters
        ----------
        text : str
            The JSON.

        Returns
        -------
        Criterion
            The criterion.

        Raises
        ------
        InputError
            If the text is not such JSON, or of a newer schema.
        """
        content = _checked_content(text)
        provenance, population = content.pop("provenance"), content.pop("population")
        provenance["warnings"] = tuple(provenance["warnings"])
        return cls(
            law=law_from_dict(content.pop("law")),
            provenance=Provenance(**provenance),
            population=None if population is None else Population.from_dict(population),
            **content,
        )


def published_criterion(name: str) -> Criterion:
    """Make the criterion of a published or corrected law.

    Parameters
    ----------
    name : str
        A law that promises a confidence over motions, such as "guo_2017_18".

    Returns
    -------
    Criterion
        At 5 % RMS^R and the 95 % that the paper states.

    Raises
    ------
    InputError
        If there is no such law.

    Examples
    --------
    Case 1 of Table 6:

    >>> criterion = published_criterion("guo_2017_18")
    >>> round(float(criterion.index(1.0039, 0.39e-3, 1.0, 0.02)), 3)
    0.956
    """
    law = known(OF_MANY_MOTIONS, name)
    return Criterion(
        law=law,
        threshold=0.05,
        metric=str(Metric.RMS),
        confidence=0.95,
        method="quantile",
        joint=False,
        provenance=Provenance(source=f"Guo and others (2017), {law.equation}", n_motions=100, n_events=19),
    )


def _checked_content(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text)
        schema = content.pop("schema_version")
    except (ValueError, AttributeError, KeyError, TypeError) as error:
        raise InputError(
            "A criterion must be JSON as written by `reliab criterion --out`",
            value=str(error),
            remedy="Write it again with this version",
        ) from error
    if schema != SCHEMA_VERSION:
        raise InputError(
            f"The schema of a criterion must be version {SCHEMA_VERSION}",
            value=schema,
            remedy="Use the version of reliab that wrote it, or derive it again",
        )
    return dict(content)
