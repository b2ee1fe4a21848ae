from .blocks import block_length as block_length, cut as cut
from .cells import Cells as Cells
from .spectral import TransformLine as TransformLine, respond as respond
from .structure_batch import Prepared as Prepared, StructureBatch as StructureBatch
from .tracking_sums import (
    QuadraturePair as QuadraturePair,
    TrackedCells as TrackedCells,
    TrackingSums as TrackingSums,
)
