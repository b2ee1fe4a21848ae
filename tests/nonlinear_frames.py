"""Hybrid tests of shear frames with one nonlinear specimen, simulated apart from the package's own loop."""

from dataclasses import dataclass

import numpy as np
from reliab_studies.measured_specimen.specimens import FAMILIES, PARAMETERS, STATES, resist

from reliab.core.compiled import compiled
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.frame import Frame, Specimen, floor_interface, modal_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame

STEP = 1.0 / 1024.0


@dataclass(frozen=True, kw_only=True)
class FrameTest:
    """A recorded test of a frame with its truth."""

    frame: FrameUnderTest
    recording: Recording
    moved: np.ndarray  # the true displacement of the specimen [m]
    ground: np.ndarray  # acceleration [m/s²]
    exact_floors: np.ndarray  # displacements with a perfect actuator [m], shape (samples, storeys)
    exact_force: np.ndarray  # of the specimen with a perfect actuator [N]

    @property
    def exact(self) -> np.ndarray:
        """Displacement of the interface with a perfect actuator [m]."""
        return self.exact_floors[:, 0]

    @property
    def error(self) -> float:
        """True RMS error over the peak of the exact response."""
        return float(np.sqrt(np.mean((self.moved - self.exact) ** 2)) / np.abs(self.exact).max())


@compiled
def _run(
    law,
    parameters,
    unit,
    specimen_stiffness,
    propagators,
    loads,
    actuator,
    state,
    floors,
    displacement,
    force,
):
    """Write floors in the computer, displacement of the specimen in the first storey and its force.

    `propagators`: what a step makes of the floors now, of those before, and of a force on the first floor.
    """
    now, before, by_force = propagators
    gain, delay = actuator
    whole_steps, part = int(delay / STEP), delay / STEP - int(delay / STEP)
    last = 0.0
    for i in range(displacement.size):
        near = floors[i - whole_steps, 0] if i >= whole_steps else 0.0
        far = floors[i - whole_steps - 1, 0] if i > whole_steps else 0.0
        displacement[i] = gain * ((1.0 - part) * near + part * far)
        step_over_unit = (displacement[i] - last) / unit
        last = displacement[i]
        share = resist(law, last / unit, step_over_unit, step_over_unit / STEP, STEP, state, parameters)
        force[i] = specimen_stiffness * unit * share
        for row in range(loads.shape[1]):
            floors[i + 1, row] = loads[i, row] - by_force[row, 0] * force[i]
            for column in range(loads.shape[1]):
                floors[i + 1, row] += now[row, column] * floors[i, column]
                if i > 0:
                    floors[i + 1, row] += before[row, column] * floors[i - 1, column]


def simulate_frame_test(
    family: str, ground: np.ndarray, draw: np.random.Generator, *, decibels: float = 40.0
) -> FrameTest:
    """Draw a frame, its specimen and actuator, run the test and record it with noise.

    `ground`: acceleration [m/s²] at 1024 Hz.
    """
    storeys = int(draw.integers(2, 5))
    mass, stiffness = shear_frame(
        (1000.0 * draw.uniform(0.7, 1.3, storeys)).tolist(),
        (draw.uniform(1e5, 3e5) * draw.uniform(0.8, 1.2, storeys)).tolist(),
    )
    damping = modal_damping(mass, stiffness, draw.uniform(0.02, 0.05))
    specimen_stiffness = draw.uniform(0.3, 0.9) * stiffness[0].sum()  # of the first storey
    complete = Frame(mass=mass, stiffness=stiffness, damping=damping)
    interface = floor_interface(complete, 1)
    partition = Partition.from_frame(
        frame=complete, interface=interface, specimen=Specimen(stiffness=specimen_stiffness)
    )
    numerical = stiffness - specimen_stiffness * np.outer(interface, interface)
    inverse = np.linalg.inv(mass / STEP**2 + damping / (2.0 * STEP))
    inertia = mass / STEP**2
    propagators = np.stack(
        [inverse @ (2.0 * inertia - numerical), inverse @ (damping / (2.0 * STEP) - inertia), inverse]
    )
    loads = -ground[:, np.newaxis] * (inverse @ mass.sum(axis=1))

    def run(law, parameters, unit, *actuator):
        """Floors in the computer, displacement of the specimen and its force."""
        floors, (displacement, force) = np.zeros((ground.size + 1, storeys)), np.zeros((2, ground.size))
        _run(
            law, parameters, unit, specimen_stiffness, propagators, loads, actuator,
            np.zeros(STATES), floors, displacement, force,
        )  # fmt: skip
        return floors[:-1], displacement, force

    law, traits = FAMILIES[family]
    no_parameters = np.zeros(PARAMETERS)
    parameters = no_parameters.copy()
    sample = traits(draw)
    parameters[: len(sample)] = sample
    peak = float(np.abs(run(FAMILIES["linear"][0], no_parameters, 1.0, 1.0, 0.0)[0][:, 0]).max())
    unit = peak / draw.uniform(1.5, 5.0)
    late = abs(draw.normal()) * 0.003 / float(complete.modes.frequency[0])
    exact, _, exact_force = run(law, parameters, unit, 1.0, 0.0)
    floors, displacement, force = run(law, parameters, unit, 1.0 + 0.01 * draw.normal(), late)
    noise = 10.0 ** (-decibels / 20.0)
    recording = Recording(
        name=family,
        command=floors[:, 0].copy(),
        measured=displacement + noise * displacement.std() * draw.standard_normal(displacement.size),
        force=force + noise * force.std() * draw.standard_normal(force.size),
        time_step=STEP,
    )
    frame = FrameUnderTest(name=f"{storeys} storeys", partition=partition, output=None, error_of="interface")
    return FrameTest(
        frame=frame,
        recording=recording,
        moved=displacement,
        ground=ground,
        exact_floors=exact,
        exact_force=exact_force,
    )
