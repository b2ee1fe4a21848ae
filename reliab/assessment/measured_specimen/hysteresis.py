"""Laws of hysteresis: one without traits, and four with many, searched for by nonlinear least squares.

Smooth hysteresis unloads elastically, loses strength and stiffness with the energy that it took, resists
less on one side, and slips while its force is small: Baber and Noori (1986, Journal of Vibration, Acoustics,
Stress, and Reliability in Design 108, 273). Hysteresis towards peaks loads again towards the largest
excursion so far, or elastically, or something between, with a break on the way where it is pinched, and each
of its sides hardens or softens and weakens in its own way: Ibarra, Medina and Krawinkler (2005, Earthquake
Engineering and Structural Dynamics 34, 1489). Hysteresis from reversals follows a curve that starts
elastically at the last reversal and bends towards the line of yielding: Menegotto and Pinto (1973, IABSE
Symposium, Lisbon, 15), or twice the curve of first loading, as Masing's rule has it for the law of Ramberg
and Osgood. A strut yields on one side, buckles on the other under a load that falls the farther and the
longer it is buckled, and is softer until it has been pulled straight: Ikeda and Mahin (1986, Journal of
Structural Engineering 112, 2506).

Forces are displacements of a spring of unit stiffness [m]; `size` is the yield displacement [m], energies are
those of the normalised element.
"""

from typing import Final

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

TRAITS: Final = 11
"""Largest number of traits of a law, its yield displacement apart."""

SMOOTH_TRAITS: Final = (
    # name, least, largest value, start
    ("exponent", 0.6, 8.0, 1.5),
    ("weak_side", 0.2, 5.0, 1.0),  # strength when negative over that when positive
    ("strength_lost", 1e-4, 1.0, 0.01),  # with a unit of energy
    ("stiffness_lost", 1e-4, 1.0, 0.01),
    ("slip", 1e-3, 0.98, 0.05),  # share of the stiffness that slips
    ("slip_grows", 0.01, 30.0, 0.3),  # with a unit of energy
    ("slip_at", 1e-3, 0.6, 0.15),  # share of the strength about which it slips
    ("slip_width", 0.02, 2.0, 0.3),
    ("width_grows", 1e-3, 1.0, 0.05),  # with a unit of energy
    ("bulge", 0.25, 4.0, 1.0),  # of the loop; one unloads elastically
    ("narrowest", 0.02, 2.0, 0.3),  # width of what slips before it has grown
)
"""Traits of smooth hysteresis."""

PEAK_TRAITS: Final = (
    ("weak_side", 0.1, 10.0, 1.0),  # strength when negative over that when positive
    ("hardening", 0.7, 1.4, 1.02),  # one and the slope of the envelope, positive
    ("hardening_negative", 0.7, 1.4, 1.02),
    ("strength_lost", 1e-4, 1.0, 0.01),  # with a unit of energy, positive
    ("strength_lost_negative", 1e-4, 1.0, 0.01),
    ("elastic", 0.01, 0.99, 0.1),  # share of elastic reloading, positive
    ("elastic_negative", 0.01, 0.99, 0.1),
    ("break_force", 0.02, 0.98, 0.5),  # over that of the peak
    ("break_displacement", 0.02, 0.98, 0.5),
    ("unloading", 1e-3, 1.0, 0.05),  # power of the ductility by which unloading softens
    ("softest", 1e-4, 0.5, 0.02),  # stiffness below which nothing falls
)
"""Traits of hysteresis towards peaks."""

REVERSAL_TRAITS: Final = (
    ("exponent", 1.0, 25.0, 4.0),  # of the bend
    ("exponent_lost", 0.01, 0.95, 0.3),  # share of it that large excursions take
    ("excursion", 0.02, 5.0, 0.5),  # beyond yielding that takes half of that, over the yield displacement
    ("hardening", 1e-3, 0.6, 0.05),  # slope of the line of yielding
    ("to_the_line", 0.01, 0.99, 0.5),  # 0: twice the first curve, 1: bends at the line of yielding
)
"""Traits of hysteresis from reversals."""

STRUT_TRAITS: Final = (
    ("side", 0.1, 10.0, 1.0),  # above one it buckles when positive
    ("buckling", 0.03, 3.0, 0.5),  # load at which it buckles over that at which it yields
    ("decline", 3e-3, 1.0, 0.05),  # share of that load lost for each yield displacement beyond buckling
    ("remains", 0.02, 0.95, 0.25),  # share of it that is left
    ("lost", 1e-3, 3.0, 0.05),  # with a yield displacement of buckling
    ("straightening", 0.02, 0.98, 0.4),  # stiffness of a buckled one while it is pulled straight
    ("hardening", 1e-3, 0.3, 0.02),  # slope of yielding
    ("straight_at", 0.05, 1.5, 0.8),  # over the largest place at which it yielded
)
"""Traits of a strut that buckles."""

_NEAREST = 0.05  # yield displacements, by which the line of yielding is away at least
_GONE = 30.0  # power of e to which nothing is left
_REACH_TOLERANCE = 1e-9  # yield displacements from a peak at which it is reached
_LARGEST_PART = 0.3  # of its yield displacement, by which an element goes on at once


@compiled
def smooth_pinched(size: float, traits: Array, increment: float, state: Array) -> float:
    """Baber and Noori; `state` holds force and energy, over size and its square."""
    exponent, weak, strength_loss, softening = traits[0], traits[1], traits[2], traits[3]
    parts = int(abs(increment) / (_LARGEST_PART * size)) + 1
    part = increment / size / parts
    for _ in range(parts):
        force, energy = state[0], state[1]
        sign = 1.0 if part > 0.0 else -1.0
        limit = (weak if force < 0.0 else 1.0) / (1.0 + strength_loss * energy)
        force_share = min(abs(force) / limit, 1.0) ** exponent
        stiffness = 1.0 - force_share if part * force > 0.0 else 1.0 - force_share * 0.5 * (1.0 - traits[9])
        slip = traits[4] * (1.0 - _decay(traits[5] * energy))
        width = (traits[7] + traits[8] * energy) * (traits[10] + slip)
        away = (force * sign - traits[6] * limit) / width
        pinch = 1.0 - slip * _decay(away * away)
        now = force + part * stiffness * pinch / (1.0 + softening * energy)
        now = min(max(now, -limit if force < 0.0 else now), limit if force >= 0.0 else now)
        state[0] = now
        state[1] = energy + max(0.5 * (now + force) * part, 0.0)
    return float(state[0] * size)


@compiled
def _decay(power: float) -> float:
    """E to the minus a power, without the library's cost where nothing is left."""
    return 0.0 if power > _GONE else 2.718281828459045**-power


@compiled
def load_towards_peaks(size: float, traits: Array, position: float, increment: float, state: Array) -> float:
    """Ibarra, Medina and Krawinkler; `state`: force, energy, places and forces of both peaks, over size."""
    weak, softest = traits[0], traits[10]
    if state[2] == 0.0:
        state[2], state[4], state[3], state[5] = 1.0, 1.0, -weak, -weak
    now, part = position / size, increment / size
    force, start = state[0], (position - increment) / size
    strength = 1.0 / (1.0 + traits[3] * state[1])
    strength_negative = weak / (1.0 + traits[4] * state[1])
    if part * force < 0.0:
        far = max(state[2], -state[3] / weak, 1.0)
        unloaded_force = force + part * max(far ** -traits[9], softest)
        resistance = unloaded_force if unloaded_force * force > 0.0 else 0.0
    elif part > 0.0:
        slope = _slope(
            start,
            force,
            state[2],
            min(state[4], strength * _envelope(state[2], traits[1])),
            traits[5],
            traits,
        )
        resistance = force + part * slope
    elif part < 0.0:
        peak = min(-state[5], strength_negative * _envelope(-state[3] / weak, traits[2]))
        resistance = force + part * _slope(-start, -force, -state[3], peak, traits[6], traits)
    else:
        resistance = force
    resistance = min(resistance, strength * _envelope(now, traits[1]))
    resistance = max(resistance, -strength_negative * _envelope(-now / weak, traits[2]))
    if now > state[2]:
        state[2], state[4] = now, resistance
    if now < state[3]:
        state[3], state[5] = now, resistance
    state[1] += max(0.5 * (resistance + force) * part, 0.0)
    state[0] = resistance
    return float(resistance * size)


@compiled
def load_towards_largest(size: float, position: float, increment: float, state: Array) -> float:
    """Elastic unloading, and loading towards the largest excursion so far, up to the yield displacement."""
    if state[1] == 0.0:
        state[1], state[2] = size, -size
    force, start = state[0], position - increment
    if increment * force < 0.0:
        unloaded_force = force + increment
        force = unloaded_force if unloaded_force * force > 0.0 else 0.0
    elif increment != 0.0:
        sign = 1.0 if increment > 0.0 else -1.0
        gap = sign * ((state[1] if increment > 0.0 else state[2]) - start)
        missing = size - sign * force
        slope = min(1.0, max(missing, 0.0) / gap) if gap > 1e-12 * size else (1.0 if missing > 0.0 else 0.0)
        force = min(max(force + slope * increment, -size), size)
    state[1], state[2] = max(state[1], position), min(state[2], position)
    state[0] = force
    return float(force)


@compiled
def _envelope(place: float, hardening: float) -> float:
    """Envelope over the strength at a place in units of its yield displacement."""
    return max(1.0 + (hardening - 1.0) * max(place - 1.0, 0.0), 0.1)


@compiled
def _slope(
    place: float, force: float, peak: float, peak_force: float, elastic: float, traits: Array
) -> float:
    """Stiffness while loading in the positive direction."""
    broken, break_force = traits[8] * peak, traits[7] * peak_force
    if place < broken and force < break_force:
        slope = (break_force - force) / (broken - place)
    else:
        distance, missing = peak - place, peak_force - force
        slope = missing / distance if distance > _REACH_TOLERANCE else 1.0
    return float(elastic + (1.0 - elastic) * min(max(slope, traits[10]), 1.0))


@compiled
def follow_reversals(size: float, traits: Array, position: float, increment: float, state: Array) -> float:
    """Menegotto and Pinto, or Masing; `state`: force, place and force of reversal, way, largest, scale."""
    now, part = position / size, increment / size
    hardening, way = traits[3], state[3]
    if part != 0.0:
        way = 1.0 if part > 0.0 else -1.0
    if state[5] == 0.0:
        state[5] = 1.0
    elif way != state[3]:
        state[1], state[2] = now - part, state[0]
        line = (1.0 - hardening + way * (hardening * state[1] - state[2])) / (1.0 - hardening)
        state[5] = 2.0 + traits[4] * (max(line, _NEAREST) - 2.0)
    state[3] = way
    excursion = max(state[4] - 1.0, 0.0)
    exponent = traits[0] * (1.0 - traits[1] * excursion / (traits[2] + excursion))
    position_on_branch = way * (now - state[1]) / state[5]
    force = way * state[2] + state[5] * _bent(max(position_on_branch, 0.0), hardening, exponent)
    if way * now > state[4]:
        force = min(force, _bent(way * now, hardening, traits[0]))
    state[4] = max(state[4], abs(now))
    state[0] = way * force
    return float(state[0] * size)


@compiled
def _bent(position: float, hardening: float, exponent: float) -> float:
    """Curve of unit slope that bends towards a line of yielding at one."""
    return float(position * (hardening + (1.0 - hardening) / (1.0 + position**exponent) ** (1.0 / exponent)))


@compiled
def strut(size: float, traits: Array, position: float, increment: float, state: Array) -> float:
    """Strut; `state`: force, way that it went buckled, place of yielding, and whether it buckled."""
    way = -1.0 if traits[0] > 1.0 else 1.0
    now, part = way * position / size, way * increment / size
    yields = 1.0 + traits[6] * max(now - 1.0, 0.0)
    strength = max(1.0 - traits[2] * max(-now - traits[1], 0.0), traits[3])
    buckles = -traits[1] * strength / (1.0 + traits[4] * state[1])
    force = state[0] + part
    if part > 0.0 and state[3] > 0.0 and force > 0.0 and now < traits[7] * state[2]:
        elastic = min(max(-state[0], 0.0), part)
        force = state[0] + elastic + traits[5] * (part - elastic)
    if force > yields:
        force, state[2] = yields, max(state[2], now)
    if force < buckles:
        state[1] += buckles - force
        force, state[3] = buckles, 1.0
    state[0] = force
    return float(way * force * size)
