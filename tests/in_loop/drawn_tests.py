"""Drawn tests of every kind that a monitor in a loop is made for, with the errors that Python computes."""

from dataclasses import dataclass

import numpy as np

from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.effects.effect import Role
from reliab.effects.registry import find_effect, library
from reliab.in_loop.sources import LoopMonitor
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.critical_delay import stability_limit
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

FINE = 4096
EFFECT_NAMES = [name for name, effect in library().items() if effect.role is Role.FORCE]


@dataclass(frozen=True, kw_only=True)
class RandomTest:
    """A test, and what Python says of it; histories in rows by actuator or interface displacement."""

    monitor: LoopMonitor
    command: np.ndarray
    measured: np.ndarray
    begin: np.ndarray  # offsets of the sensors, then differences in equilibrium [m]
    error: np.ndarray
    peaks: np.ndarray  # of the commands, carried to the interface [m]
    alarm: float | None = None  # time of the alarm of the energy [s]; of one actuator only


def monitor_in_python(structure, monitor, command, reading, offset, peak=None):
    """What Python's monitor of one actuator says."""
    theirs = Monitor(structure, monitor.time_step, feedback_lag=monitor.feedback_lag, sensor_offset=offset)
    theirs.feed(command, reading)
    return RandomTest(
        monitor=monitor,
        command=command[np.newaxis],
        measured=reading[np.newaxis],
        begin=np.array([offset, 0.0]),
        error=theirs.error[np.newaxis],
        peaks=np.array([np.abs(command).max() if peak is None else peak]),
        alarm=theirs.gains_energy_since,
    )


def random_structure(rng):
    """A structure of one degree of freedom."""
    return Structure(
        frequency=float(np.exp(rng.uniform(np.log(0.5), np.log(4.0)))),
        damping_ratio=float(rng.uniform(0.01, 0.06)),
        experimental_fraction=float(rng.uniform(0.3, 1.0)),
    )


def random_test(seed, rate, seconds=12.0):
    """A structure, and the command and measured displacement of its simulated test."""
    rng = np.random.default_rng(seed)
    structure = random_structure(rng)
    share = rng.uniform(0.0, 3.0)
    delay = share * structure.damping_ratio / (np.pi * structure.frequency * structure.experimental_fraction)
    ground = np.repeat(rng.normal(size=int(seconds * rate) // 8), 8)
    test = HybridTest(structure=structure, actuator=Actuator(gain=rng.uniform(0.97, 1.03), delay=delay))
    histories = run_closed_loop(test, ground, 1.0 / rate)
    command = np.ascontiguousarray(histories.command.values[0])
    noise = rng.normal(size=command.size) * 1e-3 * np.abs(command).max()
    return structure, command, histories.measured + noise


def draw_single_degree(seed, rate):
    """A linear structure of one degree of freedom, with a delay up to thrice the critical one."""
    structure, command, reading = random_test(seed, rate)
    monitor = LoopMonitor(
        structure=Partition.from_structure(structure),
        time_step=1.0 / rate,
        feedback_lag=(0.0, 0.37, 2.6)[seed % 3] / rate,
    )
    return monitor_in_python(structure, monitor, command, reading, 1e-3 * (seed % 2))


def shaken(rate, seconds=12.0, seed=0):
    """A ground acceleration that begins and ends at rest [m/s²]."""
    time = np.arange(int(seconds * rate)) / rate
    values = np.random.default_rng(seed).normal(size=int(seconds * 32))
    return np.interp(time, np.arange(values.size) / 32, values) * np.sin(np.pi * time / seconds) ** 2


def random_partition(seed, degrees=None):
    """A frame of some storeys whose lower ones are driven, coupled by the specimen; `degrees`: so many."""
    rng = np.random.default_rng((seed, 7))
    floors = int(rng.integers(3, 6))
    degrees = int(rng.integers(2, 4)) if degrees is None else degrees
    stiffness = 2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1)
    stiffness *= (2.0 * np.pi * rng.uniform(0.8, 3.0)) ** 2
    original, normal_part, remainder = (
        stiffness[:degrees, :degrees],
        stiffness[:degrees, degrees:],
        stiffness[degrees:, degrees:],
    )
    share = (original - normal_part @ np.linalg.solve(remainder, normal_part.T)) * rng.uniform(0.2, 0.9)
    return Partition(
        mass=np.diag(rng.uniform(0.5, 2.0, floors)),
        damping=2e-3 * stiffness,
        stiffness=stiffness,
        interface=np.eye(floors)[:, :degrees],
        specimen_stiffness=share,
        specimen_damping=1e-3 * share,
        specimen_mass=0.05 * np.eye(degrees),
    )


def loop_with_delay(partition, delay, rate, ground):
    """Interface commands and measured displacements of a loop whose actuators are late by whole samples."""
    complete = partition.nonsingular_form
    gamma, late = complete.interface, round(delay * rate)
    mass, damping, stiffness = (
        complete.numerical_mass,
        complete.numerical_damping,
        complete.numerical_stiffness,
    )
    x, v = np.zeros(complete.size), np.zeros(complete.size)
    displacement = np.zeros((ground.size + late, complete.degrees))
    inverse = np.linalg.inv(mass)
    for k in range(ground.size):
        displacement[k + late] = gamma.T @ x
        rate_of_y = (displacement[k] - displacement[max(k - 1, 0)]) * rate
        force = complete.specimen_stiffness @ displacement[k] + complete.specimen_damping @ rate_of_y
        a = inverse @ (
            -complete.mass @ complete.influence * ground[k] - damping @ v - stiffness @ x - gamma @ force
        )
        v = v + a / rate
        x = x + v / rate
    channels = displacement[late:], displacement[: ground.size]
    return tuple(np.ascontiguousarray(channel.T) for channel in channels)


def draw_frame(seed, rate):
    """A frame of three to five storeys with one actuator, late by up to 1.5 times the critical delay."""
    rng = np.random.default_rng((seed, 9))
    partition = random_partition(seed, 1)
    delay = float(rng.uniform(0.0, 1.5)) * stability_limit(partition).delay
    (command,), (reading,) = loop_with_delay(partition, delay, rate, shaken(rate, 6.0, seed))
    read = reading + 1e-3 * np.abs(command).max() * rng.normal(size=command.size)
    monitor = LoopMonitor(
        structure=partition.nonsingular_form,
        time_step=1.0 / rate,
        feedback_lag=float(rng.choice([0.0, 0.4, 2.7])) / rate,
    )
    return monitor_in_python(monitor.structure, monitor, command, read, float(rng.choice([0.0, 1e-4])))


def errors_of_assess(partition, carry, command, reading, rate, lag=0.0, standing=None):
    """Errors by degree of freedom as `assess` computes them, without taking noise away.

    In a loop the next sample is not known, and readings are joined by straight lines.
    """
    recursion = Recursion.from_displacement(partition.nonsingular_form, 1.0 / rate)
    input_motion = np.stack([delay_history(row, lag, 1.0 / rate) for row in reading])
    state = None if standing is None else recursion.static @ carry @ standing
    return respond(recursion, carry @ (command - input_motion), state) - carry @ (command - reading)


def draw_several_actuators(seed, rate):
    """Two or three actuators with coupled kinematics, offsets, standing differences and a late force."""
    rng = np.random.default_rng((seed, 8))
    partition = random_partition(seed)
    carry = np.eye(partition.degrees) + 0.3 * rng.normal(size=(partition.degrees, partition.degrees))
    lag = float(rng.choice([0.0, 0.4, 2.7])) / rate
    if seed % 2:
        command = np.cumsum(rng.normal(size=(partition.degrees, 6 * rate)), axis=1) * 1e-3 / np.sqrt(rate)
        reading = 0.98 * command
    else:
        delay = float(rng.uniform(0.0, 1.5)) * stability_limit(partition).delay
        command, reading = (
            np.linalg.solve(carry, displacement)
            for displacement in loop_with_delay(partition, delay, rate, shaken(rate, 6.0, seed))
        )
    reading = reading + 1e-3 * np.abs(command).max() * rng.normal(size=command.shape)
    offset, standing = 1e-4 * rng.normal(size=(2, partition.degrees))
    sound = reading - offset[:, np.newaxis]
    return RandomTest(
        monitor=LoopMonitor(structure=partition, to_interface=carry, time_step=1.0 / rate, feedback_lag=lag),
        command=command,
        measured=reading,
        begin=np.concatenate([offset, standing]),
        error=errors_of_assess(partition, carry, command, sound, rate, lag, standing),
        peaks=np.abs(carry @ command).max(axis=1),
    )


def effects(kind, peak, stiffness, frequency):
    """Effects of a size that shows in a motion of a peak [m]; `stiffness` [N/m], `frequency` [rad/s]."""
    force, speed = stiffness * peak, peak * frequency
    friction = {"force_n": 0.1 * force, "regularisation_velocity_m_per_s": 0.01 * speed}
    yields = {"force_n": 0.3 * force, "displacement_m": 0.3 * peak, "lost_share": 1.0}
    sizes = {
        "series_play": {"width_m": 0.05 * peak},
        "cubic_stiffness": {"cubic_n_per_m3": 0.5 * stiffness / peak**2},
        "quadratic_stiffness": {"quadratic_n_per_m2": 0.2 * stiffness / peak},
        "coulomb_friction": friction,
        "directional_friction": {**friction, "asymmetry": 0.2},
        "viscous_damping": {"damping_n_s_per_m": 0.05 * stiffness / frequency},
        "directional_damping": {"damping_n_s_per_m": 0.05 * stiffness / frequency, "asymmetry": 0.3},
        "directional_power_law_damping": {
            "coefficient": 0.05 * force / speed**0.4,
            "exponent": 0.4,
            "asymmetry": 0.3,
        },
        "velocity_dependent_friction": {**yields, "slow_share": 0.5, "speed_m_per_s": 0.2 * speed},
        "masing_hysteresis": {**yields, "exponent": 1.0},
        "attached_oscillator": {
            "mass_kg": 0.05 * stiffness / frequency**2,
            "frequency_hz": 1.2 * frequency / (2.0 * np.pi),
            "damping_ratio": 0.05,
        },
        "quadratic_damping": {"coefficient_n_s2_per_m2": 0.1 * force / speed**2},
        "power_law_damping": {"coefficient": 0.05 * force / speed**0.4, "exponent": 0.4},
        "nonlinear_maxwell": {
            "coefficient": 0.1 * force / speed**0.4,
            "exponent": 0.4,
            "series_stiffness_n_per_m": 0.5 * stiffness,
        },
        "bilinear_stiffness": {"force_n": 0.5 * force, "displacement_m": 0.5 * peak, "exponent": 5.0},
        "self_centring": {
            "force_n": 0.5 * force,
            "displacement_m": 0.5 * peak,
            "exponent": 5.0,
            "flag_share": 0.6,
        },
        "hysteresis": yields,
        "degrading_hysteresis": {**yields, "stiffness_loss": 0.02, "strength_loss": 0.02, "slip": 0.5},
        "hysteresis_with_play": {**yields, "width_m": 0.05 * peak, "asymmetry": 0.2},
        "magnetorheological_damper": {
            "force_n": 0.2 * force,
            "displacement_m": 0.2 * peak,
            "gamma": 0.5,
            "exponent": 2.0,
            "damping_n_s_per_m": 0.05 * stiffness / frequency,
            "series_damping_n_s_per_m": 2.0 * stiffness / frequency,
        },
        "viscoelastic_branch": {"stiffness_n_per_m": 0.2 * stiffness, "time_s": 0.5 / frequency},
        "two_viscoelastic_branches": {
            "stiffness_n_per_m": 0.2 * stiffness,
            "time_s": 0.5 / frequency,
            "second_stiffness_n_per_m": 0.1 * stiffness,
            "time_ratio": 5.0,
        },
        "softening": {"lost_n_per_m": 0.2 * stiffness, "power": 1.0},
        "damage": {"lost_n_per_m": 0.1 * stiffness, "power": 1.0, "damage_n_per_m2": 0.1 * stiffness / peak},
        "added_mass": {"mass_kg": 0.1 * stiffness / frequency**2},
        "gap": {"gap_m": 0.1 * peak},
    }
    return (find_effect(kind)(**sizes[kind]),)


def nonlinear_test(seed, rate, kinds, seconds=10.0):
    """A model, and command, measured and exact displacement of a simulated test."""
    rng = np.random.default_rng((seed, 40))
    structure = Structure(
        frequency=float(np.exp(rng.uniform(np.log(0.5), np.log(3.0)))),
        damping_ratio=float(rng.uniform(0.02, 0.06)),
        experimental_fraction=float(rng.uniform(0.5, 1.0)),
    )
    mass = float(np.exp(rng.uniform(0.0, 8.0)))
    time = np.arange(int(seconds * FINE)) / FINE
    shaking = np.interp(time, np.arange(int(seconds * 32)) / 32, rng.normal(size=int(seconds * 32)))
    plain = HybridTest(structure=structure, mass=mass)
    peak = float(np.abs(run_closed_loop(plain, shaking, 1.0 / FINE).command.values[0]).max())
    size_values = [
        effects(kind, peak, plain.specimen.stiffness, structure.circular_frequency) for kind in kinds
    ]
    model = HybridTest(structure=structure, mass=mass, effects=tuple(single for (single,) in size_values))
    share = rng.uniform(0.2, 0.8) * 2.0 * structure.damping_ratio / structure.circular_frequency
    late = Actuator(gain=float(rng.uniform(0.98, 1.02)), delay=float(share))
    run = run_closed_loop(
        HybridTest(structure=structure, mass=mass, effects=model.effects, actuator=late), shaking, 1.0 / FINE
    )
    exact = run_closed_loop(model, shaking, 1.0 / FINE).command.values[0]
    interval = FINE // rate
    return model, *(np.ascontiguousarray(x[::interval]) for x in (run.command.values[0], run.measured, exact))


def draw_model(seed, rate, kinds=None, noise=None):
    """A specimen with one of the shipped effects in turn, or with `kinds`; every other one with noise."""
    kinds = (EFFECT_NAMES[seed % len(EFFECT_NAMES)],) if kinds is None else kinds
    model, command, reading, exact = nonlinear_test(seed, rate, kinds)
    level = 1e-3 * (seed // len(EFFECT_NAMES) % 2) if noise is None else noise
    peak = float(np.abs(exact).max())
    read = reading + level * peak * np.random.default_rng(seed).normal(size=reading.size)
    monitor = LoopMonitor(structure=model, time_step=1.0 / rate)
    return monitor_in_python(UpdatedModel(name="", test=model), monitor, command, read, 0.0, peak)


KINDS = {
    "one degree of freedom": draw_single_degree,
    "frame": draw_frame,
    "several actuators": draw_several_actuators,
    "model": draw_model,
}
