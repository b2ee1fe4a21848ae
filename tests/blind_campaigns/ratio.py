"""The effect-to-noise ratio: what an effect changes in its channel beyond what calibration explains.

The change is the output of the effect's block with the effect minus the output without, both under the
block's true input; the calibration parameters of the block are refitted by least squares over all training
tests, and the root mean square of what remains is held against the root mean square of the channel's noise.
README.md gives the definition.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize, signal

from blind_campaigns.case import Case, Observation, decibels, root_mean_square
from blind_campaigns.march import replay_specimen
from blind_campaigns.noise import expected_spectrum
from blind_campaigns.simulator import Response, applied_ground, dropped_out, sensed, simulate_prescribed
from blind_campaigns.system import Array, Effect, Rig, Specimen

COARSE_HZ = 1024.0
_WORKING_HZ = 256.0
_TAPER_S, _DISCARD_S, _LARGEST_SHIFT_S = 0.5, 1.0, 0.12


@dataclass(frozen=True, kw_only=True)
class Change:
    """What an effect does to a channel, per training test: output with and without, calibration columns."""

    channel: str
    rate_hz: float
    with_effect: list[Array]
    without: list[Array]
    columns: list[list[Array]]
    shifts: bool

    def coarse(self) -> "Change":
        """Return the same change at about 256 samples a second."""
        stride = max(1, int(self.rate_hz // _WORKING_HZ))
        return replace(
            self,
            rate_hz=self.rate_hz / stride,
            with_effect=[part[::stride] for part in self.with_effect],
            without=[part[::stride] for part in self.without],
            columns=[[column[::stride] for column in test] for test in self.columns],
        )


def effect_change(case: Case, effect: Effect, responses: list[Response]) -> Change:
    """Return the change that one effect of an observed block causes in the training tests."""
    pick = {"actuator": _actuator_change, "sensor": _sensor_change, "specimen": _specimen_change}
    return pick.get(effect.block, _balance_change)(case, effect, responses)


def _actuator_change(case: Case, effect: Effect, responses: list[Response]) -> Change:
    bare = replace(case.rig, specimen=None)
    both = [
        [
            simulate_prescribed(rig, response.command, rate_hz=case.rate_hz, finest_hz=COARSE_HZ).piston
            for rig in (bare, bare.without(effect))
        ]
        for response in responses
    ]
    ones = [[np.ones(pair[0].size)] for pair in both]
    with_effect, without = [pair[0] for pair in both], [pair[1] for pair in both]
    return Change(
        channel="measured_m", rate_hz=case.rate_hz, with_effect=with_effect, without=without,
        columns=ones, shifts=True,
    )  # fmt: skip


def _sensor_change(case: Case, effect: Effect, responses: list[Response]) -> Change:
    alone = Rig(effects=(effect,))
    place = 1 if effect.channel == "force_n" else 0
    with_effect = [sensed(alone, response, case.rate_hz)[place] for response in responses]
    numbered = zip(with_effect, case.numbers, strict=True)
    with_effect = [dropped_out(alone, part, case.rate_hz, number) for part, number in numbered]
    without = [sensed(Rig(), response, case.rate_hz)[place] for response in responses]
    offset = [] if effect.name in {"sensor_bias", "force_bias"} else [1.0]
    columns = [[value * np.ones(part.size) for value in offset] for part in without]
    shifts = effect.channel == "measured_m" and case.observation not in {
        Observation.MEASURED_FORCE,
        Observation.SPECIMEN_ONLY,
    }
    return Change(
        channel=effect.channel, rate_hz=case.rate_hz, with_effect=with_effect, without=without,
        columns=columns, shifts=shifts,
    )  # fmt: skip


def _specimen_change(case: Case, effect: Effect, responses: list[Response]) -> Change:
    """Return forces under the true piston motion; columns are the unit spring's force and an offset."""

    def replays(rig: Rig) -> list[Array]:
        record, interval = rig.parameters(), 1.0 / case.rate_hz
        return [replay_specimen(record, r.piston, r.velocity, r.acceleration, interval) for r in responses]

    missing = case.rig.without(effect)
    spring = replace(case.rig, effects=(), specimen=Specimen(stiffness_n_per_m=1.0))
    gap = missing.find("gap")
    if gap is not None:
        spring = spring.adding(gap)
    columns = [[force, np.ones(force.size)] for force in replays(spring)]
    return Change(
        channel="force_n", rate_hz=case.rate_hz, with_effect=replays(case.rig), without=replays(missing),
        columns=columns, shifts=False,
    )  # fmt: skip


def _balance_change(case: Case, effect: Effect, responses: list[Response]) -> Change:
    """Return the forces that the numerical substructure's equation of motion lacks without the effect [N]."""
    structure = case.rig.structure
    missing = case.rig.without(effect)
    lacks = []
    for ground, response in zip(case.inputs, responses, strict=True):
        if effect.block == "excitation":
            change = applied_ground(case.rig, ground, case.rate_hz) - applied_ground(
                missing, ground, case.rate_hz
            )
            lacks.append(structure.mass * change)
        else:
            lacks.append(
                imbalance(case.rig, response, applied_ground(case.rig, ground, case.rate_hz), case.rate_hz)
            )
    zeros = [np.zeros(part.size) for part in lacks]
    return Change(
        channel="balance_n", rate_hz=case.rate_hz, with_effect=lacks, without=zeros,
        columns=[[] for _ in lacks], shifts=False,
    )  # fmt: skip


def imbalance(rig: Rig, response: Response, ground: Array, rate_hz: float) -> Array:
    """Return m·(x'' + 2ξω₀x' + (1 − α)ω₀²x + a_g) + force of a recorded command, below 30 Hz [N]."""
    structure = rig.structure
    bias = rig.find("force_bias")
    force = response.force + (bias.parameters["bias_n"] if bias is not None else 0.0)
    x = response.command
    rest = 2.0 * structure.damping_ratio * structure.omega * np.gradient(x, 1.0 / rate_hz) + ground
    rest += (1.0 - structure.experimental_fraction) * structure.omega**2 * x + force / structure.mass
    # The second difference of x is this mean of an acceleration that is linear between samples.
    total = np.zeros(x.size)
    total[1:-1] = np.convolve(rest, [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0], mode="valid")
    total[1:-1] += (x[2:] - 2.0 * x[1:-1] + x[:-2]) * rate_hz**2
    sections = signal.butter(4, min(30.0, 0.3 * rate_hz), fs=rate_hz, output="sos")
    return structure.mass * signal.sosfiltfilt(sections, total)


def shifted_spectrum(values: Array, rate_hz: float) -> tuple[Array, Array]:
    """Return frequencies [rad/s] and spectrum of a signal that fades out at its end, zero-padded."""
    tail = round(_TAPER_S * rate_hz)
    faded = values.copy()
    faded[-tail:] *= 0.5 * (1.0 + np.cos(np.pi * np.arange(1, tail + 1) / tail))
    count = values.size + round(rate_hz)
    return 2.0 * np.pi * np.fft.rfftfreq(count, 1.0 / rate_hz), np.fft.rfft(faded, count)


def kept(count: int, rate_hz: float) -> int:
    """Return how many samples of a test are judged: all but the last second."""
    return count - round(_DISCARD_S * rate_hz)


def projected(target: list[Array], columns: list[list[Array]]) -> list[Array]:
    """Return what is left of `target` after a least-squares fit with columns shared by all tests."""
    if not columns[0]:
        return target
    matrix = np.concatenate([np.stack(test, axis=1) for test in columns])
    scale = np.sqrt(np.mean(matrix**2, axis=0)) + 1e-300
    whole = np.concatenate(target)
    left = whole - (matrix / scale) @ np.linalg.lstsq(matrix / scale, whole, rcond=1e-12)[0]
    return np.split(left, np.cumsum([part.size for part in target])[:-1])


def calibrated_residual(change: Change, extra: list[list[Array]] | None = None) -> list[Array]:
    """Return what calibration (and `extra` columns) cannot explain of a change, per training test."""
    change = change.coarse()
    extra = extra if extra is not None else [[] for _ in change.without]
    if not change.shifts:
        difference = [a - b for a, b in zip(change.with_effect, change.without, strict=True)]
        columns = [[*mine, *more] for mine, more in zip(change.columns, extra, strict=True)]
        return projected(difference, columns)
    spectra = [shifted_spectrum(part, change.rate_hz) for part in change.without]

    def residual(shift: float) -> list[Array]:
        return shifted_residual(change, [s * np.exp(-1j * w * shift) for w, s in spectra], extra)

    def size(shift: float) -> float:
        return root_mean_square(residual(shift))

    return residual(best_shift(size))


def best_shift(size: Callable[[float], float]) -> float:
    """Return the change of delay [s] that makes a residual smallest."""
    grid = np.linspace(-_LARGEST_SHIFT_S, _LARGEST_SHIFT_S, 17)
    start = int(np.argmin([size(shift) for shift in grid]))
    low, high = grid[max(start - 1, 0)], grid[min(start + 1, grid.size - 1)]
    return float(
        optimize.minimize_scalar(size, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x
    )


def shifted_residual(change: Change, spectra: list[Array], extra: list[list[Array]]) -> list[Array]:
    """Return what is left of the output with the effect after a fit of filtered outputs without."""
    columns, targets = [], []
    for part, spectrum, mine, more in zip(change.with_effect, spectra, change.columns, extra, strict=True):
        count = kept(part.size, change.rate_hz)
        whole = np.fft.irfft(spectrum, part.size + round(change.rate_hz))
        columns.append([column[:count] for column in (whole, *mine, *more)])
        targets.append(part[:count])
    return projected(targets, columns)


def noise_floor(case: Case, channel: str) -> float:
    """Return the root mean square of a channel's noise; the balance of forces has the force's."""
    return case.noise_rms["force_n" if channel == "balance_n" else channel]


def nats(case: Case, channel: str, residual: list[Array], rate_hz: float) -> float:
    """Return the log-likelihood that a residual costs an ideal observer, who knows the noise."""
    total = 0.0
    for part in residual:
        spectrum = np.fft.rfft(part)
        angle = np.linspace(0.0, np.pi, spectrum.size) * rate_hz / case.rate_hz
        power = expected_spectrum(case.noise, noise_floor(case, channel), angle)
        total += float(np.sum(np.abs(spectrum) ** 2 / (part.size * power)))
    return total * case.rate_hz / rate_hz


def effect_to_noise(case: Case, change: Change, residual: list[Array]) -> float:
    """Return the ratio [dB] of what calibration leaves of a change to the noise of its channel."""
    return decibels(root_mean_square(residual) / noise_floor(case, change.channel))
