"""Elements that together resist as a specimen does, and the response of a structure with them.

Each element gives a displacement [m] for a path of displacements; the specimen's force is their sum with
coefficients [N/m] that are not negative. The elements are

- elastic-plastic springs, of which many in parallel are the distributed-element model of Iwan (1966, Journal
  of Applied Mechanics 33, 893) and contain the rule of Masing,
- springs that harden, springs behind a gap on both sides or on one,
- dashpots of several powers of the velocity, and springs in series with a dashpot (Maxwell), whose force may
  grow with a power of the velocity, as in a fluid damper behind a brace,
- masses on springs and dashpots of their own, as tuned masses and liquid in tanks,
- smooth hysteresis with elastic unloading (Bouc and Wen),
- springs that soften with the largest excursion so far, gaps that open with it, and reloading towards the
  largest excursion (Clough and Johnston 1966),
- elastic-plastic springs that weaken with the energy of the test so far,
- springs that yield and return to where they began, along a flag or on the same way (Christopoulos,
  Filiatrault and Folz 2002),
- springs that are softer the farther they are below the largest excursion (the effect of Mullins), and
- four laws of hysteresis with traits that are searched for (`hysteresis`).
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.measured_specimen.hysteresis import (
    TRAITS,
    follow_reversals,
    load_towards_largest,
    load_towards_peaks,
    smooth_pinched,
    strut,
)
from reliab.assessment.rebuilt_error.recursion import Recursion, advance
from reliab.core.arrays import Array
from reliab.core.compiled import compiled

_FAR = 10.0  # times the largest displacement, beyond which nothing yields
_RESPONSE_LIMIT = 1e3  # times the largest command, within which a response stays
_STATES = 6
_SLOW = 1e-3  # of the largest speed, below which a dashpot is linear
_FINER = 1.012  # ratio of sizes below which two elements are one


class Kind(IntEnum):
    """Kinds of elements."""

    CONSTANT = 0
    ELASTIC_PLASTIC = 1
    CUBIC = 2
    QUINTIC = 3
    DASHPOT = 4
    MAXWELL = 5
    GAP = 6
    GAP_ABOVE = 7
    GAP_BELOW = 8
    SMOOTH = 9
    SOFTENING = 10
    OPENING_GAP = 11
    PEAK_ORIENTED = 12
    WEAKENING = 13
    MULLINS = 14
    SMOOTH_PINCHED = 15
    TOWARDS_PEAKS = 16
    FROM_REVERSALS = 17
    STRUT = 18
    SELF_CENTRING = 19
    FLUID_DAMPER = 20
    OSCILLATOR = 21


_SCALABLE: Final = frozenset(Kind) - {Kind.CONSTANT, Kind.CUBIC, Kind.QUINTIC, Kind.DASHPOT, Kind.MULLINS}
"""Kinds whose size is refined."""


@compiled
def _smooth(size: float, shape: float, increment: float, state: Array) -> float:
    """Unload elastically, and yield by dz/dx = 1 − z (shape 1) or 1 − z² (shape 2), solved exactly."""
    sign = 1.0 if increment > 0.0 else -1.0
    force, remainder = sign * state[0], abs(increment) / size
    if force < 0.0:
        unloading = min(remainder, -force)
        force, remainder = force + unloading, remainder - unloading
    if remainder > 0.0:
        if shape == 1.0:
            force = 1.0 - (1.0 - force) * np.exp(-remainder)
        else:
            way = np.tanh(remainder)
            force = (force + way) / (1.0 + force * way)
    state[0] = sign * force
    return float(state[0] * size)


@compiled
def _stretch(size: float, shape: float, increment: float, relaxation: float, state: Array) -> float:
    """Stretch a spring behind a dashpot of a power below one: half the step before it yields, half after.

    `relaxation` [m]: way of the dashpot during a step when the spring is stretched by `size`. Without motion
    the stretch u follows u' = −sgn(u)·relaxation/step·(|u|/size)^(1/shape), solved exactly.
    """
    stretch = state[0] + 0.5 * increment
    power = 1.0 / shape - 1.0
    if stretch != 0.0:
        left = (abs(stretch) / size) ** -power + power * relaxation / size
        stretch = np.copysign(size * left ** (-1.0 / power), stretch)
    state[0] = stretch + 0.5 * increment
    return float(state[0])


@compiled
def _swing(
    period: float, damping_ratio: float, position: float, velocity: float, step: float, state: Array
) -> float:
    """Acceleration of a mass on a spring and a dashpot, times the square of period/2π [m].

    By Newmark's method of average acceleration.
    """
    rate = 2.0 * np.pi / period
    place = state[0] + step * state[1] + 0.25 * step**2 * state[2]
    speed = state[1] + 0.5 * step * state[2]
    pull = 2.0 * damping_ratio * rate * (velocity - speed) + rate**2 * (position - place)
    pull /= 1.0 + damping_ratio * rate * step + 0.25 * (rate * step) ** 2
    state[0], state[1], state[2] = place + 0.25 * step**2 * pull, speed + 0.5 * step * pull, pull
    return float(pull / rate**2)


@compiled
def _advance(  # noqa: C901, PLR0911, PLR0912 - one branch for each kind of element
    kind: int,
    size: float,
    shape: float,
    position: float,
    increment: float,
    velocity: float,
    step: float,
    weakness: float,
    traits: Array,
    speed: float,
    state: Array,
) -> float:
    """Displacement of one element [m] at the end of a step; its state is changed in place.

    `size` [m], of Maxwell's element and of an oscillator [s], of an opening gap [-]; `shape`: an exponent,
    the share by which a flag unloads lower, or a damping ratio; `speed` at which a dashpot gives its size
    [m/s].
    """
    if kind in (Kind.ELASTIC_PLASTIC, Kind.WEAKENING):
        state[0] = min(max(state[0] + increment, -size), size)
        return float(state[0] * weakness if kind == Kind.WEAKENING else state[0])
    if kind == Kind.SELF_CENTRING:
        low = (1.0 - shape) * size
        upper, lower = min(max(position, -low), size), min(max(position, -size), low)
        state[0] = min(max(state[0] + increment, lower), upper)
        return float(state[0])
    if kind == Kind.CUBIC:
        return position**3 / size**2
    if kind == Kind.QUINTIC:
        return position**5 / size**4
    if kind == Kind.DASHPOT:
        relative = velocity / speed
        return float(size * relative * max(abs(relative), _SLOW) ** (shape - 1.0))
    if kind == Kind.MAXWELL:
        state[0] = state[0] * np.exp(-step / size) + increment
        return float(state[0])
    if kind == Kind.FLUID_DAMPER:
        return _stretch(size, shape, increment, speed * step, state)
    if kind == Kind.OSCILLATOR:
        return _swing(size, shape, position, velocity, step, state)
    if kind == Kind.GAP:
        return position - min(max(position, -size), size)
    if kind == Kind.GAP_ABOVE:
        return max(position - size, 0.0)
    if kind == Kind.GAP_BELOW:
        return min(position + size, 0.0)
    if kind == Kind.SMOOTH:
        return _smooth(size, shape, increment, state)
    if kind == Kind.SOFTENING:
        state[1] = max(state[1], abs(position))
        return float(position * min(1.0, size / state[1])) if state[1] > 0.0 else 0.0
    if kind == Kind.OPENING_GAP:
        state[1] = max(state[1], abs(position))
        gap = size * state[1]
        return float(position - min(max(position, -gap), gap))
    if kind == Kind.PEAK_ORIENTED:
        return load_towards_largest(size, position, increment, state)
    if kind == Kind.MULLINS:
        state[1] = max(state[1], abs(position))
        return float(position * (abs(position) / state[1]) ** shape) if state[1] > 0.0 else 0.0
    if kind == Kind.SMOOTH_PINCHED:
        return smooth_pinched(size, traits, increment, state)
    if kind == Kind.TOWARDS_PEAKS:
        return load_towards_peaks(size, traits, position, increment, state)
    if kind == Kind.FROM_REVERSALS:
        return follow_reversals(size, traits, position, increment, state)
    if kind == Kind.STRUT:
        return strut(size, traits, position, increment, state)
    return size


@compiled
def _velocity(now: float, previous: float, earlier: float, step: float, place: int) -> float:
    """Velocity at the end of a step [m/s], from this and the two former displacements."""
    if place == 0:
        return 0.0
    if place == 1:
        return (now - previous) / step
    return (3.0 * now - 4.0 * previous + earlier) / (2.0 * step)


@compiled
def _weakness(kind: int, shape: float, weakness: float) -> float:
    """Share of an element that is left, or the share that has gone where its shape is one."""
    return (weakness if shape == 1.0 else 1.0 - weakness) if kind == Kind.WEAKENING else 1.0


@compiled
def _follow_path(
    kinds: NDArray[np.int64],
    sizes: Array,
    shapes: Array,
    traits: Array,
    speed: float,
    path: Array,
    step: float,
    energy: Array,
) -> Array:
    """Displacements of elements along a path [m], shape (elements, n)."""
    answer = np.empty((kinds.size, path.size))
    for element in range(kinds.size):
        state = np.zeros(_STATES)
        kind, shape = kinds[element], shapes[element]
        for i in range(path.size):
            previous = path[i - 1] if i > 0 else 0.0
            earlier = path[i - 2] if i > 1 else 0.0
            velocity = _velocity(path[i], previous, earlier, step, i)
            answer[element, i] = _advance(
                kind,
                sizes[element],
                shape,
                path[i],
                path[i] - previous,
                velocity,
                step,
                _weakness(kind, shape, energy[i]),
                traits[element],
                speed,
                state,
            )
    return answer


@compiled
def _respond(
    kinds: NDArray[np.int64],
    sizes: Array,
    shapes: Array,
    traits: Array,
    coefficients: Array,
    speed: float,
    command: Array,
    test_force: Array,
    step: float,
    energy: Array,
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
) -> Array:
    """Exact response [m]; see `Elements.respond`."""
    states = np.zeros((kinds.size, _STATES))
    answer = np.empty(command.size)
    state, scratch = np.zeros(early.shape[0]), np.zeros(early.shape[0])
    forces = np.zeros((1, 2))
    wrong, wrong_before, previous, earlier = 0.0, 0.0, 0.0, 0.0
    limit = _RESPONSE_LIMIT * np.abs(command).max()
    for i in range(command.size):
        foreseen = 2.0 * wrong - wrong_before if i > 1 else wrong
        if i > 0:
            forces[0, 0], forces[0, 1] = wrong, foreseen
            advance((0,), transition, early, late, forces, 1, state, scratch)
        now = command[i]
        for row in range(state.size):
            now -= output[row] * state[row]
        if not abs(now) <= limit:  # diverges; some elements take the longer the farther they are moved
            answer[i:] = np.nan
            return answer
        velocity = _velocity(now, previous, earlier, step, i)
        force = 0.0
        for element in range(kinds.size):
            kind, shape = kinds[element], shapes[element]
            force += coefficients[element] * _advance(
                kind,
                sizes[element],
                shape,
                now,
                now - previous,
                velocity,
                step,
                _weakness(kind, shape, energy[i]),
                traits[element],
                speed,
                states[element],
            )
        answer[i] = now
        earlier, previous = previous, now
        wrong_before, wrong = wrong, force - test_force[i]
        if i > 0:
            state += late * (wrong - foreseen)
    return answer


@dataclass(frozen=True, kw_only=True, eq=False)
class Elements:
    """Elements in parallel."""

    kinds: NDArray[np.int64]  # Kind of each, shape (elements,)
    sizes: Array  # Yield displacement, gap or unit [m], time or period [s], shape (elements,)
    # Exponent of a dashpot or of smooth hysteresis, share of one that weakens or of a flag, damping ratio of
    # a mass, shape (elements,)
    shapes: Array
    speed: float  # Velocity at which a dashpot gives its size [m/s]
    # Of laws of hysteresis, zero for all others, shape (elements, TRAITS)
    traits: Array = field(default_factory=lambda: np.zeros((0, TRAITS)))

    def __post_init__(self) -> None:
        if not self.traits.size:
            object.__setattr__(self, "traits", np.zeros((self.kinds.size, TRAITS)))

    def follow_path(self, path: Array, step: float, energy: Array) -> Array:
        """Displacements along a path [m], shape (elements, n); `energy`: energy so far [-]."""
        return np.asarray(
            _follow_path(self.kinds, self.sizes, self.shapes, self.traits, self.speed, path, step, energy)
        )

    def respond(
        self,
        coefficients: Array,
        command: Array,
        test_force: Array,
        step: float,
        energy: Array,
        numerical: Recursion,
    ) -> Array:
        """Response that a perfect actuator would have given [m], shape (n,).

        M g'' + C g' + K g = γ (f[y] − f[x_m]), y = x_c − γᵀg, with the force at the end of each step foreseen
        along a straight line, and put right once it is known. `test_force` is f[x_m] [N], `numerical` the
        recursion of the numerical substructure from force to γᵀg.
        """
        return np.asarray(
            _respond(
                self.kinds,
                self.sizes,
                self.shapes,
                self.traits,
                coefficients,
                self.speed,
                command,
                test_force,
                step,
                energy,
                numerical.transition,
                numerical.early,
                numerical.late,
                numerical.output[0],
            )
        )

    def only(self, selection: NDArray[np.bool_] | NDArray[np.int64]) -> "Elements":
        """Only some of the elements."""
        return Elements(
            kinds=self.kinds[selection],
            sizes=self.sizes[selection],
            shapes=self.shapes[selection],
            speed=self.speed,
            traits=self.traits[selection],
        )

    def replace_law(self, law: "Elements") -> "Elements":
        """Put another size and other traits in the place of the law of the same kind."""
        is_law = self.kinds == law.kinds
        return replace(
            self,
            sizes=np.where(is_law, law.sizes, self.sizes),
            traits=np.where(is_law[:, np.newaxis], law.traits, self.traits),
        )

    def append(self, additions: "Elements") -> "Elements":
        """Put others beside these elements."""
        return Elements(
            kinds=np.concatenate([self.kinds, additions.kinds]),
            sizes=np.concatenate([self.sizes, additions.sizes]),
            shapes=np.concatenate([self.shapes, additions.shapes]),
            speed=self.speed,
            traits=np.vstack([self.traits, additions.traits]),
        )

    def refine(self, coefficients: Array, ratio: float, peak: float) -> "Elements":
        """Elements that bear a part, and beside each of them one smaller and one larger by a ratio.

        `peak` displacement [m]: what is far beyond it never yields, and has no size.
        """
        rows = [
            (kind, factor * size, shape)
            for kind, size, shape, coefficient in zip(
                self.kinds, self.sizes, self.shapes, coefficients, strict=True
            )
            if coefficient > 0.0 or size >= _FAR * peak
            for factor in (
                (1.0 / ratio, 1.0, ratio) if Kind(kind) in _SCALABLE and 0.0 < size < _FAR * peak else (1.0,)
            )
        ]
        return list_elements(rows, self.speed)


def list_elements(rows: Iterable[tuple[int, float, float]], speed: float) -> Elements:
    """Elements of kind, size and shape, each once; `speed` at which a dashpot gives its size [m/s]."""
    once = {
        (kind, np.sign(size), round(np.log(abs(size) + 1e-300) / np.log(_FINER)), shape): (kind, size, shape)
        for kind, size, shape in rows
    }
    kinds, sizes, shapes = zip(*once.values(), strict=True)
    return Elements(
        kinds=np.array(kinds, dtype=np.int64),
        sizes=np.array(sizes, dtype=np.float64),
        shapes=np.array(shapes, dtype=np.float64),
        speed=speed,
    )


def law_with_traits(kind: Kind, size: float, traits: Array, speed: float) -> Elements:
    """One law of hysteresis."""
    return Elements(
        kinds=np.array([kind], dtype=np.int64),
        sizes=np.array([size]),
        shapes=np.zeros(1),
        speed=speed,
        traits=np.pad(traits, (0, TRAITS - traits.size))[np.newaxis],
    )
