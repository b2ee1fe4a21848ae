"""The virtual hybrid-simulation benchmark: three-storey frame, one actuator, four cases.

Data from Silva, Gomez, Maghareh, Dyke and Spencer (2020), *Mech. Syst. Signal Process.* 135, 106381:
structure, partition, plant with its uncertainty, sensors, converters and controllers.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from reliab_studies.laboratory.compensators.adaptive_inverse import AdaptiveInverse
from reliab_studies.laboratory.compensators.adaptive_model_based import AdaptiveModelBased
from reliab_studies.laboratory.compensators.adaptive_time_series import AdaptiveTimeSeries
from reliab_studies.laboratory.compensators.feedforward import Feedforward
from reliab_studies.laboratory.compensators.inverse import InverseCompensation
from reliab_studies.laboratory.compensators.model_inverse import ModelInverse
from reliab_studies.laboratory.compensators.pi_phase_lead import PhaseLeadControl
from reliab_studies.laboratory.laboratory import Rig, Sensors

from reliab.core.errors import InputError
from reliab.simulation.hybrid_test.closed_loop import Compensator
from reliab.simulation.transfer_systems.transfer_function import ServoHydraulic
from reliab.structures.frame import Frame, Specimen, floor_interface, modal_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import PlanarFrame

RATE: Final = 4096.0
"""Sampling rate [Hz]."""

SCALE: Final = 0.4
"""Scale of the ground motions [-]."""

FORCE_LIMIT: Final = 8900.0
"""Largest force of the actuator [N]."""

STRUCTURE: Final = PlanarFrame(
    storeys=3,
    bays=2,
    elastic_modulus=200e9,
    column_inertia=2.52 * 0.0254**4,
    beam_inertia=255267e-12,
    storey_height=0.635,
    bay_width=0.762,
)

_FLOOR_MASS: Final = (1000.0, 1100.0, 1300.0, 1000.0)
_DAMPING_RATIO: Final = (0.05, 0.04, 0.03, 0.03)
_SPECIMEN_MASS, _SPECIMEN_STIFFNESS, _SPECIMEN_RATIO = 29.13, 1.19e6, 0.0097
_PLANT_DEVIATIONS: Final = np.array([1.3, 3.3, 3.3e3])
_STIFFNESS_DEVIATION: Final = 5e4
_CONVERTER: Final = 2.0**-18
_FIRST_FACTORS: Final = (1.0, 1.98592e-2, 8.44014e-5, 1.98592e-7)  # of the plant without specimen

CASES: Final = (1, 2, 3, 4)

COMPENSATORS: Final = (
    *("pi_phase_lead", "none", "inverse", "model_inverse_first_order", "feedforward", "inverse_compensation"),
    *("adaptive_inverse", "adaptive_time_series", "adaptive_model_based"),
)
"""Names of the rigs' controllers: "inverse" is the third-order inverse of the plant."""


@dataclass(frozen=True, kw_only=True)
class BenchmarkPlant:
    """A plant of the benchmark: nominal, or drawn from its uncertainty.

    `stiffness`: true stiffness k_e of the specimen [N/m].
    """

    number: int
    servo: ServoHydraulic
    stiffness: float


def benchmark_frame(case: int) -> Frame:
    """Return the reference structure of a case 1 to 4.

    >>> benchmark_frame(1).modes.frequency.round(4)
    array([ 3.6124, 15.9966, 38.0862])
    """
    if case not in CASES:
        raise InputError("A case of the benchmark must be 1, 2, 3 or 4", value=case)
    mass = _FLOOR_MASS[case - 1] * np.eye(STRUCTURE.storeys)
    stiffness = STRUCTURE.lateral_stiffness()
    return Frame(
        mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, _DAMPING_RATIO[case - 1])
    )


def benchmark_partition(case: int, stiffness: float = _SPECIMEN_STIFFNESS) -> Partition:
    """Partition of a case: the specimen stands at the first floor; its stiffness k_e [N/m] may be another."""
    frame = benchmark_frame(case)
    damping = 2.0 * _SPECIMEN_RATIO * math.sqrt(stiffness * _SPECIMEN_MASS)
    specimen = Specimen(stiffness=stiffness, damping=damping, mass=_SPECIMEN_MASS)
    return Partition.from_frame(frame=frame, interface=floor_interface(frame, 1), specimen=specimen)


def benchmark_plants(perturbed: int, seed: int = 0) -> list[BenchmarkPlant]:
    """Draw plants with a₃, β₁, β₂ and k_e from normal distributions, beside the nominal one."""
    generator = np.random.default_rng([seed, 2020])
    plants = [BenchmarkPlant(number=0, servo=ServoHydraulic(), stiffness=_SPECIMEN_STIFFNESS)]
    while len(plants) <= perturbed:
        draws = generator.standard_normal(4)
        deviations = draws[:3] * _PLANT_DEVIATIONS
        if ServoHydraulic().leakage + deviations[0] > 0.0:
            servo = ServoHydraulic().perturb(deviations)
            stiffness = _SPECIMEN_STIFFNESS + float(draws[3]) * _STIFFNESS_DEVIATION
            plants.append(BenchmarkPlant(number=len(plants), servo=servo, stiffness=stiffness))
    return plants


def inverse_factors(servo: ServoHydraulic, specimen: Specimen) -> tuple[float, ...]:
    """Return the factors a₀ to a₃ of the inverse 1/(a₀ + a₁s + …) of the whole plant, for `ModelInverse`."""
    k, c, m = specimen.stiffness, specimen.damping, specimen.mass
    a2, a3, b1, b2 = servo.piston_coupling, servo.leakage, servo.valve_damping, servo.valve_stiffness
    column = np.array([k * a3, k + c * a3 + a2, c + m * a3, m])  # ascending powers
    whole = np.convolve([b2, b1, 1.0], column)
    whole[0] += servo.valve_gain
    return tuple((whole / (servo.input_gain * servo.valve_gain))[:4].tolist())


def benchmark_compensator(name: str) -> Compensator | None:
    """Return the controller or compensator of a name, set up for the nominal plant."""
    specimen = benchmark_partition(1).specimen
    factors = inverse_factors(ServoHydraulic(), specimen)
    lag = factors[1] / factors[0]
    compensators: dict[str, Compensator | None] = {
        "pi_phase_lead": PhaseLeadControl(quantum=_CONVERTER),
        "none": None,
        "inverse": ModelInverse(factors=factors),
        "model_inverse_first_order": ModelInverse(factors=factors[:2]),
        "feedforward": Feedforward(time=lag),
        "inverse_compensation": InverseCompensation(steps=lag * RATE + 1.0),
        "adaptive_inverse": AdaptiveInverse(steps=lag * RATE + 1.0),
        "adaptive_time_series": AdaptiveTimeSeries(factors=factors[:3]),
        "adaptive_model_based": AdaptiveModelBased(factors=_FIRST_FACTORS),
    }
    if name not in compensators:
        raise InputError(
            f"A compensator of the benchmark must be one of {', '.join(compensators)}",
            value=name,
            remedy="Choose one of these",
        )
    return compensators[name]


def benchmark_rig(compensator: str, plant: BenchmarkPlant) -> Rig:
    """Rig of the benchmark with a compensator before a plant."""
    sensors = Sensors(
        displacement_noise=math.sqrt(6.25e-14 * RATE),
        force_noise=math.sqrt(1.16e-3 * RATE),
        common_noise=True,
    )
    return replace(
        Rig(transfer_system=plant.servo, sensors=sensors, command_step=_CONVERTER),
        compensator=benchmark_compensator(compensator),
    )


def scale_record(acceleration: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ground acceleration of the benchmark [m/s²] from that of the record."""
    return np.asarray(SCALE * acceleration)
