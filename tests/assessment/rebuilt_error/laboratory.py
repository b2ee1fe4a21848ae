"""A laboratory of its own: hybrid tests of one degree of freedom by a fourth-order Runge–Kutta loop.

Nothing here imports `reliab`. The loop is x'' + 2ξω₀x' + (1 − α)ω₀²x + r = −a_g with the restoring force r
per unit mass of the displacement that the actuator reached (or reached a lag ago). The ground acceleration
is a straight line between samples. The undisturbed structure is the same loop with an actuator that reaches
its command at once.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np

PERFECT, DELAY, LAG, RATE_LIMIT, BACKLASH, LEAD, SECOND_ORDER, STROKE, BIAS, SLOW_GAIN = range(10)
"""What the actuator does; its four numbers are listed in `reached`."""

LINEAR, CUBIC, COULOMB, HYSTERESIS = range(4)
"""What the specimen does; its three numbers are listed in `restoring`."""

PARTS = 4
"""Steps of the integration between two samples."""

RATE = 1024.0


@dataclass(frozen=True)
class Lab:
    """A structure with its actuator and specimen."""

    f: float
    xi: float
    alpha: float = 1.0
    kind: int = PERFECT
    numbers: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    specimen: int = LINEAR
    shape: tuple[float, float, float] = (0.0, 0.0, 0.0)
    feedback_lag: float = 0.0


@dataclass(frozen=True)
class Outcome:
    """Histories at the samples: command, piston, force per unit mass, exact response."""

    command: np.ndarray
    measured: np.ndarray
    force: np.ndarray
    ideal: np.ndarray
    ground: np.ndarray

    @property
    def rms(self) -> float:
        """RMS^R by the trapezoidal rule."""
        error = self.measured - self.ideal
        return math.sqrt(np.trapezoid(error**2) / (error.size - 1)) / np.abs(self.ideal).max()

    @property
    def mte(self) -> float:
        """MTE^R."""
        return float(np.abs(self.measured - self.ideal).max() / np.abs(self.ideal).max())


@numba.njit(cache=True)
def _past(x, v, last, time, dt):
    """Command at a time: a cubic between stored instants, a straight line beyond the last."""
    place = time / dt
    if place <= 0.0:
        return x[0]
    j = int(place)
    if j >= last:
        return x[last] + (place - last) * dt * v[last]
    s = place - j
    a, b = x[j], x[j + 1]
    va, vb = v[j] * dt, v[j + 1] * dt
    return (
        (1 + 2 * s) * (1 - s) ** 2 * a
        + s * (1 - s) ** 2 * va
        + s * s * (3 - 2 * s) * b
        + s * s * (s - 1) * vb
    )


@numba.njit(cache=True)
def _past_velocity(v, last, time, dt):
    """Velocity of the command at a time, a straight line between stored instants."""
    place = time / dt
    if place <= 0.0:
        return 0.0
    j = min(int(place), last - 1)
    return v[j] + (place - j) * (v[j + 1] - v[j]) if j >= 0 else 0.0


@numba.njit(cache=True)
def _slopes(  # noqa: C901 - one compiled function, a branch for each actuator and specimen
    y, kind, numbers, shape, specimen, w0, xi, alpha, ground, coverage, late, late_velocity, time
):
    """Time derivatives of (x, v, piston, piston's velocity, hysteretic displacement), and force, piston."""
    x, v, m, mv, z = y[0], y[1], y[2], y[3], y[4]
    dm, dmv, piston, velocity = 0.0, 0.0, x, v
    if kind == DELAY:
        piston, velocity = numbers[0] * late, numbers[0] * late_velocity
    elif kind == LAG:
        dm = (numbers[0] * x - m) / numbers[1]
        piston, velocity = m, dm
    elif kind == RATE_LIMIT:
        dm = min(max((numbers[0] * x - m) / numbers[1], -numbers[2]), numbers[2])
        piston, velocity = m, dm
    elif kind == BACKLASH:
        piston = min(max(coverage, x - numbers[0]), x + numbers[0])
        velocity = v if abs(x - piston) >= 0.999999 * numbers[0] else 0.0
    elif kind == LEAD:
        piston = numbers[0] * (x + numbers[1] * v)
        velocity = v
    elif kind == SECOND_ORDER:
        wa, za = numbers[1], numbers[2]
        dm, dmv = mv, wa * wa * (numbers[0] * x - m) - 2.0 * za * wa * mv
        piston, velocity = m, mv
    elif kind == STROKE:
        piston = min(max(numbers[0] * x, -numbers[1]), numbers[1])
    elif kind == BIAS:
        piston, velocity = numbers[0] * x + numbers[1], numbers[0] * v
    elif kind == SLOW_GAIN:
        gain = numbers[0] + numbers[1] * math.sin(numbers[2] * time + numbers[3])
        piston, velocity = gain * x, gain * v
    k = alpha * w0 * w0
    force, dz = k * piston, 0.0
    if specimen == CUBIC:
        force += shape[0] * k * piston**3
    elif specimen == COULOMB:
        force += shape[0] * math.tanh(velocity / shape[1])
    elif specimen == HYSTERESIS:
        # Bouc–Wen: force k(a p + (1 − a)z), z' = p'(1 − (1/2 + 1/2 sgn(p'z))|z/d|ⁿ); shape = d, a, n
        dz = velocity * (1.0 - (0.5 + 0.5 * np.sign(velocity * z)) * abs(z / shape[0]) ** shape[2])
        force = k * (shape[1] * piston + (1.0 - shape[1]) * z)
    return v, -ground - 2.0 * xi * w0 * v - (1.0 - alpha) * w0 * w0 * x, dm, dmv, dz, force, piston


@numba.njit(cache=True)
def _march(  # noqa: C901 - one compiled loop
    ground, h, parts, kind, numbers, specimen, shape, w0, xi, alpha, lag
):
    """Classical Runge–Kutta steps; loops in place of whole arrays, which take seconds to compile."""
    n = ground.size
    dt = h / parts
    total = (n - 1) * parts + 1
    xs, vs, fs, ms = np.zeros(total), np.zeros(total), np.zeros(total), np.zeros(total)
    y, coverage = np.zeros(5), 0.0
    u, slope, summed = np.zeros(5), np.zeros(5), np.zeros(5)
    if kind == BIAS:
        ms[0], fs[0] = numbers[1], alpha * w0 * w0 * numbers[1]
    for i in range(1, total):
        j = (i - 1) // parts
        part = (i - 1) - j * parts
        a0 = ground[j] + (ground[j + 1] - ground[j]) * part / parts
        a1 = ground[j] + (ground[j + 1] - ground[j]) * (part + 1) / parts
        t = (i - 1) * dt
        for k in range(5):
            summed[k] = 0.0
        for stage in range(4):
            c = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            for k in range(5):
                u[k] = y[k] + c * dt * slope[k]
            a = a0 + (a1 - a0) * c
            time = t + c * dt
            tau = numbers[1] + numbers[2] * time if kind == DELAY else 0.0
            late = _past(xs, vs, i - 1, time - tau, dt) if tau > 0.0 else u[0]
            late_velocity = _past_velocity(vs, i - 1, time - tau, dt) if tau > 0.0 else u[1]
            v, acc, dm, dmv, dz, force, _ = _slopes(
                u, kind, numbers, shape, specimen, w0, xi, alpha, a, coverage, late, late_velocity, time
            )
            if lag > 0.0:
                place = max((time - lag) / dt, 0.0)
                low = min(int(place), i - 2) if i > 1 else 0
                fed = fs[low] + (place - low) * (fs[low + 1] - fs[low]) if i > 1 else 0.0
            else:
                fed = force
            slope[0], slope[1], slope[2], slope[3], slope[4] = v, acc - fed, dm, dmv, dz
            for k in range(5):
                summed[k] += (2.0 if stage in (1, 2) else 1.0) * slope[k]
        for k in range(5):
            y[k] += dt / 6.0 * summed[k]
        if kind == BACKLASH:
            coverage = min(max(coverage, y[0] - numbers[0]), y[0] + numbers[0])
        xs[i], vs[i] = y[0], y[1]
        time = i * dt
        tau = numbers[1] + numbers[2] * time if kind == DELAY else 0.0
        late = _past(xs, vs, i, time - tau, dt) if tau > 0.0 else y[0]
        late_velocity = _past_velocity(vs, i, time - tau, dt) if tau > 0.0 else y[1]
        out = _slopes(
            y, kind, numbers, shape, specimen, w0, xi, alpha, a1, coverage, late, late_velocity, time
        )
        fs[i], ms[i] = out[5], out[6]
        if not abs(y[0]) < 1e6:
            break
    return xs[::parts], ms[::parts], fs[::parts]


def run(
    lab: Lab,
    ground: np.ndarray,
    rate: float = RATE,
    parts: int = PARTS,
    ideal: np.ndarray | None = None,
) -> Outcome:
    """Run a test and, unless its exact response is given, its undisturbed structure from rest."""
    w0 = 2.0 * math.pi * lab.f
    common = (lab.specimen, np.array(lab.shape), w0, lab.xi, lab.alpha)
    command, measured_displacement, force = _march(
        ground, 1.0 / rate, parts, lab.kind, np.array(lab.numbers), *common, lab.feedback_lag
    )
    if ideal is None:
        ideal = _march(ground, 1.0 / rate, parts, PERFECT, np.array((1.0, 0.0, 0.0, 0.0)), *common, 0.0)[0]
    return Outcome(command=command, measured=measured_displacement, force=force, ideal=ideal, ground=ground)


def synthetic_ground(seed: int, duration: float = 30.0, rate: float = RATE) -> np.ndarray:
    """A shaken ground: filtered noise under an envelope, 3 m/s² at its peak."""
    rng = np.random.default_rng(seed)
    n = int(duration * rate)
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    corner = rng.uniform(1.5, 4.0)
    shape = frequency**2 / (1.0 + (frequency / corner) ** 4)
    spectrum = shape * (rng.standard_normal(frequency.size) + 1j * rng.standard_normal(frequency.size))
    time = np.arange(n) / rate
    values = np.fft.irfft(spectrum, n) * (time / 4.0) ** 2 * np.exp(-time / rng.uniform(3.0, 6.0))
    return 3.0 * values / np.abs(values).max()


def read_at2(path: Path, rate: float = RATE) -> np.ndarray:
    """Ground acceleration [m/s²] of a PEER file, straight lines between its samples."""
    lines = path.read_text(encoding="latin-1").splitlines()
    place = next(k for k, line in enumerate(lines) if "NPTS" in line.upper() or "DT" in line.upper().split())
    words = lines[place].upper().replace("=", " ").replace(",", " ").split()
    numbers = [float(word) for word in words if word.replace(".", "").replace("E-", "").isdigit()]
    step = next(number for number in numbers if number < 1.0)
    values = np.array([float(word) for line in lines[place + 1 :] for word in line.split()]) * 9.80665
    time = np.arange(0.0, (values.size - 1) * step, 1.0 / rate)
    return np.interp(time, step * np.arange(values.size), values)


def noise(kind: str, size: int, level: float, rng: np.random.Generator, rate: float = RATE) -> np.ndarray:
    """Noise of a root mean square `level`: white, slow, or of the mains."""
    if kind == "white":
        return level * rng.standard_normal(size)
    if kind == "slow":
        corner = math.exp(rng.uniform(math.log(0.2), math.log(20.0)))
        spectrum = rng.standard_normal((2, size + 1)).T @ [1.0, 1j]
        frequency = np.fft.rfftfreq(2 * size, 1.0 / rate)
        values = np.fft.irfft(spectrum / (1.0 + 1j * frequency / corner), 2 * size)[:size]
        return level * values / values.std()
    if kind == "mains":
        time = np.arange(size) / rate
        line = math.sqrt(2.0) * np.sin(2.0 * math.pi * rng.choice([50.0, 60.0]) * time + rng.uniform(0, 6.28))
        return level * (0.8 * line + 0.6 * rng.standard_normal(size))
    raise ValueError(kind)


def quantise(values: np.ndarray, level: float, rng: np.random.Generator) -> np.ndarray:
    """Readings in steps whose error has about the root mean square `level`."""
    step = math.sqrt(12.0) * level
    offset = rng.uniform()
    return step * (np.round(values / step + offset) - offset)
