"""The error of a test from command, measured displacement and recorded force, for any specimen.

With numerical mass m, damping c and stiffness k_N, and the specimen's force f along its path ::

    m x_c'' + c x_c' + k_N x_c + f[x_m] = −m a_g,   m y'' + c y' + k_N y + f[y] = −m a_g
    g = x_c − y:   m g'' + c g' + k_N g + (f[x_m] − f[y]) = 0

Only the difference of the specimen's force along two neighbouring paths is needed, so that what a
representation of f misses on both cancels. Five families of elements learn f from the test itself; the draws
behind the interval take a family by how well it predicts held-out parts of the force, fit it to blocks of the
test with random weights, and multiply the force by which the actuator's own error acts, f[x_m] − f[x_c], by
1 + (0.002 + κ h) z: h is what the family misses of held-out parts beyond their noise, z is standard normal.
A specimen that a spring and a dashpot explain as well as any family is linear, and its draws are those of a
stated linear specimen whose stiffness and damping are the test's own: 1 + κ h z, and h is mostly zero.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.arrays import Array
from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learning import (
    LearnedSpecimen,
    late_by,
    learn_specimen,
    weights_of,
)
from reliab.assessment.measured_specimen.path import MeasuredPath, fit
from reliab.assessment.rebuilt_error.channels import checked_histories, stated_start
from reliab.assessment.rebuilt_error.difference_draws import draw_differences
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    Histories,
    Unknown,
    columns_of_reading,
    draw_unknown,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise, white_floor
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError, conclude
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_simulation
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.whole_structure import whole_structure
from reliab.errors import InputError
from reliab.structures import Structure
from reliab.threads import one_thread

DRAWS = 64
"""Number of draws of the specimen and of everything else that is uncertain."""

DRAWS_OF_LINEAR = 256
"""The same where the specimen is linear, as many as of a stated one."""

_AS_STATED = 4  # draws of which one is of noise and specimen alone, behind the value
_LEAST_RATE = 256.0  # samples in a second, and in a period, that are simulated
_PER_PERIOD = 100.0
_LEAST = 0.05  # of a positive value: a draw goes no lower
_CARRIED = 3.0  # κ: relative deviation of the acting force over what is missed of held-out parts
_ALWAYS = 0.002  # relative deviation of the acting force where nothing is missed, unless it is linear
_PERIODS_OF_BLOCK = 2.0
_FEWEST_BLOCKS = 12
_PASSED = 0.27  # of the rate of simulation, up to which a filter passes


@dataclass(frozen=True, kw_only=True)
class FamilyOfSpecimen:
    """How well a family of elements predicts held-out parts of the force, and the error with it."""

    name: str  # Name of the family
    weight: float  # Share of the draws that it gets
    held_out: float  # RMS of what held-out parts of the force leave unexplained, over that of the force [-]
    rms: float  # RMS^R with this family, everything else as stated [-]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredSpecimen:
    """A specimen that was learned from a test's own force, and the test's error with it."""

    rebuilt: RebuiltError  # The error, its interval and the exact response
    families: tuple[FamilyOfSpecimen, ...]  # Families of elements that learned the specimen, the best first
    force: Array  # Force that the specimen would have had along the exact response [N], shape (n,)
    late: float  # Time by which the force seems to follow the displacement late, beyond what is stated [s]
    beyond: float  # How far the exact response leaves the range of the measured one, over the range [-]

    @property
    def held_out(self) -> float:
        """What the best family leaves unexplained of held-out parts of the force, RMS over RMS [-]."""
        return self.families[0].held_out


def rebuild_with_force(
    command: Array,
    measured: Array,
    force: Array,
    time_step: float,
    structure: Structure,
    mass: float,
    *,
    feedback_lag: float = 0.0,
    force_channel: ForceChannel | None = None,
    sensor_offset: float | None = None,
    resolution: float | None = None,
    tolerances: Tolerances | None = None,
    seed: int = 0,
) -> MeasuredSpecimen:
    """Compute the error of a test whose specimen is known by its recorded force only.

    `command`, `measured` [m] and `force` [N], shape (n,); `time_step`, `feedback_lag` [s]; `mass` of the
    structure [kg]; `sensor_offset`, `resolution` [m]. `structure` says what the computer's part is: a damping
    2ξωm and a stiffness (1 − α)mω². `force_channel` says what the recorded force holds beside that of the
    specimen, all of which was fed back.
    """
    with one_thread():
        whole = whole_structure(structure)
        command, measured = checked_histories(command, measured, time_step, whole)
        force = _checked_force(force, measured, mass)
        every = samples_in_step_of_simulation(
            structure.frequency, time_step, least_rate=_LEAST_RATE, per_period=_PER_PERIOD
        )
        require_fitting(command.size, every, time_step)
        noise = replace(estimate_noise(command, measured, time_step), resolution=resolution)
        start = stated_start(command, measured, time_step, whole, noise, sensor_offset)
        read = measured - start.offset
        smooth = noise.smooth(command - read)
        histories = Histories(
            command=command, measured=command - smooth, fed_back=smooth, time_step=time_step
        )
        channel = force_channel or ForceChannel()
        test = _learned(histories, force, every, noise, structure, mass, feedback_lag, channel)
        return _concluded(test, histories, read, every, noise, start, tolerances or Tolerances(), seed)


def _learned(
    histories: Histories,
    force: Array,
    every: int,
    noise: SensorNoise,
    structure: Structure,
    mass: float,
    feedback_lag: float,
    channel: ForceChannel,
) -> "_Test":
    """Learn the specimen with every family; `force` [N], `mass` [kg], `feedback_lag` [s]."""
    thin = histories.thinned(every)
    recorded = np.ascontiguousarray(noise.smooth(force)[::every])
    added = columns_of_channel(recorded, thin.measured, thin.time_step)
    path = MeasuredPath(
        displacement=thin.measured,
        force=recorded - channel.values @ added,
        time_step=thin.time_step,
        noise=replace(noise, time_step=thin.time_step, band=min(noise.band, _PASSED / thin.time_step)),
        block=min(
            _PERIODS_OF_BLOCK / structure.frequency, thin.command.size * thin.time_step / _FEWEST_BLOCKS
        ),
        noisy=_noise_in_band(histories.measured, force, noise),
    )
    learned = learn_specimen(path)
    return _Test(
        thin=thin,
        path=path,
        structure=structure,
        mass=mass,
        feedback_lag=feedback_lag,
        channel=channel,
        added=added,
        learned=tuple(learned),
    )


def _noise_in_band(measured: Array, force: Array, noise: SensorNoise) -> float:
    """RMS of the white noise that the filter passes, of force [N] and displacement [m], over the force's."""
    shares = white_floor(force) / np.var(force) + noise.white**2 / np.var(measured)
    return float(np.sqrt(shares * np.sum(noise.filter**2)))


def _concluded(
    test: "_Test",
    histories: Histories,
    read: Array,
    every: int,
    noise: SensorNoise,
    start: Start,
    tolerances: Tolerances,
    seed: int,
) -> MeasuredSpecimen:
    """Draw what is not known, and put the error together; `read` [m]."""
    command, thin, learned = histories.command, test.thin, test.learned
    unknown = Unknown(tolerances=tolerances, offset=start.offset_deviation, error_at_start=0.0)
    draws = DRAWS_OF_LINEAR if learned[0].linear else DRAWS
    differences = draw_differences(command, read, noise, test.structure.frequency, every, draws, seed)
    responses = [test.response(specimen) for specimen in learned]
    reference = responses[0]
    places = np.arange(command.size) / every
    whole_reference = command - np.interp(places, np.arange(thin.command.size), thin.command - reference)
    few = differences[: 2 * draws // _AS_STATED : 2]
    return MeasuredSpecimen(
        rebuilt=conclude(
            histories,
            read,
            whole_reference,
            structure=whole_structure(test.structure),
            noise=noise,
            as_stated=test.spread(few, EXACT, places, seed, carried=0.0),
            spread=test.spread(differences, unknown, places, seed, carried=1.0),
            differences=differences,
            every=every,
            unknown=unknown,
            start=start,
            seed=seed,
        ),
        families=tuple(
            FamilyOfSpecimen(
                name=specimen.family,
                weight=float(weight),
                held_out=specimen.held_out,
                rms=relative_errors(thin.measured - response, response)[0],
            )
            for specimen, weight, response in zip(learned, weights_of(learned), responses, strict=True)
        ),
        force=np.interp(places, np.arange(thin.command.size), test.force_of(learned[0], reference)),
        late=late_by(test.path, learned[0], test.added[0]),
        beyond=_beyond(reference, thin.measured),
    )


def _checked_force(force: Array, measured: Array, mass: float) -> Array:
    force = np.ascontiguousarray(force, dtype=np.float64)
    if force.shape != measured.shape or not np.isfinite(force).all() or not np.ptp(force) > 0.0:
        raise InputError(
            "A measured specimen needs its recorded force, finite, changing and as long as the displacements",
            value=f"shape {force.shape}",
            remedy="Give the force that was fed back in newtons, or state a linear specimen",
        )
    if not (np.isfinite(mass) and mass > 0.0):
        raise InputError("The mass of the structure must be positive", value=f"{mass} kg")
    return force


@dataclass(frozen=True, kw_only=True, eq=False)
class _Test:
    """A test with all that was learned of its specimen."""

    thin: Histories
    path: MeasuredPath
    structure: Structure
    mass: float
    feedback_lag: float  # Time by which the force was fed back late [s]
    channel: ForceChannel
    added: Array  # What a unit of lag, mass and friction adds to the recorded force [N], shape (3, n)
    learned: tuple[LearnedSpecimen, ...]

    def numerical(self, frequency: float, damping_ratio: float, share: float) -> tuple[float, float, float]:
        """Mass, damping and stiffness of the numerical substructure, each stated value times a factor."""
        turns = self.structure.circular_frequency * max(1.0 + frequency, _LEAST)
        ratio = self.structure.damping_ratio * max(1.0 + damping_ratio, _LEAST)
        alpha = min(self.structure.experimental_fraction * max(1.0 + share, _LEAST), 1.0)
        return self.mass, 2.0 * ratio * turns * self.mass, (1.0 - alpha) * turns**2 * self.mass

    def response(self, specimen: LearnedSpecimen) -> Array:
        """Exact response with everything as stated [m], shape (n,)."""
        of_specimen = self.force_of(specimen, self.thin.measured)
        felt = self._late(self._recorded(of_specimen, self.thin.measured, self.channel.values), 0.0)
        return self._respond(specimen, specimen.coefficients, felt, self.thin, (0.0, 0.0, 0.0))

    def _recorded(self, force: Array, displacement: Array, values: Array) -> Array:
        """Force of the specimen [N] as the channel passes it, with lag, mass and friction as given."""
        if not values.any():
            return force
        return np.asarray(force + values @ columns_of_channel(force, displacement, self.thin.time_step))

    def _late(self, felt: Array, further: float) -> Array:
        """Force as it was fed back [N], late as stated and by a further time [s]."""
        lag = self.feedback_lag + further
        return felt - lag * np.gradient(felt, self.thin.time_step) if lag else felt

    def force_of(self, specimen: LearnedSpecimen, displacement: Array) -> Array:
        """Force of the specimen along a path [N], shape (n,)."""
        rows = specimen.elements.along(displacement, self.thin.time_step, self.path.used)
        return np.asarray(specimen.coefficients @ rows)

    def _respond(
        self,
        specimen: LearnedSpecimen,
        coefficients: Array,
        felt: Array,
        thin: Histories,
        factors: Sequence[float],
    ) -> Array:
        response = specimen.elements.respond(
            coefficients, thin.command, felt, thin.time_step, self.path.used, self.numerical(*factors)
        )
        if not np.isfinite(response).all():
            raise InputError(
                "The response that a perfect actuator would have given must stay bounded",
                remedy="Check mass, share and force: the specimen's force must be that of the displacement",
            )
        return response

    def spread(
        self, differences: Array, unknown: Unknown, places: Array, seed: int, *, carried: float
    ) -> Spread:
        """Errors of draws of everything that is not known, the specimen above all."""
        sizes, strayed = [], []
        for measured, response in self._drawn(differences, unknown, seed, carried):
            error = measured - response
            sizes.append(relative_errors(error, response))
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
        self, differences: Array, unknown: Unknown, seed: int, carried: float
    ) -> Iterator[tuple[Array, Array]]:
        generator = np.random.default_rng(seed)
        thin, step, used = self.thin, self.thin.time_step, self.path.used
        drawn, _ = draw_unknown(unknown, len(differences), seed)
        columns = columns_of_reading(thin, drawn)
        added = [drawn[name][:, np.newaxis] * column for name, column in columns.items() if name in drawn]
        blocks, wanted = self.path.blocks, self.path.wanted
        families = generator.choice(len(self.learned), size=len(differences), p=weights_of(self.learned))
        of_command = {
            family: self.learned[family].elements.along(thin.command, step, used)
            for family in np.unique(families).tolist()
        }
        seen = {family: self.path.responses(self.learned[family].elements) for family in of_command}
        strayed = carried * self.channel.deviations * generator.standard_normal((len(differences), 3))
        added_seen = self.path.thinned(self.added)
        for row, difference in enumerate(differences):
            measured = thin.command - difference - sum((share[row] for share in added), np.zeros(()))
            specimen = self.learned[families[row]]
            rows = specimen.elements.along(measured, step, used)
            weights = generator.exponential(size=blocks[-1] + 1)[blocks]
            coefficients = fit(seen[int(families[row])], wanted - strayed[row] @ added_seen, weights)
            felt, commanded = coefficients @ rows, coefficients @ of_command[int(families[row])]
            missed = carried * (_CARRIED * specimen.missed + (0.0 if specimen.linear else _ALWAYS))
            factor = max(1.0 + missed * generator.standard_normal(), _LEAST)
            felt = self._recorded(
                commanded + factor * (felt - commanded), measured, self.channel.values + strayed[row]
            )
            felt = self._late(felt, float(drawn["feedback_lag"][row]))
            factors = [
                float(drawn[name][row]) for name in ("frequency", "damping_ratio", "experimental_fraction")
            ]
            yield measured, self._respond(specimen, coefficients, felt, thin, factors)


def _beyond(response: Array, measured: Array) -> float:
    """How far the response leaves the range of the measured displacement, over that range [-]."""
    outside = max(response.max() - measured.max(), measured.min() - response.min(), 0.0)
    return float(outside / np.ptp(measured))
