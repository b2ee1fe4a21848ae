from .frame_file import (
    FrameUnderTest as FrameUnderTest,
    frame_of_tables as frame_of_tables,
    read_frame as read_frame,
)
from .frame_loop import FrameLoop as FrameLoop
from .rig_loop import rig_response as rig_response, stable_with as stable_with
