"""The two coupled actuators of the multi-axial benchmark, nominal or drawn from their uncertainty."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum

NOMINAL: Final = "nominal"
"""What the plant of the benchmark is called in results; others by their number."""

_PI: Final = np.pi
_FRAME_POLE: Final = complex(-100.0 * _PI, 126.0 * _PI)
_LOWEST: Final = 2.0 * _PI * 0.01  # rad/s at which the gain of a drawn plant is that of the nominal one
_DEVIATIONS: Final = {"zeros 1": 0.055, "poles 1": 0.06, "zeros 2": 0.03, "poles 2": 0.03, "frame": 0.05}


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledPlant:
    """Measured displacements of both actuators for commands [mm]: two inputs, each with its own poles."""

    name: str
    numerators: tuple[tuple[Array, Array], tuple[Array, Array]]  # By actuator that moves, then command
    denominators: tuple[Array, Array]  # By command

    def transfer(self, s: Spectrum) -> Spectrum:
        """H(s), shape (…, 2, 2)."""
        rows = [
            [
                np.polyval(numerator, s) / np.polyval(denominator, s)
                for numerator, denominator in zip(row, self.denominators, strict=True)
            ]
            for row in self.numerators
        ]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def sampled(self, step: float) -> tuple[Array, Array, Array]:
        """Return A, B and C of the plant behind a zero-order hold of a step [s]."""
        dynamics, commands, outputs = [], [], []
        for command, denominator in enumerate(self.denominators):
            a, b, c = _companion(denominator, [row[command] for row in self.numerators])
            dynamics.append(a)
            commands.append(np.outer(b, np.eye(2)[command]))
            outputs.append(c)
        a, b = scipy.linalg.block_diag(*dynamics), np.vstack(commands)
        order = len(a)
        joint = np.zeros((order + 2, order + 2))
        joint[:order, :order], joint[:order, order:] = a * step, b * step
        held = scipy.linalg.expm(joint)
        return held[:order, :order], held[:order, order:], np.hstack(outputs)


def nominal_plant() -> CoupledPlant:
    """Return the plant of the benchmark.

    >>> gains = abs(nominal_plant().transfer(np.array([2j * np.pi]))[0])
    >>> gains.round(3)
    array([[0.808, 0.133],
           [0.131, 0.907]])
    """
    return _plant(NOMINAL, np.ones(9), rescaled=False)


def draw_plants(count: int, seed: int) -> list[CoupledPlant]:
    """Uncertain plants, numbered from 1; the first of them are the same whatever their number.

    Zeros and real poles of each command, and the frame's complex pole, are multiplied by 1 + σ times a
    standard normal number. Gains at the lowest frequency stay those of the nominal plant.
    """
    generator = np.random.default_rng([seed, 2023])
    deviations = np.array(
        [
            *[_DEVIATIONS["zeros 1"]] * 2,
            *[_DEVIATIONS["poles 1"]] * 2,
            *[_DEVIATIONS["zeros 2"]] * 2,
            *[_DEVIATIONS["poles 2"]] * 2,
            _DEVIATIONS["frame"],
        ]
    )
    draws = (1.0 + deviations * generator.standard_normal(deviations.size) for _ in range(count))
    return [_plant(str(number), factors, rescaled=True) for number, factors in enumerate(draws, start=1)]


def _plant(name: str, factors: Array, *, rescaled: bool) -> CoupledPlant:
    frame = np.real(np.poly([factors[8] * _FRAME_POLE, factors[8] * np.conj(_FRAME_POLE)]))
    zeros = np.array([240.0, 180.0, 6.0, 10.0]) * _PI * factors[[0, 1, 4, 5]]
    poles = np.array([5.3, 80.0, 7.0, 37.0]) * _PI * factors[[2, 3, 6, 7]]
    shared = np.asarray(np.poly(-zeros[:2]), dtype=np.float64)
    numerators = (
        (2165.2 * shared, 4.5394e6 * np.array([1.0, zeros[2]])),
        (349.95 * shared, 1.9238e7 * np.array([1.0, zeros[3]])),
    )
    denominators = np.polymul(np.poly(-poles[:2]), frame), np.polymul(np.poly(-poles[2:]), frame)
    plant = CoupledPlant(name=name, numerators=numerators, denominators=denominators)
    if not rescaled:
        return plant
    s = np.array([1j * _LOWEST])
    scale = np.abs(nominal_plant().transfer(s)[0]) / np.abs(plant.transfer(s)[0])
    return CoupledPlant(
        name=name,
        numerators=(
            (scale[0, 0] * numerators[0][0], scale[0, 1] * numerators[0][1]),
            (scale[1, 0] * numerators[1][0], scale[1, 1] * numerators[1][1]),
        ),
        denominators=denominators,
    )


def _companion(denominator: Array, numerators: list[Array]) -> tuple[Array, Array, Array]:
    """State of one denominator and two numerators of lower order, in a time that suits its poles."""
    order = denominator.size - 1
    scale = float(np.abs(denominator[-1] / denominator[0]) ** (1.0 / order))
    powers = scale ** np.arange(order, -1, -1.0)
    monic = denominator / denominator[0] / scale**order * powers
    dynamics = np.eye(order, k=1)
    dynamics[-1] = -monic[:0:-1]
    rows = np.zeros((len(numerators), order))
    for place, numerator in enumerate(numerators):
        row = (numerator / denominator[0] / scale**order * powers[-numerator.size :])[::-1]
        rows[place, : row.size] = row
    return scale * dynamics, scale * np.eye(order)[-1], rows
