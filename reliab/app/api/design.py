"""`reliab.design_test`: what is tolerable before a test."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.app.api.arguments import Quantity, stated_threshold, stated_values, unused
from reliab.assessment.design import CONFIDENCES, Tolerance, chart_frequencies, tolerable_errors
from reliab.core.errors import InputError
from reliab.core.rows import ResultWithRows
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.sweep.several import Numbers, several


@dataclass(frozen=True, kw_only=True)
class Design(ResultWithRows):
    """Tolerable errors of a rig before a test.

    Attributes
    ----------
    tolerances : tuple of Tolerance
        Of the structures that were asked for, by frequency, then by confidence.
    chart : tuple of Tolerance
        The same over all frequencies for which the criterion is valid.
    """

    rows_in = "design"

    tolerances: tuple[Tolerance, ...]
    chart: tuple[Tolerance, ...]

    def to_dict(self) -> dict[str, list[dict[str, Any]]]:
        """Plain numbers with stable keys: `design` and `chart`, delays in milliseconds."""
        return {
            "design": [tolerance.to_dict() for tolerance in self.tolerances],
            "chart": [tolerance.to_dict() for tolerance in self.chart],
        }


def design_test(
    *,
    f: Quantity | Sequence[Quantity] = 1.0,
    xi: Quantity = 0.02,
    alpha: Quantity = 1.0,
    threshold: float | None = None,
    confidence: Numbers | None = None,
    metric: str | None = None,
    criterion: str | Path | Criterion | None = None,
) -> Design:
    """State how much delay and amplitude error a rig may have, before a test.

    Parameters
    ----------
    f : float or sequence of float, optional
        Natural frequencies [Hz].
    xi : float, optional
        Damping ratio [-].
    alpha : float, optional
        Share of the stiffness in the laboratory [-]; limits of structures with all stiffness in the
        laboratory are transferred to it by a law for springs, which holds from ten times the damping ratio
        on. A criterion of one's own is for its own share.
    threshold : float, optional
        Error of the whole test [-], 0.05 by default; a criterion states its own.
    confidence : float or sequence of float, optional
        Shares of the population's ground motions, 0.80, 0.90, 0.95 and 0.99 by default; a criterion states
        its own.
    metric : {"rms", "mte"}, optional
        Error of the whole test; a criterion states its own.
    criterion : str, pathlib.Path or Criterion, optional
        The criterion, or its file as `reliab criterion --out` writes it; by default the one that ships.

    Returns
    -------
    Design
        Tolerable errors of each structure and over the frequency.

    Raises
    ------
    InputError
        If a value is not allowed, has a tolerance, or the criterion cannot be read.

    Examples
    --------
    >>> design = design_test(f=1, xi=0.02, confidence=0.95)
    >>> [(tolerance.frequency, tolerance.confidence) for tolerance in design.tolerances]
    [(1.0, 0.95)]
    """
    if criterion is not None:
        share_given = None if _exact(alpha, "alpha") == 1.0 else alpha
        given = {
            "threshold": threshold,
            "confidence": confidence,
            "metric": metric,
            "alpha": share_given,
        }
        for name in (name for name, value in given.items() if value is not None):
            raise unused(name, "together with `criterion`, which states its own")
    read = Criterion.read(criterion) if isinstance(criterion, str | Path) else criterion
    ratio, share = _exact(xi, "xi"), _exact(alpha, "alpha")

    def tolerances(frequencies: list[float]) -> tuple[Tolerance, ...]:
        return tuple(
            tolerable_errors(
                frequencies,
                ratio,
                threshold=stated_threshold(threshold),
                confidences=CONFIDENCES if confidence is None else several(confidence),
                metric=str(metric or Metric.RMS),
                criterion=read,
                experimental_fraction=share,
            )
        )

    stated = [f] if isinstance(f, int | Quantity) else f
    frequencies = [_exact(frequency, "f") for frequency in stated]
    return Design(tolerances=tolerances(frequencies), chart=tolerances(chart_frequencies(read)))


def _exact(quantity: Quantity, name: str) -> float:
    stated = stated_values(**{name: quantity})[name]
    if stated.deviation:
        raise InputError(
            "Tolerable errors before a test are computed for exact values",
            value=f"`{name}={stated}`",
            remedy="Leave the standard deviation out, or give several exact values",
        )
    return stated.value
