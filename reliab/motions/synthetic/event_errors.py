"""Errors of the regression: a part common to all stations of an earthquake and a part for each station."""

from collections.abc import Callable
from math import sqrt
from typing import Final, TypeVar

import numpy as np

from reliab.arrays import Array
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import Regression
from reliab.motions.synthetic.random_stream import RandomStream

_Result = TypeVar("_Result")

_CUT: Final = 2.0
"""Errors beyond this many standard deviations are drawn again, as in Dabaghi & Der Kiureghian (2018)."""

EVENT_SHARE: Final = 0.35
"""Share of the error's variance that the stations of one earthquake have in common.

The published regression gives the whole error only. Its parent, Rezaeian & Der Kiureghian (2010), separates
the inter-event error η from the intra-event error ε: τ²/(τ² + σ²) is 0.18, 0.39, 0.60, 0.48, 0.02 and 0.45
for its six parameters (τ = 0.274, 0.457, 0.511, 0.692, 0.129, 0.682; σ = 0.594, 0.569, 0.414, 0.723, 0.953,
0.760), 0.35 on average. One share for all parameters keeps the published correlations within both parts.
"""


class EventErrors:
    """Draws the errors of the stations of one earthquake, one after the other.

    The error of a station is η + ε, of which η is the same for all stations of the earthquake. The first
    station has exactly the published distribution, given that its motion is accepted; η then follows from its
    error, so that what comes first does not depend on how many stations come after it.
    """

    def __init__(self, regression: Regression, stream: RandomStream) -> None:
        self._regression = regression
        self._stream = stream
        self._shared: Array | None = None

    def draw(self, stream: RandomStream, attempt: Callable[[Array], _Result | None]) -> _Result:
        """Draw errors for the next station until one of them gives a motion."""
        shared, scale = (0.0, 1.0) if self._shared is None else (self._shared, sqrt(1.0 - EVENT_SHARE))
        while True:
            standard = shared + scale * self._draw_correlated(stream)
            if np.abs(standard).max() > _CUT:
                continue
            result = attempt(standard * self._regression.deviations)
            if result is not None:
                self._share(standard)
                return result

    def _share(self, standard: Array) -> None:
        """Draw η from its distribution given the whole error of the first station."""
        if self._shared is None:
            remainder = sqrt(EVENT_SHARE * (1.0 - EVENT_SHARE)) * self._draw_correlated(self._stream)
            self._shared = EVENT_SHARE * standard + remainder

    def _draw_correlated(self, stream: RandomStream) -> Array:
        normals = stream.normals(self._regression.deviations.size)
        correlated: Array = np.sum(self._regression.factor * normals, axis=1)
        return correlated
