"""Parameters that are calibrated in every model; they are not effects and are not reported as such."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.effects.effect import Parameter, Scales
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.force_bias import ForceBias
from reliab.simulation.hybrid_test.model import HybridTest


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A parameter of the nominal model that is fitted in every model."""

    parameter: Parameter  # Name, units, bounds and prior
    nominal: Callable[[HybridTest], float]  # The parameter's value in a model
    apply: Callable[[HybridTest, float], HybridTest]  # The model with another value


def _stiffness(model: HybridTest) -> float:
    return 0.0 if model.specimen is None else model.specimen.stiffness


def _with_stiffness(model: HybridTest, stiffness: float) -> HybridTest:
    if model.specimen is None:
        return model
    return replace(model, specimen=replace(model.specimen, stiffness=max(stiffness, 0.0)))


def _with_structure(model: HybridTest, *, frequency: float = 1.0, damping: float = 1.0) -> HybridTest:
    structure = model.structure
    if structure is None:
        return model
    changed = replace(
        structure,
        frequency=frequency * structure.frequency,
        damping_ratio=damping * structure.damping_ratio,
    )
    return replace(model, structure=changed)


def gain(nominal: HybridTest, spread: float = 0.05) -> Calibration:
    """Gain of the actuator, in units of its nominal value."""
    unit = nominal.actuator.gain
    return Calibration(
        parameter=Parameter(
            name="gain", units="-", meaning="gain of the actuator over its nominal value", signed=True,
            neutral=1.0, typical=spread, lower=0.3, upper=3.0, starts=(1.0,),
        ),
        nominal=lambda model: model.actuator.gain / unit,
        apply=lambda model, value: replace(model, actuator=replace(model.actuator, gain=value * unit)),
    )  # fmt: skip


def delay(nominal: HybridTest, spread: float = 0.005) -> Calibration:
    """Delay of the actuator [s]."""
    believed = nominal.actuator.delay
    return Calibration(
        parameter=Parameter(
            name="delay_s", units="s", meaning="delay of the actuator", signed=True,
            neutral=believed, typical=spread, lower=-1e-9, upper=believed + 0.2, starts=(believed,),
        ),
        nominal=lambda model: model.actuator.delay,
        apply=lambda model, value: replace(
            model, actuator=replace(model.actuator, delay=max(value, 0.0))
        ),
    )  # fmt: skip


def stiffness(nominal: HybridTest, spread: float = 0.05, reach: float = 0.1) -> Calibration:
    """Stiffness of the specimen, in units of its nominal value; a calibration within 10 %."""
    unit = _stiffness(nominal)
    return Calibration(
        parameter=Parameter(
            name="stiffness", units="-", meaning="stiffness over its nominal value", signed=True,
            neutral=1.0, typical=spread, lower=1.0 - reach, upper=1.0 + reach, starts=(1.0,),
        ),
        nominal=lambda model: _stiffness(model) / unit,
        apply=lambda model, value: _with_stiffness(model, value * unit),
    )  # fmt: skip


def open_stiffness(nominal: HybridTest) -> Calibration:
    """Stiffness of the specimen, in units of its nominal value, which may be wrong by any factor."""
    within = stiffness(nominal)
    parameter = Parameter(
        name="stiffness", units="-", meaning=within.parameter.meaning,
        typical=1.0, spread=1.5, lower=1e-4, upper=1e4, starts=(1.0,),
    )  # fmt: skip
    return replace(within, parameter=parameter)


def free_stiffness(nominal: HybridTest, scales: Scales) -> Calibration:
    """Stiffness of a specimen, whatever is stated of it: over the stated one, else in N/m."""
    stated = _stiffness(nominal)
    unit, size = stated or 1.0, scales.force / scales.displacement
    parameter = Parameter(
        name="stiffness" if stated else "stiffness_n_per_m", units="-" if stated else "N/m",
        meaning="stiffness over its nominal value" if stated else "stiffness of the specimen", signed=True,
        typical=size / unit, lower=0.0, upper=20.0 * size / unit, starts=(0.5 * size / unit,),
    )  # fmt: skip
    return Calibration(
        parameter=parameter,
        nominal=lambda model: _stiffness(model) / unit,
        apply=lambda model, value: _with_stiffness(model, value * unit),
    )


def damping(nominal: HybridTest) -> Calibration:
    """Exponent with which the damping of an oscillator without a rig follows its calibrated frequency.

    A nominal damping ratio leaves open by which natural frequency it is to be multiplied: by the nominal one
    (0), or by the calibrated one (1).
    """
    unit = _stiffness(nominal)
    return Calibration(
        parameter=Parameter(
            name="damping", units="-", meaning="exponent of damping over frequency", signed=True,
            neutral=0.5, typical=0.29, lower=-1e-9, upper=1.0, starts=(0.5,),
        ),
        nominal=lambda _model: 0.0,
        apply=lambda model, value: _with_structure(
            model, damping=(_stiffness(model) / unit) ** (0.5 * value)
        ),
    )  # fmt: skip


def structure_frequency() -> Calibration:
    """Natural frequency of the controller's structure over its nominal value, which may be wrong."""
    return Calibration(
        parameter=Parameter(
            name="structure_frequency", units="-", meaning="natural frequency over its nominal value",
            signed=True, neutral=1.0, typical=0.01, lower=0.9, upper=1.1, starts=(1.0,),
        ),
        nominal=lambda _model: 1.0,
        apply=lambda model, value: _with_structure(model, frequency=value),
    )  # fmt: skip


def structure_damping(spread: float = 0.1, reach: float = 0.5) -> Calibration:
    """Damping ratio of the controller's structure over its nominal value."""
    return Calibration(
        parameter=Parameter(
            name="structure_damping", units="-", meaning="damping ratio over its nominal value",
            signed=True, neutral=1.0, typical=spread, lower=1.0 - reach, upper=1.0 + reach, starts=(1.0,),
        ),
        nominal=lambda _model: 1.0,
        apply=lambda model, value: _with_structure(model, damping=value),
    )  # fmt: skip


def structure_mass() -> Calibration:
    """Mass that scales the force of the controller's structure, over its nominal value.

    The scale of a load cell that is off looks the same.
    """
    return Calibration(
        parameter=Parameter(
            name="structure_mass", units="-", meaning="mass over its nominal value",
            signed=True, neutral=1.0, typical=0.02, lower=0.8, upper=1.25, starts=(1.0,),
        ),
        nominal=lambda _model: 1.0,
        apply=lambda model, value: replace(model, mass=value * model.mass),
    )  # fmt: skip


def force_not_fed_back() -> Calibration:
    """Offset of the recorded force that the controller did not feel [N].

    An offset that it did feel moves the command with it and balances the equation of motion.
    """
    offset = ForceBias.parameters[0]
    return Calibration(
        parameter=replace(
            offset, name="force_not_fed_back_n", meaning="offset of the recorded force that was not fed back"
        ),
        nominal=lambda _model: 0.0,
        apply=lambda model, value: model.adding(ForceBias(bias_n=value)),
    )


def lag_of_force() -> Calibration:
    """Time [s] by which a force is later than a motion whose delay is badly known."""
    return Calibration(
        parameter=replace(ClockOffset.parameters[0], name="force_lag_s"),
        nominal=lambda _model: 0.0,
        apply=lambda model, value: model.adding(ClockOffset(lag_s=value)),
    )


def scale_of_excitation(expected: float, spread: float = 0.5) -> Calibration:
    """Scale of the ground motion over what a linear model expects of it, where no rig states it.

    With a nonlinear specimen it may differ from that by any factor: its bounds are wider than any data need.
    """
    return Calibration(
        parameter=Parameter(
            name="excitation_scale", units="-", meaning="ground acceleration over its expected value",
            typical=1.0, spread=spread, lower=1e-3, upper=1e3, starts=(1.0,),
        ),
        nominal=lambda _model: 1.0 / expected,
        apply=lambda model, value: model.adding(ExcitationScale(scale=value * expected)),
    )  # fmt: skip
