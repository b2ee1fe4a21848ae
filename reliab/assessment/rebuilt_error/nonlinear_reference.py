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
from dataclasses import replace

import numpy as np

from reliab.assessment.rebuilt_error.difference_draws import draw_differences
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.initial import check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    Histories,
    StandardDeviations,
    draw_unknown,
    inputs_of_reading,
)
from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.assessment.rebuilt_error.rebuild import RebuiltError, conclude
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_simulation
from reliab.assessment.rebuilt_error.spread import Spread, spread_of_draws
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.effects.effect import Effect, Role
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.partition import Partition

DRAWS = 64
"""Number of draws of the specimen and of everything else that is uncertain."""

_DRAWS_AS_STATED = 16  # of the noise alone, behind the value
_LEAST = 0.05  # of a value: a draw of a positive parameter goes no lower


def rebuild_with_specimen(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    test: HybridTest,
    *,
    deviations: Mapping[str, float] | None = None,
    sensor_offset: float | None = None,
    tolerances: Tolerances | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> RebuiltError:
    """Rebuild the error of a test with a calibrated specimen.

    `command`, `measured_displacement` [m]; `time_step` [s]; `sensor_offset` [m].
    Returns as `rebuild` returns; its structure is the tangent one, with which parts are found to first order.

    >>> from reliab.simulation.hybrid_test.model import Actuator
    >>> from reliab.effects.registry import find_effect
    >>> from reliab.structures.structure import Structure
    >>> structure = Structure(frequency=1.0, damping_ratio=0.05)
    >>> friction = find_effect("coulomb_friction")(force_n=0.05, regularisation_velocity_m_per_s=0.01)
    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> shaken = np.sin(6.0 * time) * np.exp(-0.2 * time)
    >>> late = HybridTest(structure=structure, actuator=Actuator(delay=0.004), effects=(friction,))
    >>> run = run_closed_loop(late, shaken, 0.002)
    >>> error = rebuild_with_specimen(run.command.values[0], run.measured, 0.002, late)
    >>> ideal = run_closed_loop(replace(late, actuator=Actuator()), shaken, 0.002).command.values[0]
    >>> true = np.sqrt(np.mean((run.measured - ideal) ** 2)) / np.abs(ideal).max()
    >>> bool(abs(error.rms.value / true - 1.0) < 0.02)
    True
    """
    perfect = HybridTest(
        structure=test.structure, mass=test.mass, specimen=test.specimen, effects=test.acting(Role.FORCE)
    )
    tangent = tangent_structure(perfect)
    command, measured_displacement = check_histories(command, measured_displacement, time_step, tangent)
    lowest = float(tangent.natural_frequencies[0])
    stride = samples_in_step_of_simulation(lowest, time_step)
    require_fitting(command.size, stride, time_step)
    noise = estimate_noise(command, measured_displacement, time_step)
    start = start_of_test(command, measured_displacement, time_step, tangent, noise, sensor_offset)
    read = measured_displacement - start.offset
    difference = noise.smooth(command - read)
    histories = Histories(
        command=command, measured=command - difference, fed_back=difference, time_step=time_step
    )
    reference = reference_of_model(perfect, histories)
    unknown = StandardDeviations(
        tolerances=tolerances or Tolerances(), offset=start.offset_deviation, error_at_start=0.0
    )
    differences = draw_differences(command, read, noise, lowest, stride, draws, seed)
    nominal_differences = differences[: 2 * _DRAWS_AS_STATED : 2]
    return conclude(
        histories,
        read,
        reference,
        structure=tangent,
        noise=noise,
        nominal_spread=sweep_model(perfect, histories, {}, EXACT, nominal_differences, stride, seed=seed),
        spread=sweep_model(perfect, histories, deviations or {}, unknown, differences, stride, seed=seed),
        differences=differences,
        stride=stride,
        unknown=unknown,
        start=start,
        seed=seed,
    )


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


def reference_of_model(perfect: HybridTest, histories: Histories, *, command: Motion3 | None = None) -> Array:
    """x_I [m]: the model with a perfect actuator under the demand that is computed from the test.

    `command`: motion of the command, where it is known already.
    """
    step, numerical = histories.time_step, perfect.substructure
    motion = (command or Motion3.interpolate(histories.command, step)).values
    force = load(perfect, Motion3.interpolate(histories.measured, step))
    demand = -(
        motion[2] + numerical.damping * motion[1] + numerical.stiffness * motion[0] + force / perfect.mass
    )
    reference = run_closed_loop(perfect, demand, step).command.values[0]
    if not np.isfinite(reference).all():
        raise InputError(
            "The model must stay bounded under the demand of the test",
            remedy="Calibrate the specimen on tests as large as this one",
        )
    return np.asarray(reference, dtype=np.float64)


def sweep_model(
    model: HybridTest,
    histories: Histories,
    deviations: Mapping[str, float],
    unknown: StandardDeviations,
    differences: Array,
    stride: int,
    *,
    seed: int,
) -> Spread:
    """Draw the error with a model of the specimen, with a perfect actuator, for each of the `differences`.

    `differences` [m]: draws of x_c − x_m at each `stride`-th sample; `deviations` of the model's parameters.
    """
    thin = histories.thin(stride)
    command = Motion3.interpolate(thin.command, thin.time_step)
    generator = np.random.default_rng(seed)
    nominal = _statistics(thin.measured, reference_of_model(model, thin, command=command))
    fine = _statistics(histories.measured, reference_of_model(model, histories))
    scale = np.divide(fine, nominal, out=np.ones(3), where=nominal > 0.0)
    rows, errors = [], []
    quantities, _ = draw_unknown(unknown, len(differences), seed)
    inputs, shifts = inputs_of_reading(thin, quantities)
    for row, difference in enumerate(differences):
        frequency, ratio = (float(quantities[name][row]) for name in ("frequency", "damping_ratio"))
        model_draw = _draw_model(model, deviations, frequency, ratio, generator)
        measured_displacement = thin.command - difference - shifts[row] @ inputs
        draw_histories = Histories(
            command=thin.command,
            measured=measured_displacement,
            fed_back=thin.command - measured_displacement,
            time_step=thin.time_step,
        )
        reference = reference_of_model(model_draw, draw_histories, command=command)
        rows.append(_statistics(measured_displacement, reference) * scale)
        errors.append(measured_displacement - reference)
    places = np.arange(histories.command.size) / stride
    return spread_of_draws(np.array(rows), np.mean(errors, axis=0), np.std(errors, axis=0), places)


def _statistics(measured_displacement: Array, reference: Array) -> Array:
    error = measured_displacement - reference
    return np.array([mean_square(error), np.abs(error).max(), np.abs(reference).max()])


def _draw_model(
    perfect: HybridTest,
    deviations: Mapping[str, float],
    frequency: float,
    damping_ratio: float,
    generator: np.random.Generator,
) -> HybridTest:
    """Draw a model; relative changes of the frequency and of the damping ratio as drawn [-]."""
    structure, specimen = perfect.structure, perfect.specimen
    if structure is None or specimen is None:
        raise AssertionError  # tangent_structure has looked
    stiffness = specimen.stiffness + generator.standard_normal() * deviations.get("stiffness_n_per_m", 0.0)
    return replace(
        perfect,
        structure=replace(
            structure,
            frequency=structure.frequency * max(1.0 + frequency, _LEAST),
            damping_ratio=min(structure.damping_ratio * max(1.0 + damping_ratio, _LEAST), 0.99),
        ),
        specimen=replace(specimen, stiffness=max(stiffness, 0.0)),
        effects=tuple(_draw_effect(effect, deviations, generator) for effect in perfect.effects),
    )


def _draw_effect(effect: Effect, deviations: Mapping[str, float], generator: np.random.Generator) -> Effect:
    values = effect.values.copy()
    for place, parameter in enumerate(effect.parameters):
        spread = deviations.get(f"{effect.name}.{parameter.name}", 0.0)
        value = values[place] + generator.standard_normal() * spread
        values[place] = value if parameter.signed else max(value, _LEAST * abs(values[place]))
    return effect.from_values(values)
