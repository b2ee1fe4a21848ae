from .elements import FAMILIES as FAMILIES
from .force_channel import ForceChannel as ForceChannel
from .learning import LearnedSpecimen as LearnedSpecimen, learn_specimen as learn_specimen
from .monitor import MeasuredMonitor as MeasuredMonitor, StatedForce as StatedForce
from .rebuild import MeasuredSpecimen as MeasuredSpecimen, rebuild_with_force as rebuild_with_force
