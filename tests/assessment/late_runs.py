"""One motion under actuators of several delays, stepped without the package; true errors beside it."""

from functools import cache

import numpy as np
import pandas as pd

RATE, SECONDS = 256.0, 18.0
TIME = np.arange(0.0, SECONDS, 1.0 / RATE)


def response(ground, *, delay, gain, f=1.0, xi=0.05):
    """Step a loop with a late actuator: command and what the actuator does [m]."""
    w, step = 2.0 * np.pi * f, 1.0 / RATE
    x, v = np.zeros(TIME.size), 0.0
    lag = delay * RATE
    displacement = np.zeros(TIME.size)
    for k in range(TIME.size - 1):
        displacement[k] = gain * np.interp(k - lag, np.arange(max(k - 9, 0), k + 1), x[max(k - 9, 0) : k + 1])
        v += step * (-ground[k] - 2.0 * xi * w * v - w**2 * displacement[k])
        x[k + 1] = x[k] + step * v
    displacement[-1] = displacement[-2]
    return x, displacement


@cache
def runs_of(seed, *, delays=(0.009, 0.003), f=1.0):
    """One motion under several delays, with noise of the sensors; and the true errors, RMS over the peak."""
    random = np.random.default_rng(seed)
    ground = random.normal(size=TIME.size) * np.exp(-(((TIME - 8.0) / 5.0) ** 2))
    exact, _ = response(ground, delay=0.0, gain=1.0, f=f)
    frames, errors = [], []
    for delay in delays:
        command, displacement = response(ground, delay=delay, gain=1.0, f=f)
        noise = 1e-3 * np.abs(exact).max() * random.normal(size=TIME.size)
        frames.append(
            pd.DataFrame({"time_s": TIME, "command_m": command, "measured_m": displacement + noise})
        )
        errors.append(np.sqrt(np.mean((displacement - exact) ** 2)) / np.abs(exact).max())
    return frames, errors
