"""Simulate tests: the closed loop under a ground motion, or a rig under a prescribed command.

Integration is classical Runge–Kutta of fourth order at `finest_hz` or just above (a whole number of steps
to a sample); the delayed command comes from a cubic Hermite history. Output is taken at the campaign's
rate.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from blind_campaigns.march import (
    CHANNELS,
    COMMAND,
    FORCE,
    MEMORIES,
    PISTON,
    PISTON_ACCELERATION,
    PISTON_VELOCITY,
    STATES,
    march,
)
from blind_campaigns.system import Array, Rig

FINEST_HZ = 8192.0


@dataclass(frozen=True, kw_only=True)
class Response:
    """What truly happened in a test, in SI units; `bounded` is false when the loop ran away."""

    command: Array
    piston: Array
    velocity: Array
    acceleration: Array
    force: Array
    bounded: bool


def substeps(rate_hz: float, finest_hz: float = FINEST_HZ) -> int:
    """Return the number of integration steps to a sample."""
    return max(1, math.ceil(finest_hz / rate_hz - 1e-9))


def _run(
    rig: Rig, ground: Array, noise: Array, past: Array, *, prescribed: bool, rate_hz: float, finest_hz: float
) -> Response:
    count = substeps(rate_hz, finest_hz)
    out = np.zeros((CHANNELS, ground.size))
    work = np.zeros((2, STATES)), np.zeros((4, STATES)), np.zeros((2, MEMORIES))
    bounded = march(
        rig.parameters(), ground, noise, past, prescribed, count, 1.0 / (rate_hz * count), out, *work
    )
    return Response(
        command=out[COMMAND],
        piston=out[PISTON],
        velocity=out[PISTON_VELOCITY],
        acceleration=out[PISTON_ACCELERATION],
        force=out[FORCE],
        bounded=bool(bounded) and bool(np.isfinite(out).all()),
    )


def applied_ground(rig: Rig, ground: Array, rate_hz: float) -> Array:
    """Return the ground acceleration that truly acted [m/s²], `ground` being what the operator recorded."""
    applied = rig.excitation_scale * ground
    scale, step = rig.find("excitation_scale"), rig.find("time_step_error")
    if scale is not None:
        applied = scale.parameters["scale"] * applied
    if step is not None:
        time = np.arange(ground.size) / rate_hz
        applied = np.interp(time / step.parameters["ratio"], time, applied, right=0.0)
    return applied


def simulate_loop(
    rig: Rig,
    ground: Array,
    *,
    rate_hz: float,
    finest_hz: float = FINEST_HZ,
    feedback_noise: Array | None = None,
) -> Response:
    """Return the closed loop's response to a recorded ground acceleration [m/s²], from rest.

    A controller's coarse integration steps are whole steps of the full rate, so that it is always simulated
    at that.
    """
    if rig.find("integration_error") is not None:
        finest_hz = FINEST_HZ
    noise = np.zeros(ground.size) if feedback_noise is None else feedback_noise
    steps = (ground.size - 1) * substeps(rate_hz, finest_hz) + 1
    applied = applied_ground(rig, ground, rate_hz)
    return _run(
        rig, applied, noise, np.zeros((steps, 3)), prescribed=False, rate_hz=rate_hz, finest_hz=finest_hz
    )


def simulate_prescribed(
    rig: Rig, command: Array, *, rate_hz: float, finest_hz: float = FINEST_HZ
) -> Response:
    """Return the response to a sampled command [m], a cubic spline between its samples."""
    time = np.arange(command.size) / rate_hz
    count = substeps(rate_hz, finest_hz)
    fine = np.arange((command.size - 1) * count + 1) / (rate_hz * count)
    spline = CubicSpline(time, command)
    past = np.stack([spline(fine), spline(fine, 1), spline(fine, 2)], axis=1)
    idle = np.zeros(command.size)
    return _run(rig, idle, idle, past, prescribed=True, rate_hz=rate_hz, finest_hz=finest_hz)


def sensed(rig: Rig, response: Response, rate_hz: float) -> tuple[Array, Array]:
    """Return displacement [m] and force [N] as noise-free but faulty sensors record them."""
    time = np.arange(response.piston.size) / rate_hz
    measured, force = response.piston.copy(), response.force.copy()
    for effect in rig.effects:
        values = effect.parameters
        if effect.name == "sensor_bias":
            measured += values["bias_m"]
        elif effect.name == "sensor_drift":
            measured += values["drift_m_per_s"] * time
        elif effect.name == "force_bias":
            force += values["bias_n"]
        elif effect.name == "nonlinear_sensor_scale":
            measured += values["per_m2"] * response.piston**3
    return measured, force


def dropped_out(rig: Rig, recorded: Array, rate_hz: float, test: int) -> Array:
    """Return a recorded displacement (tests count from 0) frozen now and then by `intermittent_dropout`."""
    effect = rig.find("intermittent_dropout")
    if effect is None:
        return recorded
    values = effect.parameters
    rng = np.random.default_rng([int(values["seed"]), test])
    count = rng.poisson(values["rate_per_s"] * recorded.size / rate_hz)
    length = max(2, round(values["hold_s"] * rate_hz))
    held = recorded.copy()
    for start in np.sort(rng.integers(1, recorded.size, count)):
        held[start : start + length] = held[start]
    return held
