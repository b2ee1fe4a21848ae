from .reading import read_recording as read_recording
from .recognition import (
    ACCELERATIONS as ACCELERATIONS,
    DISPLACEMENTS as DISPLACEMENTS,
    FORCES as FORCES,
    LENGTHS as LENGTHS,
    NAMES as NAMES,
    OTHER_QUANTITIES as OTHER_QUANTITIES,
    TIMES as TIMES,
    Part as Part,
    recognise as recognise,
)
from .recording import (
    FEWEST_SAMPLES as FEWEST_SAMPLES,
    LARGEST_READING as LARGEST_READING,
    Recording as Recording,
)
from .spikes import without_spikes as without_spikes
