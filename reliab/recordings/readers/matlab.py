"""MATLAB files of version 4 to 7.2: through SciPy, and where they hold objects of classes through mat-io."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy

from reliab.core.errors import InputError
from reliab.recordings.readers.columns import Columns
from reliab.recordings.readers.layouts import Tree, tests_of_tree
from reliab.recordings.readers.objects import tree_of_objects
from reliab.recordings.recording import require_few_samples
from reliab.simulation.transfer_systems.matlab_structure import require_sound_structure, subsystem_of

_SIGNATURE: Final = b"MATLAB 5.0"
_DEEPEST: Final = 16
_MOST_ITEMS: Final = 10_000  # of a cell array or a structure array


def recognises(head: bytes) -> bool:
    """Whether a file begins as one of MATLAB 5 to 7.2."""
    return head.startswith(_SIGNATURE)


def read_matlab(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the tests of a MATLAB file."""
    require_sound_structure(path)
    if subsystem_of(path):
        return tests_of_tree(path, tree_of_objects(path))
    for name, shape, _ in scipy.io.whosmat(path):
        require_few_samples(max(shape, default=0), f"{path.name}, {name}")
    content = scipy.io.loadmat(path, simplify_cells=True)
    return tests_of_tree(
        path, {name: as_tree(item) for name, item in content.items() if not name.startswith("__")}
    )


def as_tree(item: Any, depth: int = 0) -> Tree:  # noqa: ANN401 - what SciPy makes of a variable
    """Structures as mappings, cells and arrays of structures as lists, characters as text."""
    if depth > _DEEPEST:
        raise InputError(
            f"Structures are nested more than {_DEEPEST} deep",
            remedy="Save the channels as vectors",
        )
    if isinstance(item, Mapping):
        return {str(name): as_tree(value, depth + 1) for name, value in item.items()}
    if isinstance(item, np.ndarray) and item.dtype == object:
        if item.size > _MOST_ITEMS:
            raise InputError(
                f"A cell array has more than {_MOST_ITEMS:,} cells",
                value=f"{item.size:,}",
                remedy="Save the channels as vectors of numbers",
            )
        return [as_tree(value, depth + 1) for value in item.reshape(-1, order="F")]
    if isinstance(item, list | tuple):
        return [as_tree(value, depth + 1) for value in item[:_MOST_ITEMS]]
    return item if isinstance(item, str) else np.asarray(item)
