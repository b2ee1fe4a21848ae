"""The terms that are tried in each block."""

import math
from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.discrepancy.terms.monomial import monomial
from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects.effect import Effect, Parameter, Role, Setting
from reliab.effects.kernel import Kernel, Numbers

_FORCES = (
    {"abs_x": 1}, {"x": 1, "abs_x": 1}, {"x": 4}, {"x": 5}, {"abs_x": 3},
    {"abs_v": 1}, {"v": 2}, {"v": 3}, {"v": -0.5, "abs_v": 0.5},
    {"x": 1, "v": 1}, {"abs_x": 1, "v": 1}, {"x": 2, "v": 1}, {"x": 1, "abs_v": 1}, {"x": 1, "v": 2},
    {"x": 2, "v": -0.5}, {"abs_x": 1, "v": -0.5}, {"abs_x": 1, "v": 1, "abs_v": 1},
    {"t": 1}, {"t": 1, "x": 1}, {"t": 1, "v": 1}, {"t": 1, "x": 3}, {"t": 1, "v": -0.5},
)  # fmt: skip
_PISTON = (
    {"abs_x": 1}, {"x": 2}, {"x": 1, "abs_x": 1}, {"x": 3},
    {"t": 1, "x": 1}, {"t": 2, "v": 1}, {"abs_v": 1},
    {"abs_x": 1, "v": 1}, {"x": 2, "v": 1}, {"x": 1, "v": 1}, {"v": 1, "abs_v": 1},
    {"x": 1, "abs_v": 1}, {"v": 3},
)  # fmt: skip
_READINGS = ({"x": 2}, {"x": 3})


def _force_of_spring(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers
) -> float:
    return coefficients[0] * max(motion[0] - coefficients[1], 0.0)


@dataclass(frozen=True, kw_only=True)
class OneSidedSpring(OutsideTerm):
    """A force k·max(x − x₀, 0)."""

    expression: ClassVar[str] = "max(x − start, 0)"
    name = "one-sided spring"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "a spring is touched on one side only"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness of the one-sided spring",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.2, lower=-5.0, upper=5.0,
            starts=(0.02, 0.02, 0.02, 0.02, 0.02, 0.02),
        ),
        Parameter(
            name="start_m", units="m", meaning="displacement at which it is touched",
            scale=(("displacement", 1.0),), signed=True, typical=0.4, lower=-1.0, upper=1.0,
            starts=(0.02, 0.2, 0.5, -0.02, -0.2, -0.5),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_force_of_spring, linear=0, by_path=True)

    stiffness_n_per_m: float  # Stiffness k [N/m]
    start_m: float  # Displacement x₀ at which it is touched [m]


def _branch(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, x, displacement q of the dashpot; T·q' = x − q.
    ratio = step / coefficients[1]
    decay = 2.718281828459045 ** (-ratio)
    late = 1.0 - (1.0 - decay) / ratio
    x = motion[0]
    if state[0] == 0.0:
        state[2] = x
    else:
        state[2] = decay * state[2] + (1.0 - decay - late) * state[1] + late * x
    state[0], state[1] = 1.0, x
    return coefficients[0] * (x - state[2])


@dataclass(frozen=True, kw_only=True)
class Relaxation(OutsideTerm):
    """A force k(x − q) with T·q' = x − q, of a Maxwell element."""

    expression: ClassVar[str] = "(x − q), T q' = x − q"
    name = "relaxation"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen relaxes like a spring in series with a dashpot"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness of the branch",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.2, lower=-10.0, upper=10.0,
            starts=(0.02, 0.02, 0.02),
        ),
        Parameter(
            name="time_s", units="s", meaning="relaxation time",
            scale=(("displacement", 1.0), ("velocity", -1.0)), typical=1.0, lower=0.02, upper=30.0,
            starts=(0.3, 1.0, 3.0),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_branch, states=3, linear=0)

    stiffness_n_per_m: float  # Stiffness k [N/m]
    time_s: float  # Relaxation time T [s]


def _worn(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    state[0] = max(state[0], abs(motion[0]))
    return coefficients[0] * state[0] * motion[0]


def _slack(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    state[0] = max(state[0], abs(motion[0]))
    return coefficients[0] * min(max(motion[0], -coefficients[1] * state[0]), coefficients[1] * state[0])


@dataclass(frozen=True, kw_only=True)
class WornSpring(OutsideTerm):
    """A force c·x·max|x|, where the maximum is that of the test so far."""

    expression: ClassVar[str] = "x max|x|"
    name = "worn spring"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen changes with the largest displacement so far"
    parameters = (
        Parameter(
            name="coefficient", units="N/m²", meaning="change of stiffness",
            scale=(("force", 1.0), ("displacement", -2.0)), signed=True, typical=0.2, lower=-10.0, upper=10.0,
            starts=(0.02,),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_worn, states=1, linear=0, by_path=True)

    coefficient: float  # c [N/m²], negative when the specimen weakens


@dataclass(frozen=True, kw_only=True)
class GrowingSlack(OutsideTerm):
    """A force c·x within ±s·max|x| and constant beyond, where the maximum is that of the test so far."""

    expression: ClassVar[str] = "min(max(x, −s max|x|), s max|x|)"
    name = "growing slack"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is a slack that grows with the largest displacement so far"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness within the slack",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.5, lower=-10.0, upper=10.0,
            starts=(0.1, 0.1, 0.1),
        ),
        Parameter(
            name="share", units="-", meaning="slack over the largest displacement",
            typical=0.1, lower=0.003, upper=0.9, starts=(0.03, 0.1, 0.3),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_slack, states=1, linear=0, by_path=True)

    stiffness_n_per_m: float  # c [N/m], minus the spring's stiffness for a slack
    share: float  # s [-]


def _softened(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: c, p, largest displacement in earlier tests. State: largest displacement so far.
    state[0] = max(state[0], coefficients[2], abs(motion[0]))
    below = 1.0 - (abs(motion[0]) / state[0]) ** coefficients[1] if state[0] > 0.0 else 0.0
    return -coefficients[0] * motion[0] * below


@dataclass(frozen=True, kw_only=True)
class SoftenedSpring(OutsideTerm):
    """A force −c·x·(1 − (|x|/max|x|)ᵖ), where the maximum is that of this test and of all earlier ones.

    Rubber that was stretched once is softer up to there, and as stiff as it was beyond (Mullins 1969, Rubber
    Chemistry and Technology 42, 339). Tests follow each other as the campaign lists them.
    """

    expression: ClassVar[str] = "−x (1 − (|x|/max|x|)^p)"
    name = "softened spring"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = (
        "the specimen is softer while it moves less than it did before, in this test or in an earlier one, "
        "as rubber is (the effect of Mullins)"
    )
    parameters = (
        Parameter(
            name="lost_n_per_m", units="N/m", meaning="stiffness lost far below the largest displacement",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.5, lower=-10.0, upper=10.0,
            starts=(0.1, 0.1, 0.1),
        ),
        Parameter(
            name="power", units="-", meaning="power with which the stiffness returns",
            typical=2.0, spread=1.0, lower=0.2, upper=20.0, starts=(4.0, 2.0, 1.0),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_softened, states=1, linear=0, by_path=True)

    lost_n_per_m: float  # c [N/m]
    power: float  # p [-]

    def coefficients(self, setting: Setting) -> Array:
        """Parameters, and the largest displacement in earlier tests [m]."""
        return np.array([*self.values, setting.moved_before])


def _stopped(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    # What the stops add: k·g·(|x|/g − 1)ᵖ beyond the clearance g, against the displacement.
    beyond = abs(motion[0]) / coefficients[1] - 1.0
    if beyond <= 0.0:
        return 0.0
    force = coefficients[0] * coefficients[1] * math.pow(beyond, coefficients[2])
    return force if motion[0] > 0.0 else -force


@dataclass(frozen=True, kw_only=True)
class ElasticStops(OutsideTerm):
    """A force k·g·sgn(x)·(|x|/g − 1)ᵖ beyond a clearance g on both sides.

    Flat stops are linear, p = 1; contact of rounded bodies has p = 1.5 (Hertz 1882, Journal für die reine und
    angewandte Mathematik 92, 156).
    """

    expression: ClassVar[str] = "g sgn(x) (|x|/g − 1)^p beyond |x| = g"
    name = "elastic stops"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen runs into elastic stops on both sides"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="force at twice the clearance, over it",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.5, lower=0.0, upper=100.0,
            starts=(0.1, 0.1, 0.1, 0.1),
        ),
        Parameter(
            name="clearance_m", units="m", meaning="displacement at which the stops are touched",
            scale=(("displacement", 1.0),), typical=0.3, lower=0.02, upper=1.0, starts=(0.1, 0.25, 0.4, 0.6),
        ),
        Parameter(
            name="power", units="-", meaning="power with which the force grows",
            typical=1.5, spread=0.3, lower=1.0, upper=3.0, starts=(1.5, 1.5, 1.5, 1.5),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_stopped, linear=0, by_path=True)

    stiffness_n_per_m: float  # k [N/m]
    clearance_m: float  # g [m]
    power: float  # p [-]


def _delay(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: the envelope e, T·e' + e = |x|.
    state[0] += (abs(motion[0]) - state[0]) * step / (coefficients[1] + step)
    return coefficients[0] * state[0]


@dataclass(frozen=True, kw_only=True)
class AmplitudeDelay(OutsideTerm):
    """A delay κ·e more, where e is the modulus of the command, smoothed."""

    expression: ClassVar[str] = "v·envelope(|x|)"
    name = "amplitude-dependent delay"
    block = Block.ACTUATOR
    role = Role.DELAY
    description = "the delay depends on the amplitude of the command"
    parameters = (
        Parameter(
            name="delay_s_per_m", units="s/m", meaning="growth of the delay with the amplitude",
            scale=(("velocity", -1.0),), signed=True, typical=0.03, lower=-2.0, upper=2.0,
            starts=(0.003, 0.003, 0.003),
        ),
        Parameter(
            name="envelope_time_s", units="s", meaning="memory of the amplitude",
            scale=(("displacement", 1.0), ("velocity", -1.0)), typical=1.0, lower=0.01, upper=30.0,
            starts=(0.1, 1.0, 6.0),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_delay, states=1)

    delay_s_per_m: float  # κ [s/m]
    envelope_time_s: float  # Time constant of the smoothing [s]


@cache
def outside_terms(block: Block) -> tuple[type[Effect], ...]:
    """Terms of a block."""
    if block is Block.SPECIMEN:
        terms = [monomial(Role.FORCE, **exponents) for exponents in _FORCES]
        return (*terms, OneSidedSpring, Relaxation, WornSpring, GrowingSlack)
    if block is Block.ACTUATOR:
        terms = [monomial(Role.PISTON, **exponents) for exponents in _PISTON]
        return (*terms, AmplitudeDelay)
    return ()
