"""Campaigns of frames with a hidden effect, simulated by code that imports nothing of the product.

The frame is stepped exactly for loads that are straight between samples; the actuator is a delay with an
optional lag, so that the force at the end of a step is known when the step is made.
"""

from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np
from scipy.linalg import expm

RATE, FINE = 512, 8  # samples per second, and steps of the simulation to each of them
SECONDS = 24.0


@dataclass(frozen=True)
class FrameWorld:
    """What a campaign is drawn from: matrices, interface, specimen, rig, and the hidden effect."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    gamma: np.ndarray
    specimen: tuple[float, float, float]
    gain: float
    delay_steps: int
    effect: str


def draw(seed: int, effect: str) -> FrameWorld:
    """Draw a shear frame of three storeys, one of which has a spring of its own in the laboratory."""
    random = np.random.default_rng([seed, 2026])
    masses = random.uniform(800.0, 2000.0, 3)
    storeys = random.uniform(0.6e6, 1.2e6, 3)
    stiffness = np.diag(storeys + np.append(storeys[1:], 0.0))
    stiffness -= np.diag(storeys[1:], 1) + np.diag(storeys[1:], -1)
    gamma = np.zeros(3)
    upper = random.integers(0, 2)
    gamma[upper] = 1.0
    specimen = (0.4 * storeys[upper], 0.0, random.uniform(10.0, 40.0))
    mass = np.diag(masses) + specimen[2] * np.outer(gamma, gamma)
    stiffness = stiffness + specimen[0] * np.outer(gamma, gamma)
    values, shapes = np.linalg.eigh(np.linalg.inv(np.sqrt(mass)) @ stiffness @ np.linalg.inv(np.sqrt(mass)))
    modal = np.sqrt(mass) @ shapes
    damping = modal @ np.diag(2.0 * 0.03 * np.sqrt(values)) @ modal.T
    return FrameWorld(
        mass,
        damping,
        stiffness,
        gamma,
        specimen,
        random.uniform(0.97, 1.03),
        int(random.integers(20, 50)),
        effect,
    )


def shaking(seed: int) -> np.ndarray:
    """Ground acceleration at the samples [m/s²]: noise that a soil layer filters, with a rise and a decay."""
    random = np.random.default_rng([seed, 77])
    times = np.arange(int(SECONDS * RATE)) / RATE
    noise = np.fft.rfft(random.normal(size=times.size))
    frequency = np.fft.rfftfreq(times.size, 1.0 / RATE)
    ground = 2.5
    layer = (1.0 + 1.2j * frequency / ground) / (1.0 - (frequency / ground) ** 2 + 1.2j * frequency / ground)
    smooth = np.fft.irfft(noise * layer * np.exp(-((frequency / 15.0) ** 4)) * (frequency > 0.2), times.size)
    envelope = np.minimum(times / 3.0, 1.0) * np.exp(-0.15 * np.maximum(times - 8.0, 0.0))
    return 2.5 * smooth * envelope / np.abs(smooth * envelope).max()


@numba.njit(cache=True)
def _march(transition, early, late, ground, gamma, specimen, gain, delay, lag, friction, sharpness, cubic, h):
    steps, states = ground.size, transition.shape[0]
    n = states // 2
    command, velocity = np.zeros(steps), np.zeros(steps)
    piston, force = np.zeros(steps), np.zeros(steps)
    displacement, speed = 0.0, 0.0
    z = np.zeros(states)
    for k in range(1, steps):
        sent, sent_speed = 0.0, 0.0
        if k >= delay:
            sent, sent_speed = gain * command[k - delay], gain * velocity[k - delay]
        last = speed
        if lag > 0.0:
            earlier = gain * command[k - 1 - delay] if k > delay else 0.0
            displacement += (1.0 - np.exp(-h / lag)) * (0.5 * (sent + earlier) - displacement)
            speed = (sent - displacement) / lag
        else:
            displacement, speed = sent, sent_speed
        slope = (speed - last) / h
        piston[k] = displacement
        force[k] = specimen[0] * displacement + specimen[1] * speed + specimen[2] * slope
        force[k] += friction * np.tanh(speed / sharpness) + cubic * displacement**3
        z = transition @ z
        for i in range(states):
            z[i] += early[i, 0] * ground[k - 1] + late[i, 0] * ground[k]
            z[i] += early[i, 1] * force[k - 1] + late[i, 1] * force[k]
        command[k], velocity[k] = gamma @ z[:n], gamma @ z[n:]
    return command, piston, force


def simulate(world: FrameWorld, ground: np.ndarray, like: tuple[float, float] | None = None):
    """Command, piston and force at the samples, and the peaks by which the hidden effect is sized.

    These are displacement and velocity of the test without the effect, or `like` those of another test.
    """
    n = world.gamma.size
    coupling = np.outer(world.gamma, world.gamma)
    k, c, m = world.specimen
    mass, damping, stiffness = (
        world.mass - m * coupling,
        world.damping - c * coupling,
        world.stiffness - k * coupling,
    )
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.eye(n)
    a[n:] = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    loads = np.zeros((2 * n, 2))
    loads[n:] = -np.linalg.solve(mass, np.column_stack([world.mass @ np.ones(n), world.gamma]))
    h = 1.0 / (RATE * FINE)
    joint = np.zeros((2 * n + 4, 2 * n + 4))
    joint[: 2 * n, : 2 * n], joint[: 2 * n, 2 * n : 2 * n + 2] = a * h, loads * h
    joint[2 * n : 2 * n + 2, 2 * n + 2 :] = np.eye(2)
    flow = expm(joint)
    late = flow[: 2 * n, 2 * n + 2 :]
    early = flow[: 2 * n, 2 * n : 2 * n + 2] - late
    fine = np.interp(np.arange(ground.size * FINE - FINE + 1), FINE * np.arange(ground.size), ground)

    def run(lag=0.0, friction=0.0, sharpness=1.0, cubic=0.0):
        return _march(
            flow[: 2 * n, : 2 * n].copy(), early, late, fine, world.gamma, np.array(world.specimen),
            world.gain, world.delay_steps, lag, friction, sharpness, cubic, h,
        )  # fmt: skip

    plain = run()
    peak, speed = like or (np.abs(plain[1]).max(), np.abs(np.diff(plain[1])).max() / h)
    histories = {
        "none": lambda: plain,
        "coulomb_friction": lambda: run(friction=0.15 * k * peak, sharpness=0.003 * speed),
        "cubic_stiffness": lambda: run(cubic=0.15 * k / peak**2),
        "first_order_lag": lambda: run(lag=0.008),
        "sensor_bias": lambda: plain,
        "excitation_scale": lambda: plain,
    }[world.effect]()
    return [values[::FINE] for values in histories], (peak, speed)


def write_campaign(folder: Path, seed: int, effect: str, *, tests: int = 3, noise: float = 1.0) -> None:
    """Write a campaign folder; what the operator believes lacks the hidden effect."""
    world = draw(seed, effect)
    k, c, m = world.specimen
    rows = lambda matrix: "[" + ", ".join(str(row.tolist()) for row in matrix) + "]"  # noqa: E731
    text = f"""name = "frame {seed}"
[structure.frame]
mass_matrix_kg = {rows(world.mass)}
stiffness_matrix_n_per_m = {rows(world.stiffness)}
[structure.damping]
matrix_n_s_per_m = {rows(world.damping)}
[structure.specimen]
direction = {world.gamma.tolist()}
stiffness_n_per_m = {k}
damping_n_s_per_m = {c}
mass_kg = {m}
[actuator]
gain = 1.0
delay_s = 0.01
[sampling]
rate_hz = {RATE}
"""
    random, sizes = np.random.default_rng([seed, 5]), None
    for number in range(tests):
        ground = shaking(10 * seed + number)
        (command, piston, force), sizes = simulate(world, ground, sizes)
        peak = sizes[0]
        bias = 0.04 * peak if effect == "sensor_bias" else 0.0
        ground_channel = 0.93 * ground if effect == "excitation_scale" else ground
        table = np.column_stack(
            [
                np.arange(ground.size) / RATE,
                ground_channel,
                command,
                piston + bias + 2e-4 * noise * peak * random.normal(size=ground.size),
                force + 5e-4 * noise * np.abs(force).max() * random.normal(size=ground.size),
            ]
        )
        header = "time_s,ground_acceleration_mps2,command_m,measured_m,force_n"
        np.savetxt(folder / f"test_{number}.csv", table, "%.9g", ",", header=header, comments="")
        text += f'[[tests]]\nfile = "test_{number}.csv"\nheld_out = {str(number == tests - 1).lower()}\n'
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
