"""Physical monomials c·tᵃ·xⁱ·|x|ʲ·vᵏ·|v|ˡ as effects, on the force, on the piston or on a reading."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.compiled import compiled
from reliab.core.vocabulary import Block
from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects.effect import Parameter, Role, Setting
from reliab.effects.kernel import Kernel, Numbers

_SYMBOLS = ("t", "x", "|x|", "v", "|v|")
_UNITS = {
    Role.FORCE: ("force", "N"),
    Role.FORCE_READING: ("force", "N"),
    Role.PISTON: ("displacement", "m"),
    Role.DISPLACEMENT_READING: ("displacement", "m"),
}
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
    # State: started, the term one step earlier.
    exponents = (coefficients[1], coefficients[2], coefficients[3], coefficients[4], coefficients[5])
    added = coefficients[0] * _product(time, motion[0], motion[1], exponents)
    rate = (added - state[1]) / step if state[0] != 0.0 else 0.0
    state[0], state[1] = 1.0, added
    motion[0] += added
    motion[1] += rate
    return 0.0


_ON_FORCE = Kernel(function=_force, linear=0)
_ON_PISTON = Kernel(function=_move, states=2)


@dataclass(frozen=True, kw_only=True)
class Monomial(OutsideTerm):
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
) -> type[Monomial]:
    """Make the class of a term.

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
        units=f"{unit}/({expression})",
        meaning=f"coefficient of {expression}",
        scale=scale,
        signed=True,
        typical=typical,
        lower=-20.0,
        upper=20.0,
        starts=(0.1 * typical,),
    )
    attributes = {
        "name": f"{role}: {expression}",
        "block": Block.SPECIMEN if channel == "force" else Block.ACTUATOR,
        "role": role,
        "description": f"a term in {expression} that is not an effect of the library",
        "parameters": (parameter,),
        "kernel": _ON_PISTON if role is Role.PISTON else _ON_FORCE,
        "exponents": exponents,
        "expression": expression,
    }
    return type("Term", (Monomial,), attributes)


def _factor(symbol: str, exponent: float) -> str:
    if exponent == _SIGN:
        return f"sign({symbol})"
    return symbol if exponent == 1 else f"{symbol}^{exponent:g}"
