"""MATLAB files: version 5 to 7 through SciPy; version 7.3 is HDF5 and read as such."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from reliab.recordings.readers.arrays import columns_of_arrays
from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import require_few_samples
from reliab.simulation.transfer_systems import require_sound_structure


def read_matlab(path: Path) -> Columns:
    """Read the numeric variables of a MATLAB file, also inside structures.

    Returns vectors by name, those of a structure as ``structure.field``; columns of a matrix as ``name[1]``
    ….
    """
    require_sound_structure(path)
    for name, shape, _ in scipy.io.whosmat(path):
        require_few_samples(max(shape, default=0), f"{path.name}, {name}")
    return columns_of_arrays(path, dict(_flattened(scipy.io.loadmat(path, simplify_cells=True))))


def _flattened(content: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in content.items():
        if name.startswith("__"):
            continue
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", np.asarray(value)
