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
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reliab.arrays import Array
from reliab.described_files import Model, described, read_toml
from reliab.errors import InputError
from reliab.simulation.frames.frame_tables import FrameDescription
from reliab.simulation.frames.matrix_files import with_matrices
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.simulation.transfer_systems import TransferSystem
from reliab.structures import Partition, with_specimen
from reliab.structures.frames import Frame

EXACT = TolerancesTable()
"""Tolerances of a structure that is known exactly."""

REMEDY = "Compare with the frames that ship in datasets/frames"
"""What to do about a description that cannot be read."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameUnderTest:
    """A partitioned frame and the response whose error counts."""

    name: str  # Name given in the file
    partition: Partition  # Frame, interface and specimen
    # Weights of the degrees of freedom [-], shape (degrees of freedom,); None for the measured interface
    # displacement
    output: Array | None
    error_of: str  # The response in words
    transfer_system: TransferSystem | None = None  # The rig; None where the file describes none
    tolerances: TolerancesTable = EXACT  # How exactly the structure is known


def frame_of_tables(content: dict[str, Any], where: str) -> FrameUnderTest:
    """Build a tested frame with one actuator from the tables of a file."""
    if names_several(content):
        raise InputError(
            "The specimen of this frame must be driven at one degree of freedom",
            value="degrees_of_freedom",
            remedy="Describe one driven degree of freedom",
            where=where,
        )
    folder = Path(where).parent
    with finite_products(where):
        return _build(describe_frame(FrameDescription, content, folder), folder)


def describe_frame(schema: type[Model], content: dict[str, Any], folder: Path) -> Model:
    """Return what the tables of a frame's file describe by a schema, with the matrices of other files."""
    return described(
        schema,
        with_matrices(content, folder),
        rule="A description of a frame holds known keys with allowed values",
        remedy=REMEDY,
    )


def names_several(content: dict[str, Any]) -> bool:
    """Whether the tables of a file describe a specimen of several driven degrees of freedom."""
    specimen = content.get("specimen")
    described_so = isinstance(specimen, dict) and bool({"degrees_of_freedom", "directions"} & specimen.keys())
    return described_so or "kinematics" in content


@contextmanager
def finite_products(where: str) -> Iterator[None]:
    """Refuse what overflows while a description is turned into matrices; `where` names the file."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError):
        raise InputError(
            "Mass, damping and stiffness of a frame must be finite numbers",
            value="a product of values of the description is too large",
            remedy="Check the units: kg, m, N and s",
            where=where,
        ) from None
    except InputError as error:
        raise InputError(error.rule, value=error.value, remedy=error.remedy, where=where) from None


def read_frame(path: str | Path) -> FrameUnderTest:
    """Read a tested frame with one actuator from its TOML file."""
    content = read_toml(path, rule="A frame is described in a TOML file", remedy=REMEDY)
    return frame_of_tables(content, str(path))


def _build(description: FrameDescription, folder: Path) -> FrameUnderTest:
    frame = _frame(description)
    interface = description.specimen.interface(frame)
    specimen = description.specimen.specimen
    if not description.specimen.part_of_structure:
        if interface.shape != (frame.size,):
            raise InputError(f"The direction needs {frame.size} numbers", value=interface.size)
        frame = with_specimen(frame, interface, specimen)
    partition = Partition.of_frame(
        frame=frame,
        interface=interface,
        specimen=specimen,
        effects=tuple(table.effect for table in description.specimen.effects),
    )
    of, transfer = description.error, description.transfer_system
    rig = None if transfer is None else transfer.system(folder)
    words = {"interface": "the measured interface displacement", "drift": f"the drift between {of.between}"}
    return FrameUnderTest(
        name=description.name,
        partition=partition,
        output=of.output(frame),
        error_of=words.get(of.of, f"degree of freedom {of.of}"),
        transfer_system=rig,
        tolerances=description.tolerances.of_structure(
            frame.names, frame.mass, frame.damping, frame.stiffness
        ),
    )


def _frame(description: FrameDescription) -> Frame:
    """Frame of the matrices that are given."""
    table = description.frame
    mass, stiffness = table.matrices
    plain = Frame(
        mass=mass,
        stiffness=stiffness,
        damping=np.zeros_like(np.asarray(stiffness)),
        influence=table.influence,  # type: ignore[arg-type]  # made an array by Frame
        names=table.names,
    )
    return Frame(
        mass=mass,
        stiffness=stiffness,
        damping=description.damping.matrix(plain.mass, plain.stiffness),
        influence=plain.influence,
        names=plain.names,
    )
