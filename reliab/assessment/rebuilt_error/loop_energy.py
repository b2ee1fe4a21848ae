"""Net damping ratio of the loop with its actuators while the test runs: below zero the loop gains energy.

An actuator's error puts the restoring force k(x_m − x_c) into the loop. The part in phase with the velocity
acts as added damping, positive or negative: with x_m − x_c = a x_c + b x_c' one degree of freedom has ::

    s² + 2ξω₀s + ω₀² + αω₀²(a + b s) = 0,    ξ_net = −Re(s)/ω₀ ≈ ξ + αω₀b/2

(for a delay τ it is ξ − αω₀τ/2, whose zero is the stability limit to first order; the balance of energy is
that of Mosqueda, Stojadinovic and Mahin 2007, J. Struct. Eng. 133, 1). Modes of a frame are watched one by
one, each in a band around its frequency, through which command and error pass alike, so that a mode that
grows is not hidden by another one that is damped. The error moves the other modes as well, and through them
this one: with D_j = s² + 2ξ_jω_js + ω_j² + κ_jj(a + b s) and κ_ij = νᵢᵀK_eνⱼ the pole is that of ::

    D_k(s) − (a + b s)² Σ_j κ_kj κ_jk/D_j(s) = 0,    j ≠ k

a and b are those of least squares over a window that forgets exponentially, so that a wrong gain is not taken
for damping while the motion grows; an offset does not pass the band. A skew s between the recorded channels
looks like a damping ratio of αω₀s/2; the alarm allows for the largest one.

Play feeds energy in as well, and sets a small motion going; but the error that it causes does not grow with
the motion, and a large motion does not diverge from it. Play of half width δ takes the damping
(2α/π)(δ/A)(1 − δ/A) away at an amplitude A (its describing function), at most α/(2π), and its error out of
phase is (4/π)δ(1 − δ/A). From the smallest error so far of an actuator that followed its command (A > 2δ)
follows the largest δ that play can have, of which 1.6 times are granted.

The alarm is raised where ξ_net, play granted, lies below zero while the motion of the mode is among its
largest, by more standard errors than chance gives to one stable test in a hundred. So many are needed as
there were independent windows: of m modes the k-th window of each is allowed a false alarm with the
probability 0.01/(m k(k + 1)), and all of them together with 0.01. While an error is so much noise that its
relation to the command is not known to half of the command, nothing is said.

In a mode that moves the interface by ν (its modal mass one), errors x_m − x_c work as the modal force
νᵀK_e(x_m − x_c), and a motion of that mode alone has the coordinate νᵀK_e x_c/(νᵀK_e ν). To first order a
delay of 2ξω/(νᵀK_e ν) uses the damping of the mode up: the modes with the shortest of these are watched.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
import scipy.linalg

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.structures.partition import Partition

MEMORY = 3.0
"""Periods of a mode after which its window has forgotten all but 1/e."""

LOOKS = 4
"""Looks at the net damping of a mode in its period."""

WIDTH = 2.0  # quality factor of the band in which a mode is watched
_MODES_FOR_EACH_ACTUATOR = 3
_TAKES_PART = 1e-6  # of the largest share of the specimen in a mode: a mode with less cannot become unstable
_ROUNDING = 1e-24  # of the mode's own stiffness squared, that rounding leaves of no exchange
_FEWEST_SAMPLES = 5.0  # in a period of a mode: fewer do not show its motion

SETTLING = 1.0
"""Periods of motion before the indicator is trusted."""

FALSE_ALARMS = 0.01
"""Probability of a false alarm in a test of any length."""

INDEPENDENT_SAMPLES = 8.0  # samples in a period of which the errors count as independent, at least
_WHITE = 1.0  # mean square of the steps of white noise, averaged over two samples, over its own
_LARGEST_SKEW = math.sqrt(3.0)  # standard deviations of one that lies anywhere within half a step
LARGE_MOTION = 0.5  # of the largest power of the motion so far
PLAY_FACTOR = 1.6  # by which the play that the smallest error shows is multiplied
SMALLEST_FOLLOWING = 0.5  # of the command: measured motion, in phase or late, with which a piston follows it
LARGEST_UNCERTAINTY = 0.5  # of the error, over the command, for an alarm
CRITICAL = 0.25  # share of a mode's damping ratio, below which the loop is near instability
LIKELY = 1.645  # standard errors by which the net damping must lie below it
SINGULAR_DETERMINANT = 1e-12  # determinant of the scaled moments below which they count as singular
POLE_ITERATIONS = 6  # iterations for the pole
SLOWEST_POLE = 0.2  # of a mode's circular frequency with which its pole may turn


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledModes:
    """All modes of a structure, and the stiffness by which the specimen couples them, shape (n, n)."""

    circular_frequencies: Array  # [rad/s], ascending, shape (n,)
    ratios: Array  # ξ [-], shape (n,)
    coupling: Array  # νᵢᵀK_eνⱼ of modes with a modal mass of one [1/s²]
    loads: Array  # K_eν, shape (p, n)


@dataclass(frozen=True, kw_only=True, eq=False)
class WatchedMode:
    """A mode whose energy is watched, and how the specimen couples it with the others."""

    modes: CoupledModes
    place: int  # Of the mode among all modes
    time_step: float  # [s]
    skew: float = 0.0  # Standard deviation of the skew of the displacements [s]

    @property
    def skew_deviation(self) -> float:
        """Standard deviation of the net damping that the skew leaves open [-]."""
        return 0.5 * self.skew * self.stiffness / self.circular_frequency

    @property
    def projection(self) -> Array:
        """By which interface displacements are carried to the mode [-], shape (p,)."""
        stiffness = self.stiffness
        loads = self.modes.loads[:, self.place]
        return loads / stiffness if stiffness > 0.0 else np.zeros(loads.size)

    @cached_property
    def circular_frequency(self) -> float:
        """ω [rad/s]."""
        return float(self.modes.circular_frequencies[self.place])

    @cached_property
    def ratio(self) -> float:
        """ξ [-]."""
        return float(self.modes.ratios[self.place])

    @cached_property
    def stiffness(self) -> float:
        """νᵀK_eν, for one degree of freedom αω₀² [1/s²]."""
        return float(self.modes.coupling[self.place, self.place])

    @cached_property
    def exchange(self) -> Array:
        """νᵀK_eνⱼ · νⱼᵀK_eν, by which an error moves mode j and this one by it, shape (n,) [1/s⁴].

        Zero where only rounding couples them, as modes of one frequency in a symmetric structure.
        """
        exchange = self.modes.coupling[self.place] * self.modes.coupling[:, self.place]
        return np.where(np.abs(exchange) > _ROUNDING * self.stiffness**2, exchange, 0.0)

    @cached_property
    def samples(self) -> float:
        """Samples in a period [-]."""
        return 2.0 * np.pi / (self.circular_frequency * self.time_step)

    @cached_property
    def forgetting(self) -> float:
        """Weight that is left of the past after a step [-]."""
        return float(np.exp(-1.0 / (MEMORY * self.samples)))

    @property
    def look(self) -> int:
        """Samples from one look to the next."""
        return max(round(self.samples / LOOKS), 1)

    @property
    def band(self) -> Array:
        """Coefficients b₀, a₁ and a₂ of the band-pass y = b₀(x − x₋₂) − a₁y₋₁ − a₂y₋₂, shape (3,)."""
        tangent = np.tan(0.5 * self.circular_frequency * self.time_step)
        scale = 1.0 + tangent / WIDTH + tangent**2
        last = 1.0 - tangent / WIDTH + tangent**2
        return np.asarray(np.array([tangent / WIDTH, 2.0 * (tangent**2 - 1.0), last]) / scale)


def select_modes(structure: Partition, time_step: float, skew: float = 0.0) -> tuple[WatchedMode, ...]:
    """Return the modes to watch, the one with the shortest critical delay first.

    `time_step`, `skew` [s]: the standard deviation of the skew of the displacements.
    """
    interface, specimen = structure.interface, structure.specimen_stiffness
    squares, shapes = scipy.linalg.eigh(structure.stiffness, structure.mass)
    omega = np.sqrt(np.maximum(squares, np.finfo(float).tiny))
    interface_shapes = interface.T @ shapes
    modes = CoupledModes(
        circular_frequencies=omega,
        ratios=np.einsum("di,de,ei->i", shapes, structure.damping, shapes) / (2.0 * omega),
        coupling=interface_shapes.T @ specimen @ interface_shapes,
        loads=specimen @ interface_shapes,
    )
    own_coupling = np.diag(modes.coupling)
    shares = own_coupling / omega**2
    takes_part = (shares > _TAKES_PART * shares.max()) & (omega * time_step * _FEWEST_SAMPLES < 2.0 * np.pi)
    delays = np.full(omega.size, np.inf)
    delays[takes_part] = 2.0 * modes.ratios[takes_part] * omega[takes_part] / own_coupling[takes_part]
    count = min(_MODES_FOR_EACH_ACTUATOR * interface.shape[1], max(int(takes_part.sum()), 1))
    places = np.argsort(delays, kind="stable")[:count]
    return tuple(
        WatchedMode(modes=modes, place=int(place), time_step=time_step, skew=skew) for place in places
    )


@dataclass(frozen=True, kw_only=True)
class NetDamping:
    """Net damping of the loop in a mode."""

    ratio: float  # ratio, deviation: ξ_net and its standard error [-]
    deviation: float
    # ξ_net, as many standard errors as chance gives to one stable test in a hundred, and the largest skew [-]
    high: float
    large: bool  # Whether the motion is among the largest so far
    known: bool  # Whether noise leaves the error known to half of the command
    follows: bool  # Whether the piston follows its command, and does not rest within some play
    play: float  # Half width of the play that would make the actuator's error [m]
    amplitude: float  # Of the motion [m]
    play_damping: float  # Damping ratio that play takes away at most [-]
    near: bool  # Whether the loop has lost most of the mode's damping, also where chance took some

    def damping_loss(self, play: float) -> float:
        """Damping ratio that play of a half width [m], largely granted, takes away."""
        share = min(PLAY_FACTOR * play / self.amplitude, 0.5)
        return PLAY_FACTOR * 4.0 * self.play_damping * share * (1.0 - share)


@dataclass(kw_only=True)
class EnergyAlarm:
    """Looks at the net damping of a mode one after the other."""

    smallest: float = np.inf  # Smallest play so far that an actuator shows that follows its command [m]
    following: int = 0  # Looks since which it has followed its command

    def look(self, net: NetDamping | None) -> bool:
        """Return whether the loop may diverge."""
        if net is None:
            return False
        self.following = self.following + 1 if net.follows else 0
        if self.following > 1:  # not while it only begins to move
            self.smallest = min(self.smallest, net.play)
        diverges = net.large and net.known and np.isfinite(self.smallest)
        return bool(diverges and net.high + net.damping_loss(self.smallest) < 0.0)


def net_damping(mode: WatchedMode, moments: Array, totals: Array, modes: int) -> NetDamping | None:
    """Return the net damping in one of so many watched modes; None before enough motion.

    `moments`: forgetting sums of products of x_c, x_c' and x_m − x_c in the band, and of their steps, shape
    (2, 3, 3); `totals`: sum of the weights, samples that moved, and largest sum of x_c'² so far [m²/s²].
    """
    power = float(moments[0, 1, 1])
    weight, moved, largest_power = totals.tolist()
    if moved < SETTLING * mode.samples or not power > 0.0:
        return None
    scale = np.sqrt(np.maximum(np.diag(moments[0]), np.finfo(float).tiny))
    joint, steps = moments / np.outer(scale, scale)
    inverse = _inverse(float(joint[0, 1]))
    residual = np.append(-inverse @ joint[:2, 2], 1.0)
    residual_power = max(float(residual @ joint @ residual), 0.0)
    rough = min(float(residual @ steps @ residual) / residual_power, _WHITE) if residual_power > 0.0 else 0.0
    independent = max(weight * max(rough / (4.0 - rough), INDEPENDENT_SAMPLES / mode.samples), 1.0)
    chance = np.sqrt(inverse[0, 0] * residual_power / independent)
    units = scale[2] / scale[:2]
    ratio, deviation = _pole(mode, -residual[:2] * units, chance * units)
    window = np.ceil(moved / (MEMORY * mode.samples))
    quantile = -float(scipy.special.ndtri(FALSE_ALARMS / modes / (window * (window + 1.0))))
    amplitude = float(np.sqrt(2.0 / weight) * scale[0])
    high = ratio + quantile * deviation + _LARGEST_SKEW * mode.skew_deviation
    deviation = float(np.hypot(deviation, mode.skew_deviation))
    return NetDamping(
        ratio=ratio,
        deviation=deviation,
        high=high,
        large=power > LARGE_MOTION * largest_power,
        known=bool(quantile * chance * units[0] < LARGEST_UNCERTAINTY),
        follows=_follows(scale, residual, quantile * chance),
        play=_play(float(units[0] * np.sqrt(max(1.0 - joint[0, 2] ** 2, 0.0))), amplitude),
        amplitude=amplitude,
        play_damping=mode.stiffness / (2.0 * np.pi * mode.circular_frequency**2),
        near=bool(ratio + LIKELY * deviation < CRITICAL * mode.ratio),
    )


def _inverse(product: float) -> Array:
    """Inverse of a matrix of two rows with ones on its diagonal."""
    determinant = max(1.0 - product**2, SINGULAR_DETERMINANT)
    return np.array([[1.0, -product], [-product, 1.0]]) / determinant


def _play(error: float, amplitude: float) -> float:
    """Half width [m] of the play that makes an error out of phase, a share of the amplitude."""
    return 0.5 * amplitude * (1.0 - float(np.sqrt(max(1.0 - np.pi * error, 0.0))))


def _follows(scale: Array, residual: Array, chance: float) -> bool:
    """Whether the measured motion, as far as it is no chance, is half of the command or more at any phase."""
    in_phase_part = max(abs(scale[0] - residual[0] * scale[2]) - chance * scale[2], 0.0)
    quadrature_part = max((abs(residual[1]) - chance) * scale[2], 0.0)
    return bool(np.hypot(in_phase_part, quadrature_part) > SMALLEST_FOLLOWING * scale[0])


def _pole(mode: WatchedMode, law: Array, chance: Array) -> tuple[float, float]:
    """Return −Re(s)/ω of the pole under x_m − x_c = a x_c + b x_c', and its standard error.

    `law`: a [-] and b [s]; `chance`: their standard errors.
    """
    omega, twice = mode.circular_frequency, 2.0 * mode.ratio * mode.circular_frequency
    pole = complex(-mode.ratio * omega, omega)
    for _ in range(POLE_ITERATIONS):
        force = _force(mode, law, pole)[0]
        slope = force.imag / pole.imag
        square = omega**2 + force.real - slope * pole.real
        half = -0.5 * (twice + slope)
        pole = complex(half, float(np.sqrt(max(square - half**2, (SLOWEST_POLE * omega) ** 2))))
    _, law_derivative, pole_derivative = _force(mode, law, pole)
    moves = -law_derivative / (2.0 * pole + twice + pole_derivative + law_derivative * law[1])
    deviation = float(np.hypot(moves.real * chance[0], (moves * pole).real * chance[1]))
    return -pole.real / omega, deviation / omega


def _force(mode: WatchedMode, law: Array, pole: complex) -> tuple[complex, complex, complex]:
    """Return the modal force of the error per displacement, and its derivatives by a + b s and by s."""
    modes, error = mode.modes, law[0] + law[1] * pole
    twice, own_coupling = 2.0 * modes.ratios * modes.circular_frequencies, np.diag(modes.coupling)
    dynamic = pole**2 + twice * pole + modes.circular_frequencies**2 + error * own_coupling
    is_other = np.arange(own_coupling.size) != mode.place
    taking = is_other & (mode.exchange != 0.0)
    shares, weighted_shares = np.zeros((2, own_coupling.size), dtype=np.complex128)
    shares[taking] = mode.exchange[taking] / dynamic[taking]
    weighted_shares[taking] = error**2 * shares[taking] / dynamic[taking]
    return (
        complex(error * mode.stiffness - error**2 * shares.sum()),
        complex(mode.stiffness - 2.0 * error * shares.sum() + weighted_shares @ own_coupling),
        complex(weighted_shares @ (2.0 * pole + twice)),
    )


class LoopEnergy:
    """Follow the motion of each mode in its band, and raise the alarm where the loop gains energy.

    `since`: Number of the sample of the alarm; None while there is none.
    `gaining`: Mode that may diverge; None while there is none.
    """

    def __init__(self, modes: Sequence[WatchedMode]) -> None:
        self.since: int | None = None
        self.gaining: WatchedMode | None = None
        self._motions = [_Motion(mode, len(modes)) for mode in modes]
        self._size = 0

    @property
    def moves(self) -> bool:
        """Whether a sample has moved so far."""
        return any(motion.totals[1] > 0.0 for motion in self._motions)

    @property
    def net(self) -> NetDamping | None:
        """Smallest net damping of those that are known; None where none is."""
        return min(self._known_dampings, key=lambda net: net.ratio, default=None)

    @property
    def near_instability(self) -> bool:
        """Whether a mode has lost most of its damping."""
        return any(net.near for net in self._known_dampings)

    @property
    def _known_dampings(self) -> list[NetDamping]:
        return [net for motion in self._motions if (net := motion.net) is not None and net.known]

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples at the interface [m], shape (n,) or (p, n)."""
        command, measured_displacement = np.atleast_2d(command), np.atleast_2d(measured_displacement)
        alarms = [motion.feed(command, measured_displacement, self._size) for motion in self._motions]
        raised_alarms = [(sample, place) for place, sample in enumerate(alarms) if sample is not None]
        self._size += command.shape[1]
        if raised_alarms and self.since is None:
            self.since, place = min(raised_alarms)
            self.gaining = self._motions[place].mode


class _Motion:
    """Motion of a mode, and its alarm."""

    def __init__(self, mode: WatchedMode, modes: int) -> None:
        self.mode, self._modes = mode, modes
        self._alarm = EnergyAlarm()
        self._moments, self.totals = np.zeros((2, 3, 3)), np.zeros(3)
        self._signals, self._between = np.zeros((2, 4)), np.zeros(3)

    @property
    def net(self) -> NetDamping | None:
        """Net damping at the last sample."""
        return net_damping(self.mode, self._moments, self.totals, self._modes)

    def feed(self, command: Array, measured_displacement: Array, first: int) -> int | None:
        """Add samples, `first` the number of the first of them; return the one of the alarm."""
        mode, begin, alarm_sample = self.mode, 0, None
        modal_command, modal_error = (
            mode.projection @ command,
            mode.projection @ (measured_displacement - command),
        )
        while begin < modal_command.size:
            end = min(begin + mode.look - (first + begin) % mode.look, modal_command.size)
            _follow(
                modal_command[begin:end],
                modal_error[begin:end],
                first + begin == 0,
                mode.band,
                mode.forgetting,
                mode.time_step,
                self._signals,
                self._between,
                self._moments,
                self.totals,
            )
            if (first + end) % mode.look == 0 and self._alarm.look(self.net) and alarm_sample is None:
                alarm_sample = first + end - 1
            begin = end
        return alarm_sample


@compiled
def _follow(
    command: Array,
    error: Array,
    begins: bool,  # noqa: FBT001 - compiled
    band: Array,
    forgetting: float,
    time_step: float,
    signals: Array,
    midpoints: Array,
    moments: Array,
    totals: Array,
) -> None:
    """Pass command and error through the band, and sum their products, in place.

    `signals`: first value, two states of the band-pass and last value of each of both; `totals`: sum of the
    weights, samples that moved, and the largest power.
    """
    now, increments = np.empty(2), np.empty(3)
    for i in range(command.size):
        now[0], now[1] = command[i], error[i]
        for row in range(2):
            if begins and i == 0:
                signals[row, 0] = now[row]
            change = now[row] - signals[row, 0]
            now[row] = band[0] * change + signals[row, 1]
            signals[row, 1] = signals[row, 2] - band[1] * now[row]
            signals[row, 2] = -band[0] * change - band[2] * now[row]
        if not (begins and i == 0):
            for row in range(3):
                increments[row] = -midpoints[row]
            midpoints[0] = 0.5 * (now[0] + signals[0, 3])
            midpoints[1] = (now[0] - signals[0, 3]) / time_step
            midpoints[2] = 0.5 * (now[1] + signals[1, 3])
            for row in range(3):
                increments[row] += midpoints[row]
            for row in range(3):
                for column in range(3):
                    product = midpoints[row] * midpoints[column]
                    moments[0, row, column] = forgetting * moments[0, row, column] + product
                    product = increments[row] * increments[column]
                    moments[1, row, column] = forgetting * moments[1, row, column] + product
            totals[0] = forgetting * totals[0] + 1.0
            totals[1] += 1.0 if midpoints[1] != 0.0 else 0.0
            totals[2] = max(totals[2], moments[0, 1, 1])
        signals[0, 3], signals[1, 3] = now[0], now[1]
