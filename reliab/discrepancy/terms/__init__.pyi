from .clock_offset import (
    ClockOffset as ClockOffset,
    LateGround as LateGround,
    LeadingReading as LeadingReading,
    lag_of as lag_of,
    recorded_late as recorded_late,
    with_clock as with_clock,
)
from .outside_term import OutsideTerm as OutsideTerm, is_outside as is_outside
from .outside_terms import (
    ElasticStops as ElasticStops,
    SoftenedSpring as SoftenedSpring,
    outside_terms as outside_terms,
)
from .stated_damping import StatedDamping as StatedDamping, with_damping as with_damping
