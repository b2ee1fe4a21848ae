"""A test in a data frame of pandas, one history in each column."""

from pathlib import Path

import numpy as np
import pandas as pd

from reliab.recordings.readers.columns import Columns


def read_frame(frame: pd.DataFrame) -> Columns:
    """Take the columns of numbers of a data frame.

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
