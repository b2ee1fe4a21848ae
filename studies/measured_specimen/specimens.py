# ruff: noqa: ARG001, PLR2004 - every family takes the same arguments, numbers are those of its law
"""Forces of nonlinear specimens, none built from the elements with which `reliab` learns a specimen.

Each law gives a force [N per unit of k x_y] at the end of a step along a path in units of the specimen's
yield displacement x_y: `x` displacement, `moved` during the step, `rate` [1/s], `step` [s], `s` state, which
is changed in place, `p` parameters.
"""

import math
from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

STATES: Final = 10
"""Length of the state of a specimen."""

PARAMETERS: Final = 8
"""Number of parameters of which a law reads those that it needs."""


@compiled
def _bouc_wen(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Bouc and Wen; with p[2], p[3] strength and stiffness fall with energy, with p[4] it is pinched."""
    hardening, exponent = p[0], p[1]
    for _ in range(4):
        part, z = 0.25 * moved, s[0]
        strength, stiffness = 1.0 + p[2] * s[1], 1.0 + p[3] * s[1]
        pinch = 1.0
        if p[4] > 0.0:  # Baber and Noori 1986
            slip = p[4] * (1.0 - math.exp(-p[5] * s[1]))
            width = (0.2 + 0.1 * s[1]) * (p[6] + slip)
            sign = 1.0 if moved > 0.0 else -1.0
            pinch = 1.0 - slip * math.exp(
                -((z * sign - 0.15 * strength ** (-1.0 / exponent)) ** 2) / (width**2 + 1e-9)
            )
        bent = 0.5 * strength * (abs(part) * abs(z) ** (exponent - 1.0) * z + part * abs(z) ** exponent)
        s[0] = z + pinch / stiffness * (part - bent)
        s[1] += max(0.0, (1.0 - hardening) * s[0] * part)
    return float(hardening * x + (1.0 - hardening) * s[0])


@compiled
def _cubic(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    return float(x * (1.0 + p[0] * x**2))


@compiled
def _fluid_damper(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Stand a spring beside a damper whose force grows with the root of the velocity."""
    return float(0.5 * x + p[0] * math.copysign(1.0, rate) * abs(rate / 6.28) ** 0.5)


@compiled
def _damper_behind_a_spring(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Stand a spring beside a braced damper of a power of the velocity, in implicit small steps."""
    stiffness, damper, power = p[0], p[1], p[2]
    for _ in range(8):
        reached = s[0] + stiffness * moved / 8.0
        least, most = min(reached, 0.0), max(reached, 0.0)
        for _trial in range(40):
            force = 0.5 * (least + most)
            slipped = math.copysign((abs(force) / damper) ** (1.0 / power), force) * 6.28 * step / 8.0
            if force + stiffness * slipped < reached:
                least = force
            else:
                most = force
        s[0] = 0.5 * (least + most)
    return float(0.5 * x + s[0])


@compiled
def _tuned_mass(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Stand a spring beside a mass on a spring and a damper of its own, in small steps."""
    pull = 0.0
    for part in range(8):
        place = x - moved * (1.0 - (part + 1.0) / 8.0)
        pull = 2.0 * p[2] * p[1] * (rate - s[1]) + p[1] ** 2 * (place - s[0])
        s[1] += pull * step / 8.0
        s[0] += s[1] * step / 8.0
    return float(0.5 * x + p[0] * pull / p[1] ** 2)


@compiled
def _bilinear(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    s[0] = min(max(s[0] + moved, -1.0), 1.0)
    return float(p[0] * x + (1.0 - p[0]) * s[0])


@compiled
def _gap(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    return float(0.3 * x + 0.7 * (max(x - p[0], 0.0) + min(x + p[0], 0.0)))


@compiled
def _lugre(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Stand a spring beside friction after Canudas de Wit and others (1995), bristles solved implicitly."""
    stiffness = p[0] / 0.02
    for _ in range(8):
        level = p[0] * (1.0 + 0.3 * math.exp(-((rate / 0.314) ** 2))) / stiffness
        s[0] = (s[0] + rate * step / 8.0) / (1.0 + abs(rate) * step / 8.0 / level)
    return float(0.6 * x + stiffness * s[0])


@compiled
def _menegotto_pinto(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Giuffrè, Menegotto and Pinto (1973), with curvature that falls with the largest excursion."""
    b = p[0]
    way = 1.0 if moved > 0.0 else (-1.0 if moved < 0.0 else s[6])
    if s[6] == 0.0:
        s[3], s[4], s[5], s[6], s[7], s[8] = way, way, 20.0, way, 1.0, 1.0
    elif way != s[6]:
        begin, force = x - moved, s[0]
        s[1], s[2], s[6] = begin, force, way
        s[7], s[8] = max(s[7], begin), max(s[8], -begin)
        s[3] = (force - begin - way * (1.0 - b)) / (b - 1.0)
        s[4] = way * (1.0 - b) + b * s[3]
        reach = abs(way * (s[7] if way > 0.0 else s[8]) - s[3])
        s[5] = 20.0 - 18.5 * reach / (0.15 + reach)
    span = s[3] - s[1]
    along = (x - s[1]) / span if abs(span) > 1e-12 else 0.0
    curvature = max(s[5], 1.2)
    share = b * along + (1.0 - b) * along / (1.0 + abs(along) ** curvature) ** (1.0 / curvature)
    s[0] = s[2] + share * (s[4] - s[2])
    return float(s[0])


@compiled
def _peak_oriented(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Load again towards the largest excursion, with strength that energy takes (after Ibarra and others)."""
    if s[1] == 0.0:
        s[1], s[2], s[3], s[4] = 1.0, 1.0, -1.0, -1.0
    strength = 1.0 - 0.6 * min(s[5] / p[1], 0.9)
    envelope = strength + p[0] * (max(abs(x), 1.0) - 1.0)
    before, force = x - moved, s[0]
    if moved * force < 0.0:
        now = force + moved
    else:
        peak, most = (s[1], s[2]) if moved > 0.0 else (s[3], s[4])
        limit = strength + p[0] * (max(abs(peak), 1.0) - 1.0)
        aim = min(max(most, -limit), limit)
        left = peak - before
        slope = (aim - force) / left if abs(left) > 1e-9 and left * moved > 0.0 else 1.0
        now = force + min(max(slope, 0.0), 1.0) * moved
    now = min(max(now, -envelope), envelope)
    if x > s[1]:
        s[1], s[2] = x, now
    if x < s[3]:
        s[3], s[4] = x, now
    s[5] += max(0.0, 0.5 * (now + force) * moved)
    s[0] = now
    return float(now)


@compiled
def _brace(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Yield in tension and buckle as a brace, with a buckling load that falls, in compression."""
    limit = 1.0 + 0.03 * max(x - 1.0, 0.0)
    buckling = p[0] / (1.0 + p[1] * s[1]) * max(0.25, 1.0 - 0.125 * max(0.0, -x - 1.0))
    force = s[0] + moved
    if moved > 0.0 and force > 0.0 and x < s[2]:
        force = min(force, max(s[0] + 0.35 * moved, s[0]))
    force = min(force, limit)
    if force < -buckling:
        s[1] += abs(force + buckling)
        force = -buckling
    if force > 0.95 and x > s[2]:
        s[2] = x
    s[0] = force
    return float(force)


@compiled
def _rubber(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Rubber that hardens, softens below its largest excursion (Mullins), and relaxes in 80 ms."""
    s[1] = max(s[1], abs(x))
    softened = 0.55 + 0.45 * math.exp(-p[0] * (s[1] - abs(x)))
    s[0] = s[0] * math.exp(-step / 0.08) + 0.3 * moved
    return float((0.7 * x + 0.02 * x**3) * softened + s[0])


@compiled
def _ramberg_osgood(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Ramberg and Osgood (1943), with the rule of Masing from the last reversal on."""
    way = 1.0 if moved > 0.0 else (-1.0 if moved < 0.0 else s[3])
    if s[3] != 0.0 and way != s[3]:
        s[1], s[2], s[4] = x - moved, s[0], 2.0
    s[3] = way
    if s[4] == 0.0 or x * way > s[5]:  # beyond all that was reached: the skeleton curve
        s[0], s[1], s[2], s[4] = _find_skeleton_force(x, s[0], p), 0.0, 0.0, 0.0
    else:
        s[0] = s[2] + 2.0 * _find_skeleton_force(0.5 * (x - s[1]), 0.5 * (s[0] - s[2]), p)
    s[5] = max(s[5], abs(x))
    return float(s[0])


@compiled
def _find_skeleton_force(x: float, guess: float, p: Array) -> float:
    """Force f at which f + p[0] f |f|^(p[1] − 1) = x, by Newton's method."""
    force = guess
    for _ in range(30):
        power = p[0] * abs(force) ** (p[1] - 1.0)
        change = (force * (1.0 + power) - x) / (1.0 + p[1] * power)
        force -= change
        if abs(change) < 1e-10:
            break
    return force


@compiled
def _mr_damper(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Stand a spring beside a magnetorheological damper after Spencer and others (1997)."""
    of_hysteresis, behind, beside = p[0], p[1], 8.0 * p[1]
    for _ in range(8):
        part = step / 8.0
        at = x - moved * (1.0 - (_ + 1.0) / 8.0)
        inner = (of_hysteresis * s[0] + behind * rate + 0.1 * (at - s[1])) / (behind + beside)
        slipped = (rate - inner) / p[2]
        s[0] = s[0] + part * slipped * (1.0 - abs(s[0]) ** 2 * (1.0 if slipped * s[0] > 0.0 else 0.0))
        s[0] = min(max(s[0], -1.0), 1.0)
        s[1] += part * inner
        s[2] = beside * inner
    return float(0.5 * x + s[2])


@compiled
def _make_hinged_strut(x: float, moved: float, rate: float, step: float, s: Array, p: Array) -> float:
    """Pin-ended strut with a plastic hinge at midspan, which bows out (Ikeda and Mahin 1986).

    Axial displacement P + u − (d² − d₀²), in deflections d of which one shortens by a yield displacement;
    elastic deflections grow by 1/(1 + P/p[0]) towards Euler's load, and the moment |P| d stays below that of
    the hinge, p[1] (1 − |P|). s[0]: deflection without a load, s[1]: plastic elongation u.
    """
    euler, hinge, bow = p[0], p[1], p[2]
    if s[2] == 0.0:
        s[0], s[2] = bow, 1.0
    least, most = -0.9999 * euler, 1.0
    for _ in range(45):
        force = 0.5 * (least + most)
        deflection = s[0] / (1.0 + force / euler)
        if force + s[1] - (deflection**2 - bow**2) < x:
            least = force
        else:
            most = force
    force = 0.5 * (least + most)
    deflection = s[0] / (1.0 + force / euler)
    if abs(force) * deflection <= hinge * (1.0 - abs(force)):
        return float(force)
    way = 1.0 if force > 0.0 else -1.0
    least, most = 0.0, 50.0
    for _ in range(50):
        deflection = 0.5 * (least + most)
        force = way * hinge / (deflection + hinge)
        if force + s[1] - (deflection**2 - bow**2) > x:
            least = deflection
        else:
            most = deflection
    force = max(way * hinge / (deflection + hinge), -0.9999 * euler)
    s[0] = max(deflection * (1.0 + force / euler), bow)  # which is never pulled out
    if way > 0.0:
        force = min(force, hinge / (s[0] / (1.0 + force / euler) + hinge))
        s[1] = max(s[1], x - force + (s[0] / (1.0 + force / euler)) ** 2 - bow**2)
    return float(force)


(
    _LINEAR,
    _CUBIC,
    _FLUID,
    _BILINEAR,
    _GAP,
    _LUGRE,
    _BOUC_WEN,
    _MENEGOTTO,
    _PEAK,
    _BRACE,
    _RUBBER,
    _RAMBERG,
    _MR,
    _STRUT,
    _BRACED_DAMPER,
    _TUNED_MASS,
) = range(16)


@compiled
def resist(  # noqa: C901, PLR0911, PLR0912 - one branch for each law
    law: int, x: float, moved: float, rate: float, step: float, s: Array, p: Array
) -> float:
    """Force of a specimen at the end of a step; see the module."""
    if law == _FLUID:
        return _fluid_damper(x, moved, rate, step, s, p)
    if law == _BILINEAR:
        return _bilinear(x, moved, rate, step, s, p)
    if law == _GAP:
        return _gap(x, moved, rate, step, s, p)
    if law == _LUGRE:
        return _lugre(x, moved, rate, step, s, p)
    if law == _BOUC_WEN:
        return _bouc_wen(x, moved, rate, step, s, p)
    if law == _MENEGOTTO:
        return _menegotto_pinto(x, moved, rate, step, s, p)
    if law == _PEAK:
        return _peak_oriented(x, moved, rate, step, s, p)
    if law == _BRACE:
        return _brace(x, moved, rate, step, s, p)
    if law == _RUBBER:
        return _rubber(x, moved, rate, step, s, p)
    if law == _RAMBERG:
        return _ramberg_osgood(x, moved, rate, step, s, p)
    if law == _MR:
        return _mr_damper(x, moved, rate, step, s, p)
    if law == _STRUT:
        return _make_hinged_strut(x, moved, rate, step, s, p)
    if law == _TUNED_MASS:
        return _tuned_mass(x, moved, rate, step, s, p)
    if law == _BRACED_DAMPER:
        return _damper_behind_a_spring(x, moved, rate, step, s, p)
    return _cubic(x, moved, rate, step, s, p)


FAMILIES: Final[Mapping[str, tuple[int, Callable[[np.random.Generator], list[float]]]]] = {
    "linear": (_LINEAR, lambda _: [0.0]),
    "cubic": (_CUBIC, lambda draw: [draw.uniform(0.02, 0.1)]),
    "fluid damper": (_FLUID, lambda draw: [draw.uniform(0.3, 1.0)]),
    "bilinear": (_BILINEAR, lambda draw: [draw.uniform(0.02, 0.15)]),
    "gap": (_GAP, lambda draw: [draw.uniform(0.6, 2.0)]),
    "LuGre friction": (_LUGRE, lambda draw: [draw.uniform(0.2, 0.8)]),
    "Bouc-Wen": (_BOUC_WEN, lambda draw: [draw.uniform(0.03, 0.15), draw.uniform(1.0, 2.5)]),
    "degrading": (_BOUC_WEN, lambda draw: [draw.uniform(0.05, 0.15), 1.5, draw.uniform(0.01, 0.05)]),
    "Baber-Noori": (
        _BOUC_WEN,
        lambda draw: [
            draw.uniform(0.05, 0.15),
            1.5,
            draw.uniform(0.0, 0.02),
            draw.uniform(0.0, 0.04),
            draw.uniform(0.5, 0.9),
            draw.uniform(0.05, 0.3),
            draw.uniform(0.1, 0.4),
        ],
    ),
    "Menegotto-Pinto": (_MENEGOTTO, lambda draw: [draw.uniform(0.01, 0.08)]),
    "peak-oriented": (_PEAK, lambda draw: [draw.uniform(0.02, 0.08), draw.uniform(20.0, 100.0)]),
    "buckling brace": (_BRACE, lambda draw: [draw.uniform(0.4, 0.8), draw.uniform(0.05, 0.3)]),
    "rubber": (_RUBBER, lambda draw: [draw.uniform(0.3, 1.5)]),
    "Ramberg-Osgood": (_RAMBERG, lambda draw: [draw.uniform(0.2, 1.0), draw.uniform(3.0, 9.0)]),
    "MR damper": (
        _MR,
        lambda draw: [draw.uniform(0.3, 1.2), draw.uniform(0.02, 0.1), draw.uniform(0.1, 0.5)],
    ),
    "hinged strut": (
        _STRUT,
        lambda draw: [draw.uniform(0.5, 1.5), draw.uniform(0.3, 0.7), draw.uniform(0.04, 0.1)],
    ),
    "fluid damper behind a spring": (
        _BRACED_DAMPER,
        lambda draw: [draw.uniform(0.5, 3.0), draw.uniform(0.3, 1.0), draw.uniform(0.3, 0.8)],
    ),
    "tuned mass": (
        _TUNED_MASS,
        lambda draw: [draw.uniform(0.02, 0.15), draw.uniform(4.0, 10.0), draw.uniform(0.03, 0.12)],
    ),
}
"""Families of specimens: their law, and how their parameters are drawn."""
