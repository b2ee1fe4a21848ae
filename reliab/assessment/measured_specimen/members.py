"""Members of a family of elements that other parts of a test would have found.

Blocks of a test have random weights, by which coefficients are fitted and the traits of laws move. What parts
leave open of a law that is wrong is less than what the law misses: members are drawn apart until the forces
of two differ by what held-out parts are missed by (inflation of parameter uncertainties, Pernot 2017, Journal
of Chemical Physics 147, 104102).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.measured_specimen.learning import LearnedSpecimen
from reliab.assessment.measured_specimen.path import MeasuredPath, fit

_SAMPLE = 10  # members by whose differences the others are drawn apart
_FARTHEST = 5.0  # times, by which they are drawn apart at most
_SEED = 21


@dataclass(frozen=True, kw_only=True, eq=False)
class Members:
    """Members of a family along the measured path and along the command."""

    specimen: LearnedSpecimen  # As the family learned it
    path: MeasuredPath
    command: Array  # m, shape (n,)

    @cached_property
    def _seen(self) -> Array:
        return self.path.responses(self.specimen.elements)

    @cached_property
    def _along_command(self) -> Array:
        return self.specimen.elements.along(self.command, self.path.time_step, self.path.used)

    @cached_property
    def _fitted(self) -> Array:
        return fit(self._seen, self.path.force_seen)

    @cached_property
    def apart(self) -> float:
        """How many times as far as parts of the test leave open members are drawn apart [-]."""
        expected = self._fitted @ self._seen
        differ = [np.mean((coefficients @ rows - expected) ** 2) for coefficients, rows in self._sample()]
        missed = self.specimen.missed**2 * np.mean(self.path.force_seen**2)
        least = np.finfo(float).tiny
        return float(np.clip(np.sqrt(missed / max(float(np.mean(differ)), least)), 1.0, _FARTHEST))

    def _sample(self) -> Iterator[tuple[Array, Array]]:
        """Coefficients and elements, shape (elements, m), of some members."""
        generator = np.random.default_rng(_SEED)
        for _ in range(_SAMPLE):
            counts = generator.exponential(size=self.path.blocks[-1] + 1)
            rows = self._seen_with(counts)
            yield fit(rows, self.path.force_seen, counts[self.path.blocks]), rows

    def _seen_with(self, counts: Array) -> Array:
        """Elements as they are seen, shape (elements, m), with laws as weights of blocks would have them."""
        member, places = self.specimen.with_weights(counts)
        seen = self._seen.copy()
        seen[places] = self.path.responses(member.elements.only(places))
        return seen

    def member(self, counts: Array, wanted: Array, apart: float) -> tuple[LearnedSpecimen, Array]:
        """Give a member and its force along the command [N], shape (n,).

        `counts`: weights of blocks, shape (blocks,); `wanted`: force that it should have [N], shape (m,).
        """
        expected = self._fitted if wanted is self.path.force_seen else fit(self._seen, wanted)
        member, places = self.specimen.with_weights(1.0 + apart * (counts - 1.0))
        coefficients = self._apart(expected, counts, wanted, apart) if apart else expected
        rows = self._along_command.copy()
        rows[places] = member.elements.only(places).along(self.command, self.path.time_step, self.path.used)
        return replace(member, coefficients=coefficients), coefficients @ rows

    def _apart(self, expected: Array, counts: Array, wanted: Array, apart: float) -> Array:
        """Coefficients whose force differs so many times as much from what is expected, none negative."""
        rows = self._seen_with(counts)
        coefficients = fit(rows, wanted, counts[self.path.blocks])
        if apart == 1.0:
            return coefficients
        calm = expected @ self._seen
        aim = calm + apart * (coefficients @ rows - calm)
        return fit(self._seen_with(1.0 + apart * (counts - 1.0)), aim)
