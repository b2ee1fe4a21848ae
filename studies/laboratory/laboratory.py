"""A digital laboratory: a partitioned structure under a ground motion, tested with a rig."""

import math
from dataclasses import dataclass, field

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.effect import Setting
from reliab.simulation.hybrid_test.closed_loop import Compensator
from reliab.simulation.hybrid_test.open_loop import STATES, Plan, plan
from reliab.simulation.transfer_systems.transfer_function import Plant, ServoHydraulic, TransferSystem
from reliab.structures.frame import exact_step, reference_response
from reliab.structures.partition import Partition

from .march import Events, NumericalStep, PlantStep, march


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """White noise and resolution of the two sensors."""

    # displacement_noise, force_noise: Root mean square of the noise [m] and [N], one value held over each
    # step
    displacement_noise: float = 0.0
    force_noise: float = 0.0
    displacement_step: float = 0.0  # displacement_step, force_step: Resolution [m] and [N]; 0 for none
    force_step: float = 0.0
    # Whether both noises are proportional to one sequence, as where one seed serves two generators
    common_noise: bool = False

    def __post_init__(self) -> None:
        for name in ("displacement_noise", "force_noise", "displacement_step", "force_step"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(
                    f"The {name.replace('_', ' ')} of a sensor must be finite and not negative", value=value
                )


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of the rig: stroke and rate limit the command, the third limits the force."""

    stroke: float = math.inf  # Largest displacement [m]
    rate: float = math.inf  # Largest velocity [m/s]
    force: float = math.inf  # Largest force [N]

    def __post_init__(self) -> None:
        for name in ("stroke", "rate", "force"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"The limit of the rig's {name} must be positive", value=getattr(self, name))


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Everything between the numerical substructure's target and the force that comes back."""

    # Actuator with its inner loop; the benchmark's by default
    transfer_system: TransferSystem = field(default_factory=ServoHydraulic)
    compensator: Compensator | None = None  # Controller or compensator before it; none by default
    sensors: Sensors = field(default_factory=Sensors)  # Noise and resolution
    limits: Limits = field(default_factory=Limits)  # Limits of the rig; none by default
    command_step: float = 0.0  # Resolution [m] of the converter that sends the command; 0 for none


_LOST = 10.0
"""A test counts as lost where the piston moves this many times further than the reference does."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """What a digital laboratory recorded, at equal steps."""

    step: float  # Step [s]
    floors: Array  # Displacements of the numerical substructure [m], shape (degrees of freedom, samples)
    reference: Array  # Those of the undivided structure [m], same shape
    command: Array  # Target displacement of the interface, γᵀ floors [m], shape (samples,)
    sent: Array  # Command that was sent to the actuator [m], shape (samples,)
    piston: Array  # piston, measured: True and measured displacement of the piston [m], shape (samples,)
    measured: Array
    force: Array  # Force as measured [N], shape (samples,)
    ground: Array  # Ground acceleration [m/s²], shape (samples,)
    lost: bool  # Whether the test diverged; the histories then end at that instant


def run_laboratory(
    partition: Partition,
    rig: Rig,
    ground: Array,
    step: float,
    *,
    rate: float = 4096.0,
    seed: int | None = None,
    emulate_differences: bool = False,
) -> Run:
    """Run a real-time hybrid test in a digital laboratory, from rest.

    `ground` [m/s²]; `step` [s]; `rate` [Hz].

    >>> from reliab.structures.structure import Structure
    >>> from reliab.structures.partition import Partition
    >>> from reliab.simulation.transfer_systems.transfer_function import TransferFunction
    >>> shaken = np.sin(2 * np.pi * np.arange(0.0, 10.0, 0.01))
    >>> partition = Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.05), mass=1000.0)
    >>> lag = TransferFunction(numerator=(1.0,), denominator=(0.001, 1.0))
    >>> run = run_laboratory(partition, Rig(transfer_system=lag), shaken, 0.01)
    >>> run.lost, run.measured.size
    (False, 40920)
    """
    h = 1.0 / rate
    times = h * np.arange(int((ground.size - 1) * step * rate + 1e-6) + 1)
    at_samples = step * np.arange(ground.size)
    shaken = np.interp(times, at_samples, ground)
    between = np.interp(times + 0.5 * h, at_samples, ground)
    reference = reference_response(partition.frame, shaken, h)
    plant = rig.transfer_system.plant(partition.specimen)
    _check(partition, rig, plant, seed, emulate_differences)
    largest = float(np.abs(partition.direction @ reference).max())
    setting = Setting(step=h, stiffness=partition.specimen.stiffness)
    floors, signals, run_to = march(
        shaken,
        between,
        h,
        _numerical_step(partition, h, emulate_differences),
        _plant_step(partition, plant, h),
        _events(rig, plant, h, _LOST * largest),
        _socket(rig, h),
        STATES if rig.compensator is None else max(STATES, rig.compensator.kernel.states),
        plan(partition.effects, setting),
        _noise(rig, seed, times.size),
        emulate_differences,
    )
    inside = slice(0, run_to)
    return Run(
        step=h,
        floors=floors[:, inside],
        reference=reference[:, inside],
        command=partition.direction @ floors[:, inside],
        sent=signals[0, inside],
        piston=signals[1, inside],
        measured=signals[2, inside],
        force=signals[3, inside],
        ground=shaken[inside],
        lost=run_to < times.size,
    )


def _check(partition: Partition, rig: Rig, plant: Plant, seed: int | None, emulate: bool) -> None:  # noqa: FBT001
    sensors = rig.sensors
    if seed is None and (sensors.displacement_noise > 0.0 or sensors.force_noise > 0.0):
        raise InputError("Sensors with noise need a seed", remedy="Give seed=0 or another number")
    if emulate and (partition.effects or not plant.differentiated.any()):
        raise InputError(
            "Difference blocks are emulated for a servo-hydraulic actuator and a linear specimen with mass",
            value=type(rig.transfer_system).__name__,
            remedy="Use the exact variant",
        )
    if math.isfinite(rig.limits.force) and not plant.contains_nonlinear:
        raise InputError(
            "A force is limited where the transfer system has one, as a servo-hydraulic actuator does",
            value=type(rig.transfer_system).__name__,
            remedy="Leave the limit of the force out, or choose another transfer system",
        )


def _numerical_step(partition: Partition, h: float, emulate: bool) -> NumericalStep:  # noqa: FBT001
    mass, n = partition.numerical_mass, partition.frame.size
    dynamics = np.zeros((2 * n, 2 * n))
    dynamics[:n, n:] = np.eye(n)
    dynamics[n:, :n] = -np.linalg.solve(mass, partition.numerical_stiffness)
    dynamics[n:, n:] = -np.linalg.solve(mass, partition.numerical_damping)
    loads = np.zeros((2 * n, 2))
    # The whole mass shakes; what the specimen's own mass lacks, the ground term brings.
    loads[n:, 0] = -np.linalg.solve(mass, partition.frame.mass @ partition.frame.influence)
    loads[n:, 1] = -np.linalg.solve(mass, partition.direction)
    if emulate:
        transition, early, middle, late = _runge_kutta_step(dynamics, loads, h)
    else:
        transition, early, late = exact_step(dynamics, loads, h)
        middle = np.zeros_like(early)
    accelerated = partition.direction @ dynamics[n:], partition.direction @ loads[n:]
    return NumericalStep(
        transition=np.ascontiguousarray(transition),
        early=early[:, 0].copy(),
        middle=middle[:, 0].copy(),
        late=late[:, 0].copy(),
        force=(early + middle + late)[:, 1].copy(),
        interface=np.array(partition.direction),
        accelerated=np.concatenate(accelerated),
    )


def _plant_step(partition: Partition, plant: Plant, h: float) -> PlantStep:
    loads = np.column_stack([plant.command, -plant.nonlinear])
    transition, early, late = exact_step(plant.dynamics, loads, h)
    specimen = partition.specimen
    return PlantStep(
        transition=np.ascontiguousarray(transition),
        command=(early + late)[:, 0].copy(),
        nonlinear=(early + late)[:, 1].copy(),
        displacement=np.array(plant.displacement),
        velocity=np.array(plant.velocity),
        force=np.array(plant.force),
        displacement_of_command=plant.displacement_of_command,
        force_of_command=plant.force_of_command,
        contains_nonlinear=plant.contains_nonlinear,
        dynamics=plant.dynamics - np.outer(plant.differentiated, plant.velocity),
        command_rate=np.array(plant.command),
        differenced=np.array(plant.differentiated),
        linear=np.array([specimen.stiffness, specimen.damping, specimen.mass]),
    )


def _events(rig: Rig, plant: Plant, h: float, beyond: float) -> Events:
    # What follows its command at once is read a step later, so that a pure delay has that step already.
    delay = plant.delay if plant.dynamics.size else max(plant.delay - h, 0.0)
    whole, fraction = divmod(delay / h, 1.0)
    sensors, limits = rig.sensors, rig.limits
    return Events(
        whole=int(whole),
        fraction=float(fraction),
        stroke=limits.stroke,
        rate=limits.rate,
        force=limits.force,
        command_step=rig.command_step,
        displacement_step=sensors.displacement_step,
        force_step=sensors.force_step,
        beyond=beyond,
    )


def _socket(rig: Rig, h: float) -> Plan:
    if rig.compensator is None:
        return plan((), Setting(step=h))
    address = np.array([rig.compensator.kernel.address], dtype=np.int64)
    return Plan(address, np.ascontiguousarray(rig.compensator.coefficients(h)[np.newaxis]))


def _noise(rig: Rig, seed: int | None, samples: int) -> Array:
    """Noise of displacement and force, shape (2, samples)."""
    sensors = rig.sensors
    if seed is None:
        return np.zeros((2, samples))
    draws = np.random.default_rng(seed).standard_normal((1 if sensors.common_noise else 2, samples))
    return np.ascontiguousarray(draws * np.array([[sensors.displacement_noise], [sensors.force_noise]]))


def _runge_kutta_step(dynamics: Array, loads: Array, step: float) -> tuple[Array, Array, Array, Array]:
    """Transition of the classical Runge-Kutta method, and the effects of loads at begin, middle and end."""
    n = dynamics.shape[0]
    a = step * dynamics
    eye = np.eye(n)
    k1 = a
    k2 = a @ (eye + 0.5 * k1)
    k3 = a @ (eye + 0.5 * k2)
    k4 = a @ (eye + k3)
    transition = eye + (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    early = (eye + a + 0.5 * a @ a + 0.25 * a @ a @ a) / 6.0
    middle = (4.0 * eye + 2.0 * a + 0.5 * a @ a) / 6.0
    late = eye / 6.0
    b = step * loads
    return transition, early @ b, middle @ b, late @ b
