"""Errors that `assess` infers from what a laboratory records, beside the true ones of simulated tests.

Tests are simulated by a code that shares nothing with the package: the computer's part in exact steps under
straight lines, with a force that is extrapolated over each step; an actuator of second order with a dead time
behind an imperfect inverse; sensors with scale, skew, noise, a converter and filters. What is stated is off
by as much as in ordinary laboratories. `python tests/benchmarks/inferred_errors.py FOLDER --seed S --tests N
[--excitation NAME] ROW…` prints a line for each row, FOLDER being one of records with a catalog.csv.
"""

import time
from dataclasses import dataclass

import numpy as np
import scipy
from benchmark_script import argument_parser
from numba import njit

from reliab import assess, load_motions
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording

PEAK = 0.02  # m, of the exact response
MASS = 1000.0  # kg
ROWS = {
    "displacements": {"specimen": "linear"},
    "ground": {"specimen": "linear", "ground": True},
    "ground_calibrated": {"specimen": "linear", "ground": True, "is_calibrated": True},
    "ground_force": {"specimen": "linear", "ground": True, "force": True},
    "defaults": {},
    "nonlinear_force": {"force": True, "yielding": True},
    "nonlinear_force_ground": {"force": True, "ground": True, "yielding": True},
    "ground_force_no_mass": {"specimen": "linear", "ground": True, "force": True, "states_mass": False},
    "nonlinear_no_mass": {"force": True, "ground": True, "yielding": True, "states_mass": False},
    "nonlinear": {"yielding": True},
    "self_centring": {"force": True, "yielding": True, "flag": True},
    "self_centring_ground": {"force": True, "ground": True, "yielding": True, "flag": True},
}
EXCITATIONS = ("earthquake", "harmonic", "sweep", "white", "pulse", "free")


@dataclass(frozen=True, kw_only=True)
class World:
    """A simulated test."""

    rate: int
    frequency: float
    damping_ratio: float
    share: float
    command: np.ndarray
    measured: np.ndarray  # True displacement
    force: np.ndarray  # Of a unit mass
    ground: np.ndarray
    rms: float  # True error


def discretize(a, b, step):
    """Exact step of x' = a x + b u under straight lines."""
    size = len(a)
    matrix = np.zeros((size + 2, size + 2))
    matrix[:size, :size], matrix[:size, size], matrix[size, size + 1] = a * step, b * step, 1.0
    exact = scipy.linalg.expm(matrix)
    late = exact[:size, size + 1]
    return np.ascontiguousarray(exact[:size, :size]), exact[:size, size] - late, late.copy()


@njit(cache=True)
def specimen_force(law, x, moved, slip):
    """Force of a unit mass and what the specimen remembers: its slip, or its own force over the stiffness.

    `law`: stiffness, hardening, yield displacement (zero if linear), and the share of the force by which a
    self-centring specimen unloads lower than it was loaded; negative if it is bilinear.
    """
    stiffness, hardening, yields, flag = law
    if yields == 0.0:
        return stiffness * x, slip
    if flag < 0.0:
        slip = min(max(slip, x - yields), x + yields)
        return stiffness * (hardening * x + (1.0 - hardening) * (x - slip)), slip
    low = (1.0 - flag) * yields
    slip = min(max(slip + moved, min(max(x, -yields), low)), max(x, -low), yields)
    return stiffness * (hardening * x + (1.0 - hardening) * slip), slip


@njit(cache=True)
def loop(numerical, early, late, servo, servo_early, servo_late, ground, noise, inverse, gain, dead, law):
    """Command, displacement and force of a hybrid test."""
    size = ground.size
    command, displacement, force, sent = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    state, piston, slip = np.zeros(2), np.zeros(2), 0.0
    for i in range(size - 1):
        now = -ground[i] - force[i] - noise[i]
        ahead = 2.0 * force[i] - force[i - 1] if i else force[i]
        state = numerical @ state + early * now + late * (-ground[i + 1] - ahead - noise[i])
        command[i + 1] = state[0]
        sent[i + 1] = command[i + 1]
        if i >= 1:
            sent[i + 1] += inverse[0] * (command[i + 1] - command[i])
            sent[i + 1] += inverse[1] * (command[i + 1] - 2.0 * command[i] + command[i - 1])
        j = i + 1 - dead
        first, second = (sent[j - 1] if j >= 1 else 0.0), (sent[j] if j >= 0 else 0.0)
        piston = servo @ piston + servo_early * first + servo_late * second
        displacement[i + 1] = gain * piston[0]
        moved = displacement[i + 1] - displacement[i]
        force[i + 1], slip = specimen_force(law, displacement[i + 1], moved, slip)
        if abs(command[i + 1]) > 1e3:
            break
    return command, displacement, force


def critical_delay(omega, ratio, share):
    """Delay at which the loop loses stability [s]."""
    b = 2.0 * (1.0 - share) * omega**2 - 4.0 * (ratio * omega) ** 2
    c = ((1.0 - share) ** 2 - share**2) * omega**4
    square = 0.5 * (b + np.sqrt(b * b - 4.0 * c))
    frequency = np.sqrt(square)
    return np.arctan2(2.0 * ratio * omega * frequency, square - (1.0 - share) * omega**2) / frequency


def excitation(kind, generator, time, frequency, motions):
    """Ground acceleration, in any unit."""
    rate = 1.0 / time[1]
    match kind:
        case "earthquake":
            motion = motions[int(generator.integers(len(motions)))]
            at = np.arange(motion.acceleration.size) * motion.time_step
            return np.interp(time, at, motion.acceleration, right=0.0)
        case "harmonic":
            at = frequency * generator.uniform(0.6, 1.4)
            return np.sin(2.0 * np.pi * at * time) * np.minimum(1.0, time / 3.0)
        case "sweep":
            low, high = 0.4 * frequency, 2.5 * frequency
            return np.sin(2.0 * np.pi * (low * time + (high - low) * time**2 / (2.0 * time[-1])))
        case "white":
            corner = min(20.0 * frequency, 0.4 * rate)
            return scipy.signal.lfilter(
                *scipy.signal.butter(2, corner, fs=rate), generator.normal(size=time.size)
            )
        case "pulse":
            length = generator.uniform(0.5, 2.0) / frequency
            is_pulse = (time > 3.0) & (time < 3.0 + length)
            return np.where(is_pulse, np.sin(2.0 * np.pi * (time - 3.0) / length), 0.0)
    return np.where(time < 0.2 / frequency, 1.0, 0.0)


def simulate(generator, motions, kind, *, yielding, flag=False):
    """Simulate one test; None where its loop is unstable."""
    frequency = np.exp(generator.uniform(np.log(0.3), np.log(4.0)))
    ratio = np.exp(generator.uniform(np.log(0.01), np.log(0.06)))
    share, rate = generator.choice([1.0, 1.0, 0.8, 0.6, 0.4]), int(generator.choice([256, 512, 1024, 2048]))
    omega, step = 2.0 * np.pi * frequency, 1.0 / rate
    time = np.arange(0.0, generator.uniform(25.0, 60.0), step)
    ground = excitation(kind, generator, time, frequency, motions)
    late = generator.uniform(-0.5, 0.8) if generator.random() < 0.8 else generator.uniform(-0.1, 0.1)
    delay = np.clip(late * critical_delay(omega, ratio, share), -0.02, 0.04)
    servo, servo_damping = 2.0 * np.pi * generator.uniform(8.0, 25.0) * max(1.0, frequency / 1.5), 0.7
    dead = int(generator.integers(1, 4))
    servo_delay = 2.0 * servo_damping / servo + dead * step
    second = (1.0 / servo**2 + 2.0 * servo_damping / servo * dead * step + 0.5 * (dead * step) ** 2) * rate**2
    inverse = np.array([(servo_delay - delay) * rate, second * generator.uniform(0.6, 1.0)])
    exact = discretize(
        np.array([[0.0, 1.0], [-(omega**2), -2.0 * ratio * omega]]), np.array([0.0, 1.0]), step
    )
    nothing = np.zeros(time.size)
    still = (np.eye(2), np.zeros(2), np.zeros(2))
    perfect = (*exact, *still, ground, nothing, np.zeros(2), 1.0, 0, (0.0, 1.0, 0.0, -1.0))
    response = loop(*perfect)[0]
    scale = PEAK / np.abs(response).max()
    ground, response = ground * scale, response * scale
    stiffness = share * omega**2
    yields = PEAK / generator.uniform(1.2, 5.0) if yielding else 0.0
    law = (stiffness, 0.05, yields, generator.uniform(0.0, 1.0) if flag else -1.0)
    numerical = discretize(
        np.array([[0.0, 1.0], [-(1.0 - share) * omega**2, -2.0 * ratio * omega]]), np.array([0.0, 1.0]), step
    )
    actuator = discretize(
        np.array([[0.0, 1.0], [-(servo**2), -2.0 * servo_damping * servo]]), np.array([0.0, servo**2]), step
    )
    noise = generator.normal(size=time.size) * stiffness * PEAK * 10.0 ** (-generator.uniform(50, 65) / 20.0)
    gain = 1.0 + generator.uniform(-0.02, 0.02)
    arguments = (*numerical, *actuator, ground, noise, inverse, gain, dead, law)
    command, displacement, force = loop(*arguments)
    if not np.abs(command).max() < 10.0 * PEAK:
        return None
    if yielding:
        response = nonlinear(ground, omega, ratio, share, law, step)
    peak = np.abs(response).max()
    error = float(np.sqrt(np.mean((displacement - response) ** 2)) / peak)
    return World(
        rate=rate,
        frequency=frequency,
        damping_ratio=ratio,
        share=share,
        command=command,
        measured=displacement,
        force=force,
        ground=ground,
        rms=error,
    )


@njit(cache=True)
def nonlinear(ground, omega, ratio, share, law, step, fine=8):
    """Response with the specimen by central differences in fine steps."""
    h, half_damping = step / fine, ratio * omega * step / fine
    answer, x, v, slip, spring = np.zeros(ground.size), 0.0, 0.0, 0.0, 0.0
    for i in range(ground.size - 1):
        for k in range(fine):
            shaken = ground[i] + (ground[i + 1] - ground[i]) * k / fine
            v = ((1.0 - half_damping) * v + h * (-shaken - (1.0 - share) * omega**2 * x - spring)) / (
                1.0 + half_damping
            )
            x += h * v
            spring, slip = specimen_force(law, x, h * v, slip)
        answer[i + 1] = x
    return answer


def ask(world, generator, *, ground=False, force=False, states_mass=True, is_calibrated=False, specimen=None):
    """Record a test as a laboratory does, state what it knows, and judge it."""
    step, time = 1.0 / world.rate, np.arange(world.command.size) / world.rate
    scale, skew = 1.0 + generator.uniform(-0.005, 0.005), generator.uniform(-0.5, 0.5) * step
    level = 10.0 ** (-generator.uniform(40.0, 60.0) / 20.0)
    read = np.interp(time - skew, time, world.measured) * scale
    recorded_force = np.interp(time - generator.uniform(-0.5, 0.5) * step, time, world.force)
    recorded_force *= 1.0 + generator.uniform(-0.005, 0.005)
    recorded_command, statements = world.command, {}
    corner = generator.uniform(60.0, 120.0) * max(1.0, world.frequency)
    if generator.random() < 0.5 and corner < 0.4 * world.rate:
        filters = [
            scipy.signal.butter(2, corner * (1.0 + generator.uniform(-0.05, 0.05)), fs=world.rate)
            for _ in range(2)
        ]
        recorded_command, read = (
            scipy.signal.lfilter(*coefficients, row)
            for coefficients, row in zip(filters, (recorded_command, read), strict=True)
        )
        statements["filter"] = [f"{name}={corner:.1f}" for name in ("command", "measured")]
    read = read + generator.normal(size=read.size) * read.std() * level
    recorded_force = (
        recorded_force + generator.normal(size=recorded_force.size) * recorded_force.std() * level
    )
    converter = np.abs(read).max() * generator.uniform(3.0, 8.0) / 2.0**16
    read = np.round(read / converter) * converter
    if is_calibrated:
        statements |= {"scale": StatedValue(scale, 5e-4), "skew": StatedValue(1e3 * skew, 20.0 * step)}
    recording = Recording(
        command=recorded_command,
        measured=read,
        time_step=step,
        ground=world.ground if ground else None,
        force=MASS * recorded_force if force else None,
    )
    return assess(
        recording,
        f=world.frequency * (1.0 + generator.uniform(-0.02, 0.02)),
        xi=world.damping_ratio * (1.0 + generator.uniform(-0.2, 0.2)),
        alpha=world.share,
        specimen=specimen,
        **({"mass": MASS} if force and states_mass else {}),
        **statements,
    )


def measure(name, seed, tests, kind, motions):
    """Print the line of one row."""
    settings = dict(ROWS[name])
    yielding, flag = settings.pop("yielding", False), settings.pop("flag", False)
    rows, took, number = [], 0.0, 0
    while len(rows) < tests:
        generator = np.random.default_rng([seed, number])
        number += 1
        world = simulate(generator, motions, kind, yielding=yielding, flag=flag)
        if world is None or not 0.001 < world.rms < 0.35:
            continue
        began = time.perf_counter()
        verdict = ask(world, generator, **settings)
        took += time.perf_counter() - began
        rms = verdict.error.rebuilt.rms
        rows.append((world.rms, rms.value, rms.low, rms.high, str(verdict.verdict)))
    true, value, low, high = np.array([row[:4] for row in rows]).T
    word = np.array([row[4] for row in rows])

    def share(answer, among):
        return f"{np.mean(word[among] == answer):.2f}" if among.any() else "-"

    bad = true > 0.05
    print(
        f"{name:18s} {kind:10s} n {tests} coverage {np.mean((low <= true) & (true <= high)):.2f} "
        f"width/error {np.median((high - low) / true):.2f} ratio {np.median(value / true):.2f} "
        f"undecided {np.mean(word == 'undecided'):.2f} false safe {np.sum((word == 'reliable') & bad)} "
        f"false alarms {np.sum((word == 'not_reliable') & ~bad)} "
        f"NR >10 % {share('not_reliable', true > 0.1)} "
        f"6-10 % {share('not_reliable', (true > 0.06) & (true < 0.1))} "
        f"R 2-4 % {share('reliable', (true > 0.02) & (true < 0.04))} <2 % {share('reliable', true < 0.02)} "
        f"{took / tests:.2f} s",
        flush=True,
    )


def main():
    parser = argument_parser(__doc__, "folder", seed=1, tests=40)
    parser.add_argument("rows", nargs="*", choices=[*ROWS, []])
    parser.add_argument("--excitation", choices=EXCITATIONS, default="earthquake")
    options = parser.parse_intermixed_args()
    motions = load_motions(options.folder)
    for row in options.rows or ROWS:
        measure(row, options.seed, options.tests, options.excitation, motions)


if __name__ == "__main__":
    main()
