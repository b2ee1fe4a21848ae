"""The library of effects: those of this package and those that other packages add."""

from typing import Any

from reliab.core.registry import Registry
from reliab.effects.added_mass import AddedMass
from reliab.effects.attached_oscillator import AttachedOscillator
from reliab.effects.backlash import Backlash
from reliab.effects.bilinear_stiffness import BilinearStiffness
from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.degrading_hysteresis import DegradingHysteresis
from reliab.effects.delay_drift import DelayDrift
from reliab.effects.directional_damping import DirectionalDamping, DirectionalPowerLawDamping
from reliab.effects.directional_delay import DirectionalDelay
from reliab.effects.directional_friction import DirectionalFriction
from reliab.effects.effect import Effect
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.first_order_lag import FirstOrderLag
from reliab.effects.force_bias import ForceBias
from reliab.effects.gap import Gap
from reliab.effects.general.general_terms import general_term
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.hysteresis_with_play import HysteresisWithPlay
from reliab.effects.integration_error import IntegrationError
from reliab.effects.magnetorheological_damper import MagnetorheologicalDamper
from reliab.effects.masing_hysteresis import MasingHysteresis
from reliab.effects.nonlinear_maxwell import NonlinearMaxwell
from reliab.effects.power_law_damping import PowerLawDamping
from reliab.effects.quadratic_damping import QuadraticDamping
from reliab.effects.quadratic_stiffness import QuadraticStiffness
from reliab.effects.rate_limit import RateLimit
from reliab.effects.rectified_sensor import RectifiedSensor
from reliab.effects.second_order_dynamics import SecondOrderDynamics
from reliab.effects.self_centring import SelfCentring
from reliab.effects.sensor_bias import SensorBias
from reliab.effects.sensor_drift import SensorDrift
from reliab.effects.series_play import SeriesPlay
from reliab.effects.softening import Damage, Softening
from reliab.effects.stroke_saturation import CommandSaturation, StrokeSaturation
from reliab.effects.time_step_error import TimeStepError
from reliab.effects.velocity_dependent_friction import VelocityDependentFriction
from reliab.effects.viscoelastic_branch import TwoViscoelasticBranches, ViscoelasticBranch
from reliab.effects.viscous_damping import ViscousDamping

ENTRY_POINT_GROUP = "reliab.effects"
"""Group under which other packages register classes derived from `Effect`."""

_SHIPPED: tuple[type[Effect], ...] = (
    CommandSaturation,
    FirstOrderLag,
    SecondOrderDynamics,
    DelayDrift,
    DirectionalDelay,
    RateLimit,
    Backlash,
    StrokeSaturation,
    SensorBias,
    SensorDrift,
    RectifiedSensor,
    ForceBias,
    SeriesPlay,
    CubicStiffness,
    QuadraticStiffness,
    CoulombFriction,
    DirectionalFriction,
    ViscousDamping,
    DirectionalDamping,
    QuadraticDamping,
    PowerLawDamping,
    DirectionalPowerLawDamping,
    NonlinearMaxwell,
    Hysteresis,
    DegradingHysteresis,
    VelocityDependentFriction,
    MasingHysteresis,
    HysteresisWithPlay,
    BilinearStiffness,
    SelfCentring,
    MagnetorheologicalDamper,
    ViscoelasticBranch,
    TwoViscoelasticBranches,
    Softening,
    Damage,
    AddedMass,
    AttachedOscillator,
    Gap,
    ExcitationScale,
    TimeStepError,
    IntegrationError,
)


_LIBRARY: Registry[type[Effect]] = Registry(
    noun="effect",
    base=Effect,
    group=ENTRY_POINT_GROUP,
    items=_SHIPPED,
    name_of=lambda effect: str(effect.name),
)


def library() -> Registry[type[Effect]]:
    """All effects by name, in the order in which they act within their block.

    Raises InputError when it is read: if another package adds something that is not an effect, or a name that
    is already in use.
    """
    return _LIBRARY


def find_effect(name: str) -> type[Any]:  # a class derived from `Effect` with parameters of its own
    """Return the effect of a name, in the library or of a general kind.

    `name`: name as in files and reports. Returns the class of the effect. Raises InputError if there is none.

    >>> find_effect("backlash").__name__
    'Backlash'
    """
    return general_term(name) or _LIBRARY.find(name)
