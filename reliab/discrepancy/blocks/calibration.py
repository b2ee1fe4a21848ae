"""Parameters that are calibrated in every model; they are not effects and are not reported as such."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from reliab.core.stated_value import RANGES
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Parameter, Scales
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.force_bias import ForceBias
from reliab.simulation.hybrid_test.model import HybridTest


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A parameter of the nominal model that is fitted in every model."""

    parameter: Parameter  # Name, units, bounds and prior
    apply: Callable[[HybridTest, float], HybridTest]  # The model with another value
    key: str = ""  # Name in the file of a model, if it stands there
    unit: float = 1.0  # SI value of one


def _factor(name: str, meaning: str, typical: float, lower: float, upper: float) -> Parameter:
    """Return a factor on a nominal value, which is one where that is right."""
    return Parameter(
        name=name, units="-", meaning=f"{meaning} over its nominal value", signed=True,
        neutral=1.0, typical=typical, lower=lower, upper=upper, starts=(1.0,),
    )  # fmt: skip


def stiffness_of(model: HybridTest) -> float:
    """Stiffness of a model's specimen [N/m], zero without one."""
    return 0.0 if model.specimen is None else model.specimen.stiffness


def _set_stiffness(model: HybridTest, stiffness: float) -> HybridTest:
    if model.specimen is None:
        return model
    is_physical = stiffness >= RANGES["stiffness"].lowest
    return replace(model, specimen=replace(model.specimen, stiffness=stiffness if is_physical else 0.0))


def _scale_structure(model: HybridTest, *, frequency: float = 1.0, damping: float = 1.0) -> HybridTest:
    structure = model.structure
    if structure is None:
        return model
    scaled_structure = replace(
        structure,
        frequency=frequency * structure.frequency,
        damping_ratio=damping * structure.damping_ratio,
    )
    return replace(model, structure=scaled_structure)


def gain(nominal: HybridTest, spread: float = 0.05) -> Calibration:
    """Gain of the actuator, in units of its nominal value."""
    unit = nominal.actuator.gain
    return Calibration(
        parameter=_factor("gain", "gain of the actuator", spread, 0.3, 3.0),
        apply=lambda model, value: replace(model, actuator=replace(model.actuator, gain=value * unit)),
        key="gain",
        unit=unit,
    )


def delay(nominal: HybridTest) -> Calibration:
    """Delay of the actuator [s]."""
    nominal_delay = nominal.actuator.delay
    return Calibration(
        parameter=Parameter(
            name="delay_s", units="s", meaning="delay of the actuator", signed=True,
            neutral=nominal_delay, typical=0.005, lower=-1e-9, upper=nominal_delay + 0.2,
            starts=(nominal_delay,),
        ),
        apply=lambda model, value: replace(
            model, actuator=replace(model.actuator, delay=max(value, 0.0))
        ),
        key="delay_s",
    )  # fmt: skip


def stiffness(nominal: HybridTest, scales: Scales | None = None) -> Calibration:
    """Stiffness of the specimen over its nominal value, within 10 %.

    With `scales` it may have any value whatever is stated, and is in N/m where nothing is.
    """
    unit, parameter = stiffness_of(nominal), _factor("stiffness", "stiffness", 0.05, 0.9, 1.1)
    if scales is not None:
        name, units, meaning = "stiffness", "-", parameter.meaning
        if not unit > 0.0:
            name, units, meaning, unit = "stiffness_n_per_m", "N/m", "stiffness of the specimen", 1.0
        size = scales.force / scales.displacement / unit
        parameter = Parameter(
            name=name, units=units, meaning=meaning, signed=True,
            typical=size, lower=0.0, upper=20.0 * size, starts=(0.5 * size,),
        )  # fmt: skip
    return Calibration(
        parameter=parameter,
        apply=lambda model, value: _set_stiffness(model, value * unit),
        key="stiffness_n_per_m",
        unit=unit,
    )


def open_stiffness(nominal: HybridTest) -> Calibration:
    """Stiffness of the specimen, in units of its nominal value, which may be wrong by any factor."""
    bounded_calibration = stiffness(nominal)
    parameter = Parameter(
        name="stiffness", units="-", meaning=bounded_calibration.parameter.meaning,
        typical=1.0, spread=1.5, lower=1e-4, upper=1e4, starts=(1.0,),
    )  # fmt: skip
    return replace(bounded_calibration, parameter=parameter)


def damping(nominal: HybridTest) -> Calibration:
    """Exponent with which the damping of an oscillator without a rig follows its calibrated frequency.

    A nominal damping ratio leaves open by which natural frequency it is to be multiplied: by the nominal one
    (0), or by the calibrated one (1).
    """
    unit = stiffness_of(nominal)
    return Calibration(
        parameter=Parameter(
            name="damping", units="-", meaning="exponent of damping over frequency", signed=True,
            neutral=0.5, typical=0.29, lower=-1e-9, upper=1.0, starts=(0.5,),
        ),
        apply=lambda model, value: _scale_structure(
            model, damping=(stiffness_of(model) / unit) ** (0.5 * value)
        ),
    )  # fmt: skip


def structure_frequency() -> Calibration:
    """Natural frequency of the controller's structure over its nominal value, which may be wrong."""
    return Calibration(
        parameter=_factor("structure_frequency", "natural frequency", 0.01, 0.9, 1.1),
        apply=lambda model, value: _scale_structure(model, frequency=value),
    )


def structure_damping(spread: float = 0.1, reach: float = 0.5) -> Calibration:
    """Damping ratio of the controller's structure over its nominal value."""
    return Calibration(
        parameter=_factor("structure_damping", "damping ratio", spread, 1.0 - reach, 1.0 + reach),
        apply=lambda model, value: _scale_structure(model, damping=value),
    )


def structure_mass() -> Calibration:
    """Mass that scales the force of the controller's structure, over its nominal value.

    The scale of a load cell that is off looks the same.
    """
    return Calibration(
        parameter=_factor("structure_mass", "mass", 0.02, 0.8, 1.25),
        apply=lambda model, value: replace(model, mass=value * model.mass),
    )


def force_not_fed_back() -> Calibration:
    """Offset of the recorded force that the controller did not feel [N].

    An offset that it did feel moves the command with it and balances the equation of motion.
    """
    meaning = "offset of the recorded force that was not fed back"
    return Calibration(
        parameter=replace(ForceBias.parameters[0], name="force_not_fed_back_n", meaning=meaning),
        apply=lambda model, value: model.adding(ForceBias(bias_n=value)),
    )


def lag_of_force() -> Calibration:
    """Time [s] by which a force is later than a motion whose delay is badly known."""
    return Calibration(
        parameter=replace(ClockOffset.parameters[0], name="force_lag_s"),
        apply=lambda model, value: model.adding(ClockOffset(lag_s=value)),
    )


def scale_of_excitation(expected_scale: float) -> Calibration:
    """Scale of the ground motion over what a linear model expects of it, where no rig states it.

    With a nonlinear specimen it may differ from that by any factor: its bounds are wider than any data need.
    """
    return Calibration(
        parameter=Parameter(
            name="excitation_scale", units="-", meaning="ground acceleration over its expected value",
            typical=1.0, spread=0.5, lower=1e-3, upper=1e3, starts=(1.0,),
        ),
        apply=lambda model, value: model.adding(ExcitationScale(scale=value * expected_scale)),
        key="excitation_scale.scale",
        unit=expected_scale,
    )  # fmt: skip
