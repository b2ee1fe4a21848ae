"""A test with all that was learned of its specimen: exact responses, and draws of its error.

The draws take a family of elements by its weight and a member of it, and multiply the force by which the
actuator's own error acts, f[x_m] − f[x_c], by 1 + (0.002 + κ h) z: h is what the family misses of held-out
parts beyond their noise, z is standard normal. A linear specimen is multiplied by 1 + κ h z.

Members are those that other parts of a test would have found: blocks of it have random weights, by which
coefficients are fitted and the traits of laws move. What parts leave open of a law that is wrong is less than
what the law misses: members are drawn apart until the forces of two differ by what held-out parts are missed
by (inflation of parameter uncertainties, Pernot 2017, Journal of Chemical Physics 147, 104102).

A force that was recorded late against the displacement looks as if the specimen gave energy away. No passive
one does: the lag is that of the channels, or larger where viscous damping hides a part of it. Beside the
ground acceleration, the recorded force shows the structure and its own lag, whatever the specimen does.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from reliab.assessment.inference.evidence import EquationWithForce, Evidence
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.simulated import SimulatedTest
from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learning import (
    LearnedSpecimen,
    MeasuredPath,
    estimate_lag,
    fit,
    weights_of,
)
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.structures.partition import Partition

_SAMPLE = 10  # members by whose differences the others are drawn apart
_FARTHEST = 5.0  # times, by which they are drawn apart at most
_SEED = 21

_LOSS = 0.04  # loss factor of a specimen by viscous damping, as of a damping ratio of 2 %
_LEAST = 0.05  # of a positive value: a draw goes no lower
_DEVIATION_FACTOR = 3.0  # κ: relative deviation of the acting force over what is missed of held-out parts
_ALWAYS = 0.002  # relative deviation of the acting force where nothing is missed, unless it is linear


@dataclass(frozen=True, kw_only=True, eq=False)
class Members:
    """Members of a family along the measured path and along the command."""

    specimen: LearnedSpecimen  # As the family learned it
    path: MeasuredPath
    command: Array  # m, shape (n,)

    @cached_property
    def _responses(self) -> Array:
        return self.path.responses(self.specimen.elements)

    @cached_property
    def _command_responses(self) -> Array:
        return self.specimen.elements.follow_path(self.command, self.path.time_step, self.path.energy_share)

    @cached_property
    def _coefficients(self) -> Array:
        return fit(self._responses, self.path.force_seen)

    @cached_property
    def spread_factor(self) -> float:
        """How many times as far as parts of the test leave open members are drawn apart [-]."""
        mean_force = self._coefficients @ self._responses
        differ = [np.mean((coefficients @ rows - mean_force) ** 2) for coefficients, rows in self._sample()]
        unexplained_square = self.specimen.missed**2 * np.mean(self.path.force_seen**2)
        least = np.finfo(float).tiny
        return float(
            np.clip(np.sqrt(unexplained_square / max(float(np.mean(differ)), least)), 1.0, _FARTHEST)
        )

    def _sample(self) -> Iterator[tuple[Array, Array]]:
        """Coefficients and elements, shape (elements, m), of some members."""
        generator = np.random.default_rng(_SEED)
        for _ in range(_SAMPLE):
            counts = generator.exponential(size=self.path.blocks[-1] + 1)
            rows = self._responses_with_weights(counts)
            yield fit(rows, self.path.force_seen, counts[self.path.blocks]), rows

    def _responses_with_weights(self, counts: Array) -> Array:
        """Elements as they are seen, shape (elements, m), with laws as weights of blocks would have them."""
        member, places = self.specimen.weight_blocks(counts)
        responses = self._responses.copy()
        responses[places] = self.path.responses(member.elements.only(places))
        return responses

    def member(
        self, counts: Array, target_force: Array, spread_factor: float
    ) -> tuple[LearnedSpecimen, Array]:
        """Give a member and its force along the command [N], shape (n,).

        `counts`: weights of blocks, shape (blocks,); `target_force`: force that it should have [N], shape
        (m,).
        """
        mean_coefficients = (
            self._coefficients if target_force is self.path.force_seen else fit(self._responses, target_force)
        )
        member, places = self.specimen.weight_blocks(1.0 + spread_factor * (counts - 1.0))
        coefficients = (
            self._spread_coefficients(mean_coefficients, counts, target_force, spread_factor)
            if spread_factor
            else mean_coefficients
        )
        rows = self._command_responses.copy()
        rows[places] = member.elements.only(places).follow_path(
            self.command, self.path.time_step, self.path.energy_share
        )
        return replace(member, coefficients=coefficients), coefficients @ rows

    def _spread_coefficients(
        self, mean_coefficients: Array, counts: Array, target_force: Array, spread_factor: float
    ) -> Array:
        """Coefficients whose force differs so many times as much from what is expected, none negative."""
        rows = self._responses_with_weights(counts)
        coefficients = fit(rows, target_force, counts[self.path.blocks])
        if spread_factor == 1.0:
            return coefficients
        calm = mean_coefficients @ self._responses
        aim = calm + spread_factor * (coefficients @ rows - calm)
        return fit(self._responses_with_weights(1.0 + spread_factor * (counts - 1.0)), aim)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Draw:
    """A draw of what is not known of a test."""

    measured: Array  # Displacement of the specimen [m], shape (m,)
    response: Array  # What a perfect actuator would have given [m], shape (m,)
    specimen: LearnedSpecimen


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedTest(SimulatedTest):
    """A test with all that was learned of its specimen."""

    path: MeasuredPath
    whole: Partition  # The structure with its specimen as stated [kg, N·s/m, N/m]
    feedback_lag: float  # Time by which the force was fed back late [s]
    channel: ForceChannel
    added: Array  # What a unit of lag, mass and friction adds to the recorded force [N], shape (3, m)
    learned: tuple[LearnedSpecimen, ...]  # The best first
    seed: int  # Of draws of the specimen

    @cached_property
    def measured(self) -> Array:
        """x_m without noise [m], shape (m,)."""
        return self.displacement(Experiment.as_stated(actuators=1))

    @cached_property
    def weights(self) -> Array:
        """Share of the draws of each family, shape (families,)."""
        return weights_of(self.learned)

    @cached_property
    def apparent_lag(self) -> StatedValue:
        """Time by which the force seems late, beyond what is stated [s]."""
        return estimate_lag(self.path, self.learned[0], self.added[0])

    @property
    def evidence(self) -> tuple[Evidence, ...]:
        """What force and ground acceleration show: a passive specimen is never late."""
        passive = PassiveSpecimen(test=self)
        if self.channels.ground is None:
            return (passive,)
        return passive, EquationWithForce(channels=self.channels, partition=self.whole)

    @property
    def deviations_by_name(self) -> dict[str, float]:
        """Standard deviations of what the force holds beside that of a passive specimen, by names."""
        usual_lead = _LOSS / (2.0 * np.pi * float(self.whole.natural_frequencies[0]))
        lead = float(np.hypot(usual_lead, min(self.apparent_lag.value, 0.0)))
        return {**self.channel.deviations_by_name, "specimen_lead": lead}

    def lag_of_force(self, world: Experiment) -> float:
        """Time by which the force was recorded later than the displacement, beyond what is stated [s]."""
        return float(world.force_skew[0]) - (0.0 if self.channel.has_lag else float(world.skew[0]))

    @property
    def unexplained_force(self) -> float:
        """Relative deviation of the force by which the actuator's error acts, RMS over the families [-]."""
        deviations = np.array([_deviation(specimen) for specimen in self.learned])
        return float(np.sqrt(self.weights @ deviations**2))

    @cached_property
    def _numerical(self) -> Recursion:
        return Recursion.from_force(self.whole.numerical_substructure, self.time_step)

    def _recursion(self, world: Experiment) -> Recursion:
        """Recursion of the numerical substructure in a possible world."""
        if (world.frequency, world.damping_ratio, world.share) == (1.0, 1.0, 1.0):
            return self._numerical
        return Recursion.from_force(self.structure(world).numerical_substructure, self.time_step)

    def structure(self, world: Experiment) -> Partition:
        """Structure with its specimen in a possible world."""
        largest_share = 1.0 / float(self.whole.static_transfer[0, 0])  # of a stiffness, none is negative
        return self.whole.scale(
            frequency=world.frequency,
            damping_ratio=world.damping_ratio,
            share=min(max(world.share, _LEAST), largest_share),
        )

    def response(self, specimen: LearnedSpecimen, displacement: Array, *, late: bool = True) -> Array:
        """Exact response, had the actuator moved as given along the command [m], shape (m,).

        `late`: whether the force was fed back late, if so it was stated.
        """
        fed_back_force = self._record_force(
            self.force_of(specimen, displacement), displacement, self.channel.values
        )
        fed_back_force = self._late(fed_back_force, self.feedback_lag) if late else fed_back_force
        return _require_bounded(self._respond(specimen, fed_back_force, self._numerical))

    def is_bounded(self, specimen: LearnedSpecimen) -> bool:
        """Whether the exact response with a specimen stays bounded."""
        force = self.force_of(specimen, self.measured)
        return bool(np.isfinite(self._respond(specimen, force, self._numerical)).all())

    def force_of(self, specimen: LearnedSpecimen, displacement: Array) -> Array:
        """Force of the specimen along a path [N], shape (n,)."""
        rows = specimen.elements.follow_path(displacement, self.time_step, self.path.energy_share)
        return np.asarray(specimen.coefficients @ rows)

    def _record_force(self, force: Array, displacement: Array, values: Array) -> Array:
        """Force of the specimen [N] as the channel passes it, with lag, mass and friction as given."""
        if not values.any():
            return force
        return np.asarray(force + values @ columns_of_channel(force, displacement, self.time_step))

    def _late(self, force: Array, lag: float) -> Array:
        """Force as it was fed back [N], by a time late [s]."""
        return force - lag * np.gradient(force, self.time_step) if lag else force

    def _respond(self, specimen: LearnedSpecimen, test_force: Array, numerical: Recursion) -> Array:
        """Exact response [m], not finite where it diverges."""
        return specimen.elements.respond(
            specimen.coefficients, self.command, test_force, self.time_step, self.path.energy_share, numerical
        )

    @cached_property
    def _members(self) -> tuple[Members, ...]:
        return tuple(
            Members(specimen=specimen, path=self.path, command=self.command) for specimen in self.learned
        )

    def solve(self, world: Experiment, draw: int | None = None) -> Array:
        """x_m − x_I and x_I [m] in a possible world, with the specimen as it was learned, or a draw of it."""
        drawn = self._draw(world, draw)
        return np.stack([drawn.measured - drawn.response, drawn.response])[:, np.newaxis]

    def _draw(self, world: Experiment, draw: int | None) -> _Draw:
        """Response with a member, or with the family itself where that of a member diverges."""
        family, counts, chance = 0, np.ones(self.path.blocks[-1] + 1), 0.0
        if draw is not None:
            generator = np.random.default_rng([self.seed, draw])
            family = int(generator.choice(len(self.learned), p=self.weights))
            counts, chance = generator.exponential(size=counts.size), float(generator.standard_normal())
        members, measured = self._members[family], self.displacement(world)
        lag, mass_and_friction = self.lag_of_force(world), [world.attached_mass, world.load_path_friction]
        target_force = self.path.force_seen
        if lag or any(mass_and_friction):
            target_force = target_force - np.array([lag, *mass_and_friction]) @ self.path.thin(self.added)
        felt = np.array([lag if self.channel.has_lag else 0.0, *mass_and_friction])
        numerical, mass = self._recursion(world), max(float(world.force_scale[0]), _LEAST)
        for far in (0.0,) if draw is None else (members.spread_factor, 0.0):
            member, command_force = members.member(counts, target_force, far)
            specimen = replace(member, coefficients=member.coefficients / mass)
            force = self._acting(specimen, measured, command_force / mass, chance)
            force = self._record_force(force, measured, self.channel.values + felt)
            response = self._respond(specimen, self._late(force, world.feedback_lag), numerical)
            if np.isfinite(response).all():
                break
        return _Draw(measured=measured, response=_require_bounded(response), specimen=specimen)

    def _acting(
        self, specimen: LearnedSpecimen, measured_displacement: Array, command_force: Array, chance: float
    ) -> Array:
        """Force along a measured path [N] whose difference from that along the command is off."""
        factor = max(1.0 + chance * _deviation(specimen), _LEAST)
        force = self.force_of(specimen, measured_displacement)
        return np.asarray(command_force + factor * (force - command_force))

    def work_of(
        self, specimen: LearnedSpecimen, measured_displacement: Array, response: Array, *, mass: float = 1.0
    ) -> float:
        """Work done on a specimen along its exact response [J]; `mass` by which the force is divided.

        What a family misses accumulates along a path. Of the work that it misses along the measured path the
        share that is no noise is missed along the exact one, too.
        """
        work = float(scipy.integrate.trapezoid(self.force_of(specimen, response), response))
        return work + float(np.sum(self._work_missed(specimen, measured_displacement, mass)))

    def _work_missed(self, specimen: LearnedSpecimen, measured_displacement: Array, mass: float) -> Array:
        """Work that is missed along the measured path and is no noise [J], block by block."""
        residual = self.path.force / mass - self.force_of(specimen, measured_displacement)
        blocks = (np.arange(residual.size) * (self.path.time_step / self.path.block)).astype(np.int64)
        share = (specimen.missed / specimen.held_out) ** 2 if specimen.missed else 0.0
        return np.asarray(share * np.bincount(blocks, residual * np.gradient(measured_displacement)))

    def exact_of_draws(
        self, worlds: Iterable[tuple[int, Experiment]]
    ) -> Iterator[tuple[Partition, Array, Array, float]]:
        """Structures, exact responses [m] and forces along them [N], both shape (1, m), and works [J].

        `worlds`: numbers of draws and possible worlds. Each force is off by what its family misses of
        held-out parts, each work as blocks scatter.
        """
        generator = np.random.default_rng([self.seed, 2])
        scatter = float(np.linalg.norm(self._work_missed(self.learned[0], self.measured, 1.0)))
        for number, world in worlds:
            draw, off = self._draw(world, number), float(generator.standard_normal())
            force = self.force_of(draw.specimen, draw.response)
            force += off * draw.specimen.missed * float(np.std(force))
            work = self.work_of(draw.specimen, draw.measured, draw.response, mass=float(world.force_scale[0]))
            yield self.structure(world), draw.response[np.newaxis], force[np.newaxis], work + off * scatter


@dataclass(kw_only=True, eq=False)
class PassiveSpecimen(Evidence):
    """A specimen that stores and dissipates, whose force is not later than its motion.

    A force that is recorded late by some time shows channels that are so far apart; by more, where viscous
    damping makes the force early.
    """

    test: "LearnedTest"

    def whiten(self, experiment: Experiment) -> Array:
        """Compare the lag of the force with that of a possible world, shape (1,)."""
        apparent, lag = self.test.apparent_lag, self.test.lag_of_force(experiment)
        return np.array([(apparent.value + experiment.specimen_lead - lag) / apparent.deviation])

    def update(self, experiment: Experiment) -> None:
        """Leave the deviation as it is, which is that of the lag."""


def _deviation(specimen: LearnedSpecimen) -> float:
    """Relative deviation of the force by which the actuator's error acts [-]."""
    return _DEVIATION_FACTOR * specimen.missed + (0.0 if specimen.linear else _ALWAYS)


def _require_bounded(response: Array) -> Array:
    """Refuse a response that diverges [m]."""
    if not np.isfinite(response).all():
        raise InputError(
            "With this mass, share and force the exact response grows without bound",
            remedy="Check mass, share and force: the specimen's force must be that of the displacement",
        )
    return response
