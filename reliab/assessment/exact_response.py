"""What a perfect actuator would have produced, with all as stated and draw by draw, of any kind of test."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.substructures import Substructures
from reliab.core.arrays import Array
from reliab.structures.partition import Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class ExactResponse:
    """Response at the interface that a perfect actuator would have given."""

    structure: Substructures
    at_interface: Array  # Displacements [m], shape (p, n)
    force: Array  # Of the specimen without the inertia of its mass [N], shape (p, n)
    felt: Array  # The same with it [N], shape (p, n)
    work: float  # Done on the specimen [J]


@dataclass(frozen=True, kw_only=True, eq=False)
class ExactTest:
    """A test as it should have been."""

    time_step: float  # s
    every: int  # Number of samples of which one was drawn
    interface: tuple[str, ...]  # Names of the interface displacements; one empty name where there is one
    degrees: tuple[str, ...]  # Names of all degrees of freedom; none where the interface is all
    ground: Array | None  # Its ground acceleration [m/s²], shape (n,); None where it was not recorded
    has_other_ground: bool  # Whether the recorded ground acceleration is that of another test
    measured: Array  # Displacements of the specimen without noise [m], shape (p, n)
    command: Array  # The same of the command [m], shape (p, n)
    fed_back: Array  # Force of the specimen along the measured path [N], shape (p, n)
    band: tuple[Array, Array]  # Ends of the 90 % band of the exact displacements [m], each shape (p, n)
    stated: ExactResponse
    draws: Callable[[], Iterator[ExactResponse]]


def _linear(partition: Partition, interface_displacements: Array, step: float) -> ExactResponse:
    shared = Substructures.from_partition(partition)
    force, felt_force = shared.force_of_linear(interface_displacements, step)
    work = float(np.sum(scipy.integrate.trapezoid(felt_force, interface_displacements, axis=1)))
    return ExactResponse(
        structure=shared, at_interface=interface_displacements, force=force, felt=felt_force, work=work
    )


def _respond_to_force(
    partition: Partition, interface_displacements: Array, force: Array, work: float
) -> ExactResponse:
    shared = Substructures.from_partition(partition)
    return ExactResponse(
        structure=shared, at_interface=interface_displacements, force=force, felt=force, work=work
    )


def _scale_by_mass(partition: Partition, factor: float) -> Partition:
    """Structure with all of its masses, and what they feel, larger by a factor."""
    names = ("mass", "damping", "stiffness", "specimen_stiffness", "specimen_damping", "specimen_mass")
    return partition.replace_values(**{name: factor * getattr(partition, name) for name in names})


def exact_test(
    error: ErrorOfTest, degrees: tuple[str, ...], ground: Array | None, mass: float | None = None
) -> ExactTest:
    """Say what a test should have been.

    `degrees`: names of all degrees of freedom; `ground` of this test [m/s²]; `mass` of one mass with a linear
    specimen [kg], as it was identified.
    """
    specimen = error.specimen
    rebuilt, step, rows = error.rebuilt, error.rebuilt.time_step, error.displacements
    larger = 1.0 if mass is None else mass / float(rebuilt.structure.mass[0, 0])
    exact = np.stack([row.reference for row in rows])
    measured_displacement = exact + np.stack([row.smooth_error for row in rows])
    if specimen is None:
        stated_response = _linear(_scale_by_mass(rebuilt.structure, larger), exact, step)
        fed_back = stated_response.structure.force_of_linear(measured_displacement, step)[1]
    else:
        stated_response = _respond_to_force(
            specimen.test.whole, exact, specimen.force[np.newaxis], specimen.work
        )
        fed_back = specimen.fed_back[np.newaxis]

    def draws() -> Iterator[ExactResponse]:
        if specimen is not None:
            draws_of_specimen = specimen.test.exact_of_draws(rebuilt.inferred.worlds())
            yield from (_respond_to_force(*response) for response in draws_of_specimen)
            return
        for structure, response in rebuilt.inferred.exact_draws():
            yield _linear(_scale_by_mass(structure, larger), response, rebuilt.inferred.every * step)

    return ExactTest(
        time_step=step,
        every=rebuilt.inferred.every,
        interface=rebuilt.structure.names if error.has_several else ("",),
        degrees=degrees,
        ground=ground,
        has_other_ground=error.ground.misfit is not None and ground is None,
        measured=measured_displacement,
        command=rebuilt.command,
        fed_back=fed_back,
        band=(
            measured_displacement - np.stack([row.high for row in rows]),
            measured_displacement - np.stack([row.low for row in rows]),
        ),
        stated=stated_response,
        draws=draws,
    )
