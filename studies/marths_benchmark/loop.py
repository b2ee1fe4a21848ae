"""The virtual multi-axial test, step by step as the benchmark's block diagram does it.

The computer's part is integrated by Newmark's method (β = 1/4, γ = 1/2), here in the form that relates three
samples of the displacements, K₊U₊ = p₊ + 2p + p₋ − K₀U − K₋U₋, which is the same. Actuators stand behind a
zero-order hold; the specimen's force is that of the displacements as the sensors read them.
"""

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

from .controllers import Controller, filter_coefficients
from .plant import CoupledPlant
from .structure import ANGLE, ARM, NEIGHBOUR, RATE, THETA, X, substructures, to_actuators

NOISE: Final = 1.5e-7 * RATE
"""Variance of the sensors' noise [mm²]; both sensors share one history, as in the benchmark."""

_SHOWN: Final = (*X, *THETA)


@dataclass(frozen=True, kw_only=True, eq=False)
class MultiAxialRun:
    """Histories of a virtual test at 1024 Hz."""

    target: Array  # target, measured, true: Of the actuators [mm], shape (2, n); `true` without noise
    measured: Array
    true: Array
    numerical: Array  # x [m] of storeys 1, 2, 3 and rotations [rad] above each other, shape (6, n)


def run_test(
    ground: Array, plant: CoupledPlant, controller: Controller, *, seed: int | None = 0
) -> MultiAxialRun:
    """Run a test; without a seed there is no noise.

    `ground`: scaled acceleration at 1024 Hz [m/s²], shape (n,).
    """
    parts, step = substructures(), 1.0 / RATE
    noise = np.zeros(ground.size)
    if seed is not None:
        noise = np.sqrt(NOISE) * np.random.default_rng([seed, 41]).standard_normal(ground.size)
    numerator, denominator = filter_coefficients()
    histories = np.zeros((12, ground.size))
    march(
        *newmark(),
        np.ascontiguousarray(ground),
        (parts.specimen_stiffness, parts.specimen_damping / step, parts.specimen_mass / step**2),
        np.array([X[0], THETA[0], NEIGHBOUR]),
        np.array(_SHOWN),
        plant.sampled(step),
        (
            controller.dynamics,
            controller.targets,
            controller.states,
            controller.direct,
            controller.readings,
        ),
        controller.coefficients.copy(),
        controller.covariance.copy(),
        numerator,
        denominator,
        noise,
        (ARM, ANGLE),
        histories,
    )
    return MultiAxialRun(
        target=histories[:2], measured=histories[2:4], true=histories[4:6], numerical=histories[6:]
    )


def run_perfect(ground: Array) -> MultiAxialRun:
    """Run the test with actuators that move as they are told at once, x_m = x_c, and without noise.

    The specimen's force then belongs to the displacements of the same sample, for which it is solved.
    """
    parts, step = substructures(), 1.0 / RATE
    histories = np.zeros((len(_SHOWN), ground.size))
    _march_perfect(
        *newmark(),
        np.ascontiguousarray(ground),
        (parts.specimen_stiffness, parts.specimen_damping / step, parts.specimen_mass / step**2),
        np.array([X[0], THETA[0], NEIGHBOUR]),
        np.array(_SHOWN),
        histories,
    )
    target = to_actuators(histories[0], -histories[3])
    return MultiAxialRun(target=target, measured=target, true=target, numerical=histories)


def reference(ground: Array) -> Array:
    """Displacements of the undivided structure by the same method [m, rad], as in `numerical`."""
    parts = substructures()
    _, now, before, load = _coefficients(parts.mass, parts.damping, parts.stiffness)
    histories = np.zeros((len(_SHOWN), ground.size))
    _integrate(now, before, load, np.ascontiguousarray(ground), np.array(_SHOWN), histories)
    return histories


@cache
def newmark() -> tuple[Array, Array, Array, Array]:
    """K₊⁻¹, K₊⁻¹K₀, K₊⁻¹K₋ and K₊⁻¹Mι of the computer's part."""
    parts = substructures()
    later, now, before, load = _coefficients(
        parts.numerical_mass, parts.numerical_damping, parts.numerical_stiffness
    )
    return later, now, before, load


def _coefficients(mass: Array, damping: Array, stiffness: Array) -> tuple[Array, Array, Array, Array]:
    """K₊⁻¹, K₊⁻¹K₀, K₊⁻¹K₋ and K₊⁻¹Mι."""
    per_step = 2.0 * RATE
    later = np.asarray(np.linalg.inv(per_step**2 * mass + per_step * damping + stiffness), dtype=np.float64)
    now = later @ (2.0 * stiffness - 2.0 * per_step**2 * mass)
    before = later @ (per_step**2 * mass - per_step * damping + stiffness)
    load = later @ (mass @ substructures().influence)
    return later, now, before, load


@compiled
def _step(
    now: Array, before: Array, load: Array, pushed: float, current: Array, earlier: Array, moved: Array
) -> None:
    """Where the computer's part moves under the ground alone: a step of its recursion."""
    for i in range(load.size):
        total = -load[i] * pushed
        for j in range(load.size):
            total -= now[i, j] * current[j] + before[i, j] * earlier[j]
        moved[i] = total


@compiled
def _keep(current: Array, earlier: Array, moved: Array) -> None:
    for i in range(moved.size):
        earlier[i], current[i] = current[i], moved[i]


@compiled
def _show(current: Array, shown: Array, row: Array) -> None:
    for place in range(shown.size):
        row[place] = current[shown[place]]


@compiled
def _integrate(now: Array, before: Array, load: Array, ground: Array, shown: Array, histories: Array) -> None:
    size = load.size
    current, earlier, moved = np.zeros(size), np.zeros(size), np.zeros(size)
    for k in range(1, ground.size):
        pushed = ground[k] + 2.0 * ground[k - 1] + (ground[k - 2] if k > 1 else 0.0)
        _step(now, before, load, pushed, current, earlier, moved)
        _keep(current, earlier, moved)
        _show(current, shown, histories[:, k])


@compiled
def _march_perfect(  # noqa: C901, PLR0912 - a compiled kernel
    later: Array,
    now: Array,
    before: Array,
    load: Array,
    ground: Array,
    specimen: tuple[Array, Array, Array],
    driven: Array,
    shown: Array,
    histories: Array,
) -> None:
    stiffness, damping, mass = specimen
    size = load.size
    current, earlier, moved = np.zeros(size), np.zeros(size), np.zeros(size)
    at_once = stiffness + damping + mass  # force per displacement of the same sample
    pushes = np.empty((size, 3))
    for j in range(3):
        for i in range(size):
            pushes[i, j] = -later[i, driven[j]] if j == 0 else later[i, driven[j]]
    answer = np.empty((2, 3))
    for j in range(3):
        answer[0, j], answer[1, j] = pushes[driven[0], j], -pushes[driven[1], j]
    closing = np.eye(2)
    for i in range(2):
        for j in range(2):
            for row in range(3):
                closing[i, j] -= answer[i, row] * at_once[row, j]
    determinant = closing[0, 0] * closing[1, 1] - closing[0, 1] * closing[1, 0]
    node = np.zeros((3, 2))
    force, force_before, force_earlier = np.zeros(3), np.zeros(3), np.zeros(3)
    for k in range(1, ground.size):
        for i in range(2):
            node[2, i], node[1, i] = node[1, i], node[0, i]
        for i in range(3):
            force_earlier[i], force_before[i] = force_before[i], force[i]
            force[i] = 0.0
            for j in range(2):
                force[i] -= damping[i, j] * node[1, j] + mass[i, j] * (2.0 * node[1, j] - node[2, j])
        pushed = ground[k] + 2.0 * ground[k - 1] + (ground[k - 2] if k > 1 else 0.0)
        _step(now, before, load, pushed, current, earlier, moved)
        for i in range(size):
            for j in range(3):
                moved[i] += pushes[i, j] * (force[j] + 2.0 * force_before[j] + force_earlier[j])
        x, theta = moved[driven[0]], -moved[driven[1]]
        node[0, 0] = (closing[1, 1] * x - closing[0, 1] * theta) / determinant
        node[0, 1] = (closing[0, 0] * theta - closing[1, 0] * x) / determinant
        for j in range(3):
            added = at_once[j, 0] * node[0, 0] + at_once[j, 1] * node[0, 1]
            force[j] += added
            for i in range(size):
                moved[i] += pushes[i, j] * added
        _keep(current, earlier, moved)
        _show(current, shown, histories[:, k])


@compiled
def march(  # noqa: C901, PLR0912, PLR0915 - a compiled kernel
    later: Array,
    now: Array,
    before: Array,
    load: Array,
    ground: Array,
    specimen: tuple[Array, Array, Array],
    driven: Array,
    shown: Array,
    plant: tuple[Array, Array, Array],
    controller: tuple[Array, Array, Array, Array, Array],
    coefficients: Array,
    covariance: Array,
    numerator: Array,
    denominator: Array,
    noise: Array,
    geometry: tuple[float, float],
    histories: Array,
) -> None:
    """Step a whole test."""
    stiffness, damping, mass = specimen
    a, b, c = plant
    ca, cb, cc, cd, ce = controller
    arm, angle = geometry
    size, order, states = load.size, a.shape[0], ca.shape[0]
    current, earlier, moved = np.zeros(size), np.zeros(size), np.zeros(size)
    state, advanced = np.zeros(order), np.zeros(order)
    filtering, filtered = np.zeros(states), np.zeros(states)
    target, sent, measured = np.zeros(2), np.zeros(2), np.zeros(2)
    node = np.zeros((3, 2))  # x and θ as measured at the last three samples
    force, force_before, force_earlier = np.zeros(3), np.zeros(3), np.zeros(3)
    learns = coefficients.shape[0] > 0
    targets = np.zeros((2, 4))
    taps = denominator.size
    raw = np.zeros((4, taps))
    smooth = np.zeros((4, taps))
    regressor = np.zeros((2, 4))
    gained = np.zeros(4)
    for k in range(ground.size):
        # the force of the displacements that were measured last
        for i in range(2):
            node[2, i], node[1, i] = node[1, i], node[0, i]
        for i in range(2):
            total = 0.0
            for j in range(order):
                total += c[i, j] * state[j]
            histories[4 + i, k] = total
            measured[i] = total + noise[k]
            histories[2 + i, k] = measured[i]
        turned = np.arcsin(1e-3 * (measured[0] - measured[1]) / (2.0 * arm * np.sin(angle)))
        node[0, 0] = 1e-3 * measured[0] + arm * (np.cos(angle) - np.cos(turned - angle))
        node[0, 1] = turned
        for i in range(3):
            force_earlier[i], force_before[i] = force_before[i], force[i]
            total = 0.0
            for j in range(2):
                total += stiffness[i, j] * node[0, j] + damping[i, j] * (node[0, j] - node[1, j])
                total += mass[i, j] * (node[0, j] - 2.0 * node[1, j] + node[2, j])
            force[i] = total
        # the computer's part
        if k > 0:
            pushed = ground[k] + 2.0 * ground[k - 1] + (ground[k - 2] if k > 1 else 0.0)
            _step(now, before, load, pushed, current, earlier, moved)
            for i in range(size):
                for j in range(3):
                    sign = -1.0 if j == 0 else 1.0
                    moved[i] += (
                        sign * later[i, driven[j]] * (force[j] + 2.0 * force_before[j] + force_earlier[j])
                    )
            _keep(current, earlier, moved)
        _show(current, shown, histories[6:, k])
        theta = -current[driven[1]]
        for i in range(2):
            at = -angle if i == 0 else angle
            target[i] = 1e3 * (current[driven[0]] + arm * (np.cos(theta + at) - np.cos(at)))
            histories[i, k] = target[i]
        # the controller
        for i in range(2):
            total = cd[i, 0] * target[0] + cd[i, 1] * target[1]
            for j in range(states):
                total += cc[i, j] * filtering[j]
            sent[i] = total
        for i in range(states):
            total = cb[i, 0] * target[0] + cb[i, 1] * target[1]
            total += ce[i, 0] * measured[0] + ce[i, 1] * measured[1]
            for j in range(states):
                total += ca[i, j] * filtering[j]
            filtered[i] = total
        for i in range(states):
            filtering[i] = filtered[i]
        if learns:
            for i in range(2):
                for tap in range(3, 0, -1):
                    targets[i, tap] = targets[i, tap - 1]
                targets[i, 0] = target[i]
                sent[i] = 0.0
                for tap in range(4):
                    sent[i] += coefficients[i, tap] * targets[i, tap]
                for source in range(2):
                    row = 2 * i + source
                    for tap in range(taps - 1, 0, -1):
                        raw[row, tap], smooth[row, tap] = raw[row, tap - 1], smooth[row, tap - 1]
                    raw[row, 0] = measured[i] if source == 0 else sent[i]
                    total = numerator[0] * raw[row, 0]
                    for tap in range(1, taps):
                        total += numerator[tap] * raw[row, tap] - denominator[tap] * smooth[row, tap]
                    smooth[row, 0] = total
                for tap in range(3, 0, -1):
                    regressor[i, tap] = regressor[i, tap - 1]
                regressor[i, 0] = smooth[2 * i, 0]
                scale, missed = 1.0, smooth[2 * i + 1, 0]
                for row in range(4):
                    gained[row] = 0.0
                    for column in range(4):
                        gained[row] += covariance[i, row, column] * regressor[i, column]
                    scale += regressor[i, row] * gained[row]
                    missed -= coefficients[i, row] * regressor[i, row]
                for row in range(4):
                    coefficients[i, row] += gained[row] * missed / scale
                    for column in range(4):
                        covariance[i, row, column] -= gained[row] * gained[column] / scale
        # the plant
        for i in range(order):
            total = b[i, 0] * sent[0] + b[i, 1] * sent[1]
            for j in range(order):
                total += a[i, j] * state[j]
            advanced[i] = total
        for i in range(order):
            state[i] = advanced[i]
