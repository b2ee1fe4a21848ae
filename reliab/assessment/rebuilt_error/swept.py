"""Errors of many draws over a test so far, to which a later stretch of it can be joined."""

from dataclasses import dataclass, replace

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.spread import Spread


@dataclass(frozen=True, kw_only=True, eq=False)
class Swept:
    """Errors of the draws over a test so far, from which a later stretch of it can go on."""

    steps: int  # Number of steps between its samples
    # square, peak, ideal: Mean square of x_m − x_I [m²], its peak and that of x_I [m], shape (draws,)
    square: Array
    peak: Array
    ideal: Array
    # mean, deviation: Of x_m − x_I over the draws at the samples of the last stretch [m], shape (n,)
    mean: Array
    deviation: Array
    # State of the structure at the last sample: of the draws, and as stated by swept samples and by all,
    # shape (draws + 2, 2n)
    states: Array

    @property
    def spread(self) -> Spread:
        """RMS^R and MTE^R of the draws."""
        return Spread(
            rms=np.sqrt(self.square) / self.ideal,
            mte=self.peak / self.ideal,
            mean=self.mean,
            deviation=self.deviation,
        )

    def first(self, draws: int) -> "Swept":
        """Only the first draws."""
        return replace(
            self,
            square=self.square[:draws],
            peak=self.peak[:draws],
            ideal=self.ideal[:draws],
            states=np.concatenate([self.states[:draws], self.states[-2:]]),
        )

    def after_rest(self, steps: int) -> "Swept":
        """Errors of the same test with so many further steps of rest before it."""
        whole = self.steps + steps
        return replace(self, steps=whole, square=(self.steps / whole) * self.square)

    def joined(self, later: "Swept") -> "Swept":
        """Errors over this stretch and a later one, which begins at its last sample."""
        steps = self.steps + later.steps
        return replace(
            later,
            steps=steps,
            square=(self.steps / steps) * self.square + (later.steps / steps) * later.square,
            peak=np.maximum(self.peak, later.peak),
            ideal=np.maximum(self.ideal, later.ideal),
        )
