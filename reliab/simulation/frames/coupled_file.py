"""A structure with several actuators, as a laboratory describes it in `frame.toml`.

Beside the tables of a frame with one actuator (see `frame_file.py`)::

    [frame]
    names = ["x", "theta", "roof"]
    mass_matrix_kg = "M.csv"                  # a file beside this one, or rows; a degree of freedom may be
    stiffness_matrix_n_per_m = "K.csv"        #   without mass

    [specimen]
    degrees_of_freedom = ["x", "theta"]       # driven; or directions = [[1, 0, 0], [0, 1, 0]] with names
    stiffness_matrix_n_per_m = [[4.9e6, -1.6e6], [-1.6e6, 1.3e6]]   # rotations: N·m and N; or a larger
    damping_matrix_n_s_per_m = "C_e.csv"      #   matrix, whose further rows are condensed statically
    mass_matrix_kg = [[8.5, 0.0], [0.0, 0.9]]
    part_of_structure = false                 # the matrices of the frame do not hold the specimen

    [kinematics]                              # optional
    matrix = [[1.0, 0.127], [1.0, -0.127]]    # actuators by rows, degrees of freedom by columns
    # or [kinematics.geometry], exact where rotations are not small, with motions = ["x", "rotation"],
    #   pins_m = [[0.27, -0.127], [0.27, 0.127]] and directions = [[1, 0], [1, 0]] of the actuators at rest,
    #   lengths_m = [2.0, 2.0] between their pins where they are not long
    channels = "actuators"                    # what command_1, measured_1, … are; or "interface"

    [transfer_system]                         # optional
    matrix = [[{ numerator = [300.0], denominator = [1.0, 300.0] }, 0.0],
              [{ gain = 0.05 }, { numerator = [250.0], denominator = [1.0, 250.0] }]]
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reliab.arrays import Array
from reliab.described_files import read_toml
from reliab.errors import InputError
from reliab.simulation.frames.coupled_tables import (
    CoupledDescription,
    TransferMatrixTable,
    damping_of,
)
from reliab.simulation.frames.frame_file import (
    EXACT,
    REMEDY,
    FrameUnderTest,
    describe_frame,
    finite_products,
    frame_of_tables,
    names_several,
)
from reliab.simulation.frames.frame_tables import TransferTable
from reliab.simulation.frames.planar_geometry import PlanarGeometry
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.simulation.transfer_systems import ActuatorMatrix, TransferFunction, invertible
from reliab.structures import Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledFrame:
    """A frame whose specimen is driven at several degrees of freedom."""

    name: str  # Name given in the file
    partition: Partition
    kinematics: Array  # T, displacements of the actuators per interface displacement, shape (p, p)
    channels_at_interface: bool  # Whether a test's channels are interface displacements
    transfer_system: ActuatorMatrix | None = None  # The rig; None where the file describes none
    tolerances: TolerancesTable = EXACT  # How exactly the structure is known
    degrees_of_freedom: tuple[str, ...] = ()  # Names of all of them, in the order of the matrices
    geometry: PlanarGeometry | None = None  # Of the actuators, of which T is the part that is linear

    @property
    def to_interface(self) -> Array:
        """Interface displacements per unit of each channel [-], shape (p, p)."""
        if self.channels_at_interface:
            return np.eye(self.partition.degrees)
        return np.asarray(np.linalg.inv(self.kinematics), dtype=np.float64)

    def straightened(self, channels: Array) -> Array:
        """Displacements that T would have given for what channels show, shape (p, n)."""
        if self.geometry is None or self.channels_at_interface:
            return channels
        return self.geometry.as_small(channels)


def read_structure(path: str | Path) -> FrameUnderTest | CoupledFrame:
    """Read a tested frame with one actuator or several from its TOML file."""
    content = read_toml(path, rule="A frame is described in a TOML file", remedy=REMEDY)
    return structure_of_tables(content, str(path))


def structure_of_tables(content: dict[str, Any], where: str) -> FrameUnderTest | CoupledFrame:
    """Build a tested frame from the tables of a file, with one actuator or several."""
    if not names_several(content):
        return frame_of_tables(content, where)
    folder = Path(where).parent
    with finite_products(where):
        return _build(describe_frame(CoupledDescription, content, folder), folder)


def _build(description: CoupledDescription, folder: Path) -> CoupledFrame:
    if description.error.of != "interface":
        raise InputError(
            "Only errors of the measured interface displacements can be computed from a test",
            value=description.error.of,
            remedy="Leave [error] out",
        )
    partition, names = _partition(description)
    table = description.kinematics
    matrix, geometry = (np.eye(partition.degrees), None) if table is None else table.described
    kinematics = _kinematics(matrix, partition.degrees)
    return CoupledFrame(
        name=description.name,
        partition=partition,
        kinematics=kinematics,
        channels_at_interface=table is None or table.channels == "interface",
        transfer_system=_actuators(description.transfer_system, kinematics, folder),
        tolerances=description.tolerances.of_structure(
            names, partition.mass, partition.damping, partition.stiffness
        ),
        degrees_of_freedom=names,
        geometry=geometry,
    )


def _partition(description: CoupledDescription) -> tuple[Partition, tuple[str, ...]]:
    """Whole structure and specimen, which is added to matrices that do not hold it, and names of degrees."""
    table, specimen = description.frame, description.specimen
    mass, stiffness = table.matrices
    if np.shape(mass) != np.shape(stiffness):
        raise InputError(
            "Mass and stiffness matrices must be of one size",
            value=f"shapes {np.shape(mass)} and {np.shape(stiffness)}",
        )
    names = table.names or tuple(str(place + 1) for place in range(len(mass)))
    if len(names) != len(mass) or len(set(names)) != len(mass):
        raise InputError(
            f"The {len(mass)} degrees of freedom need as many different names", value=list(names)
        )
    interface, its_names = specimen.interface(names)
    k, c, m = specimen.matrices(interface.shape[1])
    damping = damping_of(description.damping, mass, stiffness)
    if not specimen.part_of_structure:
        mass, damping, stiffness = (
            whole + interface @ added @ interface.T
            for whole, added in ((mass, m), (damping, c), (stiffness, k))
        )
    partition = Partition(
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        interface=interface,
        specimen_stiffness=k,
        specimen_damping=c,
        specimen_mass=m,
        influence=table.influence,  # type: ignore[arg-type]  # made an array there
        names=its_names,
    )
    return partition, names


def _kinematics(matrix: Array, degrees: int) -> Array:
    if matrix.shape[1] != degrees:
        raise InputError(
            f"The kinematics need {degrees} columns, one for each degree of freedom of the specimen",
            value=matrix.shape[1],
        )
    return invertible(matrix)


def _actuators(
    table: TransferMatrixTable | TransferTable | None, kinematics: Array, folder: Path
) -> ActuatorMatrix | None:
    if table is None:
        return None
    if isinstance(table, TransferTable):
        size = len(kinematics)
        alike = _entry(table, folder)
        rows = tuple(tuple(alike if i == j else None for j in range(size)) for i in range(size))
    else:
        rows = tuple(tuple(_entry(entry, folder) for entry in row) for row in table.matrix)
    return ActuatorMatrix(kinematics=kinematics, transfer=rows)


def _entry(entry: TransferTable | float, folder: Path) -> TransferFunction | None:
    if isinstance(entry, TransferTable):
        system = entry.system(folder)
        if not isinstance(system, TransferFunction):
            raise InputError(
                "An entry of the matrix of transfer functions must not depend on the specimen",
                value="servo_hydraulic",
                remedy="Give numerator and denominator as they were identified with the specimen",
            )
        return system
    return TransferFunction(numerator=(entry,), denominator=(1.0,)) if entry else None
