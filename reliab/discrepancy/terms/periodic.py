"""A disturbance of one frequency, whatever the motion: a pump, a fan, a resonance nearby."""

import math
from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects.effect import Parameter, Role
from reliab.effects.kernel import Kernel, Numbers


def _wave(_motion: Numbers, time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    turn = 2.0 * math.pi * coefficients[2] * time
    return coefficients[0] * math.sin(turn) + coefficients[1] * math.cos(turn)


@dataclass(frozen=True, kw_only=True)
class Disturbance(OutsideTerm):
    """A wave s·sin(2πft) + c·cos(2πft), t from the start of each test."""

    expression: ClassVar[str] = "sine sin(2π f t) + cosine cos(2π f t)"
    description = "there is a disturbance of one frequency, whatever the motion"
    kernel = Kernel(function=_wave)

    sine: float  # sine, cosine: Amplitudes s and c
    cosine: float
    frequency_hz: float  # Frequency f [Hz]


def disturbance(role: Role, frequency: float, resolution: float) -> type[Disturbance]:
    """Make the class of disturbances about a frequency.

    `frequency`, `resolution` [Hz].

    >>> disturbance(Role.FORCE, 7.0, 0.02).name
    'disturbance of 7.00 Hz'
    """
    channel, unit = ("force", "N") if role in {Role.FORCE, Role.FORCE_READING} else ("displacement", "m")
    amplitudes = tuple(
        Parameter(
            name=name, units=unit, meaning=f"{name} amplitude", scale=((channel, 1.0),), signed=True,
            typical=0.2, lower=-10.0, upper=10.0, starts=starts,
        )
        for name, starts in (("sine", (0.01, 0.0, 0.007, 0.007)), ("cosine", (0.0, 0.01, 0.007, -0.007)))
    )  # fmt: skip
    place = Parameter(
        name="frequency_hz", units="Hz", meaning="frequency of the disturbance", typical=frequency,
        spread=resolution / frequency, lower=frequency - 2.0 * resolution, upper=frequency + 2.0 * resolution,
        starts=(frequency,),
    )  # fmt: skip
    attributes = {
        "name": f"disturbance of {frequency:.2f} Hz",
        "block": Block.SPECIMEN if channel == "force" else Block.ACTUATOR,
        "role": role,
        "parameters": (*amplitudes, place),
    }
    return type("Line", (Disturbance,), attributes)
