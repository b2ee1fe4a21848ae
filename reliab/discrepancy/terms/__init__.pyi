from .clock_offset import (
    ClockOffset as ClockOffset,
    LateGround as LateGround,
    LeadingReading as LeadingReading,
    lag_of as lag_of,
    recorded_late as recorded_late,
    with_clock as with_clock,
)
from .stated_damping import StatedDamping as StatedDamping, with_damping as with_damping
