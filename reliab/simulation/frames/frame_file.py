"""A structure as a laboratory describes it in a file: `frame.toml`.

One set of tables describes every structure::

    name = "three storeys, a brace in the laboratory"

    [frame]                                  # either a shear frame …
    masses_kg = [1000.0, 1000.0, 1000.0]
    storey_stiffnesses_n_per_m = [2e6, 2e6, 2e6]
    # … or matrices: mass_matrix_kg (or masses_kg) and stiffness_matrix_n_per_m
    # … or [frame.planar] with storeys, bays, elastic_modulus_pa, column_inertia_m4, beam_inertia_m4,
    #   storey_height_m, bay_width_m and fixed_base, beside masses_kg
    names = ["1", "2", "3"]                  # optional
    influence = [1.0, 1.0, 1.0]              # optional

    [damping]                                # one of
    ratio = 0.02                             # the same for all modes, or ratios = [0.02, 0.03, 0.05]
    # rayleigh_ratios = [0.02, 0.02] with rayleigh_frequencies_hz = [1.0, 8.0]
    # matrix_n_s_per_m = [[…], …]

    [specimen]
    degree_of_freedom = "1"                  # between ground and floor; with below = "2" between two floors;
    # or direction = [1.0, 0.0, 0.0]
    stiffness_n_per_m = 5e5
    damping_n_s_per_m = 100.0                # optional, or damping_ratio of the specimen alone
    mass_kg = 20.0                           # optional
    part_of_structure = true                 # false: the specimen is added to the matrices above

    [[specimen.effects]]                     # optional: what it does beyond its linear part
    name = "coulomb_friction"
    force_n = 50.0                           # parameters by the names of the library

    [error]                                  # optional: whose error counts
    of = "interface"                         # or a degree of freedom, or "drift"
    between = ["2", "1"]                     # of a drift

    [tolerances]                             # optional: relative standard deviations, for `reliab assess`
    mass = 0.01                              # of a factor of M
    stiffness = 0.03                         # of a factor of K, the specimen's stiffness with it
    # or frequency = 0.005, in place of both, where natural frequencies were measured
    damping_ratio = 0.15                     # or damping, of a factor of C
    specimen_stiffness = 0.02                # of the specimen's share of the stiffness
    # specimen_changes_structure = true      # M, C and K change with it: the computer's part is as stated
    # floor_masses, storey_stiffnesses, storey_dampings = 0.05 or [0.02, 0.05, 0.05], each by itself, with
    #   storey_correlation = 0.5 between those of one number
    # or mode_frequencies and mode_damping_ratios, likewise, where modes are known better than matrices

    [[tolerances.entries]]                   # optional: of single entries of a matrix and those opposite
    matrix = "stiffness"                     # or "mass", "damping"
    places = [["1", "2"]]                    # by degrees of freedom
    deviation = 0.05
    correlation = 0.5                        # between several places

    [transfer_system]                        # optional: the rig, whose error `reliab criterion` states
    numerator = [250.0]                      # coefficients in descending powers of s
    denominator = [1.0, 250.0]
    # or poles_per_s = [-250.0, [-60.0, 80.0]], where [real, imaginary] stands for a conjugate pair, with
    #   zeros_per_s and gain (at rest) beside them
    # or file = "rig.mat" beside this file, with num and den, z, p and k, or A, B, C and D; variable = "rig"
    #   names a structure that holds them
    # or gain = 0.99 alone
    delay_ms = 1.5                           # optional: pure delay beside each of these
    # or [transfer_system.servo_hydraulic], the plant of the benchmark: input_gain, valve_gain,
    #   piston_coupling_n_per_m, leakage_per_s, valve_damping_per_s, valve_stiffness_per_s2, each optional

With several actuators ::

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

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.described_files import read_toml, validate_description
from reliab.core.errors import InputError
from reliab.simulation.frames.frame_tables import FrameDescription, read_matrices
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.simulation.frames.transfer_table import PlanarGeometry, rig_of_table
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferSystem, invertible
from reliab.structures.frame import square_matrix
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

_LEAST_SHARE, _LEAST_RATIO, _LARGEST_RATIO = 1e-3, 1e-4, 0.5


def place_of_governing_mode(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> int:
    """Place of the mode whose share of the response suffers most.

    `output`: weights of the degrees of freedom in the response whose error counts, shape (n,); by default it
    is the measured interface displacements. `erring`: what actuators that err add to the interface per
    command, shape (p, p); by default all err alike.
    """
    frame = partition.nonsingular_form.frame
    shapes = frame.modes.shapes
    output_rows = partition.nonsingular_form.interface.T if output is None else output[np.newaxis]
    participation = np.abs(output_rows @ shapes).max(axis=0) * np.abs(shapes.T @ frame.mass @ frame.influence)
    # The response of a mode to a given ground acceleration goes with 1/ω², its sensitivity with α/ξ.
    lightly = np.abs(_shares(partition, erring)) / np.maximum(frame.damping_ratios, _LEAST_RATIO)
    return int(np.argmax(lightly * participation / frame.modes.circular_frequency**2))


def governing_mode(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> Structure:
    """Frequency, damping ratio and share of the specimen of the mode that suffers most."""
    frame, place = partition.nonsingular_form.frame, place_of_governing_mode(partition, output, erring)
    share = abs(float(_shares(partition, erring)[place].real))
    return Structure(
        frequency=float(frame.modes.frequency[place]),
        damping_ratio=float(frame.damping_ratios[place]),
        experimental_fraction=float(np.clip(share, 1e-6, 1.0)),
    )


def scale_of_errors(
    partition: Partition, output: Array | None = None, erring: Array | None = None
) -> Structure:
    """One-mode structure that sets the scale of gains and delays.

    Its frequency is that of the mode and its damping ratio ξ/α with the specimen's share α in the mode, so
    that errors of an actuator matter as much as in the frame.
    """
    frame, place = partition.nonsingular_form.frame, place_of_governing_mode(partition, output, erring)
    share = min(float(np.abs(_shares(partition, erring)[place])), 1.0)
    # Amplitude errors count as far as the specimen's share of the mode; ξ/α is their scale.
    scale = float(frame.damping_ratios[place]) / max(share, _LEAST_SHARE)
    return Structure(
        frequency=float(frame.modes.frequency[place]),
        damping_ratio=float(np.clip(scale, _LEAST_RATIO, _LARGEST_RATIO)),
    )


def _shares(partition: Partition, erring: Array | None) -> Spectrum:
    """Force by which errors of the actuators move each mode, over that of its spring [-], shape (modes,)."""
    if erring is None:
        return partition.impedance_shares
    frequency, _, interface_shapes = partition.modes
    omega = 2.0 * np.pi * frequency
    forces = partition.impedance((1j * omega).astype(np.complex128)) @ erring
    return np.asarray(np.einsum("pi,ipq,qi->i", interface_shapes, forces, interface_shapes) / omega**2)


EXACT = TolerancesTable()
"""Tolerances of a structure that is known exactly."""

REMEDY = "Compare with the frames that ship in datasets/frames"
"""What to do about a description that cannot be read."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameUnderTest:
    """A structure with its specimen, the actuators that drive it and the response whose error counts."""

    name: str  # Name given in the file
    partition: Partition  # Structure, interface and specimen
    # Weights of the degrees of freedom [-], shape (degrees of freedom,); None for the measured interface
    # displacement
    output: Array | None = None
    error_of: str = "the measured interface displacement"  # The response in words
    # The rig, a matrix of several actuators; None where the file describes none
    transfer_system: TransferSystem | ActuatorMatrix | None = None
    tolerances: TolerancesTable = EXACT  # How exactly the structure is known
    has_several: bool = False  # Whether it is described as driven by several actuators
    # T, displacements of the actuators per interface displacement, shape (p, p); the identity by default
    kinematics: Array = None  # type: ignore[assignment]
    channels_at_interface: bool = True  # Whether a test's channels are interface displacements
    geometry: PlanarGeometry | None = None  # Of the actuators, of which T is the part that is linear

    def __post_init__(self) -> None:
        matrix = np.eye(self.partition.degrees) if self.kinematics is None else self.kinematics
        object.__setattr__(self, "kinematics", matrix)

    @property
    def to_interface(self) -> Array:
        """Interface displacements per unit of each channel [-], shape (p, p)."""
        if self.channels_at_interface:
            return np.eye(self.partition.degrees)
        return np.asarray(np.linalg.inv(self.kinematics), dtype=np.float64)

    @property
    def governing_mode(self) -> Structure:
        """Mode that governs the error; of several actuators the lowest one."""
        return self.partition.lowest_mode if self.has_several else governing_mode(self.partition, self.output)

    def order_of_channels(self, numbers: tuple[str, ...], location: str) -> list[int]:
        """Places of the channels of a test in the order of the interface, by their numbers or its names."""
        names = self.partition.names
        if len(numbers) != len(names):
            raise InputError(
                "Each actuator needs a command and a measured displacement",
                value=f"those of {', '.join(number or '1' for number in numbers)} for {len(names)} actuators",
                remedy="Name the columns command_1, measured_1, command_2, …",
                where=location,
            )
        if self.channels_at_interface and set(numbers) == set(names):
            return [numbers.index(name) for name in names]
        return list(range(len(names)))

    def straighten(self, channels: Array) -> Array:
        """Displacements that T would have given for what channels show, shape (p, n)."""
        if self.geometry is None or self.channels_at_interface:
            return channels
        return self.geometry.as_small(channels)


def read_structure(path: str | Path) -> FrameUnderTest:
    """Read a tested frame with one actuator or several from its TOML file."""
    content = read_toml(path, rule="A frame is described in a TOML file", remedy=REMEDY)
    return frame_of_tables(content, str(path))


def read_frame(path: str | Path) -> FrameUnderTest:
    """Read a tested frame with one actuator from its TOML file."""
    return require_one_actuator(read_structure(path), str(path))


def require_one_actuator(frame: FrameUnderTest, location: str) -> FrameUnderTest:
    """Refuse a frame with several actuators; `location` names its file."""
    if frame.has_several:
        raise InputError(
            "The specimen of this frame must be driven at one degree of freedom",
            value=", ".join(frame.partition.names),
            remedy="Describe one driven degree of freedom",
            where=location,
        )
    return frame


def frame_of_tables(content: dict[str, Any], location: str) -> FrameUnderTest:
    """Build a tested frame from the tables of a file, with one actuator or several."""
    folder = Path(location).parent
    with _finite_products(location):
        description = validate_description(
            FrameDescription,
            read_matrices(content, folder),
            rule="A frame must be described by known keys with allowed values",
            remedy=REMEDY,
        )
        return _build(description, folder)


@contextmanager
def _finite_products(location: str) -> Iterator[None]:
    """Refuse what overflows while a description is turned into matrices; `location` names the file."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError):
        raise InputError(
            "Mass, damping and stiffness of a frame must be finite numbers",
            value="a product of values of the description is too large",
            remedy="Check the units: kg, m, N and s",
            where=location,
        ) from None
    except InputError as error:
        raise InputError(error.rule, value=error.value, remedy=error.remedy, where=location) from None


def _build(description: FrameDescription, folder: Path) -> FrameUnderTest:
    partition, has_several = _partition(description), description.has_several_actuators
    error = description.error
    if has_several and error.of != "interface":
        raise InputError(
            "Only errors of the measured interface displacements can be computed from a test",
            value=error.of,
            remedy="Leave [error] out",
        )
    matrix, geometry, is_interface = np.eye(partition.degrees), None, True
    if description.kinematics is not None:
        matrix, geometry = description.kinematics.describe
        is_interface = description.kinematics.channels == "interface"
    kinematics, table = _kinematics(matrix, partition.degrees), description.transfer_system
    words = {
        "interface": "the measured interface displacement",
        "drift": f"the drift between {error.between}",
    }
    return FrameUnderTest(
        name=description.name,
        partition=partition,
        output=None if has_several else error.output(partition.frame),
        error_of=words.get(error.of, f"degree of freedom {error.of}"),
        transfer_system=rig_of_table(table, kinematics if has_several else None, folder),
        tolerances=description.tolerances.check_structure(
            partition.degrees_of_freedom, partition.mass, partition.damping, partition.stiffness
        ),
        has_several=has_several,
        kinematics=kinematics,
        channels_at_interface=is_interface,
        geometry=geometry,
    )


def _partition(description: FrameDescription) -> Partition:
    """Whole structure and specimen, which is added to matrices that do not hold it."""
    table, specimen = description.frame, description.specimen
    mass, stiffness = map(square_matrix, table.matrices, ("mass matrix", "stiffness matrix"))
    if mass.shape != stiffness.shape:
        raise InputError(
            "Mass and stiffness matrices must be of the same size",
            value=f"shapes {mass.shape} and {stiffness.shape}",
            remedy="Give one row and column for each degree of freedom",
        )
    names = table.names or tuple(str(place + 1) for place in range(len(mass)))
    if len(names) != len(mass) or len(set(names)) != len(mass):
        raise InputError(
            f"The {len(mass)} degrees of freedom need as many different names",
            value=list(names),
            remedy="Give each degree of freedom a name of its own",
        )
    interface, its_names = specimen.interface(names)
    if len(interface) != len(names):
        remedy = "Give one number for each degree of freedom"
        raise InputError(f"A direction needs {len(names)} numbers", value=len(interface), remedy=remedy)
    k, c, m = specimen.matrices(interface.shape[1])
    damping = description.damping.matrix(mass, stiffness)
    if not specimen.part_of_structure:
        mass, damping, stiffness = (
            total + interface @ specimen_part @ interface.T
            for total, specimen_part in ((mass, m), (damping, c), (stiffness, k))
        )
    return Partition(
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        interface=interface,
        specimen_stiffness=k,
        specimen_damping=c,
        specimen_mass=m,
        influence=table.influence,  # type: ignore[arg-type]  # made an array there
        names=its_names,
        degrees_of_freedom=names,
        effects=tuple(table.effect for table in specimen.effects),
    )


def _kinematics(matrix: Array, degrees: int) -> Array:
    if matrix.shape[1] != degrees:
        raise InputError(
            f"The kinematics need {degrees} columns, one for each degree of freedom of the specimen",
            value=matrix.shape[1],
            remedy="Give a row for each actuator, with a number for each driven degree of freedom",
        )
    return invertible(matrix)
