from .added_mass import AddedMass as AddedMass
from .backlash import Backlash as Backlash
from .coulomb_friction import CoulombFriction as CoulombFriction
from .cubic_stiffness import CubicStiffness as CubicStiffness
from .delay_drift import DelayDrift as DelayDrift
from .directional_delay import DirectionalDelay as DirectionalDelay
from .effect import (
    Effect as Effect,
    LinearEffect as LinearEffect,
    Parameter as Parameter,
    RecordEffect as RecordEffect,
    Role as Role,
    Scales as Scales,
    Setting as Setting,
    SteppedEffect as SteppedEffect,
)
from .excitation_scale import ExcitationScale as ExcitationScale
from .first_order_lag import FirstOrderLag as FirstOrderLag
from .force_bias import ForceBias as ForceBias
from .general import (
    Disturbance as Disturbance,
    ElasticStops as ElasticStops,
    GeneralTerm as GeneralTerm,
    disturbance as disturbance,
    general_terms as general_terms,
    is_general as is_general,
)
from .hysteresis import Hysteresis as Hysteresis
from .integration_error import IntegrationError as IntegrationError
from .kernel import Kernel as Kernel, Numbers as Numbers, call_kernel as call_kernel, pointer_to as pointer_to
from .quadratic_damping import QuadraticDamping as QuadraticDamping
from .rate_limit import RateLimit as RateLimit
from .registry import ENTRY_POINT_GROUP as ENTRY_POINT_GROUP, find_effect as find_effect, library as library
from .second_order_dynamics import SecondOrderDynamics as SecondOrderDynamics
from .sensor_bias import SensorBias as SensorBias
from .sensor_drift import SensorDrift as SensorDrift
from .series_play import SeriesPlay as SeriesPlay
from .softening import Softening as Softening
from .stroke_saturation import StrokeSaturation as StrokeSaturation
from .viscoelastic_branch import ViscoelasticBranch as ViscoelasticBranch
from .viscous_damping import ViscousDamping as ViscousDamping
