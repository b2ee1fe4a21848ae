"""Actuators beyond the library: what a rig does with its command, by published kinds of equations.

Every function takes a fine step [s], the command of shape (n,), peaks of command and speed, and a generator,
and returns the motion of the piston, shape (n,).
"""

import numpy as np
from scipy import signal


def _filtered(numerator, denominator, step, command):
    system = signal.bilinear(numerator, denominator, 1.0 / step)
    return signal.lfilter(*system, command)


def third_order(step, command, reach, speed, rng):
    """A slow real pole before an oscillating pair far above, as a valve before an oil column."""
    del reach, speed
    slow, column = rng.uniform(0.03, 0.08), 2.0 * np.pi * rng.uniform(25.0, 45.0)
    damping = rng.uniform(0.3, 0.6)
    return _filtered(
        [column**2], np.polymul([slow, 1.0], [1.0, 2.0 * damping * column, column**2]), step, command
    )


def oil_column(step, command, reach, speed, rng):
    """An oscillating pair with a fast pole, and a stiffness that rises towards the ends of the stroke."""
    del speed
    natural, damping = 2.0 * np.pi * rng.uniform(2.5, 5.0), rng.uniform(0.4, 0.8)
    rise = rng.uniform(0.0, 0.1)
    y, v = 0.0, 0.0
    out = np.zeros(command.size)
    for i in range(1, command.size):
        push = natural**2 * (1.0 + rise * (y / reach) ** 2) * (command[i] - y) - 2.0 * damping * natural * v
        v += step * push
        y += step * v
        out[i] = y
    return _filtered([1.0], [0.002, 1.0], step, out)


def soft_stop(step, command, reach, speed, rng):
    """A stroke that ends in a cushion: the corner of the saturation is rounded."""
    del speed
    limit, sharpness = rng.uniform(0.4, 0.75) * reach, rng.uniform(6.0, 14.0)
    cushioned = command / (1.0 + np.abs(command / limit) ** sharpness) ** (1.0 / sharpness)
    return _filtered([1.0], [0.003, 1.0], step, cushioned)


def valve_flow(step, command, reach, speed, rng):
    """A valve whose flow saturates softly: y' = L·tanh(K(u − y)/L)."""
    del reach
    limit, gain = rng.uniform(0.35, 0.7) * speed, rng.uniform(80.0, 200.0)
    y = 0.0
    out = np.zeros(command.size)
    for i in range(1, command.size):
        y += step * limit * np.tanh(gain * (command[i] - y) / limit)
        out[i] = y
    return out


def elastic_play(step, command, reach, speed, rng):
    """Play whose flanks are springs: the piston is drawn along before the slack is crossed."""
    del speed
    half, drag = 0.5 * rng.uniform(0.1, 0.3) * reach, rng.uniform(0.02, 0.1)
    y = command[0]
    out = np.zeros(command.size)
    for i, u in enumerate(command):
        y = min(max(y + drag * (u - y) * 10.0 * step, u - half), u + half)
        out[i] = y
    return out


ACTUATORS = {
    "third_order": (third_order, {"first_order_lag", "second_order_dynamics"}),
    "oil_column": (oil_column, {"second_order_dynamics", "first_order_lag"}),
    "soft_stop": (soft_stop, {"stroke_saturation"}),
    "valve_flow": (valve_flow, {"rate_limit"}),
    "elastic_play": (elastic_play, {"backlash"}),
}
"""Equation and the names of the library that stand for it, by world."""
