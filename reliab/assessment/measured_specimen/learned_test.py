"""A test with all that was learned of its specimen: exact responses, and draws of its error.

The draws take a family of elements by its weight, fit it to blocks of the test with random weights, and
multiply the force by which the actuator's own error acts, f[x_m] − f[x_c], by 1 + (0.002 + κ h) z: h is what
the family misses of held-out parts beyond their noise, z is standard normal. A linear specimen is multiplied
by 1 + κ h z.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learning import LearnedSpecimen, weights_of
from reliab.assessment.measured_specimen.path import MeasuredPath, fit
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.interval import Histories, Unknown, draw_unknown, inputs_of_reading
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.errors import InputError
from reliab.structures import Partition

_LEAST = 0.05  # of a positive value: a draw goes no lower
_CARRIED = 3.0  # κ: relative deviation of the acting force over what is missed of held-out parts
_ALWAYS = 0.002  # relative deviation of the acting force where nothing is missed, unless it is linear
_OF_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction")
_OF_CHANNEL = ("force_lag", "attached_mass", "load_path_friction")

OF_FORCE: Final = ("specimen", "mass", *_OF_CHANNEL)
"""What is not known of specimen, mass and force, by name."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Draw:
    """A draw of what is not known of a test."""

    measured: Array  # Displacement of the specimen [m], shape (n,)
    response: Array  # What a perfect actuator would have given [m], shape (n,)
    specimen: LearnedSpecimen
    structure: Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedTest:
    """A test with all that was learned of its specimen."""

    thin: Histories
    path: MeasuredPath
    whole: Partition  # The structure with its specimen as stated [kg, N·s/m, N/m]
    mass_deviation: float  # Of the mass, over the mass [-]
    feedback_lag: float  # Time by which the force was fed back late [s]
    channel: ForceChannel
    added: Array  # What a unit of lag, mass and friction adds to the recorded force [N], shape (3, n)
    learned: tuple[LearnedSpecimen, ...]  # The best first

    @cached_property
    def weights(self) -> Array:
        """Share of the draws of each family, shape (families,)."""
        return weights_of(self.learned)

    @property
    def missed(self) -> float:
        """Relative deviation of the force by which the actuator's error acts, RMS over the families [-]."""
        deviations = np.array([_deviation(specimen) for specimen in self.learned])
        return float(np.sqrt(self.weights @ deviations**2))

    @cached_property
    def _numerical(self) -> Recursion:
        return self._recursion([0.0, 0.0, 0.0])

    def _recursion(self, relative: list[float]) -> Recursion:
        """Recursion of the numerical substructure, relative changes of each stated value given."""
        return Recursion.of_force(self._scaled(relative).without_specimen, self.thin.time_step)

    def _scaled(self, relative: list[float]) -> Partition:
        """Structure with relative changes of each stated value."""
        frequency, damping_ratio, share = (max(1.0 + change, _LEAST) for change in relative)
        most = 1.0 / float(self.whole.static_transfer[0, 0])  # of a stiffness, none is negative
        return self.whole.scaled(frequency=frequency, damping_ratio=damping_ratio, share=min(share, most))

    def response(self, specimen: LearnedSpecimen, moved: Array, *, late: bool = True) -> Array:
        """Exact response, had the actuator moved as given along the command [m], shape (n,).

        `late`: whether the force was fed back late, if so it was stated.
        """
        felt = self._recorded(self.force_of(specimen, moved), moved, self.channel.values)
        felt = self._late(felt, 0.0) if late else felt
        return self._respond(specimen, specimen.coefficients, felt, self._numerical)

    def force_of(self, specimen: LearnedSpecimen, displacement: Array) -> Array:
        """Force of the specimen along a path [N], shape (n,)."""
        rows = specimen.elements.along(displacement, self.thin.time_step, self.path.used)
        return np.asarray(specimen.coefficients @ rows)

    def _recorded(self, force: Array, displacement: Array, values: Array) -> Array:
        """Force of the specimen [N] as the channel passes it, with lag, mass and friction as given."""
        if not values.any():
            return force
        return np.asarray(force + values @ columns_of_channel(force, displacement, self.thin.time_step))

    def _late(self, felt: Array, further: float) -> Array:
        """Force as it was fed back [N], late as stated and by a further time [s]."""
        lag = self.feedback_lag + further
        return felt - lag * np.gradient(felt, self.thin.time_step) if lag else felt

    def _respond(
        self, specimen: LearnedSpecimen, coefficients: Array, felt: Array, numerical: Recursion
    ) -> Array:
        thin = self.thin
        response = specimen.elements.respond(
            coefficients, thin.command, felt, thin.time_step, self.path.used, numerical
        )
        if not np.isfinite(response).all():
            raise InputError(
                "The response that a perfect actuator would have given must stay bounded",
                remedy="Check mass, share and force: the specimen's force must be that of the displacement",
            )
        return response

    @property
    def deviations_of_force(self) -> dict[str, float]:
        """Standard deviations of what is not known of specimen, force and mass, in SI units or relative."""
        deviations = (self.missed, self.mass_deviation, *self.channel.deviations.tolist())
        return dict(zip(OF_FORCE, deviations, strict=True))

    def drawn_of_force(self, number: int, seed: int) -> dict[str, Array]:
        """Draw what is not known of specimen, force and mass, by name, each shape (number,)."""
        normal = np.random.default_rng([seed, 1]).standard_normal((len(OF_FORCE), number))
        return {
            name: deviation * row
            for (name, deviation), row in zip(self.deviations_of_force.items(), normal, strict=True)
        }

    def spread(
        self,
        differences: Array,
        unknown: Unknown,
        places: Array,
        seed: int,
        *,
        carried: Sequence[str] = (),
        varied: bool = True,
    ) -> Spread:
        """Errors of draws, one for each of the `differences` x_c − x_m [m], shape (draws, n).

        `carried`: which of `OF_FORCE` are drawn; `varied`: whether families and coefficients are.
        """
        sizes, strayed = [], []
        for draw in self._drawn(differences, unknown, seed, carried=carried, varied=varied):
            error = draw.measured - draw.response
            sizes.append(relative_errors(error, draw.response))
            strayed.append(error)
        rms, mte = np.array(sizes).T
        known = np.arange(self.thin.command.size)
        return Spread(
            rms=rms,
            mte=mte,
            mean=np.interp(places, known, np.mean(strayed, axis=0)),
            deviation=np.interp(places, known, np.std(strayed, axis=0)),
        )

    def _drawn(
        self, differences: Array, unknown: Unknown, seed: int, *, carried: Sequence[str], varied: bool
    ) -> Iterator["_Draw"]:
        generator = np.random.default_rng(seed)
        thin, step, used, draws = self.thin, self.thin.time_step, self.path.used, len(differences)
        drawn, _ = draw_unknown(unknown, draws, seed)
        inputs, shifts = inputs_of_reading(thin, drawn)
        of_force = {name: row * (name in carried) for name, row in self.drawn_of_force(draws, seed).items()}
        families = generator.choice(len(self.learned), size=draws, p=self.weights) * varied
        of_command = {
            family: self.learned[family].elements.along(thin.command, step, used)
            for family in np.unique(families).tolist()
        }
        seen = {family: self.path.responses(self.learned[family].elements) for family in of_command}
        added_seen, blocks = self.path.thinned(self.added), self.path.blocks
        for row, difference in enumerate(differences):
            measured = thin.command - difference - shifts[row] @ inputs
            family = int(families[row])
            specimen = self.learned[family]
            strayed = np.array([of_force[name][row] for name in _OF_CHANNEL])
            weights = generator.exponential(size=blocks[-1] + 1)[blocks] if varied else None
            coefficients = fit(seen[family], self.path.force_seen - strayed @ added_seen, weights)
            coefficients = coefficients / max(1.0 + of_force["mass"][row], _LEAST)
            rows = specimen.elements.along(measured, step, used)
            felt, commanded = coefficients @ rows, coefficients @ of_command[family]
            missed = of_force["specimen"][row] * _deviation(specimen) / (self.missed or 1.0)
            felt = commanded + max(1.0 + missed, _LEAST) * (felt - commanded)
            felt = self._recorded(felt, measured, self.channel.values + strayed)
            felt = self._late(felt, float(drawn["feedback_lag"][row]))
            relative = [float(drawn[name][row]) for name in _OF_STRUCTURE]
            numerical = self._recursion(relative) if any(relative) else self._numerical
            yield _Draw(
                measured=measured,
                response=self._respond(specimen, coefficients, felt, numerical),
                specimen=replace(specimen, coefficients=coefficients),
                structure=self._scaled(relative),
            )

    def exact_of_draws(
        self, differences: Array, unknown: Unknown, seed: int
    ) -> Iterator[tuple[Partition, Array, Array]]:
        """Structures, exact responses [m] and forces along them [N], draw by draw, both shape (1, n).

        Each force is off by what its family misses of held-out parts.
        """
        chance = np.random.default_rng([seed, 2]).standard_normal(len(differences)).tolist()
        draws = self._drawn(differences, unknown, seed, carried=OF_FORCE, varied=True)
        for draw, off in zip(draws, chance, strict=True):
            force = self.force_of(draw.specimen, draw.response)
            force += off * draw.specimen.missed * float(np.std(force))
            yield draw.structure, draw.response[np.newaxis], force[np.newaxis]


def _deviation(specimen: LearnedSpecimen) -> float:
    """Relative deviation of the force by which the actuator's error acts [-]."""
    return _CARRIED * specimen.missed + (0.0 if specimen.linear else _ALWAYS)
