"""The error of a test whose specimen is nonlinear and has a model.

Subtracting the equations of motion of the test and of the undisturbed structure leaves, for any specimen r ::

    m e'' + c e' + k e = −(f − r[x_I]),   x_I = x_c − e

with the numerical substructure's c and k. The force that was fed back is computed with the same model under
the measured motion, f = r[x_m], so that errors of the model cancel to first order. The demand is computed
from the test itself: the structure with a perfect actuator is simulated under

    a(t) = −(x_c'' + c x_c'/m + k x_c/m + r[x_m]/m)

which is the ground acceleration where model and test agree; the recorded one is not needed. For a linear r
this is the equation of `rebuild`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.assessment.inference.evidence import Evidence
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.simulated import SimulatedTest
from reliab.assessment.inference.uncertain_quantity import Circumstances
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.rebuilt_error.size import samples_in_step_of_simulation
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.effects.effect import Effect, Role
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.partition import Partition

_DRAWS = 64  # of the specimen and of everything else that is uncertain, at most
_LARGEST_RATIO = 0.99
_LEAST = 0.05  # of a value: a draw of a positive parameter goes no lower


def infer_modelled(
    command: Array, model: UpdatedModel, circumstances: Circumstances, *, draws: int, seed: int
) -> InferredError:
    """Infer the error of a test with a calibrated specimen, whose channels show nothing of what is unknown.

    `command` [m], shape (n,).

    >>> from reliab.assessment.rebuild import rebuild
    >>> from reliab.simulation.hybrid_test.model import Actuator
    >>> from reliab.effects.registry import find_effect
    >>> from reliab.structures.structure import Structure
    >>> structure = Structure(frequency=1.0, damping_ratio=0.05)
    >>> friction = find_effect("coulomb_friction")(force_n=0.05, regularisation_velocity_m_per_s=0.01)
    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> shaken = np.sin(6.0 * time) * np.exp(-0.2 * time)
    >>> late = HybridTest(structure=structure, actuator=Actuator(delay=0.004), effects=(friction,))
    >>> run = run_closed_loop(late, shaken, 0.002)
    >>> error = rebuild(run.command.values[0], run.measured, 0.002, UpdatedModel(name="late", test=late))
    >>> ideal = run_closed_loop(replace(late, actuator=Actuator()), shaken, 0.002).command.values[0]
    >>> true = np.sqrt(np.mean((run.measured - ideal) ** 2)) / np.abs(ideal).max()
    >>> bool(abs(error.rms.value / true - 1.0) < 0.02)
    True
    """
    test, channels = model.test, circumstances.channels
    lowest = float(circumstances.partition.natural_frequencies[0])
    stride = samples_in_step_of_simulation(lowest, channels.band.record_step)
    modelled = ModelledTest(
        model=HybridTest(
            structure=test.structure, mass=test.mass, specimen=test.specimen, effects=test.acting(Role.FORCE)
        ),
        deviations=model.deviations,
        channels=channels,
        recorded_command=command,
        every=stride,
        seed=seed,
    )
    return infer_errors(circumstances, stride, seed, draws=min(draws, _DRAWS), test=modelled)


def tangent_structure(test: HybridTest) -> Partition:
    """Whole structure per unit mass with the linear specimen of a model."""
    specimen = test.specimen
    if test.structure is None or specimen is None:
        raise InputError(
            "The error of a nonlinear specimen needs a numerical substructure",
            remedy="Add a [structure] table to the model",
        )
    numerical = test.substructure
    k, c, m = (value / test.mass for value in (specimen.stiffness, specimen.damping, specimen.mass))
    require_physical(
        "natural frequency",
        math.sqrt((numerical.stiffness + k) / (1.0 + m)) / (2.0 * math.pi),
        label="natural frequency of the model with its linear specimen",
        remedy="Give the specimen of the model its stiffness, or the computer a part of it",
    )
    return Partition.from_structure(test.structure).replace_values(
        mass=np.array([[1.0 + m]]),
        damping=np.array([[numerical.damping + c]]),
        stiffness=np.array([[numerical.stiffness + k]]),
        specimen_stiffness=np.array([[k]]),
        specimen_damping=np.array([[c]]),
        specimen_mass=np.array([[m]]),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelledTest(SimulatedTest):
    """Errors of a test whose specimen has a model."""

    model: HybridTest  # With a perfect actuator
    deviations: Mapping[str, float]  # Standard deviations of the model's parameters
    seed: int  # Of draws of the parameters

    @property
    def evidence(self) -> tuple[Evidence, ...]:
        """What the test shows of what is uncertain: nothing."""
        return ()

    @cached_property
    def _motion(self) -> Motion3:
        return Motion3.interpolate(self.command, self.time_step)

    def solve(self, world: Experiment, draw: int | None = None) -> Array:
        """x_m − x_I and x_I [m]; the model with a perfect actuator under the demand of the test."""
        model = self.model if draw is None else self.draw_model(draw)
        structure = model.structure
        if structure is None:
            raise AssertionError  # tangent_structure has looked
        structure = replace(
            structure,
            frequency=structure.frequency * world.frequency,
            damping_ratio=min(structure.damping_ratio * world.damping_ratio, _LARGEST_RATIO),
        )
        measured = self.displacement(world)
        exact = self._respond(replace(model, structure=structure), measured, world.feedback_lag)
        return np.stack([measured - exact, exact])[:, np.newaxis]

    def _respond(self, model: HybridTest, measured: Array, feedback_lag: float) -> Array:
        step, numerical, motion = self.time_step, model.substructure, self._motion.values
        force = load(model, Motion3.interpolate(measured, step))
        if feedback_lag:
            force = force - feedback_lag * np.gradient(force, step)
        demand = -(
            motion[2] + numerical.damping * motion[1] + numerical.stiffness * motion[0] + force / model.mass
        )
        exact = run_closed_loop(model, demand, step).command.values[0]
        if not np.isfinite(exact).all():
            raise InputError(
                "The model must stay bounded under the demand of the test",
                remedy="Calibrate the specimen on tests as large as this one",
            )
        return np.asarray(exact, dtype=np.float64)

    def draw_model(self, draw: int) -> HybridTest:
        """Draw the parameters of the specimen."""
        generator, specimen = np.random.default_rng((self.seed, draw)), self.model.specimen
        if specimen is None:
            raise AssertionError  # tangent_structure has looked
        deviation = self.deviations.get("stiffness_n_per_m", 0.0)
        stiffness = specimen.stiffness + generator.standard_normal() * deviation
        effects = (_draw_effect(effect, self.deviations, generator) for effect in self.model.effects)
        specimen = replace(specimen, stiffness=max(stiffness, 0.0))
        return replace(self.model, specimen=specimen, effects=tuple(effects))


def _draw_effect(effect: Effect, deviations: Mapping[str, float], generator: np.random.Generator) -> Effect:
    values = effect.values.copy()
    for place, parameter in enumerate(effect.parameters):
        spread = deviations.get(f"{effect.name}.{parameter.name}", 0.0)
        value = values[place] + generator.standard_normal() * spread
        values[place] = value if parameter.signed else max(value, _LEAST * abs(values[place]))
    return effect.from_values(values)
