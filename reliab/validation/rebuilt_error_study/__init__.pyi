from .design import Design as Design
from .judges import (
    CERTAIN as CERTAIN,
    OWN_BOUNDARY as OWN_BOUNDARY,
    REBUILT as REBUILT,
    WITH_MODEL as WITH_MODEL,
)
from .rigs import LINEAR as LINEAR, PLAIN as PLAIN, RIGHT as RIGHT
from .study import shares as shares, summarised as summarised, try_tests as try_tests
