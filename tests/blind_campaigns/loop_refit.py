"""The refit of a one-channel campaign, where only the loop as a whole can be compared."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import optimize

from blind_campaigns.case import Case, Observation
from blind_campaigns.simulator import dropped_out, sensed
from blind_campaigns.system import Actuator, Array, Effect, Rig

_WORKING_HZ = 256.0
_DELAY_UNIT_S = 0.01
_COARSE_HZ = 1024.0

SizedRival = Callable[[float], Effect]
"""A rival effect as a function of its dimensionless size."""


def loop_residual(
    case: Case, effect: Effect, *, rival: SizedRival | None = None, evaluations: int = 12
) -> list[Array]:
    """Return what calibration cannot explain of an effect, per test, at about 256 samples a second [m].

    Refitted in the loop without the effect: gain, delay and specimen stiffness with a rig, specimen
    stiffness and the excitation's scale without one, an offset unless the effect is one, and the size of
    `rival` where one is given.
    """
    target = _outputs(case, case.rig)
    missing = case.rig.without(effect)
    free_offset = effect.name != "sensor_bias"
    unknowns = _Unknowns(case, missing, rival, equivalent_delay(effect))

    def residual(theta: Array) -> Array:
        base = _outputs(case, unknowns.rig(theta))
        left = target - base if np.isfinite(base).all() else 10.0 * target
        return left - left.mean() if free_offset else left

    best = None
    for start in unknowns.starts:
        fit = optimize.least_squares(
            residual,
            start,
            bounds=(unknowns.low, np.inf),
            x_scale=unknowns.units,
            diff_step=1e-4,
            max_nfev=evaluations,
        )
        best = fit if best is None or fit.cost < best.cost else best
    sizes = [_thinned(case, given).size for given in case.inputs]
    return np.split(best.fun, np.cumsum(sizes)[:-1])


def working_rate(case: Case) -> float:
    """Return the sampling rate of the residual [Hz]."""
    return case.rate_hz / _stride(case)


def equivalent_delay(effect: Effect) -> float:
    """Return the delay [s] that linear actuator dynamics resemble at low frequency, else 0."""
    values = effect.parameters
    if effect.name == "first_order_lag":
        return values["time_constant_s"]
    if effect.name == "second_order_dynamics":
        return values["damping_ratio"] / (np.pi * values["natural_frequency_hz"])
    return 0.0


def _stride(case: Case) -> int:
    return max(1, int(case.rate_hz // _WORKING_HZ))


def _thinned(case: Case, values: Array) -> Array:
    return values[:: _stride(case)]


def _outputs(case: Case, rig: Rig) -> Array:
    runs = case.having(rig).run(_COARSE_HZ)
    outputs = []
    for number, run in zip(case.numbers, runs, strict=True):
        measured = sensed(rig, run, case.rate_hz)[0] if run.bounded else np.full(run.piston.size, np.nan)
        outputs.append(_thinned(case, dropped_out(rig, measured, case.rate_hz, number)))
    return np.concatenate(outputs)


class _Unknowns:
    """The calibration parameters of a loop as a vector of numbers near one, followed by a rival's size."""

    def __init__(self, case: Case, base: Rig, rival: SizedRival | None, delay_hint: float) -> None:
        self.base, self.rival = base, rival
        self.has_rig = case.observation is Observation.ONE_CHANNEL_RIG
        floor = 1.0 - base.actuator.delay_s / _DELAY_UNIT_S
        self.low = np.array([0.5, 0.5, floor] if self.has_rig else [0.5, 0.5])
        start = np.ones(self.low.size)
        self.units = np.full(start.size, 0.1)
        self.starts = [start]
        if self.has_rig and delay_hint > 0.0:
            self.starts = [start + np.array([0.0, 0.0, delay_hint / _DELAY_UNIT_S])]
        if rival is not None:
            self.low, self.units = np.append(self.low, 1e-6), np.append(self.units, 0.1)
            self.starts = [np.append(self.starts[0], size) for size in (0.01, 0.1)]

    def rig(self, theta: Array) -> Rig:
        """Return the rig that a vector stands for."""
        specimen = self.base.specimen
        rig = replace(
            self.base, specimen=replace(specimen, stiffness_n_per_m=theta[0] * specimen.stiffness_n_per_m)
        )
        if self.has_rig:
            actuator = self.base.actuator
            delay = max(actuator.delay_s + (theta[2] - 1.0) * _DELAY_UNIT_S, 0.0)
            rig = replace(rig, actuator=Actuator(gain=theta[1] * actuator.gain, delay_s=delay))
        else:
            rig = replace(rig, excitation_scale=theta[1] * rig.excitation_scale)
        return rig if self.rival is None else rig.adding(self.rival(theta[-1]))
