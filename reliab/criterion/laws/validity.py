"""Where a law holds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reliab.errors import InputError

_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Validity:
    """Ranges outside of which a law refuses to answer.

    Parameters
    ----------
    frequency : tuple of float
        Least and greatest natural frequency [Hz].
    damping_ratio : tuple of float
        Least and greatest damping ratio [-].

    Examples
    --------
    >>> Validity(frequency=(0.25, 2.0), damping_ratio=(0.02, 0.02)).require(1.0, 0.05)
    Traceback (most recent call last):
    ...
    reliab.errors.InputError: The damping ratio must lie where the law is valid, at 0.02; found 0.05. ...
    """

    frequency: tuple[float, float]
    damping_ratio: tuple[float, float]

    def require(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> None:
        """Raise an error where a structure lies outside.

        Parameters
        ----------
        frequency, damping_ratio : array_like
            Structures [Hz, -].

        Raises
        ------
        InputError
            If one lies outside; the message names the range.
        """
        _require("natural frequency", frequency, self.frequency, " Hz")
        _require("damping ratio", damping_ratio, self.damping_ratio, "")


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
