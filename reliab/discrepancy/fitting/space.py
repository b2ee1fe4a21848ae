"""The parameters of a candidate model as one vector."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.core.arrays import Array
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.effects.effect import Effect, LinearEffect, Parameter
from reliab.simulation.hybrid_test.model import HybridTest

MODEL_ERROR = 1e-4
"""Relative standard deviation that is added to every parameter, because simulation and machine differ too.

If the simulation were exact, long records would determine parameters to a few parts in a million. Independent
simulators of the same equations differ by some parts in ten thousand, from how the motion runs between
samples. In quadrature to the signal that is as many radians of its phase, which bounds a ratio of times.
"""

_BOUND_DISTANCE = 1e-4  # standard deviations of the prior
_SLOW = 1e-3  # rad/s, at which the phase of a transfer function is a delay


@dataclass(frozen=True, eq=False)
class ModelSpace:
    """All models of a block with given effects, as vectors of dimensionless coordinates.

    The coordinates are those of the calibrations, then of the offsets, then of the effects, each in units of
    the standard deviation of its prior, with its prior mean at zero.
    """

    block: ObservedBlock  # The block
    effects: tuple[type[Effect], ...]  # Effects beside the block's offsets

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters in the order of the coordinates."""
        parameters = [calibration.parameter for calibration in self.block.calibrations]
        for effect in (*self.block.offsets, *self.effects):
            parameters.extend(effect.parameters)
        return tuple(parameters)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, sorted."""
        return tuple(sorted(str(effect.name) for effect in self.effects))

    @property
    def key(self) -> frozenset[str]:
        """Names of the effects, by which fitted models are kept."""
        return frozenset(self.names)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.parameters)

    @cached_property
    def _prior(self) -> tuple[Array, Array]:
        pairs = np.array([parameter.coordinate_prior for parameter in self.parameters]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Bounds of the coordinates, each of shape (size,)."""
        mean, spread = self._prior
        pairs = np.array([parameter.coordinate_bounds for parameter in self.parameters]).reshape(-1, 2)
        for effect, present in self.block.removable.items():
            if effect in self.effects:
                place = self.places(effect).start
                least = self.parameters[place].coordinate(-present, self.block.scales)
                pairs[place, 0] = max(pairs[place, 0], least)
        return (pairs[:, 0] - mean) / spread, (pairs[:, 1] - mean) / spread

    def values(self, coordinates: Array) -> Array:
        """SI values of the parameters, shape (size,)."""
        mean, spread = self._prior
        scaled_coordinates = mean + spread * coordinates
        return np.array(
            [
                p.value(c, self.block.scales)
                for p, c in zip(self.parameters, scaled_coordinates.tolist(), strict=True)
            ]
        )

    def standard_deviations(self, coordinates: Array, covariance: Array) -> Array:
        """Propagate a covariance to standard deviations of the SI values, to first order, shape (size,).

        The error of the model is added.
        """
        variances = np.diag(self.covariance_of_values(coordinates, covariance))
        return np.asarray(np.hypot(np.sqrt(variances), self.model_errors(self.values(coordinates))))

    def covariance_of_values(self, coordinates: Array, covariance: Array) -> Array:
        """Propagate a covariance to that of the SI values, to first order, shape (size, size)."""
        mean, spread = self._prior
        scaled_coordinates = (mean + spread * coordinates).tolist()
        rates = [
            p.derivative(c, self.block.scales)
            for p, c in zip(self.parameters, scaled_coordinates, strict=True)
        ]
        slopes = np.array(rates) * spread
        return np.asarray(slopes[:, np.newaxis] * covariance * slopes)

    def model_errors(self, values: Array) -> Array:
        """Size of the model's own error in SI values of the parameters, shape (…, size).

        Of a ratio of times it is a share of the departure from no effect, and at least a phase of as many
        radians at the end of the longest test.
        """
        scales = self.block.scales
        phase_error = scales.displacement / (scales.velocity * scales.duration)
        ratios = [(p.neutral, phase_error) if p.precise else (0.0, 0.0) for p in self.parameters]
        neutral, least = np.array(ratios).reshape(-1, 2).T
        return np.asarray(MODEL_ERROR * np.hypot(values - neutral, least))

    def coordinates(self, values: Array) -> Array:
        """Coordinates of SI values, shape (size,)."""
        mean, spread = self._prior
        scaled_coordinates = [
            p.coordinate(v, self.block.scales) for p, v in zip(self.parameters, values.tolist(), strict=True)
        ]
        return np.asarray((np.array(scaled_coordinates) - mean) / spread)

    def model(self, coordinates: Array) -> HybridTest:
        """Return the model at given coordinates."""
        values = self.values(coordinates)
        model = self.block.nominal
        place = len(self.block.calibrations)
        for calibration, value in zip(self.block.calibrations, values.tolist(), strict=False):
            model = calibration.apply(model, value)
        effects = []
        for effect in (*self.block.offsets, *self.effects):
            count = len(effect.parameters)
            effects.append(effect.from_values(values[place : place + count]))
            place += count
        return model.adding(*effects)

    def starts(self, base: "ModelSpace", coordinates: Array) -> Iterator[Array]:
        """Coordinates from which to fit, given those of a smaller model; added effects at their starts."""
        values = dict(zip(base.keys, coordinates.tolist(), strict=True))
        added_effects = [effect for effect in self.effects if effect not in base.effects]
        tries = max((len(effect.parameters[0].starts) for effect in added_effects), default=1)
        lower, upper = self.bounds
        for k in range(tries):
            fresh = self._start(k)
            coordinates_filled = np.array(
                [values.get(key, fresh[place]) for place, key in enumerate(self.keys)]
            )
            yield np.clip(self._as_late(coordinates_filled, added_effects), lower + 1e-9, upper - 1e-9)

    def _as_late(self, coordinates: Array, added_effects: Sequence[type[Effect]]) -> Array:
        """Subtract the delay of added linear dynamics from the actuator's, which stays positive."""
        place = self.keys.index("delay_s") if "delay_s" in self.keys else None
        linear = [effect for effect in added_effects if issubclass(effect, LinearEffect)]
        if place is None or not linear:
            return coordinates
        values = self.values(coordinates)
        for effect in linear:
            slow = effect.from_values(values[self.places(effect)]).transfer(np.array([1j * _SLOW]))[0]
            values[place] += float(np.angle(slow)) / _SLOW
        values[place] = max(values[place], 0.0)
        return self.coordinates(values)

    def scale_size(self, coordinates: Array, kind: type[Effect], factor: float) -> Array:
        """Coordinates in which an effect's first parameter, if it is signed, is multiplied by a factor."""
        if not kind.parameters[0].signed:
            return coordinates
        place = self.keys.index(f"{kind.name}.{kind.parameters[0].name}")
        lower, upper = self.bounds
        trial = coordinates.copy()
        trial[place] = np.clip(factor * coordinates[place], 0.9 * lower[place], 0.9 * upper[place])
        return trial

    def replace_effect(
        self, base: "ModelSpace", coordinates: Array, kind: type[Effect], special: type[Effect]
    ) -> list[Array]:
        """Coordinates in which a special form stands in an effect's place, from those with the effect.

        A composition may be far from its first member alone, and another law from the effect that it stands
        for: they start from their own values, too, with the first parameter of the effect, its size.
        """
        own, size = f"{special.name}.", f"{special.name}.{special.parameters[0].name}"
        values = {
            key.replace(f"{kind.name}.", own, 1): value
            for key, value in zip(base.keys, base.values(coordinates).tolist(), strict=True)
        }
        bases = [values]
        if special.members or (special.refines is kind and not issubclass(special, kind)):
            other_values = {k: v for k, v in values.items() if k == size or not k.startswith(own)}
            further = [parameter for parameter in special.parameters if parameter not in kind.parameters]
            bases += [other_values] * max(len(parameter.starts) for parameter in further)
        lower, upper = self.bounds
        starts = []
        for k, base_values in enumerate(bases):
            fresh_values = zip(self.keys, self.values(self._start(max(k - 1, 0))).tolist(), strict=True)
            start = self.coordinates(np.array([base_values.get(key, fresh) for key, fresh in fresh_values]))
            starts.append(np.clip(start, lower + 1e-9, upper - 1e-9))
        return starts

    def find_bounds(self, coordinates: Array) -> tuple[str, ...]:
        """Names of the parameters of effects that lie on a bound which is no physical limit."""
        lower, upper = self.bounds
        names = []
        for place, (key, parameter) in enumerate(zip(self.keys, self.parameters, strict=True)):
            physical = parameter.signed and parameter.lower <= 0.0 <= parameter.lower + 1e-6
            low = coordinates[place] <= lower[place] + _BOUND_DISTANCE and not physical
            if low or coordinates[place] >= upper[place] - _BOUND_DISTANCE:
                names.append(key)
        return tuple(names)

    def places(self, effect: type[Effect]) -> slice:
        """Places of an effect's parameters among the coordinates."""
        first = self.keys.index(f"{effect.name}.{effect.parameters[0].name}")
        return slice(first, first + len(effect.parameters))

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """Names of the parameters in the order of the coordinates, those of effects as "effect.parameter"."""
        keys = [calibration.parameter.name for calibration in self.block.calibrations]
        for effect in (*self.block.offsets, *self.effects):
            keys.extend(f"{effect.name}.{parameter.name}" for parameter in effect.parameters)
        return tuple(keys)

    def _start(self, k: int) -> Array:
        mean, spread = self._prior
        starts = []
        for parameter in self.parameters:
            start = parameter.starts[min(k, len(parameter.starts) - 1)]
            starts.append(start - parameter.neutral if parameter.signed else np.log(start))
        return np.asarray((np.array(starts) - mean) / spread)
