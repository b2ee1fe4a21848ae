"""The terms that are tried in each block."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.compiled import compiled
from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Parameter, Role, Setting
from reliab.effects.general.general_term import GeneralTerm
from reliab.effects.general.periodic import DISTURBANCES
from reliab.effects.kernel import Kernel, Numbers

_SYMBOLS = ("t", "x", "|x|", "v", "|v|")
_UNITS = {
    Role.FORCE: ("force", "N"),
    Role.FORCE_READING: ("force", "N"),
    Role.PISTON: ("displacement", "m"),
    Role.DISPLACEMENT_READING: ("displacement", "m"),
}
_SUPERSCRIPTS = str.maketrans("0123456789.", "⁰¹²³⁴⁵⁶⁷⁸⁹·")
_SIGN = -0.5  # stands for the sign function among the exponents of x and v


@compiled
def _power(base: float, exponent: float) -> float:
    if exponent == 0.0:
        return 1.0
    if exponent == 1.0:
        return base
    if exponent == _SIGN:
        return float(np.sign(base))
    return float(base**exponent)


@compiled
def _product(time: float, x: float, v: float, exponents: tuple[float, float, float, float, float]) -> float:
    on_time, on_x, on_modulus_of_x, on_v, on_modulus_of_v = exponents
    place = _power(x, on_x) * _power(abs(x), on_modulus_of_x)
    return _power(time, on_time) * place * _power(v, on_v) * _power(abs(v), on_modulus_of_v)


def _force(motion: Numbers, time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    exponents = (coefficients[1], coefficients[2], coefficients[3], coefficients[4], coefficients[5])
    return coefficients[0] * _product(time, motion[0], motion[1], exponents)


def _move(motion: Numbers, time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: number of steps, at most two, and the term one step and two steps earlier.
    exponents = (coefficients[1], coefficients[2], coefficients[3], coefficients[4], coefficients[5])
    added = coefficients[0] * _product(time, motion[0], motion[1], exponents)
    bend = added - 2.0 * state[1] + state[2] if state[0] > 1.0 else 0.0
    rise = added - state[1] if state[0] > 0.0 else 0.0
    state[0], state[1], state[2] = min(state[0] + 1.0, 2.0), added, state[1]
    motion[0] += added
    motion[1] += (rise + 0.5 * bend) / step
    motion[2] += bend / step**2
    return 0.0


_ON_FORCE = Kernel(function=_force, linear=0)
_ON_PISTON = Kernel(function=_move, states=3)


@dataclass(frozen=True, kw_only=True)
class Monomial(GeneralTerm):
    """A term c·tᵃ·xⁱ·|x|ʲ·vᵏ·|v|ˡ."""

    exponents: ClassVar[tuple[float, ...]]
    expression: ClassVar[str]

    coefficient: float  # c, in SI units

    def coefficients(self, setting: Setting) -> NDArray[np.float64]:
        """Coefficient and exponents."""
        del setting
        return np.array([self.coefficient, *self.exponents])


def monomial(
    role: Role,
    *,
    t: float = 0,
    x: float = 0,
    abs_x: float = 0,
    v: float = 0,
    abs_v: float = 0,
    typical: float = 0.1,
    name: str = "",
    description: str = "",
) -> type[Monomial]:
    """Make the class of a term, with a name and words of its own where it has some.

    >>> monomial(Role.FORCE, x=2, v=1).expression
    'x^2 v'
    """
    exponents = (t, x, abs_x, v, abs_v)
    expression = " ".join(_factor(s, e) for s, e in zip(_SYMBOLS, exponents, strict=True) if e != 0)
    channel, unit = _UNITS[role]
    powers = {"duration": t, "displacement": max(x, 0.0) + abs_x, "velocity": max(v, 0.0) + abs_v}
    scale = ((channel, 1.0), *((name, -float(power)) for name, power in powers.items() if power))
    parameter = Parameter(
        name="coefficient",
        units=_write_unit(unit, displacement=max(x, 0.0) + abs_x, velocity=max(v, 0.0) + abs_v, time=t),
        meaning=f"coefficient of {expression}",
        scale=scale,
        signed=True,
        typical=typical,
        lower=-20.0,
        upper=20.0,
        starts=(0.1 * typical,),
    )
    attributes = {
        "name": name or f"{role}: {expression}",
        "block": Block.SPECIMEN if channel == "force" else Block.ACTUATOR,
        "role": role,
        "description": description or f"a term in {expression} that is not an effect of the library",
        "parameters": (parameter,),
        "kernel": _ON_PISTON if role is Role.PISTON else _ON_FORCE,
        "exponents": exponents,
        "expression": expression,
    }
    return type("Term", (Monomial,), attributes)


def _write_unit(unit: str, *, displacement: float, velocity: float, time: float) -> str:
    """Write the unit of a coefficient of powers of displacement, velocity and time.

    >>> _write_unit("N", displacement=2, velocity=1, time=0)
    'N·s/m³'
    >>> [_write_unit("m", displacement=1, velocity=0, time=time) for time in (0, 1)]
    ['-', '1/s']
    """
    powers = {"m": displacement + velocity - (unit == "m"), "s": time - velocity}
    above = ["N"] * (unit == "N") + [_raise(name, -power) for name, power in powers.items() if power < 0.0]
    below = [_raise(name, power) for name, power in powers.items() if power > 0.0]
    if not (above or below):
        return "-"
    denominator = f"({'·'.join(below)})" if len(below) > 1 else "".join(below)
    return "·".join(above or ["1"]) + (f"/{denominator}" if below else "")


def _raise(name: str, power: float) -> str:
    return name if power == 1.0 else name + f"{power:g}".translate(_SUPERSCRIPTS)


def _factor(symbol: str, exponent: float) -> str:
    if exponent == _SIGN:
        return f"sign({symbol})"
    return symbol if exponent == 1 else f"{symbol}^{exponent:g}"


_TERMS: Final[Mapping[Role, tuple[dict[str, Any], ...]]] = {
    Role.FORCE: (
        {"abs_x": 1, "description": "the specimen is stiffer in one direction than in the other"},
        {
            "x": 1,
            "abs_x": 1,
            "description": "the stiffness grows, or falls, with the size of the displacement",
        },
        {"x": 4, "description": "at large displacements the force differs by direction"},
        {"x": 5, "description": "the stiffness changes steeply at large displacements"},
        {"abs_x": 3, "description": "at large displacements the specimen is stiffer in one direction"},
        {"abs_v": 1, "name": "one_way_damping", "description": "a damper resists one direction more"},
        {"v": 2, "description": "a force proportional to the square of the velocity acts in one direction"},
        {"v": 3, "description": "the damping grows, or falls, with the square of the velocity"},
        {
            "v": -0.5,
            "abs_v": 0.5,
            "description": "a damper resists by the root of the velocity",
        },
        {"x": 1, "v": 1, "description": "the damping is larger on one side of the middle"},
        {"abs_x": 1, "v": 1, "description": "the damping grows, or falls, with the size of the displacement"},
        {
            "x": 2,
            "v": 1,
            "name": "displacement_dependent_damping",
            "description": "the specimen is damped more, or less, away from its middle",
        },
        {"x": 1, "abs_v": 1, "description": "the stiffness changes with the speed"},
        {"x": 1, "v": 2, "description": "the stiffness changes with the square of the velocity"},
        {
            "x": 2,
            "v": -0.5,
            "description": "the friction grows, or falls, with the square of the displacement",
        },
        {
            "abs_x": 1,
            "v": -0.5,
            "description": "the friction grows, or falls, with the size of the displacement",
        },
        {
            "abs_x": 1,
            "v": 1,
            "abs_v": 1,
            "description": "quadratic damping changes with the displacement",
        },
        {"t": 1, "description": "the force drifts over the test"},
        {
            "t": 1,
            "x": 1,
            "name": "stiffness_degradation",
            "description": "the stiffness changes in proportion to the time since a test began",
        },
        {"t": 1, "v": 1, "description": "the damping changes in proportion to the time since a test began"},
        {"t": 1, "x": 3, "description": "the hardening changes in proportion to the time since a test began"},
        {
            "t": 1,
            "v": -0.5,
            "description": "the friction changes in proportion to the time since a test began",
        },
    ),
    Role.PISTON: (
        {"abs_x": 1, "description": "the actuator's gain differs by direction"},
        {
            "x": 2,
            "name": "position_dependent_gain",
            "description": "the actuator's gain grows with its position",
        },
        {
            "x": 1,
            "abs_x": 1,
            "description": "the actuator's gain grows, or falls, with the size of its displacement",
        },
        {"x": 3, "description": "the actuator's gain grows, or falls, with the square of its displacement"},
        {
            "t": 1,
            "x": 1,
            "name": "gain_drift",
            "description": "the actuator's gain changes in proportion to the time since a test began",
        },
        {
            "t": 2,
            "v": 1,
            "description": "the actuator's delay changes with the square of the time since a test began",
        },
        {
            "abs_x": 1,
            "v": 1,
            "description": "the actuator's delay grows, or falls, with the size of its displacement",
        },
        {
            "x": 2,
            "v": 1,
            "description": "the actuator's delay grows, or falls, with the square of its displacement",
        },
        {"x": 1, "v": 1, "description": "the actuator's delay is longer on one side of its middle"},
        {"v": 1, "abs_v": 1, "description": "the actuator's delay grows, or falls, with its speed"},
        {"x": 1, "abs_v": 1, "description": "the actuator's gain changes with its speed"},
        {"v": 3, "description": "the actuator's delay grows, or falls, with the square of its velocity"},
    ),
}
"""Monomials by their place, with exponents, and names where a laboratory has a word for them."""


def _force_of_spring(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers
) -> float:
    return coefficients[0] * max(motion[0] - coefficients[1], 0.0)


@dataclass(frozen=True, kw_only=True)
class OneSidedSpring(GeneralTerm):
    """A force k·max(x − x₀, 0)."""

    expression: ClassVar[str] = "max(x − start, 0)"
    name = "one_sided_spring"
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


def _slack(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    state[0] = max(state[0], abs(motion[0]))
    return coefficients[0] * min(max(motion[0], -coefficients[1] * state[0]), coefficients[1] * state[0])


@dataclass(frozen=True, kw_only=True)
class GrowingSlack(GeneralTerm):
    """A force c·x within ±s·max|x| and constant beyond, where the maximum is that of the test so far."""

    expression: ClassVar[str] = "min(max(x, −s max|x|), s max|x|)"
    name = "slip_lock"
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


def _stopped(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    # What the stops add: k·g·(|x − m|/g − 1)ᵖ beyond the clearance g, against the displacement.
    place = motion[0] - coefficients[3]
    beyond = abs(place) / coefficients[1] - 1.0
    if beyond <= 0.0:
        return 0.0
    force = coefficients[0] * coefficients[1] * math.pow(beyond, coefficients[2])
    return force if place > 0.0 else -force


@dataclass(frozen=True, kw_only=True)
class ElasticStops(GeneralTerm):
    """A force k·g·sgn(x − m)·(|x − m|/g − 1)ᵖ beyond a clearance g on both sides of their middle m.

    Flat stops are linear, p = 1; contact of rounded bodies has p = 1.5 (Hertz 1882, Journal für die reine und
    angewandte Mathematik 92, 156).
    """

    expression: ClassVar[str] = "g sgn(x − m) (|x − m|/g − 1)^p beyond |x − m| = g"
    name = "elastic_stops"
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
        Parameter(
            name="middle_m", units="m", meaning="middle between the stops", scale=(("displacement", 1.0),),
            signed=True, typical=0.1, lower=-0.5, upper=0.5, starts=(1e-3, 1e-3, 1e-3, 1e-3),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_stopped, linear=0, by_path=True)

    stiffness_n_per_m: float  # k [N/m]
    clearance_m: float  # g [m]
    power: float  # p [-]
    middle_m: float = 0.0  # m [m]


def _delay(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: the envelope e, T·e' + e = |x|.
    state[0] += (abs(motion[0]) - state[0]) * step / (coefficients[1] + step)
    return coefficients[0] * state[0]


@dataclass(frozen=True, kw_only=True)
class AmplitudeDelay(GeneralTerm):
    """A delay κ·e more, where e is the modulus of the command, smoothed."""

    expression: ClassVar[str] = "v·envelope(|x|)"
    name = "amplitude_dependent_delay"
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
def general_terms(block: Block) -> tuple[type[Effect], ...]:
    """Terms of a block."""
    if block is Block.SPECIMEN:
        return (*_monomials(Role.FORCE), OneSidedSpring, GrowingSlack, ElasticStops)
    if block is Block.ACTUATOR:
        return (*_monomials(Role.PISTON), AmplitudeDelay)
    return ()


def _monomials(role: Role) -> tuple[type[Effect], ...]:
    return tuple(monomial(role, **term) for term in _TERMS[role])


def general_term(name: str) -> type[Effect] | None:
    """Return the term of a name, None where there is none."""
    every = (*general_terms(Block.SPECIMEN), *general_terms(Block.ACTUATOR), *DISTURBANCES)
    return next((term for term in every if term.name == name), None)
