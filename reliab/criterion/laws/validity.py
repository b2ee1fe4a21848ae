"""Where a law holds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reliab.errors import InputError

_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Validity:
    """Ranges outside of which a law refuses to answer.

    >>> Validity(frequency=(0.25, 2.0), damping_ratio=(0.02, 0.02)).require(1.0, 0.05)
    Traceback (most recent call last):
    ...
    reliab.errors.InputError: The damping ratio must lie where the law is valid, at 0.02; found 0.05. ...
    """

    frequency: tuple[float, float]  # Least and greatest natural frequency [Hz]
    damping_ratio: tuple[float, float]  # Least and greatest damping ratio [-]
    threshold: float | None = None  # The one error [-] that the law is for; None leaves it to the criterion
    metric: str | None = None  # The one metric that the law is for; None leaves it to the criterion

    def require(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> None:
        """Raise an error where a structure lies outside.

        `frequency`, `damping_ratio` [Hz, -].
        """
        _require("natural frequency", frequency, self.frequency, " Hz")
        _require("damping ratio", damping_ratio, self.damping_ratio, "")

    def require_error(self, threshold: float, metric: str) -> None:
        """Raise an error where the law is for another threshold or metric.

        `threshold` [-].
        """
        if self.threshold is not None and not np.isclose(threshold, self.threshold, rtol=_ROUNDING):
            raise InputError(
                f"The law is for an error of {self.threshold:g} only",
                value=f"{threshold:g}",
                remedy="Choose another law, or derive a criterion from ellipses at that threshold",
            )
        if self.metric is not None and metric != self.metric:
            raise InputError(
                f"The law is for the metric {self.metric} only",
                value=metric,
                remedy="Choose another law, or derive a criterion from ellipses of that metric",
            )


def _require(what: str, given: ArrayLike, bounds: tuple[float, float], unit: str) -> None:
    values = np.atleast_1d(np.asarray(given, dtype=np.float64))
    low, high = bounds
    inside = (values >= low * (1.0 - _ROUNDING)) & (values <= high * (1.0 + _ROUNDING))
    if not inside.all():
        where = f"at {low:g}{unit}" if low == high else f"between {low:g} and {high:g}{unit}"
        raise InputError(
            f"The {what} must lie where the law is valid, {where}",
            value=f"{values[~inside].flat[0]:g}{unit}",
            remedy="Choose another law, or derive a criterion from ellipses of that structure",
        )
