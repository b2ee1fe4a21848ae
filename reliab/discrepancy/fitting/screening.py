"""How much an effect promises to explain beside a fitted model, to first order."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.spectra.segment import split_by_segment
from reliab.effects.effect import Effect, Role
from reliab.effects.general.periodic import Disturbance, disturbance
from reliab.signals.noise import near_mains

_WORKERS = 2
_HIGH = 25.0  # times the noise's power, on the average of the segments
_LOWEST = 0.2  # Hz
_NEAR_ZERO = 2  # frequencies of a segment above zero that cannot be told from a drift


@dataclass(frozen=True, kw_only=True, eq=False)
class Promise:
    """How much an effect promises to explain beside a fitted model."""

    kind: type[Effect]  # The effect
    gain: float  # Gain of log-likelihood, to first order
    start: Array  # Coordinates from which to fit
    others: tuple[Array, ...] = ()  # Coordinates that promised less


def screen_effects(problem: Problem, parent: Fit, kinds: Sequence[type[Effect]], null: Fit) -> list[Promise]:
    """Rank effects by what they promise to explain beside a model."""
    fresh = [kind for kind in kinds if kind not in parent.space.effects]
    if not fresh:
        return []
    basis = np.linalg.qr(parent.jacobian[:, parent.free])[0]
    sketch_residual = problem.sketch.whiten(parent.space, parent.coordinates, parent.noise)
    with ThreadPoolExecutor(_WORKERS) as pool:
        promises = pool.map(
            lambda kind: _screen_effect(problem, parent, sketch_residual, basis, kind, null), fresh
        )
        rows = sorted(promises, key=lambda candidate: -candidate.gain)
    if not problem.flat:
        return rows
    total_energy = 0.5 * float(parent.residual @ parent.residual)
    return [
        replace(candidate, gain=-total_energy * np.log1p(-min(candidate.gain / total_energy, 0.99)))
        for candidate in rows
    ]


def _screen_effect(
    problem: Problem, parent: Fit, sketch_residual: Array, basis: Array, kind: type[Effect], null: Fit
) -> Promise:
    space = ModelSpace(parent.space.block, (*parent.space.effects, kind))
    best = Promise(kind=kind, gain=0.0, start=np.zeros(0))
    for begin in space.starts(parent.space, parent.coordinates):
        start = begin
        change = problem.sketch.whiten(space, start, parent.noise) - sketch_residual
        change -= basis @ (basis.T @ change)
        size = float(change @ change)
        projection = -float(parent.residual @ change)
        if size <= 0.0 or (projection < 0.0 and not kind.parameters[0].signed):
            continue
        gain = 0.5 * projection**2 / size
        start = space.scale_size(start, kind, projection / size)
        if gain > best.gain or best.start.size == 0:
            best = Promise(kind=kind, gain=gain, start=start, others=(*best.others, start))
        else:
            best = replace(best, others=(*best.others, start))
    return _screen_uncalibrated(problem, parent, sketch_residual, space, best) if parent is null else best


def _screen_uncalibrated(
    problem: Problem, parent: Fit, sketch_residual: Array, space: ModelSpace, best: Promise
) -> Promise:
    """Start from the nominal rig where that promises more.

    A calibration that has made up for an actuator at its limits has moved the model away from them.
    """
    for start in space.starts(parent.space, np.zeros(parent.space.size)):
        residual = problem.sketch.whiten(space, start, parent.noise)
        gain = 0.5 * float(sketch_residual @ sketch_residual - residual @ residual)
        if gain > best.gain:
            best = replace(best, gain=gain, start=start)
    return best


def line_terms(problem: Problem, fit: Fit) -> tuple[type[Disturbance], ...]:
    """Make a term of the strongest line in a model's residual, if one stands out and is not mains pickup."""
    longest = max(problem.segments, key=lambda segment: segment.end - segment.begin)
    frequency = longest.frequency
    if frequency.size <= _NEAR_ZERO + 1:
        return ()
    powers = []
    for segment, rows in split_by_segment(problem.segments, fit.residual):
        real, imaginary = rows[1 : segment.bins], rows[segment.bins :]
        power = np.concatenate([rows[:1] ** 2, 0.5 * (real**2 + imaginary**2)])
        powers.append(np.interp(frequency, segment.frequency, power))
    power = np.mean(powers, axis=0)
    power[: _NEAR_ZERO + 1] = 0.0
    power[(frequency < _LOWEST) | near_mains(frequency, 0.5 * problem.block.rate)] = 0.0
    place = int(np.argmax(power))
    if power[place] < _HIGH:
        return ()
    role = Role.FORCE if problem.block.block is Block.SPECIMEN else Role.DISPLACEMENT_READING
    return (disturbance(role, float(frequency[place]), float(frequency[1])),)
