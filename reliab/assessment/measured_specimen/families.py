"""Families of elements with which a specimen is learned, for the displacements and speeds of its test."""

import math
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Final

from reliab.assessment.measured_specimen.elements import Elements, Kind, list_elements

_LINEAR = 1e6  # times the largest displacement: an elastic-plastic spring that never yields
_YIELDS = (0.002, 0.005, 0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
_YIELDS_OF_OTHERS = (0.005, 0.01, 0.02, 0.04, 0.08, 0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 1.0)
_GAPS = tuple(0.05 * count for count in range(1, 20))
_TIMES = (0.01, 0.03, 0.1, 0.3)  # s, of Maxwell's elements
_PERIODS = tuple(0.25 * 1.12**k for k in range(22))  # over 2π displacement/speed
_DAMPING_RATIOS = (0.02, 0.07, 0.2)  # of oscillators
_POWERS = (0.2, 0.35, 0.5, 1.0, 2.0)
_STRETCHES = (0.05, 0.15, 0.4, 1.0)  # of a spring behind a fluid damper
_FLAGS = (0.0, 0.25, 0.5, 0.75, 1.0)  # share of the yield force by which a flag unloads lower
_POWERS_OF_MULLINS = (0.5, 1.0, 2.0, 4.0)

LINEAR: Final = "linear"
"""The family of a spring and a dashpot."""

FAMILIES: Final[Mapping[str, str]] = {
    LINEAR: "a spring and a dashpot",
    "oscillators": "springs, dashpots, and masses on springs and dashpots of their own",
    "plain": "springs that yield or harden, and dashpots",
    "elements": "all elements but oscillators and laws of hysteresis",
    "laws": "springs, dashpots and four laws of hysteresis",
    "all": "all elements but oscillators",
}
"""Families of elements, each with what it holds."""


def elements_of_family(name: str, displacement: float, speed: float) -> Elements:
    """Elements of a family but its laws, for the largest displacement [m] and speed [m/s] of a test."""
    parts = {
        LINEAR: [_linear(displacement)],
        "oscillators": [_oscillators(displacement, 2.0 * math.pi * displacement / speed)],
        "plain": [_plain(displacement)],
        "laws": [_laws_base(displacement)],
    }
    return list_elements(chain(*parts.get(name, [part(displacement) for part in _PARTS])), speed)


def _linear(displacement: float) -> Iterator[tuple[int, float, float]]:
    yield Kind.ELASTIC_PLASTIC, _LINEAR * displacement, 0.0
    yield Kind.DASHPOT, displacement, 1.0
    for sign in (1.0, -1.0):
        yield Kind.CONSTANT, sign * displacement, 0.0


def _oscillators(displacement: float, period: float) -> Iterator[tuple[int, float, float]]:
    yield from _linear(displacement)
    for time in _TIMES:
        yield Kind.MAXWELL, time, 0.0
    for ratio in _PERIODS:
        for damping_ratio in _DAMPING_RATIOS:
            yield Kind.OSCILLATOR, ratio * period, damping_ratio


def _laws_base(displacement: float) -> Iterator[tuple[int, float, float]]:
    yield from _linear(displacement)
    for kind in (Kind.CUBIC, Kind.QUINTIC):
        yield kind, displacement, 0.0
    yield Kind.DASHPOT, displacement, 0.35
    for time in (0.03, 0.3):
        yield Kind.MAXWELL, time, 0.0


def _plain(displacement: float) -> Iterator[tuple[int, float, float]]:
    for share in (_LINEAR, *_YIELDS):  # linear first: of springs that did not yield it is kept
        yield Kind.ELASTIC_PLASTIC, share * displacement, 0.0
    for sign in (1.0, -1.0):
        yield Kind.CONSTANT, sign * displacement, 0.0
    for kind in (Kind.CUBIC, Kind.QUINTIC):
        yield kind, displacement, 0.0
    for power in _POWERS:
        yield Kind.DASHPOT, displacement, power
    for time in _TIMES:
        yield Kind.MAXWELL, time, 0.0


def _gaps(displacement: float) -> Iterator[tuple[int, float, float]]:
    for share in _GAPS:
        yield Kind.GAP, share * displacement, 0.0
    for share in (0.0, *_GAPS[::2]):
        for kind in (Kind.GAP_ABOVE, Kind.GAP_BELOW):
            yield kind, share * displacement, 0.0


def _hysteresis(displacement: float) -> Iterator[tuple[int, float, float]]:
    for share in _YIELDS_OF_OTHERS:
        size = share * displacement
        for flag in _FLAGS:
            yield Kind.SELF_CENTRING, size, flag
        for exponent in (1.0, 2.0):
            yield Kind.SMOOTH, size, exponent
    for share in (*_YIELDS_OF_OTHERS, _LINEAR):
        for shape in (0.0, 1.0):
            yield Kind.WEAKENING, share * displacement, shape


def _fluid_dampers(displacement: float) -> Iterator[tuple[int, float, float]]:
    for share in _STRETCHES:
        for power in _POWERS[:3]:
            yield Kind.FLUID_DAMPER, share * displacement, power


def _memory_elements(displacement: float) -> Iterator[tuple[int, float, float]]:
    for share in _YIELDS_OF_OTHERS:
        for kind in (Kind.SOFTENING, Kind.PEAK_ORIENTED):
            yield kind, share * displacement, 0.0
    for power in _POWERS_OF_MULLINS:
        yield Kind.MULLINS, displacement, power
    for share in (0.2, 0.4, 0.6, 0.8):
        yield Kind.OPENING_GAP, share, 0.0


_PARTS: Final = (_plain, _gaps, _hysteresis, _fluid_dampers, _memory_elements)
