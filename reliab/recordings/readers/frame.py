"""A test in a data frame of pandas, one history in each column."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from reliab.recordings.readers.columns import Columns

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import TypeIs


def is_frame(test: object) -> "TypeIs[pd.DataFrame]":
    """Tell a data frame from anything else; whoever made one has imported pandas."""
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(test, pandas.DataFrame)


def read_frame(frame: "pd.DataFrame") -> Columns:
    """Take the columns of numbers of a data frame.

    >>> import pandas as pd
    >>> frame = pd.DataFrame({"time_s": [0.0, 0.1], "command_m": [0, 1], "remark": ["", "start"]})
    >>> list(read_frame(frame).values)
    ['time_s', 'command_m']
    """
    numbers = frame.select_dtypes("number")
    return Columns(
        path=Path("the data frame"),
        values={str(name): numbers[name].to_numpy(dtype=np.float64) for name in numbers},
        header={str(name).lower(): str(value) for name, value in frame.attrs.items()},
        named=not all(isinstance(name, int) for name in numbers),
    )
