"""Hysteresis behind play that carries no force: a damper whose pins have clearance."""

from dataclasses import dataclass, replace

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.effect import Parameter, Setting
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.series_play import SeriesPlay

_LARGEST_PART = 0.1  # of the yield displacement: largest part into which the path is divided
_MOST_PARTS = 50
_LARGEST_FORCE = 100.0  # of the yield force


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: f, d, γ, n, share that the spring lost, play over d, asymmetry.
    # State: started, displacement, z, place within the play from its middle over d. What is stressed is
    # relieved first, then the play is crossed, then the other side is loaded.
    gamma, exponent, half = coefficients[2], coefficients[3], 0.5 * coefficients[5]
    beta = 1.0 - gamma - 2.0 * min(gamma, 0.0) ** 2
    travel = (motion[0] - state[1]) / coefficients[1] if state[0] != 0.0 else 0.0
    sign = 1.0 if travel >= 0.0 else -1.0
    substeps = min(int(abs(travel) / _LARGEST_PART) + 1, _MOST_PARTS)
    increment = travel / substeps
    z, place = state[2], state[3]
    loaded, relieved = 1.0 + sign * coefficients[6], 1.0 - sign * coefficients[6]  # strengths of both sides
    for _ in range(substeps):
        remaining = increment
        if sign * z < 0.0:
            rise = remaining * (1.0 - abs(z / relieved) ** exponent * (gamma - beta))
            middle = min(sign * (z + 0.5 * rise), 0.0)
            rise = remaining * (1.0 - abs(middle / relieved) ** exponent * (gamma - beta))
            if sign * rise <= 0.0 or sign * (z + rise) < 0.0:
                z = min(max(z + rise, -_LARGEST_FORCE), _LARGEST_FORCE)
                remaining = 0.0
            else:
                remaining *= 1.0 + z / rise
                z = 0.0
        if remaining != 0.0:
            moved = min(max(place + remaining, -half), half)
            remaining -= moved - place
            place = moved
            rise = remaining * (1.0 - abs(z / loaded) ** exponent * (beta + gamma))
            rise = remaining * (1.0 - abs((z + 0.5 * rise) / loaded) ** exponent * (beta + gamma))
            z = min(max(z + rise, -_LARGEST_FORCE), _LARGEST_FORCE)
    state[0], state[1], state[2], state[3] = 1.0, motion[0], z, place
    return coefficients[0] * (z - coefficients[4] * motion[0] / coefficients[1])


@dataclass(frozen=True, kw_only=True)
class HysteresisWithPlay(Hysteresis):
    """A hysteresis that is first relieved, then crosses play without force, then is loaded the other way.

    The play is in series with the hysteretic part alone, which may yield later in one direction, at f(1 + a)
    forwards and f(1 − a) backwards, with one stiffness f/d. Unlike in
    :class:`~reliab.effects.series_play.SeriesPlay` no force is held while the play is crossed. A test begins
    in its middle.
    """

    name = "hysteresis_with_play"
    description = "the specimen yields like a Bouc–Wen hysteresis behind play that carries no force"
    refines = Hysteresis
    limiting_cases = (Hysteresis,)
    members = (Hysteresis, SeriesPlay)
    parameters = (
        *Hysteresis.parameters,
        *(replace(width, starts=width.starts[::-1]) for width in SeriesPlay.parameters),
        Parameter(
            name="asymmetry",
            units="-",
            meaning="half the difference of both directions' strength over their mean",
            signed=True,
            typical=0.3,
            lower=-0.95,
            upper=0.95,
            starts=(0.02,),
        ),
    )
    kernel = Kernel(function=_force, states=4, linear=0, by_path=True)

    width_m: float  # Whole play w [m]
    asymmetry: float = 0.0  # a [-], half the difference of both directions' strength over their mean

    def coefficients(self, setting: Setting) -> Array:
        """Parameters of the hysteresis, play over its yield displacement, and asymmetry."""
        del setting
        shape = (self.force_n, self.displacement_m, self.gamma, self.exponent, self.lost_share)
        return np.array([*shape, self.width_m / self.displacement_m, self.asymmetry])
