"""A force that was recorded later than the displacement: clocks, filters or multiplexers that differ."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects import Kernel, Numbers, Parameter, Role
from reliab.vocabulary import Block


def _nothing(_motion: Numbers, _time: float, _step: float, _coefficients: Numbers, _state: Numbers) -> float:
    return 0.0


@dataclass(frozen=True, kw_only=True)
class LateForce(OutsideTerm):
    """The whole force F(t − τ) in the place of F(t), which no single force beside the others can say.

    Only a force that lags: the specimen would give energy, which no passive one does. One that leads the
    displacement dissipates as a damper would, and is called one.
    """

    expression: ClassVar[str] = "force(t − τ)"
    name = "clock_offset"
    block = Block.SPECIMEN
    role = Role.FORCE_READING
    description = (
        "the force lags the displacement, as no passive specimen does: clocks or filters of the two channels "
        "differ"
    )
    parameters = (
        Parameter(
            name="lag_s", units="s", meaning="time by which the force is recorded later",
            scale=(("displacement", 1.0), ("velocity", -1.0)), typical=0.02, spread=1.5,
            lower=1e-5, upper=0.5,
            starts=(0.003, 0.03),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_nothing)

    lag_s: float  # τ [s]

    def delayed(self, force: Array, step: float) -> Array:
        """Force as it is recorded, shape (n,), at steps [s]; before the first sample it is the first."""
        time = np.arange(force.size) * step
        return np.asarray(np.interp(time - self.lag_s, time, force))
