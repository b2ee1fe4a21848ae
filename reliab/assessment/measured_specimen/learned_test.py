"""A test with all that was learned of its specimen: exact responses, and draws of its error.

The draws take a family of elements by its weight and a member of it, and multiply the force by which the
actuator's own error acts, f[x_m] − f[x_c], by 1 + (0.002 + κ h) z: h is what the family misses of held-out
parts beyond their noise, z is standard normal. A linear specimen is multiplied by 1 + κ h z.

Members are those that other parts of a test would have found: blocks of it have random weights, by which
coefficients are fitted and the traits of laws move. What parts leave open of a law that is wrong is less than
what the law misses: members are drawn apart until the forces of two differ by what held-out parts are missed
by (inflation of parameter uncertainties, Pernot 2017, Journal of Chemical Physics 147, 104102).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import scipy

from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learning import LearnedSpecimen, weights_of
from reliab.assessment.measured_specimen.path import MeasuredPath, fit
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.interval import Histories, Unknown, draw_unknown, inputs_of_reading
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

_SAMPLE = 10  # members by whose differences the others are drawn apart
_FARTHEST = 5.0  # times, by which they are drawn apart at most
_SEED = 21

_LEAST = 0.05  # of a positive value: a draw goes no lower
_CARRIED = 3.0  # κ: relative deviation of the acting force over what is missed of held-out parts
_ALWAYS = 0.002  # relative deviation of the acting force where nothing is missed, unless it is linear
_OF_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction")
_OF_CHANNEL = ("force_lag", "attached_mass", "load_path_friction")

OF_FORCE: Final = ("specimen", "mass", *_OF_CHANNEL)
"""What is not known of specimen, mass and force, by name."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Members:
    """Members of a family along the measured path and along the command."""

    specimen: LearnedSpecimen  # As the family learned it
    path: MeasuredPath
    command: Array  # m, shape (n,)

    @cached_property
    def _seen(self) -> Array:
        return self.path.responses(self.specimen.elements)

    @cached_property
    def _along_command(self) -> Array:
        return self.specimen.elements.along(self.command, self.path.time_step, self.path.used)

    @cached_property
    def _fitted(self) -> Array:
        return fit(self._seen, self.path.force_seen)

    @cached_property
    def apart(self) -> float:
        """How many times as far as parts of the test leave open members are drawn apart [-]."""
        expected = self._fitted @ self._seen
        differ = [np.mean((coefficients @ rows - expected) ** 2) for coefficients, rows in self._sample()]
        missed = self.specimen.missed**2 * np.mean(self.path.force_seen**2)
        least = np.finfo(float).tiny
        return float(np.clip(np.sqrt(missed / max(float(np.mean(differ)), least)), 1.0, _FARTHEST))

    def _sample(self) -> Iterator[tuple[Array, Array]]:
        """Coefficients and elements, shape (elements, m), of some members."""
        generator = np.random.default_rng(_SEED)
        for _ in range(_SAMPLE):
            counts = generator.exponential(size=self.path.blocks[-1] + 1)
            rows = self._seen_with(counts)
            yield fit(rows, self.path.force_seen, counts[self.path.blocks]), rows

    def _seen_with(self, counts: Array) -> Array:
        """Elements as they are seen, shape (elements, m), with laws as weights of blocks would have them."""
        member, places = self.specimen.with_weights(counts)
        seen = self._seen.copy()
        seen[places] = self.path.responses(member.elements.only(places))
        return seen

    def member(self, counts: Array, wanted: Array, apart: float) -> tuple[LearnedSpecimen, Array]:
        """Give a member and its force along the command [N], shape (n,).

        `counts`: weights of blocks, shape (blocks,); `wanted`: force that it should have [N], shape (m,).
        """
        expected = self._fitted if wanted is self.path.force_seen else fit(self._seen, wanted)
        member, places = self.specimen.with_weights(1.0 + apart * (counts - 1.0))
        coefficients = self._apart(expected, counts, wanted, apart) if apart else expected
        rows = self._along_command.copy()
        rows[places] = member.elements.only(places).along(self.command, self.path.time_step, self.path.used)
        return replace(member, coefficients=coefficients), coefficients @ rows

    def _apart(self, expected: Array, counts: Array, wanted: Array, apart: float) -> Array:
        """Coefficients whose force differs so many times as much from what is expected, none negative."""
        rows = self._seen_with(counts)
        coefficients = fit(rows, wanted, counts[self.path.blocks])
        if apart == 1.0:
            return coefficients
        calm = expected @ self._seen
        aim = calm + apart * (coefficients @ rows - calm)
        return fit(self._seen_with(1.0 + apart * (counts - 1.0)), aim)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Draw:
    """A draw of what is not known of a test."""

    measured: Array  # Displacement of the specimen [m], shape (n,)
    response: Array  # What a perfect actuator would have given [m], shape (n,)
    specimen: LearnedSpecimen
    structure: Partition
    mass: float  # By which the force is divided, over the mass as stated [-]


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
        return Recursion.from_force(self._scaled(relative).numerical_substructure, self.thin.time_step)

    def _scaled(self, relative: list[float]) -> Partition:
        """Structure with relative changes of each stated value."""
        frequency, damping_ratio, share = (max(1.0 + change, _LEAST) for change in relative)
        most = 1.0 / float(self.whole.static_transfer[0, 0])  # of a stiffness, none is negative
        return self.whole.scale(frequency=frequency, damping_ratio=damping_ratio, share=min(share, most))

    def response(self, specimen: LearnedSpecimen, moved: Array, *, late: bool = True) -> Array:
        """Exact response, had the actuator moved as given along the command [m], shape (n,).

        `late`: whether the force was fed back late, if so it was stated.
        """
        felt = self._recorded(self.force_of(specimen, moved), moved, self.channel.values)
        felt = self._late(felt, 0.0) if late else felt
        return _bounded(self._respond(specimen, felt, self._numerical))

    def bounded(self, specimen: LearnedSpecimen) -> bool:
        """Whether the exact response with a specimen stays bounded."""
        felt = self.force_of(specimen, self.thin.measured)
        response = self._respond(specimen, felt, self._numerical)
        return bool(np.isfinite(response).all())

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

    def _respond(self, specimen: LearnedSpecimen, felt: Array, numerical: Recursion) -> Array:
        """Exact response [m], not finite where it diverges."""
        thin = self.thin
        return specimen.elements.respond(
            specimen.coefficients, thin.command, felt, thin.time_step, self.path.used, numerical
        )

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
        draws, blocks = len(differences), self.path.blocks[-1] + 1
        drawn, _ = draw_unknown(unknown, draws, seed)
        inputs, shifts = inputs_of_reading(self.thin, drawn)
        of_force = {name: row * (name in carried) for name, row in self.drawn_of_force(draws, seed).items()}
        families = generator.choice(len(self.learned), size=draws, p=self.weights) * varied
        members = {
            family: Members(specimen=self.learned[family], path=self.path, command=self.thin.command)
            for family in np.unique(families).tolist()
        }
        for row, difference in enumerate(differences):
            of_draw = {name: float(values[row]) for name, values in (drawn | of_force).items()}
            yield self._draw(
                members[int(families[row])],
                generator.exponential(size=blocks) if varied else np.ones(blocks),
                self.thin.command - difference - shifts[row] @ inputs,
                of_draw,
                apart="specimen" in carried,
            )

    def _draw(
        self, members: Members, counts: Array, measured: Array, drawn: dict[str, float], *, apart: bool
    ) -> "_Draw":
        """Response with a member, or with the family itself where that of a member diverges."""
        strayed = np.array([drawn[name] for name in _OF_CHANNEL])
        wanted = self.path.force_seen
        if strayed.any():
            wanted = wanted - strayed @ self.path.thinned(self.added)
        relative = [drawn[name] for name in _OF_STRUCTURE]
        numerical = self._recursion(relative) if any(relative) else self._numerical
        mass = max(1.0 + drawn["mass"], _LEAST)
        for far in (members.apart if apart else 1.0, 0.0):
            member, commanded = members.member(counts, wanted, far)
            specimen = replace(member, coefficients=member.coefficients / mass)
            felt = self._acting(specimen, measured, commanded / mass, drawn["specimen"])
            felt = self._recorded(felt, measured, self.channel.values + strayed)
            felt = self._late(felt, drawn["feedback_lag"])
            response = self._respond(specimen, felt, numerical)
            if np.isfinite(response).all():
                break
        return _Draw(
            measured=measured,
            response=_bounded(response),
            specimen=specimen,
            structure=self._scaled(relative),
            mass=mass,
        )

    def _acting(self, specimen: LearnedSpecimen, measured: Array, commanded: Array, strayed: float) -> Array:
        """Force along a measured path [N] whose difference from that along the command is off."""
        missed = strayed * _deviation(specimen) / (self.missed or 1.0)
        felt = self.force_of(specimen, measured)
        return np.asarray(commanded + max(1.0 + missed, _LEAST) * (felt - commanded))

    def work_of(
        self, specimen: LearnedSpecimen, measured: Array, response: Array, *, mass: float = 1.0
    ) -> float:
        """Work done on a specimen along its exact response [J]; `mass` by which the force is divided.

        What a family misses accumulates along a path. Of the work that it misses along the measured path the
        share that is no noise is missed along the exact one, too.
        """
        along = float(scipy.integrate.trapezoid(self.force_of(specimen, response), response))
        return along + float(np.sum(self._work_missed(specimen, measured, mass)))

    def _work_missed(self, specimen: LearnedSpecimen, measured: Array, mass: float) -> Array:
        """Work that is missed along the measured path and is no noise [J], block by block."""
        left = self.path.force / mass - self.force_of(specimen, measured)
        blocks = (np.arange(left.size) * (self.path.time_step / self.path.block)).astype(np.int64)
        share = (specimen.missed / specimen.held_out) ** 2 if specimen.missed else 0.0
        return np.asarray(share * np.bincount(blocks, left * np.gradient(measured)))

    def exact_of_draws(
        self, differences: Array, unknown: Unknown, seed: int
    ) -> Iterator[tuple[Partition, Array, Array, float]]:
        """Structures, exact responses [m] and forces along them [N], both shape (1, n), and works [J].

        Each force is off by what its family misses of held-out parts, each work as blocks scatter.
        """
        chance = np.random.default_rng([seed, 2]).standard_normal(len(differences)).tolist()
        scatter = float(np.linalg.norm(self._work_missed(self.learned[0], self.thin.measured, 1.0)))
        draws = self._drawn(differences, unknown, seed, carried=OF_FORCE, varied=True)
        for draw, off in zip(draws, chance, strict=True):
            force = self.force_of(draw.specimen, draw.response)
            force += off * draw.specimen.missed * float(np.std(force))
            work = self.work_of(draw.specimen, draw.measured, draw.response, mass=draw.mass)
            yield draw.structure, draw.response[np.newaxis], force[np.newaxis], work + off * scatter


def _deviation(specimen: LearnedSpecimen) -> float:
    """Relative deviation of the force by which the actuator's error acts [-]."""
    return _CARRIED * specimen.missed + (0.0 if specimen.linear else _ALWAYS)


def _bounded(response: Array) -> Array:
    """Refuse a response that diverges [m]."""
    if not np.isfinite(response).all():
        raise InputError(
            "With this mass, share and force the exact response grows without bound",
            remedy="Check mass, share and force: the specimen's force must be that of the displacement",
        )
    return response
