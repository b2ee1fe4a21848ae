from .fmu import pack_fmu as pack_fmu
from .sources import LoopMonitor as LoopMonitor, monitor_sources as monitor_sources
