"""How well another effect could pass for the true one, both refitted together with calibration.

Rivals of the actuator and sensor act on the block's output without the effect; rivals of the specimen and
of the balance of forces are columns of a linear fit (a few shapes are tried for those with a shape
parameter); in one-channel campaigns the loop is refitted as a whole. Only a handful of pairs that can
plausibly be confused is tried there.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from scipy import optimize

from blind_campaigns.case import Case, Observation, root_mean_square
from blind_campaigns.catalogue import Definition, Scales, registry
from blind_campaigns.loop_refit import loop_residual, working_rate
from blind_campaigns.march import replay_specimen
from blind_campaigns.ratio import Change, best_shift, calibrated_residual, shifted_residual, shifted_spectrum
from blind_campaigns.simulator import Response
from blind_campaigns.system import Array, Effect, Rig, Specimen

Residuals = tuple[list[Array], dict[str, list[Array]]]
"""What calibration leaves of an effect, and what it leaves together with each rival, test by test."""

SPECIMEN_RIVALS = (
    *("cubic_stiffness", "quadratic_stiffness", "coulomb_friction", "viscous_damping", "quadratic_damping"),
    *("hysteresis", "added_mass", "gap"),
)
BALANCE_RIVALS = ("excitation_scale", "time_step_error")
LOOP_RIVALS = {
    "first_order_lag": ("viscous_damping",),
    "second_order_dynamics": ("first_order_lag",),
    "delay_drift": ("first_order_lag",),
    "rate_limit": ("stroke_saturation", "quadratic_damping"),
    "stroke_saturation": ("rate_limit", "cubic_stiffness"),
    "backlash": ("gap", "coulomb_friction"),
    "cubic_stiffness": ("gap", "stroke_saturation"),
    "quadratic_stiffness": ("cubic_stiffness",),
    "coulomb_friction": ("viscous_damping", "hysteresis", "quadratic_damping"),
    "viscous_damping": ("quadratic_damping", "coulomb_friction"),
    "quadratic_damping": ("viscous_damping", "coulomb_friction"),
    "hysteresis": ("coulomb_friction", "viscous_damping", "cubic_stiffness"),
    "added_mass": ("viscous_damping",),
    "gap": ("cubic_stiffness", "backlash"),
    "time_step_error": ("viscous_damping",),
    "integration_error": ("viscous_damping",),
}


def rival_residuals(
    case: Case, effect: Effect, change: Change, responses: list[Response], scales: Scales
) -> Residuals:
    """Return what calibration alone leaves of an observed block's effect, and what each rival leaves."""
    plain = calibrated_residual(change)
    if change.channel == "balance_n":
        columns = _balance_columns(case)
        names = [name for name in BALANCE_RIVALS if name != effect.name]
        return plain, {name: calibrated_residual(change, columns[name]) for name in names}
    if effect.block == "specimen":
        names = [name for name in SPECIMEN_RIVALS if name != effect.name]
        return plain, {name: _specimen_rival(case, change, responses, scales, name) for name in names}
    if not change.shifts or effect.name == "sensor_bias":
        return plain, {}
    coarse = _strongest(change.coarse(), 2)
    found = {name: _output_rival(coarse, name) for name in _TRANSFORMS if name != effect.name}
    for name, columns in (("sensor_drift", _ramps(coarse)), ("delay_drift", _growing_rates(coarse))):
        if name != effect.name:
            found[name] = calibrated_residual(coarse, columns)
    return calibrated_residual(coarse), found


def loop_rival_residuals(case: Case, effect: Effect, scales: Scales) -> Residuals:
    """Return the same for a one-channel campaign, where only plausible rivals are tried."""
    definitions = registry()
    allowed = {"actuator", "specimen"} if case.observation is Observation.ONE_CHANNEL_RIG else {"specimen"}
    found = {}
    for name in LOOP_RIVALS.get(effect.name, ()):
        definition = definitions[name]
        if definition.block in allowed and case.rig.find(name) is None:
            found[name] = loop_residual(case, effect, rival=_sized(definition, scales))
    return (loop_residual(case, effect, evaluations=30) if found else []), found


def _sized(definition: Definition, scales: Scales) -> Callable[[float], Effect]:
    return lambda size: definition.make(size, scales, np.full(6, 0.25))


def loop_rate(case: Case) -> float:
    """Return the sampling rate of the residuals of `loop_rival_residuals` [Hz]."""
    return working_rate(case)


def _strongest(change: Change, count: int) -> Change:
    """Return a change with only the tests in which it is largest."""
    power = [root_mean_square([a - b]) for a, b in zip(change.with_effect, change.without, strict=True)]
    places = sorted(np.argsort(power)[-count:])
    return replace(
        change,
        with_effect=[change.with_effect[i] for i in places],
        without=[change.without[i] for i in places],
        columns=[change.columns[i] for i in places],
    )


def _ramps(change: Change) -> list[list[Array]]:
    return [[np.arange(part.size) / change.rate_hz] for part in change.without]


def _growing_rates(change: Change) -> list[list[Array]]:
    """Return t·dy/dt, what a drifting delay takes from an output y to first order."""
    return [[np.arange(part.size) * np.gradient(part)] for part in change.without]


def _balance_columns(case: Case) -> dict[str, list[list[Array]]]:
    """Return the change of the applied force per change of scale and, to first order, of the time step."""
    stride = max(1, int(case.rate_hz // 256.0))
    scale = [[given[::stride]] for given in case.inputs]
    step = [[(np.arange(given.size) * np.gradient(given))[::stride]] for given in case.inputs]
    return {"excitation_scale": scale, "time_step_error": step}


def _specimen_rival(
    case: Case, change: Change, responses: list[Response], scales: Scales, name: str
) -> list[Array]:
    """Return the residual after the best of a rival's shapes, its amplitude fitted linearly."""
    definition = registry()[name]
    bare = Rig(specimen=Specimen(stiffness_n_per_m=scales.stiffness), structure=case.rig.structure)
    stride = max(1, int(case.rate_hz // 256.0))
    candidates = []
    for size, shape in _shapes(name):
        rig = bare.adding(definition.make(size, scales, np.full(6, shape)))
        extra = []
        for response in responses:
            motion = (response.piston, response.velocity, response.acceleration, 1.0 / case.rate_hz)
            force = replay_specimen(rig.parameters(), *motion) - replay_specimen(bare.parameters(), *motion)
            extra.append([force[::stride]])
        candidates.append(calibrated_residual(change, extra))
    return min(candidates, key=root_mean_square)


def _shapes(name: str) -> list[tuple[float, float]]:
    """Return the sizes and shape numbers that are tried for a rival: only hysteresis and gap have a shape."""
    if name == "gap":
        return [(float(size), 0.25) for size in np.geomspace(0.002, 2.0, 16)]
    if name == "hysteresis":
        return [(0.1, float(shape)) for shape in np.linspace(-0.5, 1.2, 8)]
    return [(0.1, 0.25)]


def _output_rival(change: Change, name: str) -> list[Array]:
    """Return the residual after the best refit of delay, gain, offset and one actuator rival."""
    measures = _measures(change)
    transform, late = _TRANSFORMS[name]

    def residual(theta: Array) -> list[Array]:
        shift = (theta[0] - late(theta[1:])) / measures.omega
        spectra = [transform(part, change.rate_hz, theta[1:], measures) for part in change.without]
        spectra = [s * np.exp(-1j * w * shift) for w, s in spectra]
        return shifted_residual(change, spectra, [[] for _ in spectra])

    def size(theta: Array) -> float:
        return root_mean_square(residual(theta))

    spectra = [shifted_spectrum(part, change.rate_hz) for part in change.without]
    nothing: list[list[Array]] = [[] for _ in spectra]
    plain = best_shift(
        lambda shift: root_mean_square(
            shifted_residual(change, [s * np.exp(-1j * w * shift) for w, s in spectra], nothing)
        )
    )
    best = None
    for start in _STARTS[name]:
        first = np.array([plain * measures.omega, *start])
        simplex = np.vstack([first, *(first + row for row in np.diag([0.02, *[0.4] * len(start)]))])
        options = {"initial_simplex": simplex, "maxfev": 80, "xatol": 1e-5, "fatol": 1e-4 * size(first)}
        fit = optimize.minimize(size, first, method="Nelder-Mead", options=options)
        best = fit if best is None or fit.fun < best.fun else best
    return residual(best.x)


@dataclass(frozen=True, kw_only=True)
class _Measures:
    """How fast and how large a block's output is."""

    omega: float
    rms: float
    peak: float
    fastest: float


def _measures(change: Change) -> _Measures:
    rates = [np.gradient(part, 1.0 / change.rate_hz) for part in change.without]
    rms = root_mean_square(change.without)
    return _Measures(
        omega=root_mean_square(rates) / rms,
        rms=rms,
        peak=max(float(np.abs(part).max()) for part in change.without),
        fastest=max(float(np.abs(part).max()) for part in rates),
    )


Spectrum = tuple[Array, Array]
Transform = Callable[[Array, float, Array, _Measures], Spectrum]


def _lag(part: Array, rate_hz: float, theta: Array, own: _Measures) -> Spectrum:
    w, spectrum = shifted_spectrum(part, rate_hz)
    return w, spectrum / (1.0 + 1j * w * np.exp(theta[0]) / own.omega)


def _second_order(part: Array, rate_hz: float, theta: Array, own: _Measures) -> Spectrum:
    w, spectrum = shifted_spectrum(part, rate_hz)
    relative = w / (own.omega * np.exp(theta[0]))
    return w, spectrum / (1.0 - relative**2 + 2j * _servo_damping(theta) * relative)


def _servo_damping(theta: Array) -> float:
    """Return the damping ratio, at most 1.2: a servo with two far poles is a lag by another name."""
    return min(float(np.exp(theta[1])), 1.2)


def _rate_limit(part: Array, rate_hz: float, theta: Array, own: _Measures) -> Spectrum:
    return shifted_spectrum(_limited(part, np.exp(theta[0]) * own.fastest / rate_hz), rate_hz)


def _stroke(part: Array, rate_hz: float, theta: Array, own: _Measures) -> Spectrum:
    limit = np.exp(theta[0]) * own.peak
    return shifted_spectrum(np.clip(part, -limit, limit), rate_hz)


def _backlash(part: Array, rate_hz: float, theta: Array, own: _Measures) -> Spectrum:
    return shifted_spectrum(_played(part, np.exp(theta[0]) * own.rms), rate_hz)


@njit
def _limited(values, largest):
    out = np.empty(values.size)
    out[0] = values[0]
    for i in range(1, values.size):
        out[i] = out[i - 1] + min(max(values[i] - out[i - 1], -largest), largest)
    return out


@njit
def _played(values, half):
    out = np.empty(values.size)
    held = 0.0
    for i in range(values.size):
        held = min(max(held, values[i] - half), values[i] + half)
        out[i] = held
    return out


def _none(_theta: Array) -> float:
    return 0.0


_TRANSFORMS: dict[str, tuple[Transform, Callable[[Array], float]]] = {
    "first_order_lag": (_lag, lambda theta: np.exp(theta[0])),
    "second_order_dynamics": (_second_order, lambda theta: 2.0 * _servo_damping(theta) * np.exp(-theta[0])),
    "rate_limit": (_rate_limit, _none),
    "stroke_saturation": (_stroke, _none),
    "backlash": (_backlash, _none),
}
"""Each rival as a filter of the output, and the delay (in radians of the dominant motion) that it brings
along.
"""

_STARTS = {
    "first_order_lag": ([-4.0], [-1.5]),
    "second_order_dynamics": ([1.0, -0.7], [3.0, -0.7]),
    "rate_limit": ([-0.1], [-0.7]),
    "stroke_saturation": ([-0.1], [-0.7]),
    "backlash": ([-4.0], [-1.5]),
}
