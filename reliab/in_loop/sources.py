"""The monitor in C: templates that do not change, and one header with the numbers of a structure.

The recursions are those of `reliab.assessment.rebuilt_error`, exact for
a straight line between samples; their coefficients are written with 17 digits, so that both compute with the
same numbers: w₊ = E w + F₀τ + F₁τ₊, y = P w + Qτ, with τ = x_c − x_m at the interface.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files

import numpy as np

from reliab.assessment.modelled_test import tangent_structure
from reliab.assessment.rebuilt_error.initial import FEWEST_AT_REST, SHIFT_OF_COMMAND, SIGNIFICANT_OFFSET
from reliab.assessment.rebuilt_error.loop_energy import (
    FALSE_ALARMS,
    INDEPENDENT_SAMPLES,
    LARGE_MOTION,
    LARGEST_UNCERTAINTY,
    MEMORY,
    PLAY_FACTOR,
    POLE_ITERATIONS,
    SINGULAR_DETERMINANT,
    SLOWEST_POLE,
    SMALLEST_FOLLOWING,
    WatchedMode,
    select_modes,
)
from reliab.assessment.rebuilt_error.noise import LOST_IN_NOISE
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.running_specimen import (
    EQUATION_TOLERANCE,
    FORCE_TRIALS,
    LONGEST_MEMORY,
    SMALLEST_DIVISOR,
    SMALLEST_SLOPE,
    VELOCITY_NOISE,
)
from reliab.assessment.rebuilt_error.running_test import SHRINKING_SHARE, TIME_WITHOUT_DOUBLING
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import Metric
from reliab.effects.effect import Effect, Role, SteppedEffect
from reliab.in_loop.effects_in_c import functions_in_c
from reliab.recordings.recording import LARGEST_READING
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.partition import Partition

TEMPLATES = ("reliab_monitor.h", "reliab_monitor.c", "example.c", "README.md")
CONFIGURATION = "reliab_monitor_config.h"
MOST_DEGREES_OF_FREEDOM = 100
_NONLINEAR_FORCE = (
    "static double nonlinear_force(double *motion, double time, "
    "double states[RELIAB_EFFECTS][RELIAB_EFFECT_STATES])"
)
_LARGEST_DRIFT = 1e-5  # m that the command moves from its first value while the sensor's offset is learned
_STUCK = 1e-3  # m of the command while the measured value repeats
_STUCK_SHARE = 0.01  # of its largest motion, where the value never repeated for so long
_FEWEST_STUCK = 8  # samples that repeat a value
_LONGER = 4  # times the longest repetition before
_FEWEST_PER_PERIOD = 10.0
_ENERGY_NUMBERS = {
    "MEMORY": MEMORY,
    "INDEPENDENT": INDEPENDENT_SAMPLES,
    "FALSE_ALARMS": FALSE_ALARMS,
    "FOLLOWS": SMALLEST_FOLLOWING,
    "LARGE_MOTION": LARGE_MOTION,
    "GRANTED": PLAY_FACTOR,
    "UNSURE": LARGEST_UNCERTAINTY,
    "SINGULAR": SINGULAR_DETERMINANT,
    "SLOWEST": SLOWEST_POLE,
}
"""Numbers of the alarm of the energy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopCoefficients:
    """Coefficients of a monitor of p actuators."""

    decay: Array  # E, shape (2n, 2n)
    early: Array  # early, late: F₀ and F₁, shape (2n, p)
    late: Array
    output: Array  # P, shape (p, 2n)
    feed_through: Array  # Q, shape (p, p)
    carry: Array  # Interface displacements per unit at each sensor [-], shape (p, p)
    equilibrium: Array  # State under a constant x_c − x_m of one at each sensor, shape (2n, p)
    share: Array  # By which a sensor's offset that the loop feels moves its command back [-], shape (p,)
    modes: tuple[WatchedMode, ...]  # Three for each actuator at most

    force_loads: tuple[Array, Array]  # F₀ and F₁ of a force at the interface, shape (2n, p) each

    @classmethod
    def from_structure(cls, structure: Partition, carry: Array, step: float) -> "LoopCoefficients":
        """Take a structure with interface displacements that the channels are carried to; `step` [s]."""
        regular = structure.nonsingular_form
        recursion, forced = (Recursion.from_displacement(regular, step), Recursion.from_force(regular, step))
        return cls(
            decay=recursion.transition,
            early=recursion.early,
            late=recursion.late,
            output=recursion.output,
            feed_through=recursion.feed_through,
            carry=carry,
            equilibrium=recursion.static @ carry,
            share=structure.shares_at_sensors(carry),
            modes=select_modes(regular, step),
            force_loads=(forced.early, forced.late),
        )


@dataclass(frozen=True, kw_only=True)
class LoopMonitor:
    """What a monitor in a loop is made for.

    Raises InputError where the rate is too low for the structure, or the structure too large.
    """

    # The whole structure, specimen included, or a model of it whose specimen is nonlinear
    structure: Partition | HybridTest
    time_step: float  # Step of the loop [s]
    feedback_lag: float = 0.0  # Time by which the force is fed back late [s]
    sensor_scale: float = 1.0  # Scale of the displacement sensor [-]
    threshold: float = 0.05  # Largest error of a good test [-]
    metric: Metric = Metric.RMS
    to_interface: Array | None = None  # Interface displacements per unit of each channel, shape (p, p)

    def __post_init__(self) -> None:
        if self.degrees_of_freedom > MOST_DEGREES_OF_FREEDOM:
            raise InputError(
                f"A monitor in a loop has {MOST_DEGREES_OF_FREEDOM} degrees of freedom at most",
                value=self.degrees_of_freedom,
                remedy="Condense the structure",
            )
        samples = 1.0 / (float(self.linear.natural_frequencies[0]) * self.time_step)
        if samples < _FEWEST_PER_PERIOD:
            raise InputError(
                f"A period of the structure must hold at least {_FEWEST_PER_PERIOD:.0f} samples",
                value=significant(samples),
                remedy="Run the monitor at the rate of the loop",
            )

    @cached_property
    def linear(self) -> Partition:
        """The structure with the linear specimen."""
        return tangent_structure(self.structure) if isinstance(self.structure, HybridTest) else self.structure

    @property
    def degrees_of_freedom(self) -> int:
        """Of the structure."""
        return int(self.linear.mass.shape[0])

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What a model says of the specimen beside its linear force."""
        return self.structure.acting(Role.FORCE) if isinstance(self.structure, HybridTest) else ()

    @cached_property
    def coefficients(self) -> LoopCoefficients:
        """Numbers of the recursion."""
        carry = np.eye(self.linear.degrees) if self.to_interface is None else self.to_interface
        return LoopCoefficients.from_structure(self.linear, carry, self.time_step)


def monitor_sources(monitor: LoopMonitor) -> dict[str, str]:
    """Return the files of a monitor in C by name."""
    folder = files("reliab.in_loop").joinpath("template")
    texts = {name: folder.joinpath(name).read_text(encoding="utf-8") for name in TEMPLATES}
    return {**texts, CONFIGURATION: _configuration(monitor)}


def _configuration(monitor: LoopMonitor) -> str:
    return "\n".join(
        [
            f"/* {_description(monitor)} Written, not edited. */",
            "#ifndef RELIAB_MONITOR_CONFIG_H",
            "#define RELIAB_MONITOR_CONFIG_H",
            *(f"#define RELIAB_{name} {value}" for name, value in _numbers(monitor).items()),
            "#endif",
            "#if defined(RELIAB_COEFFICIENTS) && !defined(RELIAB_COEFFICIENTS_WRITTEN)",
            "#define RELIAB_COEFFICIENTS_WRITTEN",
            *_coefficients(monitor),
            "#endif",
            "",
        ]
    )


def _description(monitor: LoopMonitor) -> str:
    """Say what a monitor is of."""
    lowest = significant(float(monitor.linear.natural_frequencies[0]))
    effects = ", ".join(effect.name for effect in monitor.effects)
    return (
        f"Degrees of freedom: {monitor.degrees_of_freedom}; lowest natural frequency: {lowest} Hz; "
        f"actuators: {len(monitor.coefficients.carry)}; effects of the specimen: {effects or 'none'}; "
        f"rate: {significant(1.0 / monitor.time_step)} Hz."
    )


def _numbers(monitor: LoopMonitor) -> dict[str, str]:
    """Return what the monitor is made for, and what its alarms need."""
    real = {
        "STEP": monitor.time_step,
        "SENSOR_SCALE": monitor.sensor_scale,
        "THRESHOLD": monitor.threshold,
        "CALM": TIME_WITHOUT_DOUBLING,
        "SHRINKS": SHRINKING_SHARE,
        "LOST_IN_NOISE": LOST_IN_NOISE,
        "FEWEST": float(FEWEST_AT_REST),
        "SIGNIFICANT": SIGNIFICANT_OFFSET,
        "STANDS": SHIFT_OF_COMMAND,
        "LARGEST_READING": LARGEST_READING,
        "REST_M": _LARGEST_DRIFT,
        "STUCK_M": _STUCK,
        "STUCK_SHARE": _STUCK_SHARE,
    }
    counts = {
        "ACTUATORS": len(monitor.coefficients.carry),
        "ORDER": len(monitor.coefficients.decay),
        "LAG_STEPS": int(monitor.feedback_lag / monitor.time_step),
        "WATCHED": len(monitor.coefficients.modes),
        "MODES": monitor.coefficients.modes[0].modes.ratios.size,
        "TURNS": POLE_ITERATIONS,
        "FEWEST_STUCK": _FEWEST_STUCK,
        "LONGER": _LONGER,
    }
    return {
        **{name: f"{value}u" for name, value in counts.items()},
        "METRIC_IS_RMS": str(int(monitor.metric is Metric.RMS)),
        **{name: _real(value) for name, value in (real | _ENERGY_NUMBERS).items()},
        **_numbers_of_specimen(monitor),
    }


def _numbers_of_specimen(monitor: LoopMonitor) -> dict[str, str]:
    """Return what a nonlinear specimen needs."""
    if not isinstance(monitor.structure, HybridTest) or not monitor.effects:
        return {"EFFECTS": "0"}
    states = [effect.kernel.states for effect in monitor.effects if isinstance(effect, SteppedEffect)]
    slowest = 2.0 * np.pi * float(monitor.linear.natural_frequencies[0])
    return {
        "EFFECTS": str(len(monitor.effects)),
        "EFFECT_STATES": f"{max([1, *states])}u",
        "MASS": _real(monitor.structure.mass),
        "TRIES": f"{FORCE_TRIALS}u",
        "CLOSE": _real(EQUATION_TOLERANCE),
        "FLATTEST": _real(SMALLEST_SLOPE),
        "LONGEST_MEMORY": _real(LONGEST_MEMORY / slowest),
        "NOISE_OF_SPEED": _real(VELOCITY_NOISE),
        "TINY": _real(SMALLEST_DIVISOR),
    }


def _coefficients(monitor: LoopMonitor) -> list[str]:
    """Return the arrays of the recursion."""
    recursion = monitor.coefficients
    matrices = {
        "DECAY": recursion.decay,
        "EARLY": recursion.early,
        "LATE": recursion.late,
        "OUTPUT": recursion.output,
        "FEED_THROUGH": recursion.feed_through,
        "CARRY": recursion.carry,
        "EQUILIBRIUM": recursion.equilibrium,
    }
    return [
        *(_matrix(name, values) for name, values in matrices.items()),
        _vector("SHARE", recursion.share),
        _vector("LAG_WEIGHTS", _weights(monitor)),
        *_modes(recursion.modes),
        *_specimen(monitor),
    ]


def _modes(energy_modes: Sequence[WatchedMode]) -> list[str]:
    """Write all modes, and those whose energy is watched."""
    modes = energy_modes[0].modes
    frequencies = (significant(mode.circular_frequency / (2.0 * np.pi)) for mode in energy_modes)
    return [
        _vector("SQUARES", modes.circular_frequencies**2),
        _vector("TWICE", 2.0 * modes.ratios * modes.circular_frequencies),
        _vector("STIFFNESSES", np.diag(modes.coupling)),
        f"static const mode WATCHED[{len(energy_modes)}] = {{",
        *(f"    {_mode(mode)}," for mode in energy_modes),
        "};",
        f"static const char REASONS[{len(energy_modes)}][96] = {{",
        *(f'    "the loop gains energy in its mode of {hertz} Hz and may diverge",' for hertz in frequencies),
        "};",
    ]


def _mode(mode: WatchedMode) -> str:
    """Write a mode whose energy is watched."""
    numbers = (mode.ratio, mode.forgetting, mode.samples, mode.circular_frequency)
    arrays = ", ".join(map(_row, (mode.projection, mode.band, mode.exchange)))
    return f"{{{arrays}, {', '.join(map(_real, numbers))}, {mode.look}u, {mode.place}u}}"


def _specimen(monitor: LoopMonitor) -> list[str]:
    """Return the functions of a nonlinear specimen."""
    test = monitor.structure
    if not isinstance(test, HybridTest) or not monitor.effects:
        return []
    setting = test.setting(monitor.time_step)
    names = [f"effect_{place}" for place in range(len(monitor.effects))]
    calls = [
        f"    total += {name}(motion, time, RELIAB_STEP, {name.upper()}, states[{place}]);"
        for place, name in enumerate(names)
    ]
    early, late = monitor.coefficients.force_loads
    return [
        _vector("PUSHED_EARLY", early[:, 0]),
        _vector("PUSHED_LATE", late[:, 0]),
        *(
            _vector(name.upper(), effect.coefficients(setting))
            for name, effect in zip(names, monitor.effects, strict=True)
        ),
        *functions_in_c(monitor.effects),
        _NONLINEAR_FORCE,
        "{",
        "    double total = 0.0;",
        *calls,
        "    return total;",
        "}",
    ]


def _weights(monitor: LoopMonitor) -> Array:
    """Return weights of the displacements so many steps ago, and one, two and three more; shape (4,)."""
    lag_steps = int(monitor.feedback_lag / monitor.time_step)
    impulse = np.zeros(2 * lag_steps + 16)
    impulse[lag_steps + 8] = 1.0
    late = delay_history(impulse, monitor.feedback_lag, monitor.time_step)
    return np.asarray(late[2 * lag_steps + 8 : 2 * lag_steps + 12])


def _matrix(name: str, values: Array) -> str:
    rows = ",\n    ".join(map(_row, values))
    return f"static const double {name}[{values.shape[0]}][{values.shape[1]}] = {{\n    {rows}}};"


def _vector(name: str, values: Array) -> str:
    return f"static const double {name}[{values.size}] = {_row(values)};"


def _row(values: Array) -> str:
    return "{" + ", ".join(_real(float(value)) for value in values) + "}"


def _real(value: float) -> str:
    """Write a double so that reading gives the same bits."""
    return repr(float(value))
