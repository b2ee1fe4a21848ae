from .deviation import Deviation as Deviation, peak_of_history as peak_of_history
from .effect_loop import EffectLoop as EffectLoop
from .engine import Engine as Engine, Loop as Loop
from .excitation import Excitation as Excitation
from .hybrid_test.model import Actuator as Actuator
from .linear_loop.cells import LEAD_TOLERANCE as LEAD_TOLERANCE, REDUCTION_TOLERANCE as REDUCTION_TOLERANCE
