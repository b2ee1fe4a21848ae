"""Structures of the study: springs, dampers and masses, at floors and in storeys."""

import pandas as pd
from reliab_studies.rths_benchmark.benchmark import benchmark_partition

from reliab.arrays import Array
from reliab.structures import (
    Partition,
    Specimen,
    Structure,
    drift_interface,
    floor_interface,
    stability_limit,
    with_specimen,
)
from reliab.structures.frames import Frame, modal_damping, shear_frame


def partitioned_structures() -> dict[str, Partition]:
    """Structures of the study by name: springs, dampers and masses, at floors and in storeys."""
    structure = Structure(frequency=1.0, damping_ratio=0.03, experimental_fraction=0.5)
    mass, stiffness = shear_frame([2000.0, 2000.0, 1500.0], [1.2e6, 1.0e6, 8.0e5])
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.03))
    low, soft = shear_frame([3000.0, 2500.0], [4e5, 2.5e5])
    two = Frame(mass=low, stiffness=soft, damping=modal_damping(low, soft, 0.05))
    tall, tower = shear_frame([1500.0] * 6, [9e5] * 6)
    six = Frame(mass=tall, stiffness=tower, damping=modal_damping(tall, tower, 0.02))

    def spring(frame: Frame, interface: Array, specimen: Specimen) -> Partition:
        return Partition.of_frame(frame=frame, interface=interface, specimen=specimen)

    def beside(frame: Frame, interface: Array, specimen: Specimen) -> Partition:
        return spring(with_specimen(frame, interface, specimen), interface, specimen)

    return {
        "one mass, half of its spring": Partition.of_structure(structure, mass=1000.0),
        "two storeys, the first one tested": spring(
            two, floor_interface(two, 1), Specimen(stiffness=4e5, mass=100.0)
        ),
        "two storeys, the second one tested": spring(
            two, drift_interface(two, 2, 1), Specimen(stiffness=2.5e5)
        ),
        "three storeys, half of the first": spring(frame, floor_interface(frame, 1), Specimen(stiffness=6e5)),
        "three storeys, a heavy specimen": spring(
            frame, floor_interface(frame, 1), Specimen(stiffness=5e5, mass=300.0)
        ),
        "three storeys, a damper parallel to the first": beside(
            frame, floor_interface(frame, 1), Specimen(stiffness=2e4, damping=6e3, mass=20.0)
        ),
        "six storeys, the first one tested": spring(
            six, floor_interface(six, 1), Specimen(stiffness=9e5, mass=50.0)
        ),
        "benchmark, case 1": benchmark_partition(1),
        "benchmark, case 4": benchmark_partition(4),
    }


def shares_of_structures() -> pd.DataFrame:
    """Tabulate modes and the specimen's share in them.

    Columns `structure`, `mode`, `f` [Hz], `xi`, shares `alpha`, `mass` and `damping` [-], and
    `critical_delay_ms` of the structure.
    """
    rows = []
    for name, partition in partitioned_structures().items():
        limit = stability_limit(partition).delay
        ratios, alphas = partition.frame.damping_ratios, partition.stiffness_shares
        felt = partition.impedance_shares
        for mode, frequency in enumerate(partition.frame.modes.frequency):
            rows.append(
                {
                    "structure": name,
                    "mode": mode + 1,
                    "f": float(frequency),
                    "xi": float(ratios[mode]),
                    "alpha": float(alphas[mode]),
                    "mass": float(alphas[mode] - felt[mode].real),
                    "damping": float(felt[mode].imag / (2.0 * ratios[mode])),
                    "critical_delay_ms": 1e3 * limit,
                }
            )
    return pd.DataFrame(rows)
