"""MATLAB files of version 4 to 7.2: through SciPy, and where they hold objects of classes through mat-io."""

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

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


_HEADER: Final = 20  # bytes
_BYTES_OF: Final = (8, 4, 4, 2, 2, 1)  # of a number, by the code of its kind
_LONGEST_NAME: Final = 64
_KINDS: Final = 3  # of matrices: numbers, text, sparse


class _Matrix(NamedTuple):
    """What the header of a matrix states."""

    name_length: int  # with the zero behind it
    rows: int
    columns: int
    size: int  # bytes of its numbers


def recognises_matlab_4(head: bytes) -> bool:
    """Whether a file begins with the header of a matrix and a name."""
    matrix = _matrix(head)
    if matrix is None:
        return False
    name = head[_HEADER : _HEADER + matrix.name_length]
    return name.endswith(b"\x00") and name[:-1].replace(b"_", b"a").isalnum()


def read_matlab_4(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the vectors and matrices of a file, whose sizes are compared with its own before."""
    _require_whole(path)
    content = scipy.io.loadmat(path, simplify_cells=True)
    return tests_of_tree(
        path, {name: as_tree(item) for name, item in content.items() if not name.startswith("__")}
    )


def _require_whole(path: Path) -> None:
    """Refuse matrices that reach beyond the end of the file, before memory is taken for them."""
    length, place = path.stat().st_size, 0
    with path.open("rb") as file:
        while place < length:
            file.seek(place)
            matrix = _matrix(file.read(_HEADER))
            if matrix is None:
                raise ValueError(f"no matrix at byte {place}")
            require_few_samples(max(matrix.rows, matrix.columns), path.name)
            place += _HEADER + matrix.name_length + matrix.size
    if place != length:
        raise ValueError("a matrix that reaches beyond the end of the file")


def _matrix(head: bytes) -> _Matrix | None:
    """Read the header of a matrix in either order of bytes; None where it is none."""
    if len(head) < _HEADER:
        return None
    for order, machine in (("<", 0), (">", 1)):
        code, rows, columns, imaginary, name_length = struct.unpack(f"{order}5i", head[:_HEADER])
        thousands, kind = divmod(code, 1000)
        precision, sort = divmod(kind, 10)
        if (
            thousands == machine
            and 0 <= precision < len(_BYTES_OF)
            and sort < _KINDS
            and min(rows, columns) >= 0
            and imaginary in {0, 1}
            and 1 < name_length <= _LONGEST_NAME
        ):
            size = rows * columns * _BYTES_OF[precision] * (1 + imaginary)
            return _Matrix(name_length=name_length, rows=rows, columns=columns, size=size)
    return None
