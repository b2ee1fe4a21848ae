"""Arrays of a binary file as columns."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.recordings.readers.columns import Columns

_MOST_COLUMNS = 64
_MATRIX = 2


def columns_of_arrays(
    path: Path, arrays: Mapping[str, NDArray[Any]], units: Mapping[str, str] | None = None
) -> Columns:
    """Take the vectors, narrow matrices and single numbers among arrays.

    Returns vectors of the most common length; columns of a matrix as ``name[1]``, ``name[2]`` ….
    """
    vectors: dict[str, NDArray[np.float64]] = {}
    scalars: dict[str, float] = {}
    for name, array in arrays.items():
        if not (np.issubdtype(array.dtype, np.number) and np.isrealobj(array)):
            continue
        values = np.asarray(array, dtype=np.float64).squeeze()
        if values.ndim == 0:
            scalars[name] = float(values)
        elif values.ndim == 1:
            vectors[name] = values
        elif values.ndim == _MATRIX and min(values.shape) <= _MOST_COLUMNS:
            long = values if values.shape[0] >= values.shape[1] else values.T
            vectors |= {f"{name}[{place + 1}]": column for place, column in enumerate(long.T)}
    if not vectors:
        raise InputError(
            "A test's file must hold vectors of numbers",
            value=", ".join(arrays) or "nothing",
            remedy="Save command and measured displacement as vectors",
            where=path.name,
        )
    sizes = [vector.size for vector in vectors.values()]
    size = max(set(sizes), key=lambda length: (sizes.count(length), length))
    return Columns(
        path=path,
        values={name: vector for name, vector in vectors.items() if vector.size == size},
        units=dict(units or {}),
        scalars=scalars,
        named=len(vectors) > 1 and not all(name.endswith("]") for name in vectors),
    )
