from .exact_loop import ideal_response as ideal_response, stable_with as stable_with
from .frame_file import (
    FrameUnderTest as FrameUnderTest,
    frame_of_tables as frame_of_tables,
    read_frame as read_frame,
    read_structure as read_structure,
    with_one_actuator as with_one_actuator,
)
from .frame_loop import FrameLoop as FrameLoop
from .governing_mode import (
    governing_mode as governing_mode,
    place_of_governing_mode as place_of_governing_mode,
)
